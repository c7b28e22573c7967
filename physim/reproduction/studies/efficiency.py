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

from physim.reproduction.model import Arm, Verdict, outcome
from physim.reproduction.studies.danger_mode import of_group
from physim.reproduction.study import (
    FREE,
    Estimate,
    Runs,
    Study,
    each,
    estimate,
    free_of_contact,
    measure_group,
    told,
)

FIXED = (0.01, 0.05, 0.1, 0.2, 0.3, 0.5)
"""[s] fixed intervals"""
LONGEST = (0.1, 0.2, 0.3, 0.5)
"""[s] longest intervals of (14), with the beta of the world"""
BETAS = (0.05, 0.3, 0.5, 0.9)
"""other values of beta, up to 0.2 s"""


def conclude_updates(arms: Sequence[Runs]) -> Sequence[Verdict]:
    """What (14) saves against fixed intervals, at what safety, and what beta does."""
    fixed = dict(zip(FIXED, arms, strict=False))
    events = dict(zip(LONGEST, arms[len(FIXED) :], strict=False))
    lower = arms[len(FIXED) + len(LONGEST) :]
    betas = [runs.of("updates") for runs in lower]
    event, fine, plain = events[0.2], fixed[0.01], fixed[0.1]
    fewer, less = (event.of("updates").is_below(one.of("updates")) for one in (fine, plain))
    pairs = [(events[t].free.good, fixed[t].free.good) for t in LONGEST]
    better = any(adapted > same for adapted, same in pairs)
    ordered = all(b.median <= a.median for a, b in pairwise(betas))
    return (
        Verdict(
            "Event-triggered updates take less work than a fixed interval of 0.01 s",
            "in words only",
            told(["updates", "messages", "evaluations", FREE], event, fine),
            outcome(fewer and event.free.good >= fine.free.good, fewer),
        ),
        Verdict(
            "Event-triggered updates take less work than a fixed interval of 0.1 s",
            "in words only",
            f"up to 0.2 s: {told(['updates', 'messages', FREE], event, plain)}; up to 0.1 s: "
            f"{told(['updates'], events[0.1])}",
            outcome(less and event.free.good >= plain.free.good, less),
            "Up to 0.1 s (14) can only add updates; nearly all of the saving comes from the longer "
            "interval, which is ours.",
        ),
        Verdict(
            "Intervals that adapt to the collision time keep robots apart where fixed ones of the "
            "same length do not",
            "in words only",
            each(["updates", FREE], {f"{t:g} s": (events[t], fixed[t]) for t in LONGEST}),
            outcome(better and all(adapted >= same for adapted, same in pairs), better),
        ),
        Verdict(
            "A smaller beta brings more updates",
            "0 < beta < 1 in (14)",
            each(["updates"], {f"beta {b:g}": [r] for b, r in zip(BETAS, lower, strict=True)}),
            outcome(ordered and betas[-1].is_below(betas[0]), ordered),
            "The paper does not state its beta.",
        ),
    )


def _arm(label: str, *overrides: str) -> Arm:
    return Arm(label, "ten_robots", (*overrides, "time.duration=70"))


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
    shown=of_group("updates", "evaluations", "kept"),
    note=free_of_contact,
)


WIDE = (
    "controller.distance_low=2.0",
    "controller.distance_high=3.0",
    "controller.time_low=4.0",
    "controller.time_high=6.0",
    "controller.horizon=10.0",
)
UNIFORM = ("formation.gain=0.0",)


def _took(runs: Runs) -> Estimate:
    """Time to finish [s]; inf where a run did not finish in the time given."""
    column = runs.column("time_to_finish")
    return estimate(math.inf if math.isnan(took) else took for took in column)


def conclude_operation(arms: Sequence[Runs]) -> Sequence[Verdict]:
    """Shorter than with wide thresholds, as safe; closer together than at one speed."""
    shipped, cautious, equal = arms
    took, slow, other = map(_took, arms)
    shorter, done = took.is_below(slow), cautious.share("time_to_finish", math.isfinite)
    error, drift = (runs.of("formation_error_peak") for runs in (shipped, equal))
    spread, stretch = (runs.of("farthest_distance") for runs in (shipped, equal))
    return (
        Verdict(
            "Less conservative avoidance shortens the operation time",
            "in words only",
            f"time to finish {took.text(1, 's')} against {slow.text(1, 's')} with wide thresholds "
            f"({done.good} of {done.of} finish); {told([FREE], shipped, cautious)}",
            outcome(shorter and shipped.free.good >= cautious.free.good, shorter),
            "The paper compares with other methods without a measurement; the conservative variant "
            "is ours.",
        ),
        Verdict(
            "Speeds set by (7) keep the cluster closer together than one speed for all",
            "mitigates the common drift or lag observed in uniform-speed models",
            f"{told(['formation_error_peak', 'farthest_distance'], shipped, equal)}, time to "
            f"finish {took.text(1, 's')} against {other.text(1, 's')}",
            outcome(
                error.is_below(drift) and spread.is_below(stretch), error.median < drift.median
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
    shown=of_group("time_to_finish", "formation_error_peak", "messages"),
    note=lambda runs: (
        f"{free_of_contact(runs)}\n{{}} finished".format(
            *runs.share("time_to_finish", math.isfinite)
        )
    ),
)
