"""What a reader makes of a source: shapes in metres, each with the role that the source states."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
import shapely

from physim.errors import PhysimError
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


@dataclass
class Drawing:
    """Shapes of a source, and what is told of it.

    ``kind`` says what it was read as, ``path`` is that of the source; ``facts`` say what was read
    and how, ``changes`` every shape that was dropped or repaired. ``doubt`` says what to look at
    where no place or way is found: what the source hides, or how it may be meant.
    """

    kind: str
    path: Path
    shapes: list[Shape] = field(default_factory=list)
    facts: list[str] = field(default_factory=list)
    changes: list[str] = field(default_factory=list)
    doubt: str = ""

    def of(self, *roles: Role) -> list[Shape]:
        """Shapes of some roles, in the order of the source."""
        return [one for one in self.shapes if one.role in roles]

    def moved(self, points: FloatArray) -> FloatArray:
        """Points (n, 2) [m] from an origin in whole kilometres, as national grids need; it is told.

        Only where the place itself is no larger than coordinates may be.
        """
        far, size = np.abs(points).max(initial=0.0), np.ptp(points, axis=0).max(initial=0.0)
        if not far > LARGEST >= size:
            return points
        origin = np.floor(points.min(axis=0) / KILOMETRE) * KILOMETRE
        self.facts.append(f"origin moved to {origin[0]:.0f}, {origin[1]:.0f} m of the source")
        return np.asarray(points - origin)

    def refusal(self, message: str, shape: Shape | None = None) -> ImportSourceError:
        """Error at the source, or at a shape of it, with its label and line where known."""
        if shape is None:
            return refused(self.path, message)
        return refused(
            self.path, f"{shape.label}: {message}" if shape.label else message, shape.line
        )

    def lack(self, message: str, shape: Shape | None = None) -> ImportSourceError:
        """Error for want of lines or of a way, with the doubt about the source."""
        return self.refusal(f"{message}; {self.doubt}" if self.doubt else message, shape)


def refused(source: Path | str, message: str, line: int | None = None) -> ImportSourceError:
    """Error at a source, or at a line of it (from 1)."""
    place = f"{source}" if line is None else f"{source}:{line}"
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


def invalid_at(polygon: Any) -> str:
    """`` at (x, y)``: where a shapely polygon crosses or touches itself; else empty."""
    at = re.search(r"\[(\S+) (\S+)\]", shapely.is_valid_reason(polygon))
    return f" at {place([float(at[1]), float(at[2])])}" if at else ""


def rounded(points: FloatArray) -> FloatArray:
    """Points to the millimetre, neighbours that become one point merged."""
    near: FloatArray = np.asarray(points, dtype=np.float64).round(DIGITS) + 0.0
    if len(near) < 2:
        return near
    keep = np.concatenate(([True], (np.diff(near, axis=0) != 0.0).any(axis=1)))
    return np.asarray(near[keep])
