"""What control costs: update intervals by (14) against fixed ones, and the operation time.

(14) is not known; the text says that it saves messages and work. Read as the smaller of 0.1 s
and beta times the collision time it can only add updates to those of a fixed 0.1 s; read as
beta times the collision time, held below a longest interval of its own, it saves what the
longest one saves. Both readings, beta from 0.05 to 0.9, and fixed intervals from 0.01 to 0.5 s,
over the first 70 s of the ten robots, with their merge in them.

Less conservative, shorter operation time (Sections 1 and 4): the paper compares with other
methods in words only. What can be compared without them: the same controller with thresholds so
wide that robots avoid whatever is near, as a conservative method does, and with one speed for
all robots in place of (7), the "uniform-speed models" of Section 4.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from physim.reproduction.estimates import (
    column,
    contact_free,
    count,
    estimate,
    estimated,
    free_text,
    measure_group,
    outcome,
    share_text,
)
from physim.reproduction.pictures import rows_of_measures
from physim.reproduction.study import Arm, Runs, Study, Table, Verdict

FIXED = (0.01, 0.05, 0.1, 0.2, 0.3, 0.5)
"""[s] fixed intervals"""
LONGEST = (0.1, 0.2, 0.3, 0.5)
"""[s] longest intervals of (14), with the beta of the world"""
BETAS = (0.05, 0.3, 0.5, 0.9)
"""other values of beta, up to 0.2 s"""
FIRST = "time.duration=70"


def conclude_updates(arms: Table) -> Sequence[Verdict]:
    """What (14) saves against fixed intervals, at what safety, and what beta does."""
    fixed = dict(zip(FIXED, arms, strict=False))
    events = dict(zip(LONGEST, arms[len(FIXED) :], strict=False))
    betas = [estimated(runs, "updates") for runs in arms[len(FIXED) + len(LONGEST) :]]
    event, fine, plain = events[0.2], fixed[0.01], fixed[0.1]
    free = contact_free(event)[0]
    fewer = estimated(event, "updates").high < estimated(fine, "updates").low
    less = estimated(event, "updates").high < estimated(plain, "updates").low
    pairs = [(contact_free(events[t])[0], contact_free(fixed[t])[0]) for t in LONGEST]
    better = any(adapted > same for adapted, same in pairs)
    ordered = all(b.median <= a.median for a, b in pairwise(betas))

    def each(runs: Runs, name: str, digits: int) -> str:
        return estimated(runs, name).text(digits)

    return (
        Verdict(
            "Event-triggered updates take less work than a fixed interval of 0.01 s",
            "in words only",
            f"a robot and second: updates {each(event, 'updates', 2)} against "
            f"{each(fine, 'updates', 1)}, messages {each(event, 'messages', 1)} against "
            f"{each(fine, 'messages', 0)}, collision times {each(event, 'evaluations', 0)} against "
            f"{each(fine, 'evaluations', 0)}; free of contact {free_text(event)} against "
            f"{free_text(fine)}",
            outcome(fewer and free >= contact_free(fine)[0], fewer),
        ),
        Verdict(
            "Event-triggered updates take less work than a fixed interval of 0.1 s",
            "in words only",
            f"updates a robot and second {each(event, 'updates', 2)} up to 0.2 s, "
            f"{each(events[0.1], 'updates', 2)} up to 0.1 s, against {each(plain, 'updates', 2)}; "
            f"messages {each(event, 'messages', 1)} against {each(plain, 'messages', 1)}; "
            f"free of contact {free_text(event)} against {free_text(plain)}",
            outcome(less and free >= contact_free(plain)[0], less),
            "Up to 0.1 s (14) can only add updates; nearly all of the saving comes from the longer "
            "interval, which is ours.",
        ),
        Verdict(
            "Intervals that adapt to the collision time keep robots apart where fixed ones of the "
            "same length do not",
            "in words only",
            "; ".join(
                f"{t:g} s: {each(events[t], 'updates', 2)} updates a robot and second, free of "
                f"contact {free_text(events[t])}, fixed {free_text(fixed[t])}"
                for t in LONGEST
            ),
            outcome(better and all(adapted >= same for adapted, same in pairs), better),
        ),
        Verdict(
            "A smaller beta brings more updates",
            "0 < beta < 1 in (14)",
            "updates a robot and second at beta "
            + ", ".join(f"{beta:g}: {one.text(2)}" for beta, one in zip(BETAS, betas, strict=True)),
            outcome(ordered and betas[-1].high < betas[0].low, ordered),
            "The paper does not state its beta.",
        ),
    )  # fmt: skip


def _arm(label: str, *overrides: str) -> Arm:
    return Arm(label, "ten_robots", (*overrides, FIRST))


UPDATES = Study(
    name="updates",
    title="Update intervals",
    claim="Updates triggered by collision times save messages and work, and robots keep apart.",
    arms=(
        *(
            _arm(
                f"fixed {interval:g} s",
                "controller.event_triggered=false",
                f"controller.longest_interval={interval}",
            )
            for interval in FIXED
        ),
        *(_arm(f"(14) ≤ {t:g} s", f"controller.longest_interval={t}") for t in LONGEST),
        *(_arm(f"(14) ≤ 0.2 s, β {beta:g}", f"controller.beta={beta}") for beta in BETAS),
    ),
    measure=measure_group,
    conclude=conclude_updates,
    draw=rows_of_measures(
        "Event-triggered updates against fixed periods",
        5.2,
        (
            ("updates", "updates\n[1/s per robot]"),
            ("evaluations", "collision times worked out\n[1/s per robot]"),
            ("kept", "shortest distance\nto anything [m]"),
        ),
        lambda runs: "{} of {} free\nof contact".format(*contact_free(runs)),
        logarithmic=("updates", "evaluations"),
    ),
)


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
