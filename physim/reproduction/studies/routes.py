"""Robots on outer routes exceed 1 m/s, those on inner routes fall below (Section 4, Fig. 7c).

A robot's route is longer or shorter than the reference path by its offset times the curvature.
Where that makes 5 % or more, averaged over the 10 m that a robot goes in the window of the averaged
speeds, the robot counts as on an outer or an inner route.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from physim.geometry.shapes import FloatArray
from physim.metrics import averaged_speeds, column_over_time
from physim.plots.style import CYCLE, INK, QUIET
from physim.record import Record
from physim.reproduction.claims.following import turning
from physim.reproduction.studies.drawing import points, prepared, single_runs
from physim.reproduction.studies.estimates import column, estimated, outcome
from physim.reproduction.study import Arm, Measures, Study, Table, Verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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
