"""Less conservative, shorter operation time (Sections 1 and 4).

The paper compares with other methods in words only. What can be compared without them: the same
controller with thresholds so wide that robots avoid whatever is near, as a conservative method
does, and with one speed for all robots in place of (7), the "uniform-speed models" of Section 4.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from physim.plots.style import WIDTH
from physim.record import Record
from physim.reproduction.studies.drawing import prepared, rows_of_measures
from physim.reproduction.studies.estimates import column, estimate, freely, outcome, share_text
from physim.reproduction.studies.figures import figures, safety, work
from physim.reproduction.study import Arm, Measures, Study, Verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDE = (
    "controller.distance_low=2.0",
    "controller.distance_high=3.0",
    "controller.time_low=4.0",
    "controller.time_high=6.0",
    "controller.horizon=10.0",
)
UNIFORM = ("formation.gain=0.0",)
PAPER, CAUTIOUS, EQUAL = 0, 1, 2
"""places of the arms"""


def measure(record: Record) -> Measures:
    """Time to finish (inf: not in the time given), spread, contacts, danger mode and messages."""
    names = ("time_to_finish", "farthest_distance", "formation_error_peak", "danger_share")
    found = figures(record, *names)
    took = found["time_to_finish"]
    found["operation"] = math.inf if math.isnan(took) else took
    return {**found, **safety(record), "messages": work(record)["messages"]}


def _free(runs: Sequence[Measures]) -> tuple[int, int]:
    return freely(runs, "contacts", lambda value: value == 0.0)


def conclude(arms: Sequence[Sequence[Measures]]) -> Sequence[Verdict]:
    """Shorter than with wide thresholds, as safe; closer together than at one speed."""
    took = [estimate(column(runs, "operation")) for runs in arms]
    free = [_free(runs) for runs in arms]
    shorter = took[PAPER].high < took[CAUTIOUS].low
    done = freely(arms[CAUTIOUS], "operation", math.isfinite)
    spread = [estimate(column(arms[k], "farthest_distance")) for k in (PAPER, EQUAL)]
    error = [estimate(column(arms[k], "formation_error_peak")) for k in (PAPER, EQUAL)]
    closer = error[0].high < error[1].low
    return (
        Verdict(
            "Less conservative avoidance shortens the operation time",
            "in words only",
            f"time to finish {took[PAPER].text(1, 's')} against {took[CAUTIOUS].text(1, 's')} with "
            f"wide thresholds ({done[0]} of {done[1]} finish); free of contact "
            f"{share_text(*free[PAPER])} against {share_text(*free[CAUTIOUS])}",
            outcome(shorter and free[PAPER][0] >= free[CAUTIOUS][0], shorter),
            "The paper compares with other methods without a measurement; the conservative variant "
            "is ours.",
        ),
        Verdict(
            "Speeds set by (7) keep the cluster closer together than one speed for all",
            "mitigates the common drift or lag observed in uniform-speed models",
            f"largest formation error {error[0].text(1, 'm')} against {error[1].text(1, 'm')}, "
            f"largest distance {spread[0].text(1, 'm')} against {spread[1].text(1, 'm')}, time to "
            f"finish {took[PAPER].text(1, 's')} against {took[EQUAL].text(1, 's')}",
            outcome(
                closer and spread[0].high < spread[1].low,
                error[0].median < error[1].median,
            ),
        ),
    )


def draw(figure: Figure, arms: Sequence[Sequence[Measures]]) -> None:
    """Time to finish, largest distance and messages of every arm."""
    prepared(figure, "Operation time and what it costs", height=2.7, width=WIDTH)
    rows_of_measures(
        figure,
        [arm.label for arm in STUDY.arms],
        arms,
        (
            ("time_to_finish", "time to finish [s]", False),
            ("formation_error_peak", "largest formation\nerror [m]", False),
            ("messages", "messages\n[1/s per robot]", False),
        ),
        [
            "{} of {} free of contact\n{} finished".format(
                *_free(mine), freely(mine, "operation", math.isfinite)[0]
            )
            for mine in arms
        ],
    )


STUDY = Study(
    name="operation",
    title="Operation time",
    claim="Less conservative control shortens the operation time.",
    arms=(
        Arm("as shipped", "ten_robots"),
        Arm("wide thresholds", "ten_robots", WIDE),
        Arm("one speed for all", "ten_robots", UNIFORM),
    ),
    measure=measure,
    conclude=conclude,
    draw=draw,
)
