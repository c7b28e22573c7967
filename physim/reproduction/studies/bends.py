"""Formation errors spike in bends and converge after them (Sections 3.2 and 4, Figs. 2b, 7a).

The three robots of Fig. 2, whose reference path has sharp corners: a bend lasts while any robot is
near a corner, and what lies between two bends is a straight. On a straight the errors must die away
with the time constant 1/(alpha N) of (7) and (8), every robot being a neighbour of all others.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from physim.errors import RecordError
from physim.geometry.shapes import FloatArray
from physim.metrics import (
    active_steps,
    column_over_time,
    formation_errors,
    world_settings,
)
from physim.plots.style import CYCLE, QUIET
from physim.record import Record
from physim.reproduction.studies.drawing import prepared
from physim.reproduction.studies.estimates import column, estimate, outcome
from physim.reproduction.studies.fits import root_mean_square, time_constant
from physim.reproduction.study import Arm, Measures, Study, Verdict
from physim.world_file import load_world

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


def measure(record: Record) -> Measures:
    """Peak in bends and at the ends of straights, time constants, and the error along the way."""
    time, station = column_over_time(record, "reference_station")
    course = formation_errors(record)
    if course is None:
        raise RecordError(f"{record!r} has no formation errors")
    steps = active_steps(record)
    there = np.where(steps < record.steps_run, steps * record.dt, math.inf)
    under_way = time < there.min()
    size = root_mean_square(course.values)
    straights = _straights(_in_bend(station, corners(record.reference.points)), under_way)
    gain = float(world_settings(record)["formation"]["gain"])
    found = [
        time_constant(time[a:b], size[a:b])
        for a, b in straights
        if time[b - 1] - time[a] >= SHORTEST and size[a] >= LARGE
    ]
    largest = np.abs(course.values).max(axis=1)
    after = straights[1:]  # the first straight follows the start, not a bend
    measures = {
        "peak": float(largest[under_way].max()),
        "after_bends": float(np.median([size[a] for a, _ in after])) if after else math.nan,
        "end_of_straights": float(np.median([size[b - 1] for _, b in after]))
        if after
        else math.nan,
        "risen": _share([size[a] > size[b - 1] for (a, _), (_, b) in _pairs(straights)]),
        "fallen": _share([size[b - 1] < size[a] for a, b in straights]),
        "time_constant": float(np.median(found)) if found else math.nan,
        "theory": 1.0 / (gain * record.robots),
        "final": float(largest[-1]),
    }
    place = station.mean(axis=1)
    at = np.interp(STATIONS, np.maximum.accumulate(place), size, right=math.nan)
    measures.update({f"at_{s}": float(value) for s, value in zip(STATIONS, at, strict=True)})
    return measures


def corners(points: FloatArray) -> FloatArray:
    """Stations [m] of the corners of a line (P, 2)."""
    way = np.diff(points, axis=0)
    heading = np.unwrap(np.arctan2(way[:, 1], way[:, 0]))
    place = np.cumsum(np.hypot(way[:, 0], way[:, 1]))[:-1]
    return np.asarray(place[np.abs(np.diff(heading)) > SHARP])


def _in_bend(station: FloatArray, places: FloatArray) -> NDArray[np.bool_]:
    """Whether any robot is near a corner, (K,), for stations (K, N)."""
    near = np.abs(station[:, :, None] - places) <= NEAR
    return np.asarray(near.any(axis=(1, 2)))


def _straights(bend: NDArray[np.bool_], under_way: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Stretches of moments [a, b) outside bends, with all robots under way."""
    free = np.concatenate(([False], ~bend & under_way, [False]))
    change = np.flatnonzero(np.diff(free.astype(np.int8)))
    return [(int(a), int(b)) for a, b in change.reshape(-1, 2) if b - a > 1]


def _pairs(
    straights: Sequence[tuple[int, int]],
) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Every straight after the first, with the one before it."""
    return list(zip(straights[1:], straights[:-1], strict=True))


def _share(values: Sequence[bool | np.bool_]) -> float:
    """Share [%] of what is true."""
    return 100.0 * float(np.mean(np.array(values))) if values else math.nan


def conclude(arms: Sequence[Sequence[Measures]]) -> Sequence[Verdict]:
    """Errors rise in bends and fall after, with the theory's time constant, to zero at the end."""
    paper = arms[0]
    after, before = (estimate(column(paper, name)) for name in ("after_bends", "end_of_straights"))
    risen, fallen = (estimate(column(paper, name)) for name in ("risen", "fallen"))
    ratios = [estimate([run["time_constant"] / run["theory"] for run in runs]) for runs in arms]
    near = [abs(one.median - 1.0) <= TOLERANCE for one in ratios]
    final = estimate(column(paper, "final"))
    each = "; ".join(
        f"{arm.label}: {estimate(column(runs, 'time_constant')).text(1, 's')} of "
        f"{runs[0]['theory']:.1f} s"
        for arm, runs in zip(STUDY.arms, arms, strict=True)
    )
    return (
        Verdict(
            "Formation errors spike in bends and converge after them",
            "errors increase at sharp path curvatures",
            f"root mean square error after a bend {after.text(2, 'm')}, at the end of the straight "
            f"that follows {before.text(2, 'm')}; it rose in {risen.text(0, '%')} of the "
            f"bends and fell on {fallen.text(0, '%')} of the straights; peak of one robot "
            f"{estimate(column(paper, 'peak')).text(2, 'm')}",
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
            "The paper's alpha and waypoints are lost; the time constant is that of our alpha.",
        ),
        Verdict(
            "Formation errors converge to zero by the end (Fig. 2b)",
            "zero at the end",
            f"largest error at the end {final.text(2, 'm')}",
            outcome(final.high <= CONVERGED, final.median <= CONVERGED),
        ),
    )


def draw(figure: Figure, arms: Sequence[Sequence[Measures]]) -> None:
    """Root mean square error along the way, median and range of the seeds, with the bends."""
    prepared(figure, "Formation errors spike in bends and converge after them", height=3.3)
    axis = figure.subplots()
    for k, (arm, runs) in enumerate(zip(STUDY.arms, arms, strict=True)):
        at = np.array([[run[f"at_{s}"] for s in STATIONS] for run in runs])
        middle = [float(np.median(column_)) for column_ in at.T]
        low, high = np.min(at, axis=0), np.max(at, axis=0)
        axis.fill_between(STATIONS, low, high, color=CYCLE[k], alpha=0.2, linewidth=0.0)
        axis.plot(STATIONS, middle, color=CYCLE[k], label=arm.label, linestyle=("-", "--", ":")[k])
    for place in corners(np.array(load_world(WORLD).reference)):
        axis.axvspan(place - NEAR, place + NEAR, color=QUIET, alpha=0.13, linewidth=0.0)
    axis.axvspan(0, 0, color=QUIET, alpha=0.13, label="corner of the reference path")
    axis.set_xlabel("place of the mean robot along the reference path [m]")
    axis.set_ylabel("root mean square\nformation error [m]")
    axis.set_xlim(STATIONS[0], STATIONS[-1])
    axis.set_ylim(bottom=0.0)
    figure.legend(loc="outside lower left", ncols=2)


_WIDE = "formation.limits=[0.5, 1.5]"

STUDY = Study(
    name="bends",
    title="Formation errors in bends",
    claim="Formation errors spike in bends and converge after them.",
    arms=(
        Arm("α = 0.02/s", WORLD),
        Arm("α = 0.05/s", WORLD, ("formation.gain=0.05", _WIDE)),
        Arm("α = 0.1/s", WORLD, ("formation.gain=0.1", _WIDE)),
    ),
    measure=measure,
    conclude=conclude,
    draw=draw,
)
