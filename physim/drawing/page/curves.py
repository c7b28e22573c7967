"""Courses over the time of a run that the page plots, on a grid: bins that keep every extreme."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.drawing.crowd import MOST_LINES, NAMED, quantiles
from physim.drawing.page.packing import Pack
from physim.drawing.timeline import Timeline
from physim.geometry.shapes import FloatArray, IntArray

BINS = 3000
"""Least values at most; of longer runs each is that of a stretch of time"""
MOMENTS = 400
"""at which bands of a crowd and its modes are taken"""
MOST_NOW, MOST_LOOKED_AT = 40_000, 4_000_000
"""Samples, and samples of robots, of which the distances of that very moment are kept; of more,
those of samples spread evenly"""
LENGTH, SECONDS = 1e-4, 1e-3
"""[m], [s] to which they are rounded"""
ERROR = 1e-3
"""[m] to which formation errors and deviations are"""


def pack_curves(timeline: Timeline, pack: Pack) -> dict[str, Any]:
    """Add the courses; returns what the header says of them."""
    record, samples = timeline.record, len(timeline.time)
    bins = np.linspace(0, samples, min(samples, BINS), endpoint=False)
    first = np.unique(bins.astype(np.int64))
    pack.whole("bin", record.steps[first])
    clearance, walls = record.clearance, record.boundary_clearance
    if timeline.moving > 1:
        pack.real("pair", np.minimum.reduceat(clearance.min(axis=1), first), LENGTH)
    has_walls = bool(np.isfinite(walls).any())
    if has_walls:
        pack.real("wall", np.minimum.reduceat(walls.min(axis=1), first), LENGTH)
    # and of single moments, told beside a picture of that moment, with the two that are closest
    count = min(samples, MOST_NOW, max(BINS, MOST_LOOKED_AT // timeline.robots))
    at = np.unique(np.linspace(0, samples - 1, count).astype(np.int64))
    pack.whole("now", record.steps[at])
    clearance, walls = timeline.distances_at(at)
    if timeline.moving > 1:
        nearest = np.sort(np.argsort(clearance, axis=1, kind="stable")[:, :2], axis=1)
        if timeline.scene.moved:  # the closest two need not be two robots
            nearest = timeline.closest_at(at)
        pack.real("now_pair", clearance.min(axis=1), LENGTH)
        pack.whole("now_a", nearest[:, 0])
        pack.whole("now_b", nearest[:, 1])
    pack.real("now_wall", walls.min(axis=1), LENGTH)
    return {
        "pair": timeline.moving > 1,
        "wall": has_walls,
        "times": _pack_times(timeline, first, pack),
        "error": _pack_errors(timeline, pack),
        "modes": _pack_modes(timeline, pack),
    }


def _moments(timeline: Timeline) -> FloatArray:
    """(T,) [s] spread evenly over a run."""
    return np.linspace(timeline.begin, timeline.duration, MOMENTS)


def _pack_times(timeline: Timeline, first: IntArray, pack: Pack) -> bool:
    """Add the least collision time of the decisions in each bin; inf where all have none."""
    record = timeline.record
    values = record.column("collision_time", absent=np.nan)
    if not np.isfinite(values).any():
        return False
    values = np.where(np.isnan(values), np.inf, values)
    bins = np.searchsorted(record.steps[first], record.updates["step"], side="right") - 1
    least = np.full(len(first), np.inf)
    np.minimum.at(least, bins, values)
    pack.real("times", least, SECONDS)
    return True


def _pack_errors(timeline: Timeline, pack: Pack) -> dict[str, Any]:
    """Add formation errors, or deviations, (N, T) at samples spread evenly; with bands of a crowd.

    Returns what their plot is called.
    """
    curves, samples = timeline.curves, len(timeline.time)
    bands = timeline.robots > MOST_LINES
    count = min(samples, MOMENTS if bands else BINS)
    at = np.linspace(0, samples - 1, count).astype(np.int64)
    pack.whole("error_step", timeline.record.steps[at])
    pack.real("error", curves.values[at].T, ERROR)
    if bands:
        levels = quantiles(curves.values[timeline.shown(_moments(timeline))])
        pack.real("bands", levels, ERROR)
    return {"title": curves.title, "name": curves.name, "bands": bands}


def _pack_modes(timeline: Timeline, pack: Pack) -> bool:
    """Add how many robots of a crowd have each mode (modes + 1, T); the last have none."""
    if timeline.robots <= NAMED:
        return False
    modes = timeline.modes(timeline.decisions(_moments(timeline)))
    known = len(timeline.scene.modes)
    counts = [(modes == mode).sum(axis=1) for mode in (*range(known), -1)]
    pack.whole("mode_counts", np.array(counts))
    return True
