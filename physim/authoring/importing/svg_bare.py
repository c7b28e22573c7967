"""A drawing with all left out that is not needed to find its lines, written anew.

What the library that reads it never sees costs nothing there, however much of it there is: colours,
fonts, embedded images, text, attributes of other programs, style sheets but for what they hide.
What no program draws where it stands is put into ``defs``, as the library knows no other way.
"""

from __future__ import annotations

from collections.abc import Mapping
from urllib.parse import unquote
from xml.sax.saxutils import quoteattr

from physim.authoring.importing.svg_css import CUTS, NAMESPACE, OTHER
from physim.authoring.importing.svg_paths import as_meant
from physim.authoring.importing.svg_seen import handed_on
from physim.authoring.importing.svg_sheets import cut_of, declarations, hidden_by
from physim.authoring.importing.svg_values import (
    AUTO,
    BLANKS,
    NUMBER,
    RADII,
    SHAPES,
    TAKES,
    pixels_of,
)
from physim.escaping import escaped

XLINK = "http://www.w3.org/1999/xlink|href"
LABEL = "http://www.inkscape.org/namespaces/inkscape|label"
SVG = f"{NAMESPACE}|"
LINE, TAG = "physim-line", "physim-tag"
"""Attributes that tell of an element where it stands, and what it is"""
FAULT, CUT = "physim-fault", "physim-cut"
"""Attributes, handed on to all that is in an element: what of it is not read, what it is cut by

Before the former stands its line; the name of the latter has a number after it, as all that stand
about a shape cut it.
"""
SAME_ID = "physim-id"
"""Attribute for an id that an element before has, which is the one that copies (``use``) mean"""
PREFIXES = {LABEL: "inkscape:label", XLINK: "xlink:href"}
NOT_LINES = ("text", "image", "foreignObject", "flowRoot")
"""Elements that hold no lines; they are listed as left out."""
ONLY_COPIED = "symbol"
"""An element that is drawn by its copies (``use``) alone"""
LINK = "http://www.w3.org/1999/xhtml|link"
MOVING = ("animate", "animateMotion", "animateTransform", "set")
"""Elements that change what they stand in as time goes by"""
NOT_DRAWN = ("defs", "clipPath", "pattern", "mask", "marker", ONLY_COPIED)
"""Elements that hold what is drawn elsewhere, if at all."""
GROUPS = ("svg", "g", "a", "switch")
DRAWN = (*GROUPS, *TAKES)
"""Elements that are drawn, or hold what is; nothing is drawn of others and of what is in them."""
NOWHERE = ' d="M0,0H1"'
"""Of a shape that is not read: a line, so that it is found"""
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

        ``fault`` is what of it is not read: it goes in without it, and matters where a line with a
        role is in it.
        """
        tag = name.removeprefix(SVG)
        tag = "other" if "|" in tag else tag
        kept = {key: attributes[key] for key in ("id", LABEL) if key in attributes}
        if kept.get("id") in self._ids:
            kept[SAME_ID] = kept.pop("id")
        self._ids.add(kept.get("id", ""))
        kept |= {LINE: str(line), TAG: tag if tag.isascii() and tag.isalnum() else "element"}
        style = declarations(attributes.get("style", ""), ("display", "overflow", *CUTS, OTHER))
        own = {**attributes, **style}
        if own.get("display") == "none":
            kept["display"] = "none"
        if tag == "use":
            kept[XLINK] = copied(attributes)
        if fault:
            kept[FAULT] = f"{line} {fault}"
        else:
            kept |= _geometry(tag, attributes)
        cut = cut_of(own) or ("edge" if tag == ONLY_COPIED and not _spills(own) else "")
        if cut:
            kept[f"{CUT}-{len(self._parts)}"] = f"line {line}: {called(tag, attributes)}: its {cut}"
        kept |= handed_on(attributes)
        written = (f" {PREFIXES.get(key, key)}={quoteattr(value)}" for key, value in kept.items())
        self._open(tag, "".join(written), bool(fault))

    def _open(self, tag: str, written: str, is_faulty: bool) -> None:
        begin, end = ("<defs>", "</defs>") if tag == ONLY_COPIED else ("", "")
        if not self._ends:
            tag, written = "svg", ROOT + written
        elif tag in SHAPES and is_faulty:
            tag, written = "path", written + NOWHERE
        elif tag in GROUPS or tag == ONLY_COPIED:
            tag = "g"
        elif tag not in DRAWN:
            tag = "defs"
        self._parts.append(f"{begin}<{tag}{written}>")
        self._ends.append(f"</{tag}>{end}")

    def end(self) -> None:
        """End the element that was begun last."""
        self._parts.append(self._ends.pop())


def _geometry(tag: str, given: Mapping[str, str]) -> dict[str, str]:
    """What says where the lines of an element lie, as the library reads it.

    All that it takes is said, of what else nothing: the library would take that of one about it.
    """
    kept = {key: given.get(key, default) for key, default in TAKES.get(tag, {}).items()}
    for key, value in kept.items():
        match key:
            case "d":
                kept[key] = as_meant(value)
            case "points":  # the library wants gaps between them
                kept[key] = " ".join(NUMBER.findall(value))
            case _ if value != AUTO:  # it reckons with units where it may not
                kept[key] = repr(pixels_of(value))
    for key, other in (RADII, RADII[::-1]):
        if kept.get(key) == AUTO:
            kept[key] = kept[other] if kept[other] != AUTO else "0"
    return {**kept, **({"transform": given["transform"]} if "transform" in given else {})}


def hidden(attributes: dict[str, str]) -> dict[str, str]:
    """Attributes of an element, so that it is hidden whatever they say."""
    return {**attributes, "style": f"{attributes.get('style', '')};display:none"}


def copied(attributes: dict[str, str]) -> str:
    """What a ``use`` of these attributes copies."""
    return unquote(attributes.get("href", attributes.get(XLINK, "")).strip(BLANKS))


def is_hidden(attributes: dict[str, str]) -> bool:
    """Whether an element hides itself and all in it."""
    keys = ("display", "opacity")  # what is in it may have another visibility
    own = {**attributes, **declarations(attributes.get("style", ""), keys)}
    return bool(hidden_by({key: own[key] for key in keys if key in own}))


def called(tag: str, attributes: dict[str, str]) -> str:
    """``<rect> "pillar"``: an element as messages call it, by its label or else its id."""
    name = attributes.get(LABEL) or attributes.get("id") or ""
    return f'<{escaped(tag[:40])}> "{escaped(name)[:60]}"' if name else f"<{escaped(tag[:40])}>"


def _spills(own: Mapping[str, str]) -> bool:
    """Whether what is in a symbol is drawn beyond its edges, too."""
    return own.get("overflow", "").strip(BLANKS).lower() == "visible"
