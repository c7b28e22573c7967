"""Markup of pages: elements, tables and a whole page. What is not `Html` is text, and only text.

``tag("a", "r1 & r2", href="#t=3", class_="worst")`` gives
``<a href="#t=3" class="worst">r1 &amp; r2</a>``.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterable
from html import escape

from physim.escaping import escaped, escaped_lines

EMPTY = frozenset({"br", "hr", "img", "input", "link", "meta", "source"})
"""Elements without an end"""


class Html(str):
    """Markup that was made here: it is put into a page as it is."""

    __slots__ = ()


def text(value: object) -> Html:
    """A value as text of a page or as a value within quotes: nothing in it acts."""
    return value if isinstance(value, Html) else Html(escape(escaped(str(value)), quote=True))


def tag(name: str, /, *children: object, **attributes: object) -> Html:
    """An element. Children are texts, `Html`, or what gives these one by one; None is left out.

    Attributes: an underscore at the end is dropped and within a name is a hyphen (``class_``,
    ``data_name``). False and None leave an attribute out, True writes it without a value.
    """
    opened = name
    for key, value in attributes.items():
        if value is not None and value is not False:
            key = key.rstrip("_").replace("_", "-")
            opened += f" {key}" if value is True else f' {key}="{text(value)}"'
    if name in EMPTY:
        return Html(f"<{opened}>")
    return Html(f"<{opened}>{together(children)}</{name}>")


def together(children: object, between: str = "") -> Html:
    """Markup of a text, of `Html`, or of all that an iterable gives, one behind the other."""
    if children is None:
        return Html()
    if isinstance(children, str) or not isinstance(children, Iterable):
        return text(children)
    return Html(between.join(together(child) for child in children))


def table(
    head: Iterable[object], rows: Iterable[Iterable[object]], *, caption: object = None,
    **attributes: object,
) -> Html:  # fmt: skip
    """A table in a box that scrolls sideways where the screen is narrow.

    A cell is text or `Html`; a whole ``td`` or ``th``, made by `tag`, stays as it is.
    """

    def line(cells: Iterable[object]) -> Html:
        return tag("tr", (cell if is_cell(cell) else tag("td", cell) for cell in cells))

    def is_cell(cell: object) -> bool:
        return isinstance(cell, Html) and cell.startswith(("<td", "<th"))

    top = [cell if is_cell(cell) else tag("th", cell, scope="col") for cell in head]
    return tag(
        "div",
        tag(
            "table",
            tag("caption", caption) if caption else None,
            tag("thead", tag("tr", top)) if top else None,
            tag("tbody", (line(row) for row in rows)),
            **attributes,
        ),
        class_="wide",
    )


def labelled(rows: Iterable[tuple[str, str]]) -> Html:
    """A plain table of labels and texts, as notebooks show it."""
    return tag(
        "table",
        (
            tag("tr", tag("th", label, scope="row", align="left"), tag("td", words, align="left"))
            for label, words in rows
        ),
    )


def lines(words: str) -> Html:
    """Text of several lines, their ends kept."""
    return tag("pre", Html(escape(escaped_lines(words))))


def page(
    title: str,
    body: object,
    *,
    style: str,
    script: str = "",
    generator: str = "",
    head: object = (),
    beside: bool = False,
) -> Html:
    """A whole page that loads nothing: one style and at most one script, both within it.

    ``style`` and ``script`` are our own files, put in as they are; ``head`` is further markup.
    ``beside``: it may show videos and pages that lie beside it.
    """
    meta = [
        tag("meta", charset="utf-8"),
        tag("meta", name="generator", content=generator) if generator else None,
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", http_equiv="Content-Security-Policy", content=policy(style, script, beside)),
        tag("title", title),
        head,
        Html(f"<style>{style}</style>"),
    ]
    end = Html(f"<script>{script}</script>") if script else None
    whole = tag("html", tag("head", meta), tag("body", body, end), lang="en")
    return Html(f"<!DOCTYPE html>\n{whole}\n")


def policy(style: str, script: str = "", beside: bool = False) -> str:
    """Content-Security-Policy of such a page: pictures lie within it, nothing is loaded but, with
    ``beside``, videos and pages from its own place."""

    def digest(words: str) -> str:
        return f"'sha256-{base64.b64encode(hashlib.sha256(words.encode()).digest()).decode()}'"

    runs = f"script-src {digest(script)}; " if script else ""
    loads = "media-src 'self' file:; frame-src 'self' file:; " if beside else ""
    return (
        f"default-src 'none'; {loads}{runs}style-src {digest(style)}; img-src data:; "
        "base-uri 'none'; form-action 'none'"
    )
