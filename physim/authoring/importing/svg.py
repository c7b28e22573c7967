"""An SVG drawing: shapes in layers or with ids ``boundary``, ``obstacle``, ``path`` and ``robot``.

What is read is listed here, by element and attribute; a shape with a role that depends on anything
else is refused. Colours say nothing. The y axis is turned up, the lower edge of the page is y = 0.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field, replace
from math import radians
from pathlib import Path
from typing import Any

import numpy as np
import shapely
import svgelements
from lxml import etree

from physim.authoring.importing.drawing import (
    Drawing,
    Shape,
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
from physim.escaping import escaped
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
GROUPMODE = "{http://www.inkscape.org/namespaces/inkscape}groupmode"
HREF = "{http://www.w3.org/1999/xlink}href"
UNITS = ("mm", "cm", "in", "pt", "pc")
"""Those of a page that say how large it is"""
METRES_PER_PIXEL = 0.0254 / 96.0

GROUPS = ("svg", "g", "a", "symbol")
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
READ = {**LINES, "use": ("x", "y", "href"), "svg": (), "g": (), "symbol": (),
        "a": ("href", "target", "rel")}  # fmt: skip
"""Elements that are read, each with its own attributes"""
NO_LINES = re.compile(
    r"defs|style|title|desc|metadata|script|text|image|foreignObject|animate\w*|set|filter|marker|"
    r"clipPath|mask|pattern|symbol|cursor|view|(?:linear|radial|mesh)[gG]radient"
)
"""Elements without lines of their own where they stand"""
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
    reader = _Reader(path, options, _tree(path))
    drawing = reader.drawing
    reader.walk(reader.root, _State(reader.frame))
    for option, names in (("boundary", options.boundary), ("ignore", options.ignore)):
        for name in sorted({*names} - reader.names):
            near = nearest(name[:100], sorted(reader.names))
            raise refused(path, f"--{option} {escaped(name)}: no shape has that id or label{near}")
    if reader.unroled and not options.ignore_others:
        how = "say boundary, obstacle, path or robot by layer or name"
        raise unroled(path, reader.unroled, how)
    check_work(path, [one.points for one in drawing.shapes])
    if reader.unroled:
        drawing.changes += listed([f"line {n}: {one}: no role, left out (--ignore-others)"
                                   for one, _, _, n in reader.unroled])  # fmt: skip
    drawing.changes += listed([told for told, _, _ in reader.hidden])
    if lines := [line for _, role, line in reader.hidden if role in ("boundary", "wall")]:
        drawing.unseen = (
            f"; hidden and left out: {plural(len(lines), 'boundary', 'boundaries')}, the first in "
            f"line {lines[0]}; show what counts"
        )
    if reader.unread:
        kinds = ", ".join(f"{count} <{tag}>" for tag, count in reader.unread.items())
        drawing.changes.append(f"not followed, left out: {kinds}")
    if not drawing.of("boundary", "obstacle"):
        message = "no line is a boundary; put those about the place into a layer named boundary, "
        message += "give them that id, or name them by --boundary ID"
        raise refused(path, f"{message}{drawing.unseen}")
    return drawing


def _tree(path: Path) -> Any:
    """Root of a drawing, without entities and whatever is beyond all measure."""
    parser = etree.XMLParser(resolve_entities=False, no_network=True, remove_comments=True)
    try:
        root = etree.fromstring(read_bytes(path, MOST_TEXT), parser)
    except etree.XMLSyntaxError as error:
        reason = escaped(str(error.msg))[:100]
        raise refused(path, f"not valid XML: {reason}", error.lineno or 1) from None
    document = root.getroottree().docinfo.internalDTD
    entity = next((one for one in parser.error_log if "ENTITY" in one.type_name), None)
    if entity or (document is not None and any(document.iterentities())):
        line = entity.line if entity else None
        raise refused(path, "has an XML entity; save the drawing as plain SVG without any", line)
    if root.tag not in (f"{SVG}svg", "svg"):
        raise refused(path, f"the root is <{escaped(str(root.tag))[:60]}>, not <svg>", 1)
    if sum(1 for _ in root.iter()) > MOST_ELEMENTS:
        raise refused(path, f"more than {MOST_ELEMENTS} elements; leave out what is no wall")
    for sheet in root.iter(f"{SVG}style", "style"):
        if said := _hides("".join(sheet.itertext())):
            message = f'a style sheet says "{escaped(said)[:40]}"; of sheets only paint is read'
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


@dataclass(frozen=True)
class _State:
    """What an element has from those that it stands in."""

    matrix: Any
    role: str = ""
    name: str = ""
    is_copy: bool = False
    """whether role and name are those of a copy, which what it is a copy of does not change"""
    is_hidden: bool = False
    is_visible: bool = True
    group: str = ""
    """the nearest name about it, or one that is nearly a role"""
    group_kind: str = "group"
    """``group`` or ``layer``"""
    copy: Any = None
    """the outermost <use> by which it stands where it does, if any"""
    unread: tuple[int, str] | None = None
    """line and words on the first thing that is not read"""
    levels: int = 0


@dataclass
class _Reader:
    """Shapes of a drawing with a role, and what is said of the others."""

    path: Path
    options: Options
    root: Any
    drawing: Drawing = field(init=False)
    frame: Any = field(init=False)
    hidden: list[tuple[str, str, int]] = field(default_factory=list)
    """what is told of it, role, and line"""
    unroled: list[tuple[str, str, str, int]] = field(default_factory=list)
    """description, hint, name by which it may be ignored, and line"""
    unread: Counter[str] = field(default_factory=Counter)
    names: set[str] = field(default_factory=set)
    count: int = 0
    points: int = 0

    def __post_init__(self) -> None:
        self.drawing = Drawing("SVG drawing", self.path)
        self.tolerance = self.options.tolerance or TOLERANCE
        self.by_id: dict[str, Any] = {}
        for element in self.root.iter(etree.Element):
            self.by_id.setdefault(element.get("id", ""), element)
        self.frame = self._frame()

    def _frame(self) -> Any:
        """Matrix from user units of the page to metres of the world; says its scale."""
        root, scale = self.root, self.options.scale
        sides = [root.get(key, "").strip().lower() for key in ("width", "height")]
        view = root.get("viewBox", "")
        try:
            is_said = [bool(one) and one[-1] != "%" for one in sides]
            size = [length(one) if said else 0.0 for one, said in zip(sides, is_said, strict=True)]
            if not all(side > 0.0 for side, said in zip(size, is_said, strict=True) if said):
                raise ValueError("width and height must be above 0")
            box = numbers(view) or [0.0, 0.0, *size]
            if len(box) != 4 or (view and not min(box[2:]) > 0.0):
                raise ValueError("four numbers are needed, the last two above 0")
        except ValueError as error:
            given = f'width="{sides[0]}" height="{sides[1]}" viewBox="{view}"'
            message = f"<svg {escaped(given)[:120]}>: {error}"
            raise refused(self.path, message, root.sourceline) from None
        x, y, width, height = box
        told = f"{scale:g} m per user unit (--scale)" if scale is not None else ""
        if scale is None:
            if not sides[0].endswith(UNITS) or not size[0] > 0.0:
                message = "the page has no real-world units; --scale M says how many metres a user "
                raise refused(self.path, f"{message}unit is", root.sourceline)
            if size[1] > 0.0 and abs(size[1] / height * width / size[0] - 1.0) > 1e-3:
                message = (
                    "width, height and viewBox stretch the page; give it one scale, or --scale"
                )
                raise refused(self.path, message, root.sourceline)
            scale = size[0] / width * METRES_PER_PIXEL
            told = f"real-world units of the page ({sides[0]}): {scale:.6g} m per user unit"
        corner = f"the page's {'lower' if height > 0.0 else 'upper'} left corner"
        self.drawing.facts.append(
            f"{told}; curves flattened within {self.tolerance:g} m; y turned up, {corner} is (0, 0)"
        )
        return svgelements.Matrix(scale, 0.0, 0.0, -scale, -x * scale, (y + height) * scale)

    def walk(self, element: Any, state: _State, is_copied: bool = False) -> None:
        """Take all shapes of an element that is drawn where it stands, or where it is copied to."""
        tag = etree.QName(element).localname
        if etree.QName(element).namespace not in (SVG[1:-1], None):
            return
        if NO_LINES.fullmatch(tag) and not (is_copied and tag == "symbol"):
            if tag in ("text", "image", "script", "set", "foreignObject") or tag[:7] == "animate":
                self.unread[tag] += 1
            return
        self.count += 1
        if self.count > MOST_ELEMENTS:
            raise refused(self.path, f"more than {MOST_ELEMENTS} elements, copies written out")
        within = self._entered(element, tag, state)
        if within is None:
            return
        if tag in GROUPS and (tag != "svg" or element is self.root):
            for child in element.iterchildren(etree.Element):
                self.walk(child, within)
        elif tag in ("use", *LINES):
            self._drawn(element, tag, within)
        elif any(etree.QName(one).localname in ("use", *LINES)
                 for one in element.iter(etree.Element)):  # fmt: skip
            named = [role_named(one.get(key, "")) for one in element.iter(etree.Element)
                     for key in (LABEL, "id")]  # fmt: skip
            role = within.role or next((role for role, _ in named if role), "")
            self._drawn(element, tag, replace(within, role=role))

    def _entered(self, element: Any, tag: str, state: _State) -> _State | None:
        """What holds within an element; None where it is to be ignored."""
        line = element.sourceline
        label, own_id = element.get(LABEL, "").strip(), element.get("id", "").strip()
        names = {one for one in (label, own_id) if one}
        self.names |= names
        if names & {*self.options.ignore}:
            told = f"line {line}: <{tag}> {escaped(label or own_id)[:60]}: left out (--ignore)"
            self.drawing.changes.append(told)
            return None
        role, rest = role_named(label)
        is_automatic = OF_PROGRAMS.fullmatch(own_id.lower()) is not None
        if not role and not is_automatic:
            role, rest = role_named(own_id)
        if names & {*self.options.boundary}:
            role, rest = "boundary", ""
        if state.is_copy:
            role, rest = "", ""
        elif role:
            state = replace(state, role=role, name=rest)
        elif label and state.role and tag != "svg":
            state = replace(state, name=label)
        look, unread = self._looked_at(element, tag)
        matrix, fault = self._moved(element.get("transform", ""), state.matrix)
        unread = fault or unread
        if unread and state.unread is None:
            state = replace(state, unread=(line, f"<{tag}> {_quoted(label or own_id)}{unread}"))
        if tag in GROUPS and element is not self.root:
            group = label or ("" if is_automatic and state.group else own_id)
            if group and (hint(group) or not hint(state.group)):
                kind = "layer" if element.get(GROUPMODE) == "layer" else "group"
                state = replace(state, group=group, group_kind=kind)
        if state.levels > MOST_LEVELS:
            message = f"more than {MOST_LEVELS} groups or copies within each other, or a copy of "
            raise refused(
                self.path, f"{message}itself ({escaped(own_id)[:40]}); ungroup some", line
            )
        visible = {"hidden": False, "collapse": False, "visible": True}
        return replace(
            state,
            matrix=matrix,
            is_hidden=state.is_hidden or look["display"] == "none" or _is_nought(look["opacity"]),
            is_visible=visible.get(look["visibility"], state.is_visible),
            levels=state.levels + 1,
        )

    def _looked_at(self, element: Any, tag: str) -> tuple[dict[str, str], str]:
        """Display, visibility and opacity of an element, and what of it is not read."""
        is_read = tag in READ and (tag != "svg" or element is self.root)
        unread = "" if is_read else ": is not read; take what it holds out of it"
        look = dict.fromkeys(("display", "visibility", "opacity"), "")
        given = {str(key): str(value) for key, value in element.attrib.items() if key[0] != "{"}
        is_root = element is self.root
        for key, value in given.items():
            if key in look:
                look[key] = value.strip().lower()
            elif not (is_root or key in READ.get(tag, ()) or PAINT.fullmatch(key)
                      or COMMON.fullmatch(key) or value.strip() == "none"
                      or (tag == "use" and key in ("width", "height"))):  # fmt: skip
                unread = unread or f': the attribute "{escaped(key)[:40]}" is not read'
        style = re.sub(r"/\*.*?(?:\*/|\Z)", " ", given.get("style", ""), flags=re.S)
        for one in style.split(";"):
            key, _, value = (part.strip().lower() for part in one.partition(":"))
            if key == "all":  # sets those before it aside
                look = dict.fromkeys(look, key)
            if key in look:
                look[key] = value.removesuffix("!important").strip()
            elif key and value != "none" and not PAINT.fullmatch(key):
                unread = unread or f': its style says "{escaped(key)[:40]}", which is not read'
        for key, value in look.items():
            if value and not SEEN.fullmatch(value):
                unread = unread or f': {key} "{escaped(value)[:40]}" is not read'
        return look, f"{unread}; use plain attributes, or ungroup it" if unread else ""

    def _moved(self, transform: str, matrix: Any) -> tuple[Any, str]:
        """A matrix after a transform, and what is wrong with its text."""
        at, text = 0, transform.strip()
        text = "" if text == "none" else text
        try:
            while at < len(text):
                found = FUNCTION.match(text, at)
                counts = COUNTS.get(found[1], ()) if found else ()
                if found is None or len(given := numbers(found[2])) not in counts:
                    given_name = found[1][:40] if found else ""
                    alike = [one for one in COUNTS if one.lower() == given_name.lower()]
                    of = f"is unknown{nearest(given_name, alike or list(COUNTS))}"
                    if counts:
                        of = f"takes {' or '.join(map(str, counts))} numbers"
                    raise ValueError(f'"{escaped(text[at : at + 30])}" {of}')
                # as svgelements has it, the left one is applied first
                one = svgelements.Matrix(f"{found[1]}({','.join(map(repr, given))})")
                if abs(one.a * one.d - one.b * one.c) == 0.0:
                    raise ValueError(f'"{escaped(found[0])[:40]}" leaves no area')
                matrix = one * matrix
                at = found.end()
        except ValueError as error:
            return matrix, f": transform: {error}"
        return matrix, ""

    def _drawn(self, element: Any, tag: str, state: _State) -> None:
        """Take a shape or a copy that has a role and is seen."""
        shown = element if state.copy is None else state.copy
        line, own = shown.sourceline, _named(shown)
        called = f"<{etree.QName(shown).localname}> {_quoted(own)}".rstrip()
        if state.is_hidden or not (state.is_visible or tag == "use"):
            self.hidden.append((f"line {line}: hidden {called}, left out", state.role, line))
            return
        target = element.get("href", element.get(HREF, "")).strip()
        if tag == "use" and target[1:] in self.by_id and target.startswith("#"):
            try:
                x, y = (length(element.get(key, "0")) for key in ("x", "y"))
            except ValueError as error:
                state = replace(state, unread=state.unread or (line, f"{called}: {error}"))
                x = y = 0.0
            matrix = svgelements.Matrix(1.0, 0.0, 0.0, 1.0, x, y) * state.matrix
            copied = replace(state, matrix=matrix, is_copy=bool(state.role), copy=shown)
            self.walk(self.by_id[target[1:]], copied, is_copied=True)
            return
        if tag == "use":
            if not target:
                return
            what = f': copies "{escaped(target)[:40]}", which is not in this file'
            state = replace(state, unread=state.unread or (line, called + what))
        if not state.role:
            given = "" if OF_PROGRAMS.fullmatch(own.lower()) else own
            near = hint(given) or hint(state.group)
            within = f" in {state.group_kind} {_quoted(state.group)}" if state.group else ""
            name = given or state.group or own
            self.unroled.append((called + within, near, name, line))
        elif state.unread is not None:
            raise refused(self.path, state.unread[1], state.unread[0])
        else:
            try:
                self._take(element, tag, state, shown)
            except ValueError as error:
                called = f"<{tag}> {_quoted(_named(element))}".rstrip()
                raise refused(self.path, f"{called}: {error}", element.sourceline) from None

    def _take(self, element: Any, tag: str, state: _State, shown: Any) -> None:
        """Take the lines of a shape, or ``shown`` copy; ValueError where they suit no such role."""
        role, name, line = state.role, state.name, shown.sourceline
        label = f"'{escaped(_named(shown))[:60]}'"
        label = label if label != "''" else f"<{etree.QName(shown).localname}>"
        heading = None
        if role == "robot" and "@" in name:
            name, _, said = (one.strip() for one in name.rpartition("@"))
            if len(degrees := numbers(said)) != 1:
                raise ValueError(f'"@{escaped(said)[:40]}": one number of degrees is needed')
            heading = radians(degrees[0])
        elif role == "robot" and (found := re.fullmatch(r".*\S\s+([-+]?[\d.]+)°?", name)):
            message = f'"{escaped(name)[:40]}" may hold a heading; write @{found[1][:20]} if so, '
            raise ValueError(f"{message}else a name without the space")
        m = state.matrix
        turn = np.array([[m.a, m.b], [m.c, m.d]])
        tolerance = self.tolerance / float(np.linalg.norm(turn, 2))
        data = outline(tag, element.attrib)
        lines = subpaths(data, tolerance)
        if role == "robot" and lines:
            size = np.ptp(np.vstack([points for points, _ in lines]), axis=0).max()
            if 0.0 < FINE * size < tolerance:
                lines = subpaths(data, FINE * float(size))
        placed = [(rounded(points @ turn + (m.e, m.f)), closed) for points, closed in lines]
        for points, _ in placed:
            if not np.isfinite(points).all():
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
            at = re.findall(r"[-+.\de]+", shapely.is_valid_reason(ring))[-2:]
            raise ValueError(f"its outline crosses itself at {place([float(one) for one in at])}")
        if ring.area <= 0.0:
            raise ValueError(f"{role} at {place(points[0])} has no area")
        if solid.overlaps(ring):
            raise ValueError("its outlines cross each other; draw each as a shape of its own")
        solid = solid.symmetric_difference(ring)
    found = [one for one in shapely.get_parts(solid) if one.area > 0.0]
    if role == "robot" and (len(found) > 1 or any(one.interiors for one in found)):
        raise ValueError("a robot has one outline; draw each as a shape of its own")
    return found


def _named(element: Any) -> str:
    """Label of an element, or its id; empty without any."""
    return str(element.get(LABEL) or element.get("id") or "")


def _quoted(name: str) -> str:
    return f'"{escaped(name)[:60]}"' if name else ""
