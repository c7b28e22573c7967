"""Danger mode (Fig. 5): which rule decides in it, what switches it, what thresholds trade.

The paper says "by distance" and "by collision time" and not which of (12) and (13) goes first
where both are short. The worlds are those that cannot do without avoidance.

Collision time and distance together switch against either alone: a threshold of 0 switches one
off, since no distance or time is below it. "Time only" has no threshold of the distance to
boundaries either.

Without hysteresis danger ends at the thresholds at which it begins. Boundaries have one
threshold in either case.

The paper's five thresholds are unknown. Long thresholds of the collision time give Figure 8's
shares of danger mode and break the speeds of Figure 7 and the distances of Figure 6; short ones
keep those and leave robots in safe mode.
"""

from __future__ import annotations

from collections.abc import Sequence

from physim.reproduction.claims import tolerances as tol
from physim.reproduction.estimates import (
    arrived,
    contact_free,
    estimated,
    free_text,
    measure_group,
    outcome,
    share_text,
)
from physim.reproduction.pictures import rows_of_measures
from physim.reproduction.study import Arm, Runs, Study, Table, Verdict

WORLDS = ("ten_robots", "crowded_start", "three_robots", "nonconvex")
KINDS = {
    "distance_first": "(12) first",
    "time_first": "(13) first",
    "distance": "(12) alone",
    "time": "(13) alone",
    "none": "none",
}
FIRST, LATER, *_, NONE = range(len(KINDS))


def conclude_avoidance(arms: Table) -> Sequence[Verdict]:
    """Is avoidance needed, and does what the worlds ship with keep robots apart?"""
    without, first, later = (arms[kind :: len(KINDS)] for kind in (NONE, FIRST, LATER))
    shipped = [later[k] if WORLDS[k] == "crowded_start" else first[k] for k in range(len(WORLDS))]
    free = [contact_free(runs) for runs in shipped]
    bare = [contact_free(runs) for runs in without]
    needed = [b[1] - b[0] >= 0.5 * b[1] for b in bare]
    safe = [f[0] >= 0.95 * f[1] for f in free]
    both = [s and n for s, n in zip(safe, needed, strict=True)]
    wider = [
        estimated(a, "shortest_distance").low > estimated(b, "shortest_distance").high
        for a, b in zip(first, later, strict=True)
    ]
    finish = [arrived(a)[0] >= arrived(b)[0] for a, b in zip(first, later, strict=True)]
    return (
        Verdict(
            "Robots avoid collisions by (12) and (13)",
            "in words only",
            "; ".join(
                f"{world}: free of contact {share_text(*f)}, without avoidance {share_text(*b)}"
                for world, f, b in zip(WORLDS, free, bare, strict=True)
            ),
            outcome(all(both), any(both)),
            "Met where 95 % of the runs are free of contact with avoidance, and at most half "
            "without it.",
        ),
        Verdict(
            "Distances first, then collision times: robots stay farther apart",
            "the order is not stated (Fig. 5)",
            "; ".join(
                f"{world}: shortest distance between robots "
                f"{estimated(a, 'shortest_distance').text(2, 'm')} against "
                f"{estimated(b, 'shortest_distance').text(2, 'm')}, finished {arrived(a)[0]} "
                f"against {arrived(b)[0]} of {len(a)}"
                for world, a, b in zip(WORLDS, first, later, strict=True)
            ),
            outcome(all(wider) and all(finish), any(wider)),
            "In crowds the foremost robot may stand still for ever among others that avoid it; "
            "crowded_start therefore ships with collision times first.",
        ),
    )  # fmt: skip


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
    draw=rows_of_measures(
        "Which rule decides in danger mode",
        7.2,
        (
            ("shortest_distance", "shortest distance\nbetween robots [m]"),
            ("by_distance", "share of decisions\nby (12) [–]"),
            ("by_time", "share of decisions\nby (13) [–]"),
        ),
        lambda runs: (
            "{} of {} free of contact,\n".format(*contact_free(runs))
            + f"{arrived(runs)[0]} finished"
        ),
    ),
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


def better(both: Runs, alone: Runs) -> bool:
    """Whether runs with both are better: no worse in any respect, and clearly better in one.

    Respects: runs free of contact, runs that finish, distance kept (intervals apart).
    """
    kept, lost = estimated(both, "kept"), estimated(alone, "kept")
    no_worse = (
        contact_free(both)[0] >= contact_free(alone)[0]
        and arrived(both)[0] >= arrived(alone)[0]
        and kept.high >= lost.low
    )
    clearly = (
        contact_free(both)[0] > contact_free(alone)[0]
        or arrived(both)[0] > arrived(alone)[0]
        or kept.low > lost.high
    )
    return no_worse and clearly


def conclude_switching(arms: Table) -> Sequence[Verdict]:
    """For each of the two left out: are both together better, in both worlds, in one, in none?"""
    verdicts = []
    for k, what in ((1, "distance"), (2, "collision time")):
        wins, measured = [], []
        for w, world in enumerate(SWITCHING_WORLDS):
            both, alone = arms[len(SWITCHES) * w], arms[len(SWITCHES) * w + k]
            wins.append(better(both, alone))
            measured.append(f"{world}: {_compared(both, alone)}")
        verdicts.append(
            Verdict(
                f"Collision time and distance together do better than {what} alone",
                "in words only",
                "; ".join(measured),
                outcome(all(wins), any(wins)),
                "The five thresholds of Fig. 5 are unknown; these are ours.",
            )
        )
    return tuple(verdicts)


def _compared(both: Runs, alone: Runs) -> str:
    kept = [estimated(runs, "kept").text(3, "m") for runs in (both, alone)]
    return (
        f"free of contact {free_text(both)} against {free_text(alone)}, "
        f"finished {arrived(both)[0]} against {arrived(alone)[0]}, shortest distance to "
        f"anything {kept[0]} against {kept[1]}"
    )


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
    draw=rows_of_measures(
        "Switching by distance, by time, by both",
        3.6,
        (
            ("kept", "shortest distance\nto anything [m]"),
            ("danger_share", "share of time\nin danger mode [–]"),
            ("time_to_finish", "time to finish [s]"),
        ),
        lambda runs: (
            "{} of {} free of contact\n".format(*contact_free(runs))
            + f"{arrived(runs)[0]} finished"
        ),
    ),
)


LOW = {"ten_robots": 1.5, "three_robots": 2.0}
"""[s] time_low of the shipped worlds; without hysteresis the upper thresholds are at the lower"""


def conclude_hysteresis(arms: Table) -> Sequence[Verdict]:
    """Whether hysteresis makes modes switch less often."""
    fewer, seen, measured = [], [], []
    for w, world in enumerate(LOW):
        on, off = (estimated(arms[2 * w + k], "mode_switches") for k in (0, 1))
        fewer.append(on.high < off.low)
        seen.append(on.median < off.median)
        free = [contact_free(arms[2 * w + k]) for k in (0, 1)]
        measured.append(
            f"{world}: {on.text(1)} with, {off.text(1)} without, a robot and minute; free of "
            f"contact {share_text(*free[0])} with, {share_text(*free[1])} without"
        )
    return (
        Verdict(
            "Hysteresis makes robots switch modes less often",
            "five thresholds, two of them upper ones (Fig. 5)",
            "; ".join(measured),
            outcome(all(fewer), any(seen)),
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
    draw=rows_of_measures(
        "Hysteresis of the mode switching",
        2.9,
        (
            ("mode_switches", "mode switches\n[1/min per robot]"),
            ("danger_share", "share of time\nin danger mode [–]"),
            ("kept", "shortest distance\nto anything [m]"),
        ),
    ),
)


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
