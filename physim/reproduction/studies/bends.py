"""Bends: formation errors spike in them, robots on outer routes go faster (Sections 3.2 and 4).

The three robots of Fig. 2 have a reference path with sharp corners: a bend lasts while any
robot is near a corner, and what lies between two bends is a straight. On a straight the errors
must die away with the time constant 1/(alpha N) of (7) and (8), every robot being a neighbour
of all others (Figs. 2b, 7a).

A robot's route is longer or shorter than the reference path by its offset times the curvature.
Where that makes 5 % or more, averaged over the 10 m that a robot goes in the window of the
averaged speeds, the robot counts as on an outer or an inner route (Fig. 7c).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np

from physim.analysis.metrics import (
    Figures,
    column_over_time,
    formation_errors,
)
from physim.errors import RecordError
from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.reproduction.measures import Measures, corners, turning
from physim.reproduction.model import Arm, Verdict, outcome
from physim.reproduction.study import (
    Runs,
    Shown,
    Study,
    root_mean_square,
    same,
    time_constant,
)

CORNER = math.radians(15.0)
"""[rad] turn of the reference path that makes a corner"""
NEAR = 3.0
"""[m] before and after a corner that belong to the bend: the robots cut corners"""
SHORTEST = 5.0
"""[s] straights that last less are not fitted"""
LARGE = 0.2
"""[m] root mean square error at the start of a straight below which nothing is fitted"""
TOLERANCE = 0.15
"""[-] by which the time constant may differ from that of the theory"""
CONVERGED = 0.1
"""[m] formation error that counts as zero at the end, as in the table of reported numbers"""


def measure_bends(record: Record) -> Measures:
    """Peak in bends and at the ends of straights, and time constants [m, %, s]."""
    time, station = column_over_time(record, "reference_station")
    course = formation_errors(record)
    if course is None:
        raise RecordError(f"{record!r} has no formation errors")
    steps = Figures(record).active_steps
    there = np.where(steps < record.steps_run, steps * record.dt, math.inf)
    progressing = time < there.min()
    size, largest = root_mean_square(course.values), np.abs(course.values).max(axis=1)
    near = np.abs(station[:, :, None] - corners(record.reference.points, CORNER)) <= NEAR
    # stretches of moments [a, b) with no robot in a bend and none at its goal yet
    free = np.concatenate(([False], ~near.any(axis=(1, 2)) & progressing, [False]))
    ends = np.flatnonzero(np.diff(free.astype(np.int8))).reshape(-1, 2)
    straights = [(a, b) for a, b in ends.tolist() if b - a > 1]
    after = straights[1:]  # the first straight follows the start, not a bend
    constant = _median(
        time_constant(time[a:b], size[a:b])
        for a, b in straights
        if time[b - 1] - time[a] >= SHORTEST and size[a] >= LARGE
    )
    theory = 1.0 / (float(record.world_settings["formation"]["gain"]) * record.robots)
    return {
        "peak": float(largest[progressing].max()),
        "after_bends": _median(size[a] for a, _ in after),
        "end_of_straights": _median(size[b - 1] for _, b in after),
        "risen": _mean([100.0 * (size[a] > size[b - 1]) for (_, b), (a, _) in pairwise(straights)]),
        "fallen": _mean([100.0 * (size[b - 1] < size[a]) for a, b in straights]),
        "time_constant": constant,
        "theory": theory,
        "over_theory": constant / theory,
        "final": float(largest[-1]),
    }


def _median(values: Iterable[float]) -> float:
    found = list(values)
    return float(np.median(found)) if found else math.nan


def _mean(values: Sequence[float] | FloatArray) -> float:
    return float(np.mean(values)) if len(values) else math.nan


def conclude_bends(arms: Sequence[Runs]) -> Sequence[Verdict]:
    """Errors rise in bends and fall after, with the theory's time constant, to zero at the end."""
    paper = arms[0]
    after, before = paper.of("after_bends"), paper.of("end_of_straights")
    risen, fallen, final = paper.of("risen"), paper.of("fallen"), paper.of("final")
    return (
        Verdict(
            "Formation errors spike in bends and converge after them",
            "errors increase at sharp path curvatures",
            f"root mean square error after a bend {after.text(2, 'm')}, at the end of the straight "
            f"that follows {before.text(2, 'm')}; it rose in {risen.text(0, '%')} of the "
            f"bends and fell on {fallen.text(0, '%')} of the straights; peak of one robot "
            f"{paper.of('peak').text(2, 'm')}",
            outcome(
                before.is_below(after) and risen.median > 50.0 and fallen.median > 50.0,
                after.median > before.median,
            ),
            "In a bend against the one before it the errors may fall: routes change sides.",
        ),
        Verdict(
            "After a bend the errors die away with the time constant 1/(alpha N) of (7)",
            "in words only",
            "; ".join(
                f"{arm.label}: {runs.of('time_constant').text(1, 's')} of "
                f"{runs.of('theory').median:.1f} s"
                for arm, runs in zip(BENDS.arms, arms, strict=True)
            ),
            same((runs.of("over_theory") for runs in arms), TOLERANCE),
            "The paper's alpha and waypoints are unknown; the time constant is that of our alpha.",
        ),
        Verdict(
            "Formation errors converge to zero by the end (Fig. 2b)",
            "zero at the end",
            f"largest error at the end {final.text(2, 'm')}",
            outcome(final.high <= CONVERGED, final.median <= CONVERGED),
        ),
    )


_WIDE = "formation.limits=[0.5, 1.5]"

BENDS = Study(
    name="bends",
    title="Formation errors in bends",
    claim="Formation errors spike in bends and converge after them.",
    arms=(
        Arm("α = 0.02/s", "three_robots"),
        Arm("α = 0.05/s", "three_robots", ("formation.gain=0.05", _WIDE)),
        Arm("α = 0.1/s", "three_robots", ("formation.gain=0.1", _WIDE)),
    ),
    measure=measure_bends,
    conclude=conclude_bends,
    shown={
        "after_bends": Shown("root mean square error after a bend", "m"),
        "end_of_straights": Shown("at the end of the straight that follows", "m"),
        "over_theory": Shown("time constant over 1/(αN)", line=1.0),
    },
)


WINDOW = 10.0
"""[m] along the reference path over which its curvature is taken"""
CLEAR = 0.05
"""[-] by which a route must be longer or shorter to count"""
STEADY = 1.0
"""[m/s] nu_0"""


def measure_routes(record: Record) -> Measures:
    """Mean averaged forward speed [m/s] on outer and inner routes and between, over all robots."""
    speeds = Figures(record).averaged
    if not len(speeds.time):
        return dict.fromkeys(("outer", "between", "inner"), math.nan)
    grid, station = column_over_time(record, "reference_station")
    longer = np.full(speeds.forward.shape, np.nan)
    rows = np.searchsorted(record.time, speeds.time - 1e-9).clip(0, record.samples - 1)
    for i in range(record.robots):
        s = np.interp(speeds.time, grid, station[:, i])
        longer[:, i] = extra_length(record.reference.points, s, record.pose[rows, i, :2])
    known = np.isfinite(speeds.forward)
    speed, longer = speeds.forward[known], longer[known]
    return {
        "outer": _mean(speed[longer >= CLEAR]),
        "between": _mean(speed[np.abs(longer) < CLEAR]),
        "inner": _mean(speed[longer <= -CLEAR]),
    }


def extra_length(line: FloatArray, station: FloatArray, position: FloatArray) -> FloatArray:
    """How much longer a robot's route is than the reference path there, (K,) [-].

    Minus the signed curvature times the offset, left positive both: on the outside of a bend this
    is positive. Of stations (K,) [m] along a line (P, 2) and positions (K, 2).
    """
    leg = np.diff(line, axis=0)
    length = np.hypot(leg[:, 0], leg[:, 1])
    here = np.searchsorted(np.cumsum(length)[:-1], station, side="right")
    along, across = leg[here] / length[here, None], position - line[here]
    offset = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]
    return np.asarray(-turning(line, station, WINDOW) / WINDOW * offset)


def conclude_routes(arms: Sequence[Runs]) -> Sequence[Verdict]:
    """Whether speeds on outer routes lie above 1 m/s and on inner routes below, for each world."""

    def verdict(arm: Arm, runs: Runs) -> Verdict:
        outer, inner = runs.of("outer"), runs.of("inner")
        apart = outer.low > STEADY > inner.high
        return Verdict(
            f"Robots on outer routes exceed 1 m/s, those on inner routes fall below ({arm.label})",
            "above 1 m/s behind or outside, below 1 m/s ahead or inside",
            f"averaged over 10 s: outer {outer.text(3, 'm/s')}, inner {inner.text(3, 'm/s')}, "
            f"between {runs.of('between').text(3, 'm/s')}",
            outcome(apart, inner.is_below(outer)),
            "The paper's paths are unknown; which robot is outside follows from ours.",
        )

    return tuple(map(verdict, ROUTES.arms, arms))


ROUTES = Study(
    name="routes",
    title="Outer and inner routes",
    claim="Robots on outer routes exceed 1 m/s, those on inner routes fall below.",
    arms=(Arm("three robots", "three_robots"), Arm("ten robots", "ten_robots")),
    measure=measure_routes,
    conclude=conclude_routes,
    shown={
        name: Shown(f"speed over 10 s, {name} routes", "m/s", line=STEADY)
        for name in ("outer", "between", "inner")
    },
)
