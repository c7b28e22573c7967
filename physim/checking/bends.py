"""Bends of a corridor: walls that fold over, and legs that run into each other."""

from __future__ import annotations

import numpy as np
import shapely

from physim.checking.crossings import crossings, self_crossings
from physim.checking.telling import Told
from physim.errors import plural
from physim.geometry.corridor import SIDES
from physim.geometry.shapes import FloatArray

LEAST_LOSS = 0.02
"""Share of the written distance to a wall that a fold must take away to be told"""


def tell_folds(centreline: FloatArray, walls: list[FloatArray], told: Told) -> None:
    """Warn of a wall that folds over on the inner side of a bend.

    ``walls`` (n + 2, 2) left and right, prolonged by one point at both ends. A folded wall crosses
    itself, or runs backwards for a while and comes nearer to the centreline than half the width.
    """
    for name, wall in zip(SIDES, walls, strict=True):
        places = self_crossings(wall)
        if places:
            x, y = places[0]
            more = f" and at {plural(len(places) - 1, 'more place')}" if len(places) > 1 else ""
            what = f"the {name} crosses itself at ({x:.6g}, {y:.6g}){more}"
        else:
            what = _folded(name, wall[1:-1], centreline)
        if what:
            told.warn(
                ("corridor",),
                f"{what}: the bend is tighter than half the width, so the corridor is narrower "
                "there than written; widen the bend, or put the points of the centreline further "
                "apart",
            )


def _folded(name: str, wall: FloatArray, centreline: FloatArray) -> str:
    """Where a wall (n, 2) runs against its centreline (n, 2) and comes too near; or nothing."""
    backwards = (np.diff(wall, axis=0) * np.diff(centreline, axis=0)).sum(axis=1) <= 0.0
    ends = np.flatnonzero(np.append(backwards, False) | np.append(False, backwards))
    if not len(ends):
        return ""
    places = shapely.points(wall[ends])
    room = shapely.distance(shapely.LineString(centreline), places)
    # half the width of the written corridor: the wall's distance from the two lines at the corner
    wanted = _distance_across(wall, centreline)[ends]
    k = int(np.argmin(room / wanted))
    if room[k] >= wanted[k] * (1.0 - LEAST_LOSS):
        return ""
    x, y = wall[ends[k]]
    return (
        f"the {name} folds over at ({x:.6g}, {y:.6g}), {room[k]:.4g} m from the centreline instead "
        f"of {wanted[k]:.4g} m"
    )


def _distance_across(wall: FloatArray, centreline: FloatArray) -> FloatArray:
    """(n,) [m] distance of each point of a wall from the line through the segment it starts."""
    step = np.diff(centreline, axis=0)
    step = np.vstack([step, step[-1:]]) / np.hypot(*np.vstack([step, step[-1:]]).T)[:, None]
    apart = wall - centreline
    return np.asarray(np.abs(step[:, 0] * apart[:, 1] - step[:, 1] * apart[:, 0]))


def runs_into_itself(centreline: FloatArray, walls: list[FloatArray], told: Told) -> bool:
    """Refuse a corridor of which two legs run into each other: walls of one lie in the other.

    ``walls`` left, right and the caps. To be called where the centreline leaves the area between.
    """
    found = crossings(walls)
    if not found:
        return False
    place = shapely.Point(found[0][2])
    legs = shapely.linestrings(np.stack([centreline[:-1], centreline[1:]], axis=1))
    away = shapely.distance(legs, place)
    one = int(np.argmin(away))
    apart = np.abs(np.arange(len(legs)) - one) > 1
    if not apart.any():
        return False
    other = int(np.argmin(np.where(apart, away, np.inf)))
    first, second = sorted((one, other))
    told.error(
        ("corridor", "centreline"),
        f"the corridor runs into itself at ({place.x:.6g}, {place.y:.6g}): the leg from [{first}] "
        f"to [{first + 1}] and the leg from [{second}] to [{second + 1}] have less than the width "
        "between them; part them, or draw boundaries instead, which may close on themselves",
    )
    return True
