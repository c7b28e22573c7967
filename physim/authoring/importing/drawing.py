"""What a reader makes of a source: shapes in metres, each with the role that the source states."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import shapely

from physim.errors import PhysimError
from physim.escaping import escaped
from physim.geometry.shapes import FloatArray

DIGITS = 3
"""Digits after the point of every coordinate written: millimetres."""

LARGEST = 1.0e6
"""[m] largest coordinate of a world"""
KILOMETRE = 1000.0

MOST_CORNERS = 2_000
"""Corners of one obstacle of a world; a longer outline becomes a closed boundary."""

MOST_LISTED = 20
"""Things of one kind that are listed one by one."""


class ImportSourceError(PhysimError):
    """A source that cannot be imported: what, where in it, and what to do."""


Role = Literal["place", "boundary", "obstacle", "path", "robot"]


@dataclass(frozen=True)
class Shape:
    """A shape of a source [m], world frame, x right and y up, coordinates to the millimetre.

    ``geometry`` is a shapely geometry by ``role``: ``place`` (where robots may go) and ``obstacle``
    (solid) are valid Polygons, whose holes count; ``robot`` is a valid Polygon without holes;
    ``boundary`` and ``path`` are LineStrings, closed where the first point is the last.
    ``name`` is that of the robot or of the robot whose path it is, as the source has it, empty
    where it states none; ``heading`` [rad] that of a robot, None where it heads along its path.
    ``label`` is what messages call the shape, ``line`` its line of the text from 1, where known.

    Places of one source are apart: those that overlap or abut have been united.
    """

    role: Role
    geometry: Any
    name: str = ""
    heading: float | None = None
    label: str = ""
    line: int | None = None

    @property
    def points(self) -> FloatArray:
        """(n, 2) [m] of a line, or of the outer ring of a polygon, the first point repeated."""
        ring = self.geometry.exterior if self.role not in ("boundary", "path") else self.geometry
        return np.asarray(shapely.get_coordinates(ring))

    def __str__(self) -> str:
        """``"pillar", line 3``."""
        return self.label if self.line is None else f"{self.label}, line {self.line}"


@dataclass(frozen=True)
class DrawnRobot:
    """A robot as drawn: its outline (n, 2) [m], world frame, and the name that it has there."""

    outline: FloatArray
    drawn_name: str
    name: str = ""
    """see `Drawing.name_robots`"""

    @property
    def own_name(self) -> str:
        """The drawn name as a world may have it; empty where there is none."""
        return escaped(self.drawn_name)[:80].strip()


@dataclass(frozen=True)
class Source:
    """A line as the source has it: where it stands in the text, and what it became."""

    role: str
    """``boundary``, ``obstacle``, ``path`` or ``robot``"""
    label: str
    """what messages call it"""
    line: int | None
    """of the text, from 1"""
    points: FloatArray
    """(n, 2) [m]"""

    def __str__(self) -> str:
        """``'pillar', line 3``."""
        return self.label if self.line is None else f"{self.label}, line {self.line}"


@dataclass
class Drawing:
    """Lines of a source [m], world frame, x right and y up.

    ``boundaries`` are polylines, closed ones with the first point repeated; ``obstacles`` are
    rings without that; ``area`` is the shapely polygon that robots may use, once it is known, and
    ``within`` the one that a source of polygons says is where they may; ``solids`` are those that
    it says are walls all through, ``painted`` walls that are drawn so: they may be a floor.
    ``facts`` say what was read and how; ``changes`` every line that was dropped or repaired.
    """

    kind: str
    path: Path = Path()
    """of the source"""
    shapes: list[Shape] = field(default_factory=list)
    boundaries: list[FloatArray] = field(default_factory=list)
    obstacles: list[FloatArray] = field(default_factory=list)
    reference: FloatArray | None = None
    robots: list[DrawnRobot] = field(default_factory=list)
    paths: dict[str, FloatArray] = field(default_factory=dict)
    area: Any = None
    within: Any = None
    solids: list[Any] = field(default_factory=list)
    painted: list[Any] = field(default_factory=list)
    are_paths_named: bool = False
    """whether every path has a name: robots without one follow the nearest of those of others"""
    has_formation: bool = True
    """whether all robots go along the reference path, as a formation does"""
    facts: list[str] = field(default_factory=list)
    changes: list[str] = field(default_factory=list)
    sources: list[Source] = field(default_factory=list)
    """of what the lines were made, where the source has a name and a line for each"""
    repairs: list[str] = field(default_factory=list)
    """those of the changes that may be why the area does not suit the path"""

    def of(self, *roles: Role) -> list[Shape]:
        """Shapes of some roles, in the order of the source."""
        return [one for one in self.shapes if one.role in roles]

    def nearest(self, point: Sequence[float] | FloatArray, *roles: Role) -> Shape | None:
        """The shape of some roles that is nearest to a point (2,) [m]; None without any."""
        some = self.of(*roles)
        apart = [shapely.distance(one.geometry, shapely.Point(point[:2])) for one in some]
        return some[int(np.argmin(apart))] if some else None

    def refusal(self, message: str, shape: Shape | None = None) -> ImportSourceError:
        """Error at the source, or at a shape of it, with its label and line where known."""
        if shape is None:
            return refused(self.path, message)
        return refused(
            self.path, f"{shape.label}: {message}" if shape.label else message, shape.line
        )

    def source_at(self, point: Sequence[float] | FloatArray, *roles: str) -> Source | None:
        """The source of one of some roles, of any without, nearest to a point (2,) [m]."""
        some = [one for one in self.sources if not roles or one.role in roles]
        if not some:
            return None
        return some[int(np.argmin(shapely.distance(_lines(some), shapely.Point(point[:2]))))]

    def is_on(self, point: Sequence[float] | FloatArray, role: str, distance: float) -> bool:
        """Whether a source of a role lies within a distance [m] of a point (2,) [m]."""
        source = self.source_at(point, role)
        return source is not None and bool(
            shapely.dwithin(_lines([source])[0], shapely.Point(point[:2]), distance)
        )

    def name_robots(self) -> None:
        """Give all robots their names, once they are known: as drawn, else by number, if free."""
        drawn = [robot.own_name for robot in self.robots]
        taken = set[str]()
        for k, robot in enumerate(self.robots):
            name = drawn[k] or f"r{k + 1}"
            while name in taken or (name in drawn and name != drawn[k]):
                name = f"{name}_{k + 1}"
            taken.add(name)
            self.robots[k] = replace(robot, name=name)

    def named(self, point: Sequence[float] | FloatArray, *roles: str) -> str:
        """`` ('pillar', line 3)`` for the source nearest to a point; empty where none is known."""
        source = self.source_at(point, *roles)
        return "" if source is None else f" ({source})"

    def refused_at(
        self, path: Path, message: str, point: Sequence[float] | FloatArray, *roles: str
    ) -> ImportSourceError:
        """Error at the source nearest to a point, with its name and line where these are known."""
        message = "; its cause may be: ".join([message, *self.repairs[:1]])
        source = self.source_at(point, *roles)
        if source is None:
            return refused(path, message)
        return refused(path, f"{source.label}: {message}", source.line)

    def add_outline(self, polygon: Any) -> None:
        """Take the outer ring of a shapely polygon as a boundary, its holes as obstacles."""
        self.boundaries.append(shapely.get_coordinates(polygon.exterior))
        for ring in polygon.interiors:
            points = shapely.get_coordinates(ring)
            if is_long(ring):
                self.boundaries.append(points)
            else:
                self.obstacles.append(points[:-1])


def is_long(ring: Any) -> bool:
    """Whether a closed shapely line has too many corners for an obstacle of a world."""
    return bool(shapely.get_num_coordinates(ring) - 1 > MOST_CORNERS)


def _lines(sources: Sequence[Source]) -> list[Any]:
    return [
        shapely.LineString(one.points) if len(one.points) > 1 else shapely.Point(one.points[0])
        for one in sources
    ]


def refused(source: Path | str, message: str, line: int | None = None) -> ImportSourceError:
    """Error at a source, or at a line of it (from 1)."""
    place = escaped(str(source)) if line is None else f"{escaped(str(source))}:{line}"
    return ImportSourceError(f"{place}: {message}")


def listed(entries: Sequence[Any], describe: Callable[[Any], str] = str) -> list[str]:
    """Describe the first of many entries, and say how many more there are."""
    lines = [describe(entry) for entry in entries[:MOST_LISTED]]
    more = len(entries) - len(lines)
    return [*lines, f"and {more} more"] if more else lines


def place(point: Sequence[float] | FloatArray) -> str:
    """``(x, y)`` in metres."""
    x, y = (round(float(v), 2) + 0.0 for v in point[:2])
    return f"({x:.2f}, {y:.2f})"


def grid_origin(points: FloatArray) -> FloatArray:
    """(2,) [m] to be taken from points (n, 2): whole kilometres, as national grids need; else 0.

    Only where the place itself is no larger than coordinates may be.
    """
    if np.isfinite(points).all() and np.abs(points).max() > LARGEST >= np.ptp(points, axis=0).max():
        return np.asarray(np.floor(points.min(axis=0) / KILOMETRE) * KILOMETRE)
    return np.zeros(2)


def moved_to(origin: FloatArray) -> list[str]:
    """What is told of an origin (2,) [m] that is taken from all points."""
    if not origin.any():
        return []
    return [f"origin moved to {origin[0]:.0f}, {origin[1]:.0f} m of the source"]


def rounded(points: FloatArray) -> FloatArray:
    """Points to the millimetre, neighbours that become one point merged."""
    near: FloatArray = np.asarray(points, dtype=np.float64).round(DIGITS) + 0.0
    if len(near) < 2:
        return near
    keep = np.concatenate(([True], (np.diff(near, axis=0) != 0.0).any(axis=1)))
    return np.asarray(near[keep])


def number(value: float) -> str:
    """Shortest decimal of at most three digits after the point; always with a point."""
    text = f"{value:.{DIGITS}f}".rstrip("0")
    text = text + "0" if text.endswith(".") else text
    return "0.0" if text == "-0.0" else text
