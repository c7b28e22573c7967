"""What the thresholds of the collision time trade: time in danger mode, speeds, distances.

The paper's five thresholds are lost. Long ones give Figure 8's shares of danger mode and break the
speeds of Figure 7 and the distances of Figure 6; short ones keep those and leave robots in safe
mode.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from physim.plots.style import WIDTH
from physim.record import Record
from physim.reproduction.claims import tolerances as tol
from physim.reproduction.studies.drawing import prepared, rows_of_measures
from physim.reproduction.studies.estimates import column, estimate, freely, outcome
from physim.reproduction.studies.figures import figures, safety
from physim.reproduction.study import Arm, Measures, Study, Verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TIMES = ((0.5, 1.0), (1.0, 2.0), (1.5, 3.0), (2.0, 4.0), (3.0, 6.0))
"""[s] time_low and time_high of each arm"""
HORIZON = 10.0
SLOWEST, FASTEST = 0.8, 1.3
"""[m/s] of Figure 7c"""

Runs = Sequence[Measures]


def measure(record: Record) -> Measures:
    """Share of danger mode, speeds averaged over 10 s, largest distance, safety."""
    names = ("finished", "danger_share", "averaged_speed_min", "farthest_distance")
    return {**safety(record), **figures(record, *names)}


def _free(runs: Runs) -> tuple[int, int]:
    return freely(runs, "contacts", lambda value: value == 0.0)


def conclude(arms: Sequence[Runs]) -> Sequence[Verdict]:
    """Can mostly danger mode, the speeds and the distances be had together?"""
    told, together = [], []
    for (low, high), runs in zip(TIMES, arms, strict=True):
        share, speed, far = (
            estimate(column(runs, name))
            for name in ("danger_share", "averaged_speed_min", "farthest_distance")
        )
        together.append(
            share.median > tol.MOST_OF_TIME
            and speed.median >= SLOWEST
            and far.median <= tol.FARTHEST
        )
        told.append(
            f"{low:g}/{high:g} s: danger mode {100.0 * share.median:.0f} % of the time, slowest "
            f"average {speed.text(2, 'm/s')}, farthest {far.text(1, 'm')}, free of contact "
            "{} of {}".format(*_free(runs))
        )
    return (
        Verdict(
            "Mostly danger mode (Fig. 8), averaged speeds of at least 0.8 m/s (Fig. 7c) and no "
            "more than 21.5 m between robots (Fig. 6c), all at once",
            "Figs. 6 to 8 are of one run",
            "; ".join(told),
            outcome(any(together)),
            "With our paths they cannot be had together: who avoids slows down, and the group "
            "stretches.",
        ),
    )


def draw(figure: Figure, arms: Sequence[Runs]) -> None:
    """Danger mode, slowest average, largest and shortest distance of every pair of thresholds."""
    prepared(figure, "Thresholds of the collision time", height=3.2, width=WIDTH)
    rows_of_measures(
        figure,
        [arm.label for arm in STUDY.arms],
        arms,
        (
            ("danger_share", "share of time\nin danger mode [–]", False),
            ("averaged_speed_min", "slowest speed over\n10 s [m/s]", False),
            ("farthest_distance", "largest distance\n[m]", False),
            ("between_robots", "shortest distance\nbetween robots [m]", False),
        ),
        ["{} of {} free\nof contact".format(*_free(mine)) for mine in arms],
    )


STUDY = Study(
    name="thresholds",
    title="Thresholds of the collision time",
    claim="What long and short thresholds of the collision time cost.",
    arms=tuple(
        Arm(
            f"{low:g} and {high:g} s",
            "ten_robots",
            (
                f"controller.time_low={low}",
                f"controller.time_high={high}",
                f"controller.horizon={HORIZON}",
            ),
        )
        for low, high in TIMES
    ),
    measure=measure,
    conclude=conclude,
    draw=draw,
)
