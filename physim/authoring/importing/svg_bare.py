"""A drawing with all left out that is not needed to find its lines, written anew.

What the library that reads it never sees costs nothing there, however much of it there is: colours,
fonts, embedded images, text, attributes of other programs, style sheets but for what they hide.
What no program draws where it stands is put into ``defs``, as the library knows no other way.
"""

from __future__ import annotations

import re
from xml.sax.saxutils import quoteattr

from physim.authoring.importing.svg_paths import as_meant
from physim.authoring.importing.svg_seen import INVISIBLE, handed_on
from physim.authoring.importing.svg_sheets import IGNORED, SELECTOR, SHOWN, declarations, rules
from physim.authoring.importing.svg_values import (
    AUTO,
    EXTENTS,
    ORIGINS,
    PLACES,
    RADII,
    origin_of,
    pixels_of,
)
from physim.escaping import escaped

XLINK = "http://www.w3.org/1999/xlink|href"
LABEL = "http://www.inkscape.org/namespaces/inkscape|label"
SVG = "http://www.w3.org/2000/svg|"
FAULT = "physim-fault"
"""Attribute that says what is wrong with an element, where it matters"""
LINE, TAG, CUT, SPILLS = "physim-line", "physim-tag", "physim-cut", "physim-spills"
"""Attributes that tell of an element where it stands, and what it or a group about it is cut by.

The last is that of a drawing within a drawing that is not cut at its edges.
"""
PREFIXES = {LABEL: "inkscape:label", XLINK: "xlink:href"}
KEPT = ("id", LABEL, "transform", "display", "d", "points", *PLACES, *EXTENTS, "viewBox",
        "preserveAspectRatio")  # fmt: skip
STYLED = ("display", "transform", *PLACES, *EXTENTS)
"""Properties that count in ``style="..."``."""
NOTHING = re.compile(r"[-+]?(0+\.?0*|\.0+)%?")
"""An opacity of zero."""
CUTS = ("clip-path", "mask")
"""Properties by which only a part of an element is drawn; they are not applied, but told."""
UNSEEN = ("display", "visibility", "opacity", "fill", "stroke")
"""Properties by which an element is not to be seen."""
FROM_SHEETS = (*UNSEEN, *CUTS)
"""Properties that count in a style sheet."""
UNREAD = ("d", "rotate", "scale", "translate", "offset-path")
"""Properties that change lines, and are read nowhere but as attributes or in ``transform``."""
BEYOND = "by more than a tag, a class or an id; delete what is hidden, or save as plain SVG"
NOT_LINES = ("text", "image", "foreignObject", "flowRoot")
"""Elements that hold no lines; they are listed as left out."""
ONLY_COPIED = "symbol"
"""An element that is drawn by its copies (``use``) alone"""
NOT_DRAWN = ("defs", "clipPath", "pattern", "mask", "marker", ONLY_COPIED)
"""Elements that hold what is drawn elsewhere, if at all."""
AS_DEFS = ("mask", "marker", "foreignObject", "flowRoot")
"""Those whose shapes the library would take for drawn."""
ROOT = ' xmlns="{}" xmlns:xlink="{}" xmlns:inkscape="{}"'.format(
    *(name.partition("|")[0] for name in (SVG, XLINK, LABEL))
)


class BareSvg:
    """The text of a drawing, put together element by element."""

    def __init__(self) -> None:
        self._parts: list[str] = []
        self._ends: list[str] = []
        self._hides = self._shows = ""
        self.origin = ""
        """what in a style sheet turns elements about another point than (0, 0)"""

    @property
    def text(self) -> str:
        """All of it."""
        return "".join(self._parts)

    def start(self, name: str, attributes: dict[str, str], line: int, fault: str) -> None:
        """Begin an element; ``name`` and the names of its attributes are as expat has them.

        ``fault`` is what is wrong with it if it has a role.
        """
        tag = name.removeprefix(SVG)
        tag = "other" if "|" in tag else tag
        shown = tag if tag.isascii() and tag.isalnum() else "element"
        kept = {key: attributes[key] for key in KEPT if key in attributes}
        style = declarations(attributes.get("style", ""), STYLED)
        is_within = tag == "svg" and bool(self._ends)
        if tag == "svg" and not is_within:  # the page is where it is
            for key in ("x", "y"):
                kept.pop(key, None)
                style.pop(key, None)
        if style:
            kept["style"] = ";".join(f"{key}:{value}" for key, value in style.items())
        own = {**kept, **style}
        if "d" in kept:
            kept["d"] = as_meant(kept["d"])
        for key, other in (RADII, RADII[::-1]):
            if own.get(key, "").strip().lower() == AUTO:  # the library would take it for none
                length = own.get(other, AUTO)
                kept["style"] = f"{kept.get('style', '')};{key}:{length if length != AUTO else 0}"
        cut = _cut({**attributes, **declarations(attributes.get("style", ""), CUTS)})
        if is_within and _spills(attributes):
            kept[SPILLS] = "yes"
        if tag == ONLY_COPIED and "viewBox" in attributes:  # would fit it into its copies' boxes
            cut = "viewBox"
        if cut:
            kept[CUT] = f"line {line}: {called(tag, attributes)}: its {cut}"
        elif IGNORED in attributes:
            kept[CUT] = f"<style> has a {attributes[IGNORED]}, which"
        if tag == "use" and (href := attributes.get(XLINK, attributes.get("href"))) is not None:
            kept[XLINK] = href
        kept |= handed_on(attributes)
        kept |= {LINE: str(line), TAG: shown, **({FAULT: fault} if fault else {})}
        written = (f" {PREFIXES.get(key, key)}={quoteattr(value)}" for key, value in kept.items())
        tag = "defs" if tag in AS_DEFS else tag
        begin, end = ("<defs>", "</defs>") if tag == ONLY_COPIED else ("", "")
        self._parts.append(f"{begin}<{tag}{'' if self._ends else ROOT}{''.join(written)}>")
        if is_within and "viewBox" not in kept:  # the library moves what is in one with a view only
            x, y = (pixels_of(own.get(key, "0")) for key in ("x", "y"))
            self._parts.append(f'<g transform="translate({x!r},{y!r})">')
            self._ends.append(f"</g></{tag}>")
        else:
            self._ends.append(f"</{tag}>{end}")

    def sheet(self, text: str) -> str:
        """What is wrong with a style sheet, or nothing."""
        for selector, body in rules(text):
            shown = f'"{escaped(selector)[:60]}"'
            found = declarations(body, (*STYLED, *CUTS, *UNSEEN, *UNREAD, *ORIGINS))
            for key in ("transform", *UNREAD):
                if found.get(key, "none").lower() != "none":
                    return f"{shown} has a {key}; only those of elements are read"
            if wrong := origin_of(found):
                self.origin = self.origin or f"{shown} has {wrong}"
            hides = (
                _is_unseen(found)
                or found.get("display", "").lower() == "none"
                or found.get("visibility", "").lower() in INVISIBLE
            )
            if all(SELECTOR.fullmatch(one.strip()) for one in selector.split(",")):
                self._hides = self._hides or (shown if hides else "")
                continue
            if _cut(found) or hides:
                return f"{shown} hides or cuts what it selects, {BEYOND}"
            if any(key in found for key in SHOWN):
                self._shows = self._shows or shown
        if self._hides and self._shows:
            return f"{self._shows} may show what {self._hides} hides, {BEYOND}"
        return ""

    def is_hidden(self, attributes: dict[str, str]) -> bool:
        """Whether an element hides itself and all in it."""
        own = {**attributes, **declarations(attributes.get("style", ""), UNSEEN)}
        return own.get("display", "").strip().lower() == "none" or _is_unseen(own)

    def end(self) -> None:
        """End the element that was begun last."""
        self._parts.append(self._ends.pop())


def hidden(attributes: dict[str, str]) -> dict[str, str]:
    """Attributes of an element, so that it is hidden whatever they say."""
    return {**attributes, "style": f"{attributes.get('style', '')};display:none !important"}


def hidden_by(attributes: dict[str, str]) -> str:
    """By which attribute an element is hidden where no style says otherwise; or empty.

    Any rule of a style sheet comes before it, unlike before a style of the element's own.
    """
    own = {key: attributes[key].strip().lower() for key in SHOWN if key in attributes}
    for key in declarations(attributes.get("style", ""), SHOWN):
        own.pop(key, None)
    is_hidden = {
        "display": own.get("display") == "none",
        "visibility": own.get("visibility") in INVISIBLE,
        "opacity": _is_unseen(own),
    }
    return next((key for key in SHOWN if is_hidden[key]), "")


def _is_unseen(properties: dict[str, str]) -> bool:
    return NOTHING.fullmatch(properties.get("opacity", "1").strip()) is not None


def called(tag: str, attributes: dict[str, str]) -> str:
    """``<rect> "pillar"``: an element as messages call it, by its label or else its id."""
    name = attributes.get(LABEL) or attributes.get("id") or ""
    return f'<{escaped(tag[:40])}> "{escaped(name)[:60]}"' if name else f"<{escaped(tag[:40])}>"


def _cut(properties: dict[str, str]) -> str:
    """``clip-path``, ``mask``, both, or neither: by what an element of these properties is cut."""
    given = (key for key in CUTS if properties.get(key, "none").strip().lower() != "none")
    return " and ".join(given)


def _spills(attributes: dict[str, str]) -> bool:
    """Whether what is in a drawing within a drawing is drawn beyond its edges, too."""
    style = declarations(attributes.get("style", ""), ("overflow",))
    return {**attributes, **style}.get("overflow", "").strip().lower() == "visible"


def functions_of(tag: str, attributes: dict[str, str]) -> int:
    """How many functions of transforms move what is in an element; a page within one has three."""
    style = declarations(attributes.get("style", ""), ("transform",))
    own = attributes.get("transform", "") + style.get("transform", "")
    return own.count("(") + (3 if tag == "svg" else 0)
