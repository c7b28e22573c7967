"""A drawing with all left out that is not needed to find its lines, written anew.

What the library that reads it never sees costs nothing there, however much of it there is: colours,
fonts, embedded images, text, attributes of other programs, style sheets but for what they hide.
What no program draws where it stands is put into ``defs``, as the library knows no other way.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from urllib.parse import unquote
from xml.sax.saxutils import quoteattr

from physim.authoring.importing.svg_css import CUTS, NAMESPACE
from physim.authoring.importing.svg_paths import as_meant
from physim.authoring.importing.svg_seen import handed_on
from physim.authoring.importing.svg_sheets import IGNORED, cut_of, declarations, hidden_by
from physim.authoring.importing.svg_values import (
    AUTO,
    EXTENTS,
    NUMBER,
    PLACES,
    RADII,
    SHAPES,
    pixels_of,
)
from physim.escaping import escaped

XLINK = "http://www.w3.org/1999/xlink|href"
LABEL = "http://www.inkscape.org/namespaces/inkscape|label"
SVG = f"{NAMESPACE}|"
FAULT = "physim-fault"
"""Attribute that says what is wrong with an element, where it matters"""
LINE, TAG, CUT, SPILLS = "physim-line", "physim-tag", "physim-cut", "physim-spills"
"""Attributes that tell of an element where it stands, and what it or a group about it is cut by.

The last is that of a drawing within a drawing that is not cut at its edges.
"""
SAME_ID = "physim-id"
"""Attribute for an id that an element before has, which is the one that copies (``use``) mean"""
PREFIXES = {LABEL: "inkscape:label", XLINK: "xlink:href"}
KEPT = ("id", LABEL, "transform", "display", "d", "points", *PLACES, *EXTENTS, "viewBox",
        "preserveAspectRatio")  # fmt: skip
OF_PLACE = (*PLACES, *EXTENTS, "d", "points", "viewBox", "preserveAspectRatio")
"""Attributes that say where the lines of an element lie: of those that take them alone"""
STYLED = ("display", *PLACES, *EXTENTS)
"""Properties that count in ``style="..."``."""
UNGIVEN = {
    "path": {"d": ""},
    "rect": dict.fromkeys(("x", "y", "width", "height"), "0"),
    "circle": dict.fromkeys(("cx", "cy", "r"), "0"),
    "ellipse": dict.fromkeys(("cx", "cy"), "0"),
    "line": dict.fromkeys(("x1", "y1", "x2", "y2"), "0"),
    "polyline": {"points": ""},
    "polygon": {"points": ""},
    "use": {"x": "0", "y": "0"},
    "svg": {
        "x": "0",
        "y": "0",
        "width": "100%",
        "height": "100%",
        "preserveAspectRatio": "xMidYMid",
    },
}
"""What holds of an element that does not say so: the library would take that of one about it."""
FURTHER = {
    "rect": RADII,
    "ellipse": RADII,
    "use": ("width", "height"),
    "svg": ("viewBox",),
    "symbol": ("viewBox",),
}
"""What else an element takes of what says where its lines lie; others have none of it."""
NOT_LINES = ("text", "image", "foreignObject", "flowRoot")
"""Elements that hold no lines; they are listed as left out."""
ONLY_COPIED = "symbol"
"""An element that is drawn by its copies (``use``) alone"""
MOVING = ("animate", "animateMotion", "animateTransform", "set")
"""Elements that change what they stand in as time goes by"""
NOT_DRAWN = ("defs", "clipPath", "pattern", "mask", "marker", ONLY_COPIED)
"""Elements that hold what is drawn elsewhere, if at all."""
DRAWN = ("svg", "g", "a", "switch", "use", *SHAPES)
"""Elements that are drawn, or hold what is; nothing is drawn of others and of what is in them."""
AS_THEY_ARE = (*DRAWN, "defs", "clipPath", "pattern", ONLY_COPIED)
"""Those that the library takes for what they are."""
ROOT = ' xmlns="{}" xmlns:xlink="{}" xmlns:inkscape="{}"'.format(
    *(name.partition("|")[0] for name in (SVG, XLINK, LABEL))
)


class BareSvg:
    """The text of a drawing, put together element by element."""

    def __init__(self) -> None:
        self._parts: list[str] = []
        self._ends: list[str] = []
        self._ids: set[str] = set()

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
        kept = {**_taken(tag, attributes, KEPT), **transform_of(attributes)}
        if kept.get("id") in self._ids:
            kept[SAME_ID] = kept.pop("id")
        self._ids.add(kept.get("id", ""))
        style = _taken(tag, declarations(attributes.get("style", ""), STYLED), STYLED)
        is_within = tag == "svg" and bool(self._ends)
        if tag == "svg" and not is_within:  # the page is where it is
            for key in ("x", "y"):
                kept.pop(key, None)
                style.pop(key, None)
        if tag == "svg":  # of which the library reads no style
            kept, style = {**kept, **style}, {}
        if style:
            kept["style"] = ";".join(f"{key}:{value}" for key, value in style.items())
        own = {**kept, **style}
        if "d" in kept:
            kept["d"] = as_meant(kept["d"])
        if "points" in kept:  # the library wants gaps between them
            kept["points"] = " ".join(NUMBER.findall(kept["points"]))
        for key, other in (RADII, RADII[::-1]):
            given = own.get(key, AUTO if tag in ("ellipse", "rect") else "")
            if given.strip().lower() == AUTO:  # the library would take it for none
                length = own.get(other, AUTO)
                kept["style"] = f"{kept.get('style', '')};{key}:{length if length != AUTO else 0}"
        cut = cut_of({**attributes, **declarations(attributes.get("style", ""), CUTS)})
        if is_within and _spills(attributes):
            kept[SPILLS] = "yes"
        if tag == ONLY_COPIED and kept.pop("viewBox", ""):  # its copies fit it into their boxes
            cut = cut or ("" if _spills(attributes) else "edge")
        if cut:
            kept[CUT] = f"line {line}: {called(tag, attributes)}: its {cut}"
        elif IGNORED in attributes:
            kept[CUT] = f"<style> has a {attributes[IGNORED]}, which"
        if tag == "use":
            kept[XLINK] = copied(attributes)
        if tag != "svg" or is_within:
            kept = {**UNGIVEN.get(tag, {}), **kept}
        kept |= handed_on(attributes)
        kept |= {LINE: str(line), TAG: shown, **({FAULT: fault} if fault else {})}
        written = (f" {PREFIXES.get(key, key)}={quoteattr(value)}" for key, value in kept.items())
        tag = tag if tag in AS_THEY_ARE else "defs"
        begin, end = ("<defs>", "</defs>") if tag == ONLY_COPIED else ("", "")
        self._parts.append(f"{begin}<{tag}{'' if self._ends else ROOT}{''.join(written)}>")
        if is_within and "viewBox" not in kept:  # the library moves what is in one with a view only
            x, y = (pixels_of(own.get(key, "0")) for key in ("x", "y"))
            self._parts.append(f'<g transform="translate({x!r},{y!r})">')
            self._ends.append(f"</g></{tag}>")
        else:
            self._ends.append(f"</{tag}>{end}")

    def end(self) -> None:
        """End the element that was begun last."""
        self._parts.append(self._ends.pop())


def _taken(tag: str, given: Mapping[str, str], keys: Iterable[str]) -> dict[str, str]:
    """What an element takes of attributes, or of a style, among ``keys``.

    Units are in small letters, the only ones that the library knows.
    """
    some = (*UNGIVEN.get(tag, ()), *FURTHER.get(tag, ()))
    kept = {key: given[key] for key in keys if key in given}
    kept = {key: value for key, value in kept.items() if key in some or key not in OF_PLACE}
    return {
        key: value.lower() if key in (*PLACES, *EXTENTS) else value for key, value in kept.items()
    }


def hidden(attributes: dict[str, str]) -> dict[str, str]:
    """Attributes of an element, so that it is hidden whatever they say."""
    return {**attributes, "style": f"{attributes.get('style', '')};display:none"}


def copied(attributes: dict[str, str]) -> str:
    """What a ``use`` of these attributes copies."""
    return unquote(attributes.get("href", attributes.get(XLINK, "")))


def is_hidden(tag: str, attributes: dict[str, str]) -> bool:
    """Whether an element hides itself and all in it."""
    own = {**attributes, **declarations(attributes.get("style", ""), ("display", "opacity"))}
    is_without_box = own.get("display") == "contents" and tag in SHAPES
    own.pop("visibility", "")  # which what is in it may have otherwise
    return is_without_box or bool(hidden_by(own))


def called(tag: str, attributes: dict[str, str]) -> str:
    """``<rect> "pillar"``: an element as messages call it, by its label or else its id."""
    name = attributes.get(LABEL) or attributes.get("id") or ""
    return f'<{escaped(tag[:40])}> "{escaped(name)[:60]}"' if name else f"<{escaped(tag[:40])}>"


def _spills(attributes: dict[str, str]) -> bool:
    """Whether what is in a drawing within a drawing is drawn beyond its edges, too."""
    style = declarations(attributes.get("style", ""), ("overflow",))
    return {**attributes, **style}.get("overflow", "").strip().lower() == "visible"


def transform_of(attributes: dict[str, str]) -> dict[str, str]:
    """The ``transform`` of an element, that of its style first; none where it has none."""
    own = {key: attributes[key] for key in ("transform",) if key in attributes}
    return {**own, **declarations(attributes.get("style", ""), ("transform",))}


def functions_of(tag: str, attributes: dict[str, str]) -> int:
    """How many functions of transforms move what is in an element; a page within one has three."""
    return transform_of(attributes).get("transform", "").count("(") + (3 if tag == "svg" else 0)
