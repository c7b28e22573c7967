"""The formation along the paths: whether the robots stand apart in it, in the order they start."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from physim.errors import Location
from physim.geometry.shapes import FloatArray
from physim.tolerances import CONTACT, LENGTH
from physim.world.checks.findings import MOST_ALIKE, Diagnostics
from physim.world.checks.room import inscribed_radius
from physim.world.checks.way import Way, is_ring
from physim.world.faults import describe
from physim.world.layout.shared import Shared, sharing
from physim.world.scene import Layout

PLACES = 12
"""Stations of the reference path at which the whole formation is laid out."""
MOST_PAIRS = 100_000
"""Pairs of robots that meet at one of these stations which are looked at, about"""
MOST_OF = PLACES // 2
"""of them at which two robots meet at least, for whom it is sure that they do wherever both are"""


def listed_leads(laid: Layout) -> FloatArray | None:
    """(N,) [m] wanted lead of each robot over the first, where the world lists them."""
    plan: Any = laid.world.formation
    spacing = plan.spacing
    is_one_each = isinstance(spacing, tuple) and len(spacing) == len(laid.world.robots)
    return np.array(spacing, dtype=np.float64) if is_one_each else None


def start_stations(laid: Layout, line: shapely.LineString) -> FloatArray | None:
    """(N,) [m] stations at the start along the reference path; None unless all are known."""
    return np.asarray(line.project(shapely.points(laid.start[:, :2])))


def check_spacing(
    laid: Layout, reference: FloatArray, leads: FloatArray, found: Diagnostics
) -> None:
    """Lay the formation out along the reference path and see which footprints meet."""
    shared = list(range(len(laid.paths)))
    if len(shared) < 2:
        return
    way = Way(reference)
    room = way.station[-1] - (leads.max() - leads.min())
    if room <= 0.0:
        return  # reported as a reference path that is too short
    bases = _bases(laid, shared, way, leads, room)
    shapes, is_there = _laid_out(laid, shared, way.at((bases + leads[shared][:, None]).ravel())[0])
    met = {(shared[i], shared[j]): count for i, j, count in _meetings(shapes, is_there)}
    row = {robot: k for k, robot in enumerate(shared)}
    both = {(i, j): int((is_there[row[i]] & is_there[row[j]]).sum()) for i, j in met}
    is_listed = listed_leads(laid) is not None
    where: Location = ("formation", "spacing") if is_listed else ("formation",)
    everywhere = sorted(pair for pair, count in met.items() if MOST_OF <= count == both[pair])
    for i, j in everywhere[:MOST_ALIKE]:
        found.error(
            (*where, j) if is_listed else where,
            f"{abs(leads[j] - leads[i]):.4g} m between {name_of(laid, i)} and {name_of(laid, j)} "
            "along the reference path is less than their footprints need on their paths: they "
            f"would overlap in formation; {_remedy(laid, i, j)}",
        )
    somewhere = sorted(met.keys() - {*everywhere})
    for i, j in somewhere[:MOST_ALIKE]:
        found.warn(
            where,
            f"in formation {name_of(laid, i)} and {name_of(laid, j)} would overlap at "
            f"{met[i, j]} of {both[i, j]} places along the reference path, where their paths come "
            "close; space them further apart there",
        )


def check_order(laid: Layout, leads: FloatArray, found: Diagnostics) -> None:
    """Warn of robots that would have to pass one another on a path that they share.

    Told of who is to lead, by whatever little, but starts wholly behind; once for each such path.
    Where the seed places robots, any order is meant.
    """
    reach = Shared(inscribed_radius)
    written = [i for i, robot in enumerate(laid.world.robots) if robot.pose is not None]
    known = list(written)
    for rows in sharing([laid.paths[i] for i in known]):
        robots = np.array([known[k] for k in rows])
        way = Way(laid.paths[robots[0]])
        if len(robots) < 2 or is_ring(way.points):
            continue
        robots = robots[np.argsort(leads[robots], kind="stable")]
        lead, station = leads[robots], way.nearest(laid.start[robots, :2])
        radius = np.array([reach(laid.footprints[i]) for i in robots.tolist()])
        back = station - radius
        ahead = np.array([np.argmax(back[: k + 1]) for k in range(len(robots))])
        # the foremost of all that are to be behind; equal leads have no order
        first = np.searchsorted(lead, lead - LENGTH)
        gap = np.where(first > 0, back[ahead[first - 1]] - (station + radius), -np.inf)
        k = int(np.argmax(gap))
        if gap[k] <= LENGTH:
            continue
        leader, other = int(robots[k]), int(robots[ahead[first[k] - 1]])
        behind = station[ahead[first[k] - 1]] - station[k]
        is_listed = listed_leads(laid) is not None
        found.warn(
            ("formation", "spacing", leader) if is_listed else ("formation",),
            f"{name_of(laid, leader)} is to be {leads[leader] - leads[other]:.4g} m ahead of "
            f"{name_of(laid, other)} but starts {behind:.4g} m behind it on the same path: it "
            "would have to pass; list the leads in the order of the start, or give them paths "
            "of their own",
        )


def _bases(
    laid: Layout, robots: Sequence[int], way: Way, leads: FloatArray, room: float
) -> FloatArray:
    """Places (K,) [m] of the first robot along s* at which the formation is laid out.

    Within ``room``, all that lie between the ends of the robots' own paths; all of it where a path
    is closed, or leads over the joint of a closed s*, and its ends say nothing of what it passes.
    """
    low, high = -leads.min(), -leads.min() + room
    ends = np.array([laid.paths[i][[0, -1]] for i in robots])
    at = way.nearest(ends.reshape(-1, 2)).reshape(-1, 2)
    if (at[:, 0] < at[:, 1]).all() and not any(is_ring(laid.paths[i]) for i in robots):
        bases = at - leads[list(robots)][:, None]
        low, high = np.clip((bases.min(), bases.max()), low, high)
    return np.linspace(low, high, PLACES)


def _meetings(shapes: Any, is_there: NDArray[np.bool_]) -> list[tuple[int, int, int]]:
    """Which two rows of shapes (R, K) meet, and at how many of K places where both are there.

    Of a crowd that stands in one place the first rows alone are looked at, with all others.
    """
    rows = count = len(shapes)
    block = max(1, MOST_PAIRS // count)
    found = []
    for column, there in zip(shapes.T, is_there.T, strict=True):
        tree, seen = shapely.STRtree(column), 0
        for first in range(0, rows, block):
            last = min(first + block, rows)
            i, j = tree.query(column[first:last], predicate="dwithin", distance=CONTACT)
            i += first
            both = (i < j) & there[i] & there[j]
            found.append(i[both] * count + j[both])
            seen += int(both.sum())
            if seen > MOST_PAIRS:
                rows = last
                break
    pairs, places = np.unique(np.concatenate(found), return_counts=True)
    known = pairs < rows * count
    return [
        (*divmod(pair, count), at)
        for pair, at in zip(pairs[known].tolist(), places[known].tolist(), strict=True)
    ]


def _remedy(laid: Layout, i: int, j: int) -> str:
    """What parts two robots that would overlap in formation: depends on where spacing is from."""
    if listed_leads(laid) is not None:
        return "space them further apart, or separate their paths"
    if any(laid.world.robots[k].pose is None for k in (i, j)):
        return (
            "spacing is initial, and the seed places them this close along the road; try another "
            "seed, a larger min_gap or another abreast in start, or list the leads in "
            "formation.spacing"
        )
    return (
        "spacing is initial, so they start this close along the road; move their poses apart, or "
        "list the leads in formation.spacing, or separate their paths"
    )


def _laid_out(
    laid: Layout, robots: Sequence[int], beside: FloatArray
) -> tuple[Any, NDArray[np.bool_]]:
    """Footprints (R, K) of robots on their own paths, next to K places each, beside (R K, 2).

    And whether their paths come by there: a robot whose path has not begun, or is over, is not in
    the formation, and stands at the end of its path here.
    """
    beside = beside.reshape(len(robots), -1, 2)
    is_there = np.ones(beside.shape[:2], dtype=np.bool_)
    shapes = np.empty(beside.shape[:2], dtype=object)
    for rows in sharing([laid.paths[robot] for robot in robots]):
        way = Way(laid.paths[robots[rows[0]]])
        wanted = beside[rows].reshape(-1, 2)
        stations = way.nearest(wanted)
        places, ahead = way.at(stations)
        apart = ((wanted - places) * ahead).sum(axis=1)  # along the path: beyond its ends alone
        at_end = (stations <= LENGTH) | (stations >= way.station[-1] - LENGTH)
        is_beyond = at_end & (np.abs(apart) > LENGTH) & (not is_ring(way.points))
        is_there[rows] = ~is_beyond.reshape(len(rows), -1)
        by_robot = zip(rows, np.split(places, len(rows)), np.split(ahead, len(rows)), strict=True)
        for row, place, direction in by_robot:
            x, y = laid.footprints[robots[row]].T
            c, s = direction.T
            turned = [np.outer(c, x) - np.outer(s, y), np.outer(s, x) + np.outer(c, y)]
            shapes[row] = shapely.polygons(np.stack(turned, axis=2) + place[:, None])
    return shapes, is_there


def name_of(laid: Layout, number: int) -> str:
    """Name of a robot, as messages have it."""
    return describe(laid.names[number])
