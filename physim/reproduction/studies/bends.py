"""Formation errors spike in bends and converge after them (Sections 3.2 and 4, Figs. 2b, 7a).

The three robots of Fig. 2, whose reference path has sharp corners: a bend lasts while any robot is
near a corner, and what lies between two bends is a straight. On a straight the errors must die away
with the time constant 1/(alpha N) of (7) and (8), every robot being a neighbour of all others.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
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
from physim.reproduction.studies.estimates import estimate, estimated, outcome
from physim.reproduction.studies.fits import root_mean_square, time_constant
from physim.reproduction.study import Arm, Measures, Study, Table, Verdict
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


def measure_bends(record: Record) -> Measures:
    """Peak in bends and at the ends of straights, time constants, and the error along the way."""
    time, station = column_over_time(record, "reference_station")
    course = formation_errors(record)
    if course is None:
        raise RecordError(f"{record!r} has no formation errors")
    steps = active_steps(record)
    there = np.where(steps < record.steps_run, steps * record.dt, math.inf)
    progressing = time < there.min()
    size = root_mean_square(course.values)
    near = np.abs(station[:, :, None] - corners(record.reference.points)) <= NEAR
    straights = _straights(np.any(near, axis=(1, 2)), progressing)
    gain = float(world_settings(record)["formation"]["gain"])
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
