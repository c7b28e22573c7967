"""What groups do: danger mode (Fig. 5), update intervals (14), and the operation time.

Danger mode. The paper says "by distance" and "by collision time" and not which of (12) and (13)
goes first where both are short. The worlds are those that cannot do without avoidance.

Collision time and distance together switch against either alone: a threshold of 0 switches one
off, since no distance or time is below it. "Time only" has no threshold of the distance to
boundaries either.

Without hysteresis danger ends at the thresholds at which it begins. Boundaries have one
threshold in either case.

The paper's five thresholds are unknown. Long thresholds of the collision time give Figure 8's
shares of danger mode and break the speeds of Figure 7 and the distances of Figure 6; short ones
keep those and leave robots in safe mode.

Update intervals. (14) is not known; the text says that it saves messages and work. Read as the
smaller of 0.1 s and beta times the collision time it can only add updates to those of a fixed
0.1 s; read as beta times the collision time, held below a longest interval of its own, it saves
what the longest one saves. Both readings, beta from 0.05 to 0.9, and fixed intervals from 0.01 to
0.5 s, over the first 70 s of the ten robots, with their merge in them.

Less conservative, shorter operation time (Sections 1 and 4): the paper compares with other
methods in words only. What can be compared without them: the same controller with thresholds so
wide that robots avoid whatever is near, as a conservative method does, and with one speed for
all robots in place of (7), the "uniform-speed models" of Section 4.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from physim.reproduction.claims import FARTHEST
from physim.reproduction.measures import MOST_OF_TIME
from physim.reproduction.model import Arm, Verdict, outcome
from physim.reproduction.study import (
    ARRIVED,
    FREE,
    GROUP,
    Estimate,
    Runs,
    Shown,
    Study,
    each,
    estimate,
    falls,
    free_and_arrived,
    free_of_contact,
    measure_group,
    told,
)

WORLDS = ("ten_robots", "crowded_start", "three_robots", "nonconvex")
KINDS = {
    "distance_first": "(12) first",
    "time_first": "(13) first",
    "distance": "(12) alone",
    "time": "(13) alone",
    "none": "none",
}
FREE_WITH, FREE_WITHOUT = 0.95, 0.5
"""[-] share of the runs free of contact, with avoidance at least and without it at most"""


def of_group(*names: str, **lines: float) -> dict[str, Shown]:
    """These measures of `GROUP`, some with a line to compare with."""
    return {name: GROUP[name]._replace(line=lines.get(name)) for name in names}


def conclude_avoidance(arms: Sequence[Runs]) -> Sequence[Verdict]:
    """Is avoidance needed, and does what the worlds ship with keep robots apart?"""
    first, later, *_, bare = (arms[kind :: len(KINDS)] for kind in range(len(KINDS)))
    shipped = [later[k] if WORLDS[k] == "crowded_start" else first[k] for k in range(len(WORLDS))]
    tried = dict(zip(WORLDS, zip(shipped, bare, strict=True), strict=True))
    order = dict(zip(WORLDS, zip(first, later, strict=True), strict=True))
    shows = [a.free.rate >= FREE_WITH and b.free.rate <= FREE_WITHOUT for a, b in tried.values()]
    wider = [
        b.of("shortest_distance").is_below(a.of("shortest_distance")) for a, b in order.values()
    ]
    finish = [a.arrived.good >= b.arrived.good for a, b in order.values()]
    return (
        Verdict(
            "Robots avoid collisions by (12) and (13)",
            "in words only",
            f"with avoidance against without it: {each([FREE], tried)}",
            outcome(all(shows), any(shows)),
            "Met where 95 % of the runs are free of contact with avoidance, and at most half "
            "without it.",
        ),
        Verdict(
            "Distances first, then collision times: robots stay farther apart",
            "the order is not stated (Fig. 5)",
            each(["shortest_distance", ARRIVED], order),
            outcome(all(wider) and all(finish), any(wider)),
            "In crowds the foremost robot may stand still for ever among others that avoid it; "
            "crowded_start therefore ships with collision times first.",
        ),
    )


AVOIDANCE = Study(
    name="avoidance",
    title="Which rule decides in danger mode",
    claim="Avoidance by distance (12) and by collision time (13), each first, each alone, neither.",
    arms=tuple(
        Arm(f"{world}, {label}", world, (f"controller.avoidance={kind}",))
        for world in WORLDS
        for kind, label in KINDS.items()
    ),
    measure=measure_group,
    conclude=conclude_avoidance,
    shown=of_group("shortest_distance", "by_distance", "by_time"),
    note=free_and_arrived,
    seeds=50,
)


NO_TIME = ("controller.time_low=0.0", "controller.time_high=0.0")
NO_DISTANCE = (
    "controller.distance_low=0.0",
    "controller.distance_high=0.0",
    "controller.boundary_low=0.0",
)
SWITCHING_WORLDS = ("ten_robots", "three_robots")
SWITCHES = (("both", ()), ("distance only", NO_TIME), ("time only", NO_DISTANCE))


def _is_better(both: Runs, alone: Runs) -> bool:
    """Whether runs with both are better: no worse in any respect, and clearly better in one.

    Respects: runs free of contact, runs that finish, distance kept (intervals apart).
    """
    kept, lost = both.of("kept"), alone.of("kept")
    counts = ((both.free, alone.free), (both.arrived, alone.arrived))
    no_worse = all(a.good >= b.good for a, b in counts) and not kept.is_below(lost)
    return no_worse and (any(a.good > b.good for a, b in counts) or lost.is_below(kept))


def conclude_switching(arms: Sequence[Runs]) -> Sequence[Verdict]:
    """For each of the two left out: are both together better, in both worlds, in one, in none?"""

    def verdict(k: int, what: str) -> Verdict:
        pairs = list(zip(arms[:: len(SWITCHES)], arms[k :: len(SWITCHES)], strict=True))
        wins = [_is_better(*pair) for pair in pairs]
        return Verdict(
            f"Collision time and distance together do better than {what} alone",
            "in words only",
            each([FREE, ARRIVED, "kept"], dict(zip(SWITCHING_WORLDS, pairs, strict=True))),
            outcome(all(wins), any(wins)),
            "The five thresholds of Fig. 5 are unknown; these are ours.",
        )

    return verdict(1, "distance"), verdict(2, "collision time")


SWITCHING = Study(
    name="switching",
    title="Switching by time and distance",
    claim="Collision time and distance together switch better than either alone.",
    arms=tuple(
        Arm(f"{world.replace('_', ' ')},\n{label}", world, overrides)
        for world in SWITCHING_WORLDS
        for label, overrides in SWITCHES
    ),
    measure=measure_group,
    conclude=conclude_switching,
    shown=of_group("kept", "danger_share", "time_to_finish"),
    note=free_and_arrived,
)


LOW = {"ten_robots": 1.5, "three_robots": 2.0}
"""[s] time_low of the shipped worlds; without hysteresis the upper thresholds are at the lower"""


def conclude_hysteresis(arms: Sequence[Runs]) -> Sequence[Verdict]:
    """Whether hysteresis makes modes switch less often."""
    pairs = dict(zip(LOW, zip(arms[::2], arms[1::2], strict=True), strict=True))
    return (
        Verdict(
            "Hysteresis makes robots switch modes less often",
            "five thresholds, two of them upper ones (Fig. 5)",
            f"with against without it: {each(['mode_switches', FREE], pairs)}",
            falls(
                *([off.of("mode_switches"), on.of("mode_switches")] for on, off in pairs.values())
            ),
            "The paper names the thresholds, not their values or the rate of switches.",
        ),
    )


HYSTERESIS = Study(
    name="hysteresis",
    title="Hysteresis",
    claim="Upper thresholds above the lower ones keep modes from switching to and fro.",
    arms=tuple(
        Arm(f"{world.replace('_', ' ')},\nhysteresis {word}", world, overrides)
        for world, low in LOW.items()
        for word, overrides in (
            ("on", ()),
            ("off", (f"controller.time_high={low}", "controller.distance_high=0.5")),
        )
    ),
    measure=measure_group,
    conclude=conclude_hysteresis,
    shown=of_group("mode_switches", "danger_share", "kept"),
)


TIMES = ((0.5, 1.0), (1.0, 2.0), (1.5, 3.0), (2.0, 4.0), (3.0, 6.0))
"""[s] time_low and time_high of each arm"""
HORIZON = 10.0
SLOWEST = 0.8
"""[m/s] of Figure 7c"""


def conclude_thresholds(arms: Sequence[Runs]) -> Sequence[Verdict]:
    """Can mostly danger mode, the speeds and the distances be had together?"""
    together = [
        runs.of("danger_share").median > MOST_OF_TIME
        and runs.of("averaged_speed_min").median >= SLOWEST
        and runs.of("farthest_distance").median <= FARTHEST
        for runs in arms
    ]
    names = ("danger_share", "averaged_speed_min", "farthest_distance", FREE)
    return (
        Verdict(
            "Mostly danger mode (Fig. 8), averaged speeds of at least 0.8 m/s (Fig. 7c) and no "
            "more than 21.5 m between robots (Fig. 6c), all at once",
            "Figs. 6 to 8 are of one run",
            each(
                names, {arm.label: [runs] for arm, runs in zip(THRESHOLDS.arms, arms, strict=True)}
            ),
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
    shown=of_group(
        "danger_share",
        "averaged_speed_min",
        "farthest_distance",
        "shortest_distance",
        averaged_speed_min=SLOWEST,
        farthest_distance=FARTHEST,
    ),
    note=free_of_contact,
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
    note=lambda runs: f"{free_of_contact(runs)}\n{{}} finished".format(
        *runs.share("time_to_finish", math.isfinite)
    ),
)
