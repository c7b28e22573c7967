"""Less conservative, shorter operation time (Sections 1 and 4).

The paper compares with other methods in words only. What can be compared without them: the same
controller with thresholds so wide that robots avoid whatever is near, as a conservative method
does, and with one speed for all robots in place of (7), the "uniform-speed models" of Section 4.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from physim.reproduction.studies.drawing import rows_of_measures
from physim.reproduction.studies.estimates import (
    column,
    contact_free,
    count,
    estimate,
    estimated,
    outcome,
    share_text,
)
from physim.reproduction.studies.figures import measure_group
from physim.reproduction.study import Arm, Runs, Study, Table, Verdict

WIDE = (
    "controller.distance_low=2.0",
    "controller.distance_high=3.0",
    "controller.time_low=4.0",
    "controller.time_high=6.0",
    "controller.horizon=10.0",
)
UNIFORM = ("formation.gain=0.0",)
SHIPPED, CAUTIOUS, EQUAL = 0, 1, 2
"""places of the arms"""


def _times(runs: Runs) -> list[float]:
    """Times to finish [s]; inf where a run did not finish in the time given."""
    return [math.inf if math.isnan(took) else took for took in column(runs, "time_to_finish")]


def conclude_operation(arms: Table) -> Sequence[Verdict]:
    """Shorter than with wide thresholds, as safe; closer together than at one speed."""
    took = [estimate(_times(runs)) for runs in arms]
    free = [contact_free(runs) for runs in arms]
    shorter = took[SHIPPED].high < took[CAUTIOUS].low
    done = count(arms[CAUTIOUS], "time_to_finish", math.isfinite)
    spread = [estimated(arms[k], "farthest_distance") for k in (SHIPPED, EQUAL)]
    error = [estimated(arms[k], "formation_error_peak") for k in (SHIPPED, EQUAL)]
    closer = error[0].high < error[1].low
    return (
        Verdict(
            "Less conservative avoidance shortens the operation time",
            "in words only",
            f"time to finish {took[SHIPPED].text(1, 's')} against {took[CAUTIOUS].text(1, 's')} "
            f"with wide thresholds ({done[0]} of {done[1]} finish); free of contact "
            f"{share_text(*free[SHIPPED])} against {share_text(*free[CAUTIOUS])}",
            outcome(shorter and free[SHIPPED][0] >= free[CAUTIOUS][0], shorter),
            "The paper compares with other methods without a measurement; the conservative variant "
            "is ours.",
        ),
        Verdict(
            "Speeds set by (7) keep the cluster closer together than one speed for all",
            "mitigates the common drift or lag observed in uniform-speed models",
            f"largest formation error {error[0].text(1, 'm')} against {error[1].text(1, 'm')}, "
            f"largest distance {spread[0].text(1, 'm')} against {spread[1].text(1, 'm')}, time to "
            f"finish {took[SHIPPED].text(1, 's')} against {took[EQUAL].text(1, 's')}",
            outcome(
                closer and spread[0].high < spread[1].low,
                error[0].median < error[1].median,
            ),
        ),
    )


OPERATION = Study(
    name="operation",
    title="Operation time",
    claim="Less conservative control shortens the operation time.",
    arms=(
        Arm("as shipped", "ten_robots"),
        Arm("wide thresholds", "ten_robots", WIDE),
        Arm("one speed for all", "ten_robots", UNIFORM),
    ),
    measure=measure_group,
    conclude=conclude_operation,
    draw=rows_of_measures(
        "Operation time and what it costs",
        2.7,
        (
            ("time_to_finish", "time to finish [s]"),
            ("formation_error_peak", "largest formation\nerror [m]"),
            ("messages", "messages\n[1/s per robot]"),
        ),
        lambda runs: (
            "{} of {} free of contact\n".format(*contact_free(runs))
            + "{} finished".format(*count(runs, "time_to_finish", math.isfinite))
        ),
    ),
)
