"""Blocks as one HTML page that needs nothing beside it but the videos."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from html import escape
from pathlib import Path
from urllib.parse import quote

from physim.reproduction.document import (
    Block,
    Code,
    Commands,
    Film,
    Heading,
    Inline,
    Link,
    Paragraph,
    Picture,
    Table,
    Words,
    inlines,
)
from physim.reproduction.study import Outcome

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
.pictures { display: flex; flex-wrap: wrap; gap: 1.25rem; align-items: flex-start; }
figure { margin: 0; flex: 1 1 28rem; max-width: min(100%, 34rem); }
figure.whole { flex-basis: 100%; max-width: min(100%, 56rem); }
img, video { max-width: 100%; height: auto; display: block; }
figcaption { font-size: .85rem; color: #62686f; margin-top: .3rem; }
@media print { h2 { break-after: avoid; } figure, tr { break-inside: avoid; } }
"""


def html(blocks: Sequence[Block], title: str, folder: Path) -> str:
    """Text of a page; pictures are read from ``folder``. Raises OSError where one is missing."""
    body, pictures = [], list[str]()
    for block in blocks:
        if isinstance(block, Picture | Film):
            pictures.append(_figure(block, folder))
            continue
        body += _gathered(pictures)
        body.append(_block(block))
    body += _gathered(pictures)
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<link rel="icon" href="data:,">\n<title>{escape(title)}</title>\n'
        f"<style>\n{STYLE}</style>\n</head>\n<body>\n" + "\n".join(body) + "\n</body>\n</html>\n"
    )


def _gathered(pictures: list[str]) -> list[str]:
    """Pictures so far, side by side; leaves none."""
    if not pictures:
        return []
    shown = "\n".join(pictures)
    pictures.clear()
    return [f'<div class="pictures">\n{shown}\n</div>']


def _figure(block: Picture | Film, folder: Path) -> str:
    caption, kind = escape(block.caption), ""
    if isinstance(block, Film):
        file = escape(quote(block.file))
        shown = (
            f'<video controls preload="metadata" src="{file}"></video>'
            f'<figcaption>{caption} (<a href="{file}">{escape(block.file)}</a>)</figcaption>'
        )
    else:
        content = (folder / block.file).read_bytes()
        data = base64.b64encode(content).decode("ascii")
        if _pixels_across(content) > WIDE:
            kind = ' class="whole"'
        shown = (
            f'<img src="data:image/png;base64,{data}" alt="{caption}">'
            f"<figcaption>{caption}</figcaption>"
        )
    return f"<figure{kind}>{shown}</figure>"


def _pixels_across(png: bytes) -> int:
    """Width of a PNG, from its header."""
    return int.from_bytes(png[16:20], "big")


def _block(block: Heading | Paragraph | Commands | Table) -> str:
    match block:
        case Heading():
            mark = f' id="{escape(block.anchor)}"' if block.anchor else ""
            return f"<h{block.level}{mark}>{escape(block.text)}</h{block.level}>"
        case Paragraph():
            return f"<p>{_words(block.words)}</p>"
        case Commands():
            lines = escape("\n".join(block.lines))
            return f"<pre><code>{lines}</code></pre>"
        case Table():
            head = "".join(f"<th>{escape(cell)}</th>" for cell in block.header)
            rows = "\n".join(
                "<tr>" + "".join(f"<td>{_words(cell)}</td>" for cell in row) + "</tr>"
                for row in block.rows
            )
            return (
                f'<div class="wide"><table>\n<thead><tr>{head}</tr></thead>\n'
                f"<tbody>\n{rows}\n</tbody>\n</table></div>"
            )


def _words(words: Words) -> str:
    return "".join(_inline(one) for one in inlines(words))


def _inline(one: Inline) -> str:
    match one:
        case Code():
            return f"<code>{escape(one.text)}</code>"
        case Link():
            target = one.target if one.target.startswith("#") else quote(one.target)
            return f'<a href="{escape(target)}">{escape(one.text)}</a>'
        case Outcome():
            kind = one.value.replace(" ", "-")
            return f'<span class="outcome {kind}">{escape(one.value)}</span>'
        case str():
            return escape(one)
