"""Figure 8: safe and danger mode of each of the ten robots."""

from __future__ import annotations

import numpy as np

from physim import metrics
from physim.record import Record
from physim.reproduction.claims import tolerances as tol
from physim.reproduction.claims.claim import Claim, Quantity, holds, steps
from physim.reproduction.study import Measures

SAFE_ONES = (5, 8, 10)
"""Robots that are more in safe mode (paper), counted from 1."""
ROBOTS = 10


def measure_modes(record: Record) -> Measures:
    """Shares of safe mode of Robots 5, 8 and 10 and of the others."""
    found = metrics.share_of_modes(record, danger=False)
    if found is None or len(found.robots) != ROBOTS:
        return {}
    share = np.array([np.nan if one is None else one for one in found.robots])
    calm = np.isin(np.arange(1, ROBOTS + 1), SAFE_ONES)
    both = (share > 0.0) & (share < 1.0)
    return {
        "safe_least_of_5_8_10": float(share[calm].min()),
        "safe_least_of_others": float(share[~calm].min()),
        "safe_largest_of_others": float(share[~calm].max()),
        "others_in_danger": float((share[~calm] < tol.MOST_OF_TIME).sum()),
        "both_modes": float(both.sum()),
    }


def claims_of_figure_8() -> tuple[Claim, ...]:
    """What Figure 8 and the words about it say."""
    return (
        Claim(
            "Robots switch between safe and danger mode", "both modes",
            (Quantity("both_modes", "of 10 robots use both", 0),),
            holds(lambda run: run["both_modes"] == ROBOTS),
        ),
        Claim(
            "Robots 5, 8 and 10 spend more time in safe mode than in danger mode",
            "more than half",
            (Quantity("safe_least_of_5_8_10", "%", 1, "least share of safe mode of the three:"),),
            holds(lambda run: run["safe_least_of_5_8_10"] > tol.MOST_OF_TIME),
        ),
        Claim(
            "Robots 5, 8 and 10 spend more of their time in safe mode than any other robot",
            "more than the rest",
            (
                Quantity("safe_least_of_5_8_10", "%", 1, "least of the three"),
                Quantity("safe_largest_of_others", "%", 1, "largest of the others"),
            ),
            holds(lambda run: run["safe_least_of_5_8_10"] > run["safe_largest_of_others"]),
        ),
        Claim(
            "The other robots spend more time in danger mode than in safe mode",
            "less than half safe",
            (
                Quantity("others_in_danger", "of 7 robots", 0),
                Quantity("safe_least_of_others", "%", 1, "least share of safe mode"),
            ),
            steps(
                lambda run: run["others_in_danger"] == ROBOTS - len(SAFE_ONES),
                lambda run: run["others_in_danger"] > 0,
            ),
            "The paper's paths and five thresholds are unknown; ours keep robots in safe mode "
            "longer.",
        ),
    )  # fmt: skip
