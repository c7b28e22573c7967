"""The Markdown of a report as one HTML page that needs nothing beside it but the videos."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from urllib.parse import unquote

from markdown_it import MarkdownIt
from markdown_it.common.utils import escapeHtml
from markdown_it.renderer import RendererHTML
from markdown_it.token import Token
from markdown_it.utils import EnvType, OptionsDict

from physim.reproduction.page import anchor_of

WIDE = 1000
"""[px] Wider pictures (maps) have a line for themselves."""
STYLE = """\
:root { color-scheme: light; }
body { margin: 0 auto; padding: 2rem 1.25rem 4rem; max-width: 70rem; color: #22262c;
  background: #fff; font: 16px/1.5 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .5rem; }
h2 { font-size: 1.35rem; margin: 3rem 0 .5rem; padding-top: 1rem; border-top: 1px solid #d6dade; }
h3 { font-size: 1.05rem; margin: 2rem 0 .5rem; }
p { max-width: 48rem; margin: .5rem 0; }
a { color: #0b5cad; }
code { font: .875em/1.4 ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace;
  background: #f3f4f6; padding: .1em .3em; border-radius: 3px; }
pre { background: #f3f4f6; padding: .6rem .9rem; border-radius: 4px; overflow-x: auto;
  max-width: 100%; box-sizing: border-box; }
pre code { padding: 0; }
.wide { overflow-x: auto; margin: 1rem 0; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; }
th, td { text-align: left; vertical-align: top; padding: .45rem .7rem .45rem 0;
  border-bottom: 1px solid #d6dade; }
th { border-bottom: 2px solid #62686f; white-space: nowrap; }
td { min-width: 5.5rem; }
td:first-child { min-width: 14rem; }
.outcome { font-weight: 600; white-space: nowrap; padding: .1em .5em; border-radius: 3px; }
.met { background: #d8eedf; color: #0b4a2f; }
.partly-met { background: #fdeccb; color: #6b4200; }
.not-met { background: #f9d9c8; color: #7a2600; }
figure { display: inline-block; vertical-align: top; margin: .6rem .5rem .6rem 0;
  width: max(28rem, calc(50% - 1rem)); max-width: 100%; }
figure.whole { display: block; width: min(100%, 56rem); }
img, video { max-width: 100%; height: auto; display: block; }
figcaption { font-size: .85rem; color: #62686f; margin-top: .3rem; }
@media print { h2 { break-after: avoid; } figure, tr { break-inside: avoid; } }
"""


def html(text: str, title: str, folder: Path) -> str:
    """Page made from Markdown; pictures are read from ``folder``. Raises OSError for a missing one.

    Markup within the Markdown (raw HTML) is shown, not followed.
    """
    parser = MarkdownIt("js-default", {"html": False}, renderer_cls=_Renderer)
    tokens = parser.parse(text)
    for opening, inline, closing in zip(tokens, tokens[1:], tokens[2:], strict=False):
        children = inline.children or []
        if opening.type == "heading_open":
            opening.attrSet("id", anchor_of("".join(child.content for child in children)))
        for child, following in pairwise(children):
            if child.type == "strong_open":
                child.attrSet("class", f"outcome {following.content.replace(' ', '-')}")
        if opening.type == "paragraph_open" and _is_figure(children):
            opening.tag = closing.tag = "figure"
            if children[0].type == "image" and _embed(children[0], folder) > WIDE:
                opening.attrSet("class", "whole")
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<link rel="icon" href="data:,">\n<title>{escapeHtml(title)}</title>\n'
        f"<style>\n{STYLE}</style>\n</head>\n<body>\n"
        f"{parser.renderer.render(tokens, parser.options, {})}</body>\n</html>\n"
    )


class _Renderer(RendererHTML):
    """Tables that scroll, pictures with captions, videos that play."""

    def table_open(
        self, tokens: Sequence[Token], idx: int, options: OptionsDict, env: EnvType
    ) -> str:
        return f'<div class="wide">{self.renderToken(tokens, idx, options, env)}'

    def table_close(
        self, tokens: Sequence[Token], idx: int, options: OptionsDict, env: EnvType
    ) -> str:
        return f"{self.renderToken(tokens, idx, options, env).rstrip()}</div>\n"

    def image(self, tokens: Sequence[Token], idx: int, options: OptionsDict, env: EnvType) -> str:
        picture = super().image(tokens, idx, options, env)
        return f"{picture}<figcaption>{escapeHtml(str(tokens[idx].attrs['alt']))}</figcaption>"

    def link_open(
        self, tokens: Sequence[Token], idx: int, options: OptionsDict, env: EnvType
    ) -> str:
        link = self.renderToken(tokens, idx, options, env)
        if not _is_film(tokens[idx]):
            return link
        file = escapeHtml(str(tokens[idx].attrs["href"]))
        return f'<video controls preload="metadata" src="{file}"></video>{link}'


def _is_figure(children: Sequence[Token]) -> bool:
    """Whether a paragraph is a picture or a video."""
    return (len(children) == 1 and children[0].type == "image") or any(map(_is_film, children[:1]))


def _is_film(token: Token) -> bool:
    return token.type == "link_open" and str(token.attrs["href"]).endswith(".mp4")


def _embed(picture: Token, folder: Path) -> int:
    """Put the file of a picture into the page itself; returns its width [pixels]."""
    content = (folder / unquote(str(picture.attrs["src"]))).read_bytes()
    picture.attrSet("src", f"data:image/png;base64,{base64.b64encode(content).decode('ascii')}")
    return int.from_bytes(content[16:20], "big")  # from the header of a PNG
