"""What the thresholds of the collision time trade: time in danger mode, speeds, distances.

The paper's five thresholds are unknown. Long ones give Figure 8's shares of danger mode and break
the speeds of Figure 7 and the distances of Figure 6; short ones keep those and leave robots in safe
mode.
"""

from __future__ import annotations

from collections.abc import Sequence

from physim.reproduction.claims import tolerances as tol
from physim.reproduction.studies.drawing import rows_of_measures
from physim.reproduction.studies.estimates import contact_free, estimated, outcome
from physim.reproduction.studies.figures import measure_group
from physim.reproduction.study import Arm, Study, Table, Verdict

TIMES = ((0.5, 1.0), (1.0, 2.0), (1.5, 3.0), (2.0, 4.0), (3.0, 6.0))
"""[s] time_low and time_high of each arm"""
HORIZON = 10.0
SLOWEST, FASTEST = 0.8, 1.3
"""[m/s] of Figure 7c"""


def conclude_thresholds(arms: Table) -> Sequence[Verdict]:
    """Can mostly danger mode, the speeds and the distances be had together?"""
    measured, together = [], []
    for (low, high), runs in zip(TIMES, arms, strict=True):
        share, speed, far = (
            estimated(runs, name)
            for name in ("danger_share", "averaged_speed_min", "farthest_distance")
        )
        together.append(
            share.median > tol.MOST_OF_TIME
            and speed.median >= SLOWEST
            and far.median <= tol.FARTHEST
        )
        measured.append(
            f"{low:g}/{high:g} s: danger mode {100.0 * share.median:.0f} % of the time, slowest "
            f"average {speed.text(2, 'm/s')}, farthest {far.text(1, 'm')}, free of contact "
            "{} of {}".format(*contact_free(runs))
        )
    return (
        Verdict(
            "Mostly danger mode (Fig. 8), averaged speeds of at least 0.8 m/s (Fig. 7c) and no "
            "more than 21.5 m between robots (Fig. 6c), all at once",
            "Figs. 6 to 8 are of one run",
            "; ".join(measured),
            outcome(any(together)),
            "With our paths the three exclude each other: robots that avoid others slow down, and "
            "the group stretches.",
        ),
    )


THRESHOLDS = Study(
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
    measure=measure_group,
    conclude=conclude_thresholds,
    draw=rows_of_measures(
        "Thresholds of the collision time",
        3.2,
        (
            ("danger_share", "share of time\nin danger mode [–]"),
            ("averaged_speed_min", "slowest speed over\n10 s [m/s]"),
            ("farthest_distance", "largest distance\n[m]"),
            ("shortest_distance", "shortest distance\nbetween robots [m]"),
        ),
        lambda runs: "{} of {} free\nof contact".format(*contact_free(runs)),
    ),
)
