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
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from physim.analysis.metrics import active_steps, averaged_speeds, column_over_time
from physim.drawing.plots.style import CYCLE, INK, QUIET
from physim.errors import RecordError
from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.reproduction import decided
from physim.reproduction.claims.motion import turning
from physim.reproduction.estimates import (
    column,
    estimate,
    estimated,
    outcome,
    root_mean_square,
    time_constant,
)
from physim.reproduction.pictures import points, prepared, single_runs
from physim.reproduction.study import Arm, Measures, Study, Table, Verdict
from physim.world.file import load_world

if TYPE_CHECKING:
    from matplotlib.figure import Figure


WORLD = "three_robots"
SHARP = math.radians(15.0)
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
STATIONS = tuple(range(12, 151, 2))
"""[m] places of the mean robot along the reference path at which the error is kept for the plot"""


def measure_bends(record: Record) -> Measures:
    """Peak in bends and at the ends of straights, time constants, and the error along the way."""
    time, station = column_over_time(record, "reference_station")
    course = decided.formation_errors(record)
    if course is None:
        raise RecordError(f"{record!r} has no formation errors")
    steps = active_steps(record)
    there = np.where(steps < record.steps_run, steps * record.dt, math.inf)
    progressing = time < there.min()
    size = root_mean_square(course.values)
    near = np.abs(station[:, :, None] - corners(record.reference.points)) <= NEAR
    straights = _straights(np.any(near, axis=(1, 2)), progressing)
    gain = float(record.world_settings["formation"]["gain"])
    found = [
        time_constant(time[a:b], size[a:b])
        for a, b in straights
        if time[b - 1] - time[a] >= SHORTEST and size[a] >= LARGE
    ]
    largest = np.abs(course.values).max(axis=1)
    after = straights[1:]  # the first straight follows the start, not a bend
    measures = {
        "peak": float(largest[progressing].max()),
        "after_bends": _median([size[a] for a, _ in after]),
        "end_of_straights": _median([size[b - 1] for _, b in after]),
        "risen": _share([size[a] > size[b - 1] for (_, b), (a, _) in pairwise(straights)]),
        "fallen": _share([size[b - 1] < size[a] for a, b in straights]),
        "time_constant": _median(found),
        "theory": 1.0 / (gain * record.robots),
        "final": float(largest[-1]),
    }
    place = station.mean(axis=1)
    at = np.interp(STATIONS, np.maximum.accumulate(place), size, right=math.nan)
    measures.update({f"at_{s}": float(value) for s, value in zip(STATIONS, at, strict=True)})
    return measures


def corners(points: FloatArray) -> FloatArray:
    """Stations [m] of the corners of a line (P, 2)."""
    leg = np.diff(points, axis=0)
    heading = np.unwrap(np.arctan2(leg[:, 1], leg[:, 0]))
    place = np.cumsum(np.hypot(leg[:, 0], leg[:, 1]))[:-1]
    return np.asarray(place[np.abs(np.diff(heading)) > SHARP])


def _straights(bend: NDArray[np.bool_], progressing: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Stretches of moments [a, b) with no robot in a bend and none at its goal yet."""
    free = np.concatenate(([False], ~bend & progressing, [False]))
    change = np.flatnonzero(np.diff(free.astype(np.int8)))
    return [(int(a), int(b)) for a, b in change.reshape(-1, 2) if b - a > 1]


def _median(values: Sequence[float]) -> float:
    return float(np.median(values)) if values else math.nan


def _share(values: Sequence[bool | np.bool_]) -> float:
    """Share [%] of what is true."""
    return 100.0 * float(np.mean(np.array(values))) if values else math.nan


def conclude_bends(arms: Table) -> Sequence[Verdict]:
    """Errors rise in bends and fall after, with the theory's time constant, to zero at the end."""
    paper = arms[0]
    after, before = (estimated(paper, name) for name in ("after_bends", "end_of_straights"))
    risen, fallen = (estimated(paper, name) for name in ("risen", "fallen"))
    ratios = [estimate([run["time_constant"] / run["theory"] for run in runs]) for runs in arms]
    near = [abs(one.median - 1.0) <= TOLERANCE for one in ratios]
    final = estimated(paper, "final")
    each = "; ".join(
        f"{arm.label}: {estimated(runs, 'time_constant').text(1, 's')} of {runs[0]['theory']:.1f} s"
        for arm, runs in zip(BENDS.arms, arms, strict=True)
    )
    return (
        Verdict(
            "Formation errors spike in bends and converge after them",
            "errors increase at sharp path curvatures",
            f"root mean square error after a bend {after.text(2, 'm')}, at the end of the straight "
            f"that follows {before.text(2, 'm')}; it rose in {risen.text(0, '%')} of the "
            f"bends and fell on {fallen.text(0, '%')} of the straights; peak of one robot "
            f"{estimated(paper, 'peak').text(2, 'm')}",
            outcome(
                after.low > before.high and risen.median > 50.0 and fallen.median > 50.0,
                after.median > before.median,
            ),
            "In a bend against the one before it the errors may fall: routes change sides.",
        ),
        Verdict(
            "After a bend the errors die away with the time constant 1/(alpha N) of (7)",
            "in words only",
            each,
            outcome(all(near), any(near)),
            "The paper's alpha and waypoints are unknown; the time constant is that of our alpha.",
        ),
        Verdict(
            "Formation errors converge to zero by the end (Fig. 2b)",
            "zero at the end",
            f"largest error at the end {final.text(2, 'm')}",
            outcome(final.high <= CONVERGED, final.median <= CONVERGED),
        ),
    )


def draw_bends(figure: Figure, labels: Sequence[str], arms: Table) -> None:
    """Root mean square error along the way, median and range of the seeds, with the bends."""
    prepared(figure, "Formation errors spike in bends and converge after them", height=3.3)
    axis = figure.subplots()
    for k, (label, runs) in enumerate(zip(labels, arms, strict=True)):
        at = np.array([[run[f"at_{s}"] for s in STATIONS] for run in runs])
        middle = [float(np.median(values)) for values in at.T]
        low, high = np.min(at, axis=0), np.max(at, axis=0)
        axis.fill_between(STATIONS, low, high, color=CYCLE[k], alpha=0.2, linewidth=0.0)
        axis.plot(STATIONS, middle, color=CYCLE[k], label=label, linestyle=("-", "--", ":")[k])
    for place in corners(np.array(load_world(WORLD).reference)):
        axis.axvspan(place - NEAR, place + NEAR, color=QUIET, alpha=0.13, linewidth=0.0)
    axis.axvspan(0, 0, color=QUIET, alpha=0.13, label="corner of the reference path")
    axis.set_xlabel("place of the mean robot along the reference path [m]")
    axis.set_ylabel("root mean square\nformation error [m]")
    axis.set_xlim(STATIONS[0], STATIONS[-1])
    axis.set_ylim(bottom=0.0)
    figure.legend(loc="outside lower left", ncols=2)


_WIDE = "formation.limits=[0.5, 1.5]"

BENDS = Study(
    name="bends",
    title="Formation errors in bends",
    claim="Formation errors spike in bends and converge after them.",
    arms=(
        Arm("α = 0.02/s", WORLD),
        Arm("α = 0.05/s", WORLD, ("formation.gain=0.05", _WIDE)),
        Arm("α = 0.1/s", WORLD, ("formation.gain=0.1", _WIDE)),
    ),
    measure=measure_bends,
    conclude=conclude_bends,
    draw=draw_bends,
)


WINDOW = 10.0
"""[m] along the reference path over which its curvature is taken"""
CLEAR = 0.05
"""[-] by which a route must be longer or shorter to count"""
STEADY = 1.0
"""[m/s] nu_0"""


def measure_routes(record: Record) -> Measures:
    """Mean averaged forward speed [m/s] on outer and inner routes and between, over all robots."""
    speeds = averaged_speeds(record)
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


def _mean(values: FloatArray) -> float:
    return float(values.mean()) if len(values) else math.nan


def conclude_routes(arms: Table) -> Sequence[Verdict]:
    """Whether speeds on outer routes lie above 1 m/s and on inner routes below, for each world."""
    verdicts = []
    for arm, mine in zip(ROUTES.arms, arms, strict=True):
        outer, inner = (estimated(mine, name) for name in ("outer", "inner"))
        verdicts.append(
            Verdict(
                f"Robots on outer routes exceed 1 m/s, those on inner routes fall below "
                f"({arm.label})",
                "above 1 m/s behind or outside, below 1 m/s ahead or inside",
                f"averaged over 10 s: outer {outer.text(3, 'm/s')}, inner {inner.text(3, 'm/s')}, "
                f"between {estimated(mine, 'between').text(3, 'm/s')}",
                outcome(
                    outer.low > STEADY and inner.high < STEADY,
                    outer.low > inner.high,
                ),
                "The paper's paths are unknown; which robot is outside follows from ours.",
            )
        )
    return tuple(verdicts)


def draw_routes(figure: Figure, labels: Sequence[str], arms: Table) -> None:
    """Averaged speeds of every seed on outer routes, between and on inner routes."""
    prepared(figure, "Outside a bend robots go faster, inside slower")
    axis = figure.subplots()
    looks = (("outer", CYCLE[1], "^", -0.24, "outer route"),
             ("between", CYCLE[0], "o", 0.0, "neither"),
             ("inner", CYCLE[2], "v", 0.24, "inner route"))  # fmt: skip
    for name, colour, marker, shift, label in looks:
        places = [k + shift for k in range(len(arms))]
        columns = [column(mine, name) for mine in arms]
        for place, values in zip(places, columns, strict=True):
            single_runs(axis, place, values, colour)
        points(axis, places, columns, colour, marker, label)
    axis.axhline(STEADY, color=INK, linewidth=0.8, linestyle=(0, (4, 2)), zorder=1.5)
    axis.annotate(
        "ν₀", (1.0, STEADY), xycoords=("axes fraction", "data"), xytext=(-2, 2),
        textcoords="offset points", ha="right", va="bottom", fontsize=8.0, color=QUIET,
    )  # fmt: skip
    axis.set_xticks(range(len(labels)), labels)
    axis.set_xlim(-0.5, len(labels) - 0.5)
    axis.grid(visible=False, axis="x")
    axis.tick_params(axis="x", length=0.0)
    axis.set_ylabel("forward speed\naveraged over 10 s [m/s]")
    figure.legend(loc="outside lower left", ncols=3)


ROUTES = Study(
    name="routes",
    title="Outer and inner routes",
    claim="Robots on outer routes exceed 1 m/s, those on inner routes fall below.",
    arms=(Arm("three robots", "three_robots"), Arm("ten robots", "ten_robots")),
    measure=measure_routes,
    conclude=conclude_routes,
    draw=draw_routes,
)
