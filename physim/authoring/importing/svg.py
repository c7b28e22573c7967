"""An SVG drawing: lines in layers or with ids ``boundary``, ``obstacle``, ``path`` and ``robot``.

svgelements reads it: transforms, units and the viewBox are applied. The y axis is turned up, with
the lower edge of the page at y = 0. Curves become polylines, no chord further from its curve
than a stated tolerance.
"""

from __future__ import annotations

import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import svgelements

from physim.authoring.importing.drawing import (
    Drawing,
    DrawnRobot,
    Source,
    listed,
    place,
    refused,
    rounded,
)
from physim.authoring.importing.joining import join_ends
from physim.authoring.importing.lines import is_closed
from physim.authoring.importing.options import Options
from physim.authoring.importing.outlines import drop_marks
from physim.authoring.importing.path_pieces import take_paths
from physim.authoring.importing.roles import nearest_role, role_named
from physim.authoring.importing.source import read_xml
from physim.authoring.importing.svg_bare import CUT, FAULT, LINE, SAME_ID, TAG
from physim.authoring.importing.svg_curves import subpaths
from physim.authoring.importing.svg_guard import look_at
from physim.authoring.importing.svg_look import SvgLook
from physim.authoring.importing.svg_page import Frame
from physim.authoring.importing.svg_seen import (
    has_area,
    has_line,
    is_even_odd,
    is_seen,
    is_unsure,
)
from physim.authoring.importing.svg_walls import LABEL, NAMES, Walls, names_of
from physim.authoring.importing.walls import painted
from physim.authoring.importing.work import MOST_POINTS, check_work
from physim.escaping import escaped
from physim.geometry.shapes import FloatArray

TOLERANCE = 0.01
"""[m] chords of curves, unless the user says otherwise"""
FINE = 0.01
"""[-] of the size of a robot, within which its chords keep however small it is"""
OF_PROGRAMS = re.compile(r"path[-_]?\d[\d_-]*|path-copy.*")
"""Ids that programs give by themselves"""


@dataclass(frozen=True)
class _Line:
    """One polyline of a drawing [m] with what it is for."""

    role: str
    name: str
    points: FloatArray
    is_closed: bool
    where: str
    """what messages call it"""
    line: int | None
    """of the text, from 1"""
    own_id: str
    """that of the copy, if it is one"""


def read_svg(path: Path, options: Options) -> Drawing:
    """Read a drawing; raises ImportSourceError with file:line where there is one."""
    look = look_at(path, read_xml(path))
    drawing = Drawing(kind="SVG drawing")
    try:
        root = svgelements.SVG.parse(io.StringIO(look.bare.text), reify=False, ppi=96.0)
    except RecursionError:
        raise refused(path, "groups are nested too deeply; ungroup some of them") from None
    except (ValueError, TypeError, ArithmeticError, AttributeError, LookupError) as error:
        reason = escaped(str(error))[:100] or type(error).__name__
        raise refused(path, f"cannot be read as SVG: {reason}") from None
    found = _Lines(path, look, options)
    for element, role, name, own_id in _shapes(root, "", "", found.walls):
        found.look_at(element, role, name, own_id)
    if unknown := found.walls.unknown(look.lines):
        raise refused(path, unknown)
    drawing.changes += found.told()
    drawing.facts.append(
        f"{found.frame.scale}; curves flattened within {found.tolerance:g} m; y turned up, "
        f"{found.frame.corner} is (0, 0)"
    )
    check_work(path, [line.points for line in found.lines])
    drawing.sources = [Source(one.role, one.where, one.line, one.points) for one in found.lines]
    _sort(path, drawing, found.lines, found.walls)
    drawing.painted = found.painted
    return drawing


class _Lines:
    """The lines of a drawing, shape by shape, and what is said of those that are not taken."""

    def __init__(self, path: Path, look: SvgLook, options: Options) -> None:
        self.path, self.look = path, look
        self.frame = Frame.of(path, look, options)
        self.tolerance = TOLERANCE if options.tolerance is None else options.tolerance
        self.lines: list[_Line] = []
        self.painted: list[Any] = []  # shapely polygons of walls with a painted area
        self._hidden = [*look.left_out]
        self.walls = Walls(frozenset(options.boundary), self._hidden)
        self._nameless: dict[Any, list[tuple[str, int | None, str]]] = {}  # by group, if in one
        self._left_out: list[str] = []
        self._whole: dict[str, None] = {}  # what is taken as it would not be drawn
        self._seen: set[int | None] = set()
        self._count = 0

    def look_at(self, element: Any, role: str, name: str, own_id: str) -> None:
        """Take the lines of a shape, if it has a role and is seen; refuse those that are not read.

        Without a role ``name`` is that of the group that has one.
        """
        own = element.values.get("attributes", {})
        label = next(iter(names_of(element)), "")
        where = escaped(repr(label[:60])) if label else f"<{own.get(TAG, 'element')}>"
        line = int(own[LINE]) if LINE in own else None
        self._seen.add(line)
        is_named = self.walls.asked_for(element) or bool(_role(element)[0])
        if not is_seen(element.values, self.look.may_be_painted or is_named):
            told = f"line {line}: hidden <{own.get(TAG, 'element')}> {escaped(label)[:60]}"
            self._hidden.append(f"{told.rstrip()}, left out")
            if not role and is_seen(element.values, is_meant=True):  # it may be asked for
                self.walls.note(element, name, self.frame.metres)
        elif not role:
            group = (name, None if name else len(self._nameless))
            self._nameless.setdefault(group, []).append((where, line, label))
            self.walls.note(element, name, self.frame.metres)
        else:
            if fault := element.values.get(FAULT):
                at, _, what = fault.partition(" ")
                raise refused(self.path, what, int(at))
            found = self._subpaths(element, role, where, line)
            for cut in (value for key, value in element.values.items() if CUT in key):
                self._whole[f"{cut} is not applied; taken whole"] = None
            if not is_named and (doubt := _doubt(element.values, found)):
                self._whole[f"line {line}: {where}: {doubt}; taken"] = None
            kind = "boundary" if role == "wall" else role
            lines = [
                _Line(kind, name, rounded(self.frame.placed(points)), closed, where, line, own_id)
                for points, closed in found
            ]
            if role == "wall" and has_area(element.values):
                rings = [one.points for one in lines if one.is_closed]
                self.painted += painted(rings, is_even_odd(element.values))
            for one in lines:
                self._take(one)

    def _subpaths(
        self, element: Any, role: str, where: str, line: int | None
    ) -> list[tuple[FloatArray, bool]]:
        tolerance = self.tolerance / self.frame.metres
        try:
            shape = svgelements.Path(element)
            box = shape.bbox() if role == "robot" else None
            if box is not None and (size := max(box[2] - box[0], box[3] - box[1])) > 0.0:
                tolerance = min(tolerance, FINE * size)
            return subpaths(shape, tolerance, MOST_POINTS - self._count)
        except (ValueError, ArithmeticError) as error:
            raise refused(self.path, f"{where}: {escaped(str(error))[:160]}", line) from None

    def _take(self, line: _Line) -> None:
        if len(line.points) < 2:
            self._left_out.append(f"{line.where}: a line of no length, left out")
        else:
            self.lines.append(line)
            self._count += len(line.points)

    def told(self) -> list[str]:
        """What is said of all that was not taken, or not as it would be drawn."""
        hidden, nothing = [*dict.fromkeys(self._hidden)], self.look.not_among(self._seen)
        nameless = [_no_role(group, of) for (group, _), of in self._nameless.items()]
        kinds = (hidden, nameless, self._left_out, [*self._whole], nothing)
        return [one for kind in kinds for one in listed(kind)]


def _no_role(group: str, shapes: Sequence[tuple[str, int | None, str]]) -> str:
    """What is said of shapes of a group, "" for none, that have no role: what, line and label."""
    where, line, label = shapes[0]
    more = f" and {len(shapes) - 1} more" if len(shapes) > 1 else ""
    within = f" in {escaped(repr(group[:60]))}" if group and group != label else ""
    near = nearest_role(group) or nearest_role(label)
    told = f"line {line}: {where}{more}{within}: in no layer boundary, obstacle, path or robot"
    return f"{told}, left out{near}"


def _doubt(values: Mapping[str, Any], lines: Sequence[tuple[FloatArray, bool]]) -> str:
    """Why a shape with these lines may not be seen, or is not, though it has a role; or empty."""
    if is_unsure(values):
        return "whether its paint is seen depends on what is not read"
    if has_area(values) and not has_line(values) and not all(_area(line) for line, _ in lines):
        return "has no line (stroke), and no area that is painted, or a part has none"
    return ""


def _area(points: FloatArray) -> float:
    """Of a polyline that is closed; 0 for one that lies in a line, give or take a grain."""
    x, y = (points - points[0]).T
    area = abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2.0
    return area if area > 1e-9 * float(np.ptp(points, axis=0).max()) ** 2 else 0.0


def _role(element: Any) -> tuple[str, str]:
    """Role of an element and the rest of its name; ids such as path42 are Inkscape's own."""
    own = element.values.get("attributes", {})
    for key in NAMES:
        text = str(own.get(key) or "")
        role, rest = role_named(text)
        if role and (key == LABEL or not OF_PROGRAMS.fullmatch(text.strip().lower())):
            return role, rest
    return "", ""


def _id(element: Any) -> str:
    own = element.values.get("attributes", {})
    return str(own.get("id") or own.get(SAME_ID) or "")


def _shapes(
    group: Any, role: str, name: str, walls: Walls, copied: tuple[str, str, str] = ("", "", "")
) -> Any:
    """Every shape below a group, with the role and name that it or its layer has, and its id.

    Without a role the name is that of the group that has one, for `Walls.note`. Role, name and id
    of a copy, ``copied``, take the place of those of what it is a copy of.
    """
    for element in group:
        own, rest = _role(element)
        is_asked_for = walls.takes(element)
        if is_asked_for:
            own, rest = "boundary", ""
        label = next(iter(names_of(element)), "")
        within = name if role else ""  # that of a group without a role names nothing in it
        drawn = str(element.values.get("attributes", {}).get(LABEL) or "")
        given = rest or (drawn if drawn and role and not own else "")
        if isinstance(element, svgelements.Group | svgelements.Use):
            named = given or within if own or role else label or name
            whose = copied
            if isinstance(element, svgelements.Use):
                whose = (copied[0] or own or role, copied[1] or given, copied[2] or _id(element))
            yield from _shapes(element, own or role, named, walls, whose)
        elif isinstance(element, svgelements.Shape):
            is_wall = {own, role} == {"boundary", "wall"}  # its own name says which
            if own and role and own != role and not (rest or is_asked_for or is_wall):
                own = role
            named = copied[1] or rest or (drawn if drawn and not own else within)
            kind = copied[0] or own or role
            own_id = copied[2] if copied[0] else _id(element)
            yield element, kind, named if kind else name, own_id


def _sort(path: Path, drawing: Drawing, lines: list[_Line], walls: Walls) -> None:
    """Give every line its place in the drawing."""
    paths: list[tuple[str, FloatArray]] = []
    labels = {line.name for line in lines if line.role == "robot"}
    called = {line.name for line in lines if line.role == "path"} - labels  # by id, if at all
    open_paths = {line.name for line in lines if line.role == "path" and not line.is_closed}
    for line in lines:
        points = line.points
        ring = points[:-1] if is_closed(points) else points
        if line.role == "boundary":
            drawing.boundaries.append(points)
        elif line.role == "path":
            if line.is_closed and line.name in open_paths:  # the head of an arrow
                drawing.changes.append(
                    f"line {line.line}: {line.where}: closed, beside an open path: left out"
                )
                continue
            paths.append((line.name, points))
        elif line.role == "robot":
            if len(ring) < 3:
                message = f"{line.where}: a robot at {place(ring[0])} has no area; draw its outline"
                raise refused(path, message, line.line)
            by_id = line.own_id if line.own_id in called else ""
            drawing.robots.append(DrawnRobot(ring, line.name or by_id))
        else:
            drawing.obstacles.append(ring)
        if line.role in ("robot", "obstacle") and not (line.is_closed and len(points) > 2):
            drawing.changes.append(
                f"line {line.line}: {line.where}: {line.role} at {place(points[0])} is not closed: "
                "closed by a straight line"
            )
    drop_marks(drawing)
    take_paths(drawing, paths)
    drawing.changes += join_ends(drawing.boundaries)
    if not drawing.boundaries:
        raise refused(
            path,
            "no line is a boundary; put the walls into a layer named boundary, or give them the "
            f"id boundary{walls.advice()}",
        )
