"""Formation neighbours: who knows whom by (7), and whether they keep the whole formation together.

The error sum of (7) is taken over a robot's neighbours. Where no chain of neighbours connects two
parts of the formation, neither keeps its distance to the other, whatever the gain; of a robot
without any neighbour the sum is empty, and it drives at the steady speed.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from typing import Any

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from physim.geometry.shapes import FloatArray, IntArray
from physim.tolerances import CONTACT
from physim.world.checks.findings import MOST_ALIKE, Diagnostics
from physim.world.checks.spacing import listed_leads, name_of, start_stations
from physim.world.scene import Layout


def check_neighbours(laid: Layout, found: Diagnostics) -> None:
    """Warn of a formation whose parts are not connected by neighbours."""
    plan = laid.world.formation
    if plan is None or not plan.gain or len(laid.world.robots) < 2:
        return
    if plan.neighbours == "range":
        _check_range(laid, plan.range, found)
    elif are_pairs(plan.neighbours) and set(chain(*plan.neighbours)) <= {*laid.names}:
        _check_pairs(laid, found)


def _check_range(laid: Layout, reach: float | None, found: Diagnostics) -> None:
    """Warn of a gap longer than ``reach`` [m] between robots in formation, or at the start."""
    if reach is None:
        return
    station = start_stations(laid, shapely.LineString(laid.reference))
    lead = listed_leads(laid)
    lead = station if lead is None else lead
    moments = [("in formation", lead), ("at the start", station)]
    gaps = [(*_largest_gap(at), when) for when, at in moments if at is not None]
    gap, ahead, behind, when = max(gaps, key=lambda one: one[0], default=(0.0, 0, 0, ""))
    if gap > reach:
        found.warn(
            ("formation", "range"),
            f"{when} {name_of(laid, ahead)} is {gap:.4g} m ahead of {name_of(laid, behind)} along "
            f"the reference path, with nobody between them: beyond {reach:.4g} m they are no "
            "neighbours, so that by (7) nobody ahead and nobody behind that gap keeps its distance "
            f"to the others, whatever the gain; use a range of at least {gap * 1.001:.4g} m, or "
            "list pairs of neighbours",
        )


def _largest_gap(station: FloatArray) -> tuple[float, int, int]:
    """The largest gap [m] between one robot and the next along the path, and these, ahead first."""
    order = np.argsort(station, kind="stable")
    gaps = np.diff(station[order])
    k = int(np.argmax(gaps))
    return float(gaps[k]), int(order[k + 1]), int(order[k])


def _check_pairs(laid: Layout, found: Diagnostics) -> None:
    """Warn of robots that no chain of listed pairs connects with the first."""
    near = list(listed_neighbours(laid))
    count = len(near)
    row = np.repeat(np.arange(count), [len(others) for others in near])
    column = np.concatenate(near)
    graph = coo_array((np.ones(len(row)), (row, column)), shape=(count, count))
    parts, part = connected_components(graph, directed=False)
    if parts == 1:
        return
    largest = int(np.argmax(np.bincount(part)))
    left = np.flatnonzero(part != largest)
    advice = "add a pair of one of each" if parts == 2 else "add pairs until one leads to all"
    names = ", ".join(name_of(laid, int(i)) for i in left[:MOST_ALIKE])
    more = f" and {len(left) - MOST_ALIKE} more" if len(left) > MOST_ALIKE else ""
    found.warn(
        ("formation", "neighbours"),
        f"no chain of pairs connects {names}{more} with the other robots: by (7) neither side "
        f"keeps its distance to the other, whatever the gain; {advice}",
    )


def neighbours_at(laid: Layout, station: FloatArray) -> Iterator[IntArray]:
    """For each robot its neighbours, increasing, at stations (N,) [m] of the reference path."""
    plan: Any = laid.world.formation
    if are_pairs(plan.neighbours):
        return listed_neighbours(laid)
    return _within(station, plan.range or 0.0)


def are_pairs(neighbours: Any) -> bool:
    """Whether these are pairs of names, as in a world without a fault there."""
    return isinstance(neighbours, tuple) and all(
        isinstance(pair, tuple) and len(pair) == 2 for pair in neighbours
    )


def listed_neighbours(laid: Layout) -> Iterator[IntArray]:
    """For each robot those that are listed as its neighbours, increasing."""
    index = {name: i for i, name in enumerate(laid.names)}
    near: list[set[int]] = [set() for _ in laid.names]
    plan: Any = laid.world.formation
    for a, b in plan.neighbours:
        if a in index and b in index:
            near[index[a]].add(index[b])
            near[index[b]].add(index[a])
    for others in near:
        yield np.array(sorted(others), dtype=np.int64)


def _within(station: FloatArray, reach: float) -> Iterator[IntArray]:
    """For each robot the others within ``reach`` [m] of its station, increasing."""
    order = np.argsort(station)
    margin = reach + CONTACT  # at first a hair more, so that no rounding leaves one out
    low = np.searchsorted(station, station - margin, sorter=order)
    high = np.searchsorted(station, station + margin, side="right", sorter=order)
    for i in range(len(station)):
        some = np.sort(order[low[i] : high[i]])
        yield some[(np.abs(station[some] - station[i]) <= reach) & (some != i)]
