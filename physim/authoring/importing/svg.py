"""An SVG drawing: shapes in layers or with ids ``boundary``, ``obstacle``, ``path`` and ``robot``.

What is read is listed here, by element and attribute; a shape with a role that depends on anything
else is refused. Colours say nothing. The y axis is turned up, the lower edge of the page is y = 0.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field, replace
from math import inf, radians
from pathlib import Path
from typing import Any

import numpy as np
import shapely
import svgelements
from lxml import etree

from physim.authoring.importing.drawing import (
    Drawing,
    Shape,
    invalid_at,
    listed,
    place,
    refused,
    rounded,
)
from physim.authoring.importing.options import Options
from physim.authoring.importing.roles import hint, role_named, unroled
from physim.authoring.importing.source import MOST_TEXT, read_bytes
from physim.authoring.importing.svg_lines import MOST_POINTS, length, numbers, outline, subpaths
from physim.authoring.importing.work import check_work
from physim.errors import nearest, plural
from physim.geometry.shapes import FloatArray

TOLERANCE = 0.01
"""[m] chords of curves, unless the user says otherwise"""
FINE = 0.01
"""[-] of the size of a robot, within which its chords keep however small it is"""
MOST_ELEMENTS = 100_000
"""Elements, copies counted each time"""
MOST_OUTLINES = 1_000
"""Closed lines of one shape"""
MOST_LEVELS = 100
"""Groups and copies within each other"""
SVG = "{http://www.w3.org/2000/svg}"
LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
HREF = "{http://www.w3.org/1999/xlink}href"
UNITS = ("mm", "cm", "in", "pt", "pc")
"""Those of a page that say how large it is"""
METRES_PER_PIXEL = 0.0254 / 96.0

LINES = {
    "path": ("d",),
    "rect": ("x", "y", "width", "height", "rx", "ry"),
    "circle": ("cx", "cy", "r"),
    "ellipse": ("cx", "cy", "rx", "ry"),
    "line": ("x1", "y1", "x2", "y2"),
    "polyline": ("points",),
    "polygon": ("points",),
}
"""Shapes, and the attributes that say where their lines lie"""
READ = {**LINES, "use": ("x", "y", "width", "height", "href"), "svg": (), "g": (), "symbol": (),
        "a": ("href", "target", "rel")}  # fmt: skip
"""Elements that are read, each with its own attributes"""
NO_LINES = re.compile(
    r"defs|style|title|desc|metadata|script|text|image|foreignObject|animate\w*|set|filter|marker|"
    r"clipPath|mask|pattern|symbol|cursor|view|(?:linear|radial|mesh)[gG]radient"
)
"""Elements without lines of their own where they stand"""
UNFOLLOWED = re.compile(r"text|image|script|set|foreignObject|animate\w*")
"""Those of them that may show something"""
PAINT = re.compile(
    r"(?:fill|stroke|color|paint|marker|font|text|stop|flood|lighting|background|solid)(?:-[a-z-]+)?|"
    r"-inkscape-[a-z-]+|(?:shape|image)-rendering|(?:letter|word)-spacing|line-height|white-space|"
    r"vector-effect|clip-rule|overflow|mix-blend-mode|isolation|pointer-events|cursor|filter|"
    r"enable-background|writing-mode|direction|unicode-bidi|[a-z]+-baseline|baseline-shift|"
    r"inline-size|shape-(?:inside|padding|margin|subtract)|opacity"
)
"""Properties that move and hide nothing, but for an opacity of 0"""
COMMON = re.compile(
    r"id|class|style|display|visibility|transform|lang|tabindex|role|focusable|(?:aria|data|on)[\w-]*"
)
SEEN = re.compile(r"(?!contents)[a-z-]+|[\d.]+%?")
"""Values of display, visibility and opacity that are read"""
OF_PROGRAMS = re.compile(rf"(?:{'|'.join(READ)}|layer)[-_]?\d[\d_-]*")
"""Ids that programs give by themselves"""
FUNCTION = re.compile(r"\s*([A-Za-z]+)\s*\(([^()]*)\)\s*,?\s*")
COUNTS = {"matrix": (6,), "translate": (1, 2), "scale": (1, 2), "rotate": (1, 3), "skewX": (1,),
          "skewY": (1,)}  # fmt: skip
"""How many numbers each function of a transform takes"""


def read_svg(path: Path, options: Options) -> Drawing:
    """Read a drawing; raises ImportSourceError with file:line where there is one."""
    root = _tree(path)
    drawing = Drawing("SVG drawing", path)
    reader = _Reader(drawing, options, root)
    reader.walk(root, _State(_frame(drawing, root, options)))
    for option, names in (("boundary", options.boundary), ("ignore", options.ignore)):
        for name in sorted({*names} - reader.names):
            near = nearest(name[:100], sorted(reader.names))
            raise refused(path, f"--{option} {name}: no shape has that id or label{near}")
    if reader.unroled and not options.ignore_others:
        how = "say boundary, obstacle, path or robot by layer or name"
        raise unroled(path, reader.unroled, how)
    check_work(path, [one.points for one in drawing.shapes])
    drawing.changes += listed([f"line {n}: {one}: no role, left out (--ignore-others)"
                               for one, _, _, n in reader.unroled])  # fmt: skip
    drawing.changes += listed([f"line {n}: hidden {one}, left out" for one, _, n in reader.hidden])
    if walls := [n for _, role, n in reader.hidden if role in ("boundary", "wall")]:
        count = plural(len(walls), "boundary", "boundaries")
        drawing.doubt = (
            f"hidden and left out: {count}, the first in line {walls[0]}; show what counts"
        )
    if reader.unread:
        kinds = ", ".join(f"{count} <{tag}>" for tag, count in reader.unread.items())
        drawing.changes.append(f"not followed, left out: {kinds}")
    if not drawing.of("boundary", "obstacle"):
        raise drawing.lack(
            "no line is a boundary; put those about the place into a layer named boundary, "
            "give them that id, or name them by --boundary ID"
        )
    return drawing


def _tree(path: Path) -> Any:
    """Root of a drawing, without entities and whatever is beyond all measure."""
    parser = etree.XMLParser(resolve_entities=False, no_network=True, remove_comments=True)
    try:
        root = etree.fromstring(read_bytes(path, MOST_TEXT), parser)
    except etree.XMLSyntaxError as error:
        reason = str(error.msg)[:100]
        raise refused(path, f"not valid XML: {reason}", error.lineno or 1) from None
    document = root.getroottree().docinfo.internalDTD
    entity = next((one for one in parser.error_log if "ENTITY" in one.type_name), None)
    if entity or (document is not None and any(document.iterentities())):
        line = entity.line if entity else None
        raise refused(path, "has an XML entity; save the drawing as plain SVG without any", line)
    if root.tag not in (f"{SVG}svg", "svg"):
        raise refused(path, f"the root is <{str(root.tag)[:60]}>, not <svg>", 1)
    if sum(1 for _ in root.iter()) > MOST_ELEMENTS:
        raise refused(path, f"more than {MOST_ELEMENTS} elements; leave out what is no wall")
    for sheet in root.iter(f"{SVG}style", "style"):
        if said := _hides("".join(sheet.itertext())):
            message = f'a style sheet says "{said[:40]}"; of sheets only paint is read'
            raise refused(
                path, f"{message}: save as plain SVG, or use attributes", sheet.sourceline
            )
    return root


def _hides(sheet: str) -> str:
    """The first declaration of a style sheet that may do more than paint; empty without any."""
    sheet = re.sub(r"/\*.*?(?:\*/|\Z)", " ", sheet, flags=re.S)
    sheet = re.sub(r'"[^"\n]*"|\'[^\'\n]*\'|url\([^()]*\)', "0", sheet)
    sheet = re.sub(r"@font-face\s*\{[^{}]*\}|@(?:import|charset|namespace)\b[^;{}@]*;", " ", sheet)
    depth = 0
    for text, end in re.findall(r"([^{};]*)([{};]|\Z)", sheet):
        if end == "{":
            depth += 1
        elif text.strip():
            key, _, value = (one.strip().lower() for one in text.partition(":"))
            if not depth or not PAINT.fullmatch(key) or (key == "opacity" and _is_nought(value)):
                return str(text).strip()
        depth -= end == "}"
    return ""


def _is_nought(value: Any) -> bool:
    return re.fullmatch(r"[+-]?[0.]+%?|-.*", value) is not None


def _frame(drawing: Drawing, root: Any, options: Options) -> Any:
    """Matrix from user units of the page to metres of the world; says its scale."""
    sides = [root.get(key, "").strip().lower() for key in ("width", "height")]
    view = root.get("viewBox", "")
    try:
        size = [length(one) if one and one[-1] != "%" else inf for one in sides]
        if not min(size) > 0.0:
            raise ValueError("width and height must be above 0")
        box = numbers(view) or [0.0, 0.0, *(0.0 if one == inf else one for one in size)]
        if len(box) != 4 or (view and not min(box[2:]) > 0.0):
            raise ValueError("four numbers are needed, the last two above 0")
    except ValueError as error:
        given = f'width="{sides[0]}" height="{sides[1]}" viewBox="{view}"'
        message = f"<svg {given[:120]}>: {error}"
        raise refused(drawing.path, message, root.sourceline) from None
    x, y, width, height = box
    if (scale := options.scale) is not None:
        told = f"{scale:g} m per user unit (--scale)"
    else:
        message = ""
        if not sides[0].endswith(UNITS):
            message = "the page has no real-world units; --scale M says how many metres a user "
            message += "unit is"
        elif size[1] < inf and abs(size[1] / height * width / size[0] - 1.0) > 1e-3:
            message = "width, height and viewBox stretch the page; give it one scale, or --scale"
        if message:
            raise refused(drawing.path, message, root.sourceline)
        scale = size[0] / width * METRES_PER_PIXEL
        told = f"real-world units of the page ({sides[0]}): {scale:.6g} m per user unit"
    corner = f"the page's {'lower' if height > 0.0 else 'upper'} left corner"
    drawing.facts.append(
        f"{told}; curves flattened within {options.tolerance or TOLERANCE:g} m; "
        f"y turned up, {corner} is (0, 0)"
    )
    return svgelements.Matrix(scale, 0.0, 0.0, -scale, -x * scale, (y + height) * scale)


@dataclass(frozen=True)
class _State:
    """What an element has from those that it stands in."""

    matrix: Any
    role: str = ""
    name: str = ""
    is_hidden: bool = False
    is_visible: bool = True
    group: str = ""
    """the nearest name about it, or one that is nearly a role"""
    copy: Any = None
    """the outermost <use> by which it stands where it does, if any"""
    is_said: bool = False
    """whether that has a role, which what it is a copy of does not change"""
    unread: tuple[int, str] | None = None
    """line and words on the first thing that is not read"""
    levels: int = 0


@dataclass
class _Reader:
    """Takes the shapes of a drawing with a role, and keeps what is said of the others."""

    drawing: Drawing
    options: Options
    root: Any
    hidden: list[tuple[str, str, int]] = field(default_factory=list)
    """description, role, and line"""
    unroled: list[tuple[str, str, str, int]] = field(default_factory=list)
    """description, hint, name by which it may be ignored, and line"""
    unread: Counter[str] = field(default_factory=Counter)
    names: set[str] = field(default_factory=set)
    count: int = 0
    points: int = 0

    def __post_init__(self) -> None:
        self.by_id: dict[str, Any] = {}
        for element in self.root.iter(etree.Element):
            self.by_id.setdefault(element.get("id", ""), element)

    def walk(self, element: Any, state: _State, is_copied: bool = False) -> None:
        """Take all shapes of an element that is drawn where it stands, or where it is copied to."""
        tag = _tag(element)
        if etree.QName(element).namespace not in (SVG[1:-1], None):
            return
        if NO_LINES.fullmatch(tag) and not (is_copied and tag == "symbol"):
            if UNFOLLOWED.fullmatch(tag):
                self.unread[tag] += 1
            return
        self.count += 1
        if self.count > MOST_ELEMENTS:
            message = f"more than {MOST_ELEMENTS} elements, copies written out"
            raise refused(self.drawing.path, message)
        within = self._entered(element, tag, state)
        if within is None:
            return
        if tag in ("use", *LINES):
            self._drawn(element, tag, within)
        else:
            for child in element.iterchildren(etree.Element):
                self.walk(child, within)

    def _entered(self, element: Any, tag: str, state: _State) -> _State | None:
        """What holds within an element; None where it is to be ignored."""
        label, own_id = element.get(LABEL, "").strip(), element.get("id", "").strip()
        names = {one for one in (label, own_id) if one}
        self.names |= names
        if names & {*self.options.ignore}:
            told = f"line {element.sourceline}: {_called(element)}: left out (--ignore)"
            self.drawing.changes.append(told)
            return None
        given_id = "" if OF_PROGRAMS.fullmatch(own_id.lower()) else own_id
        role, rest = role_named(label)
        if not role:
            role, rest = role_named(given_id)
        if names & {*self.options.boundary}:
            role, rest = "boundary", ""
        if role and not state.is_said:
            state = replace(state, role=role, name=rest)
        elif label and state.role and tag != "svg" and not state.is_said:
            state = replace(state, name=label)
        if tag not in ("use", *LINES) and element is not self.root:
            group = label or (given_id if state.group else own_id)
            if group and (hint(group) or not hint(state.group)):
                state = replace(state, group=group)
        if state.levels > MOST_LEVELS:
            message = f"more than {MOST_LEVELS} groups or copies within each other, or a copy of "
            message += f"itself ({own_id[:40]}); ungroup some"
            raise refused(self.drawing.path, message, element.sourceline)
        look, unread = _looks(element, tag, element is self.root)
        matrix = state.matrix
        try:
            matrix = _transform(element.get("transform", "")) * matrix
        except ValueError as error:
            unread = f"transform: {error}"
        if unread and state.unread is None:
            unread = f"{_called(element)}: {unread}"
            state = replace(state, unread=(element.sourceline, unread))
        visible = {"hidden": False, "collapse": False, "visible": True}
        return replace(
            state,
            matrix=matrix,
            is_hidden=state.is_hidden or look["display"] == "none" or _is_nought(look["opacity"]),
            is_visible=visible.get(look["visibility"], state.is_visible),
            levels=state.levels + 1,
        )

    def _drawn(self, element: Any, tag: str, state: _State) -> None:
        """Take a shape or a copy that has a role and is seen."""
        shown = element if state.copy is None else state.copy
        line, called, unread = shown.sourceline, _called(shown), state.unread
        if state.is_hidden or not (state.is_visible or tag == "use"):
            self.hidden.append((called, state.role, line))
            return
        if tag == "use":
            target, x, y = element.get("href", element.get(HREF, "")).strip(), 0.0, 0.0
            try:
                x, y = (length(element.get(key, "0")) for key in ("x", "y"))
            except ValueError as error:
                unread = unread or (line, f"{called}: {error}")
            if target[:1] == "#" and target[1:] in self.by_id:
                matrix = svgelements.Matrix(1.0, 0.0, 0.0, 1.0, x, y) * state.matrix
                copied = replace(
                    state, matrix=matrix, is_said=bool(state.role), copy=shown, unread=unread
                )
                self.walk(self.by_id[target[1:]], copied, is_copied=True)
                return
            if not target:
                return
            message = f'{called}: copies "{target[:40]}", which is not in this file'
            unread = unread or (line, message)
        if not state.role:
            own = "" if OF_PROGRAMS.fullmatch(_name(shown).lower()) else _name(shown)
            within = f' in "{state.group[:60]}"' if state.group else ""
            near = hint(own) or hint(state.group)
            self.unroled.append((called + within, near, own or state.group or _name(shown), line))
        elif unread is not None:
            raise refused(self.drawing.path, unread[1], unread[0])
        else:
            try:
                self._take(element, tag, state, shown)
            except ValueError as error:
                message = f"{_called(element)}: {error}"
                raise refused(self.drawing.path, message, element.sourceline) from None

    def _take(self, element: Any, tag: str, state: _State, shown: Any) -> None:
        """Take the lines of a shape, or ``shown`` copy; ValueError where they suit no such role."""
        role, name, line, label = state.role, state.name, shown.sourceline, _called(shown)
        heading = None
        if role == "robot" and "@" in name:
            name, _, said = (one.strip() for one in name.rpartition("@"))
            if len(degrees := numbers(said)) != 1:
                raise ValueError(f'"@{said[:40]}": one number of degrees is needed')
            heading = radians(degrees[0])
        elif role == "robot" and (found := re.fullmatch(r".*\S\s+([-+]?[\d.]+)°?", name)):
            message = f'"{name[:40]}" may hold a heading; write @{found[1][:20]} if so, '
            raise ValueError(f"{message}else a name without the space")
        m = state.matrix
        turn = np.array([[m.a, m.b], [m.c, m.d]])
        tolerance = (self.options.tolerance or TOLERANCE) / float(np.linalg.norm(turn, 2))
        data = outline(tag, element.attrib)
        lines = subpaths(data, tolerance)
        if role == "robot" and lines:
            size = np.ptp(np.vstack([points for points, _ in lines]), axis=0).max()
            if 0.0 < FINE * size < tolerance:
                lines = subpaths(data, FINE * float(size))
        placed = [(rounded(points @ turn + (m.e, m.f)), closed) for points, closed in lines]
        if not all(np.isfinite(points).all() for points, _ in placed):
            raise ValueError("a coordinate is not a finite number")
        placed = [(points, closed) for points, closed in placed if len(points) > 1]
        self.points += sum(len(points) for points, _ in placed)
        if self.points > MOST_POINTS:
            raise ValueError(f"more than {MOST_POINTS} points up to here; simplify the drawing")
        if not placed:
            self.drawing.changes.append(f"line {line}: {label}: a line of no length, left out")
        geometries: list[Any] = [shapely.LineString(points) for points, _ in placed]
        if role == "wall":
            if any(closed for _, closed in placed):
                raise ValueError('a closed "wall" may be solid or not: call it obstacle if it is, '
                                 "else boundary")  # fmt: skip
            role = "boundary"
        if role in ("obstacle", "robot"):
            geometries = _solids(role, placed)
        self.drawing.shapes += [Shape(role, one, name, heading, label, line) for one in geometries]  # type: ignore[arg-type]


def _looks(element: Any, tag: str, is_root: bool) -> tuple[dict[str, str], str]:
    """Display, visibility and opacity of an element, and what of it is not read."""
    look = dict.fromkeys(("display", "visibility", "opacity"), "")
    is_read = tag in READ and (tag != "svg" or is_root)
    unread = [] if is_read else ["is not read; take what it holds out of it"]
    given = {str(key): str(value) for key, value in element.attrib.items() if key[0] != "{"}
    for key, value in given.items():
        if key in look:
            look[key] = value.strip().lower()
        elif not (is_root or key in READ.get(tag, ()) or PAINT.fullmatch(key)
                  or COMMON.fullmatch(key) or value.strip() == "none"):  # fmt: skip
            unread.append(f'the attribute "{key[:40]}" is not read')
    style = re.sub(r"/\*.*?(?:\*/|\Z)", " ", given.get("style", ""), flags=re.S)
    for one in style.split(";"):
        key, _, value = (part.strip().lower() for part in one.partition(":"))
        if key == "all":  # sets those before it aside
            look = dict.fromkeys(look, key)
        if key in look:
            look[key] = value.removesuffix("!important").strip()
        elif key and value != "none" and not PAINT.fullmatch(key):
            unread.append(f'its style says "{key[:40]}", which is not read')
    unread += [f'{key} "{value[:40]}" is not read'
               for key, value in look.items() if value and not SEEN.fullmatch(value)]  # fmt: skip
    return look, f"{unread[0]}; use plain attributes, or ungroup it" if unread else ""


def _transform(text: str) -> Any:
    """Matrix of a transform; ValueError for what the standard does not have."""
    matrix, at, text = svgelements.Matrix(), 0, text.strip()
    while text != "none" and at < len(text):
        found = FUNCTION.match(text, at)
        if found is None or len(given := numbers(found[2])) not in COUNTS.get(found[1], ()):
            takes = ", ".join(f"{key} {' or '.join(map(str, n))}" for key, n in COUNTS.items())
            raise ValueError(f'"{text[at : at + 30]}" is none of {takes} numbers')
        # as svgelements has it, the left one is applied first
        matrix = svgelements.Matrix(f"{found[1]}({','.join(map(repr, given))})") * matrix
        at = found.end()
    if abs(matrix.a * matrix.d - matrix.b * matrix.c) == 0.0:
        raise ValueError(f'"{text[:40]}" leaves no area')
    return matrix


def _solids(role: str, lines: list[tuple[FloatArray, bool]]) -> list[Any]:
    """Polygons of closed lines; one within another is a hole."""
    solid: Any = shapely.Polygon()
    if len(lines) > MOST_OUTLINES:
        raise ValueError(f"{len(lines)} outlines in one shape; at most {MOST_OUTLINES} are read")
    for points, closed in lines:
        if not closed or len(points) < 4:
            raise ValueError(f"{role} at {place(points[0])} is not closed; draw its outline")
        ring = shapely.Polygon(points)
        if not ring.is_valid:
            raise ValueError(f"its outline crosses itself{invalid_at(ring)}")
        if ring.area <= 0.0:
            raise ValueError(f"{role} at {place(points[0])} has no area")
        if solid.overlaps(ring):
            raise ValueError("its outlines cross each other; draw each as a shape of its own")
        solid = solid.symmetric_difference(ring)
    found = [one for one in shapely.get_parts(solid) if one.area > 0.0]
    if role == "robot" and (len(found) > 1 or any(one.interiors for one in found)):
        raise ValueError("a robot has one outline; draw each as a shape of its own")
    return found


def _tag(element: Any) -> str:
    return str(etree.QName(element).localname)


def _name(element: Any) -> str:
    """Label of an element, or its id; empty without any."""
    return str(element.get(LABEL) or element.get("id") or "")


def _called(element: Any) -> str:
    """``<rect> "pillar"``: what messages call an element."""
    name = _name(element)[:60]
    return f"<{_tag(element)}>" + (f' "{name}"' if name else "")
