"""A drawing with all left out that is not needed to find its lines, written anew.

What the library that reads it never sees costs nothing there, however much of it there is: colours,
fonts, embedded images, text, attributes of other programs, style sheets but for what they hide.
"""

from __future__ import annotations

from itertools import islice
from xml.sax.saxutils import escape, quoteattr

from physim.authoring.importing.svg_values import EXTENTS, PLACES

XLINK = "http://www.w3.org/1999/xlink|href"
LABEL = "http://www.inkscape.org/namespaces/inkscape|label"
SVG = "http://www.w3.org/2000/svg|"
LINE, TAG = "physim-line", "physim-tag"
"""Attributes that tell of an element where it stands"""
PREFIXES = {LABEL: "inkscape:label", XLINK: "xlink:href"}
KEPT = ("id", LABEL, "transform", "display", "class", "d", "points", *PLACES, *EXTENTS, "viewBox",
        "preserveAspectRatio")  # fmt: skip
STYLED = ("display", "transform", *PLACES, *EXTENTS)
"""Properties that count in ``style="..."``; in a style sheet the first alone."""
MOST_CLASSES = 20
"""Classes of an element that are looked up"""
ROOT = ' xmlns="{}" xmlns:xlink="{}" xmlns:inkscape="{}"'.format(
    *(name.partition("|")[0] for name in (SVG, XLINK, LABEL))
)


class BareSvg:
    """The text of a drawing, put together element by element."""

    def __init__(self) -> None:
        self._parts: list[str] = []
        self._names: list[str] = []

    @property
    def text(self) -> str:
        """All of it."""
        return "".join(self._parts)

    def start(self, name: str, attributes: dict[str, str], line: int) -> None:
        """Begin an element; ``name`` and the names of its attributes are as expat has them."""
        tag = name.removeprefix(SVG)
        tag = "other" if "|" in tag else tag
        shown = tag if tag.isascii() and tag.isalnum() else "element"
        kept = {key: attributes[key] for key in KEPT if key in attributes}
        if "class" in kept:
            kept["class"] = " ".join(islice(dict.fromkeys(kept["class"].split()), MOST_CLASSES))
        if style := _declarations(attributes.get("style", ""), STYLED):
            kept["style"] = ";".join(f"{key}:{value}" for key, value in style.items())
        if tag == "use" and (href := attributes.get(XLINK, attributes.get("href"))) is not None:
            kept[XLINK] = href
        kept |= {LINE: str(line), TAG: shown}
        written = (f" {PREFIXES.get(key, key)}={quoteattr(value)}" for key, value in kept.items())
        self._parts.append(f"<{tag}{'' if self._names else ROOT}{''.join(written)}>")
        self._names.append(tag)

    def sheet(self, text: str) -> str:
        """Take what a style sheet hides; returns the first selector that moves anything, or ""."""
        for selector, body in _rules(text):
            found = _declarations(body, STYLED)
            if "transform" in found:
                return selector
            if "display" in found:
                self._parts.append(escape(f"{selector}{{display:{found['display']}}}"))
        return ""

    def end(self) -> None:
        """End the element that was begun last."""
        self._parts.append(f"</{self._names.pop()}>")


def functions_of(tag: str, attributes: dict[str, str]) -> int:
    """How many functions of transforms move what is in an element; a page within one has two."""
    style = _declarations(attributes.get("style", ""), ("transform",))
    own = attributes.get("transform", "") + style.get("transform", "")
    return own.count("(") + (2 if tag == "svg" else 0)


def _rules(text: str) -> list[tuple[str, str]]:
    """Selectors and declarations of a style sheet; linear in its length."""
    begun, *commented = text.split("/*")
    text = begun + "".join(part.partition("*/")[2] for part in commented)
    parts = (part.rpartition("{") for part in text.split("}"))
    return [(selector.strip(), body) for selector, opened, body in parts if opened]


def _declarations(style: str, keys: tuple[str, ...]) -> dict[str, str]:
    """Those of some properties, the last of each; without ``!important``."""
    parts = (one.partition(":") for one in style.split(";"))
    found = {key.strip().lower(): value.partition("!")[0].strip() for key, _, value in parts}
    return {key: found[key] for key in keys if found.get(key)}
