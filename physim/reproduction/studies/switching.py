"""Collision time and distance together against either alone in the switching of modes (Fig. 5).

A threshold of 0 switches one off: no distance or time is below it. "Time only" has no threshold of
the distance to boundaries either.
"""

from __future__ import annotations

from collections.abc import Sequence

from physim.reproduction.studies.drawing import rows_of_measures
from physim.reproduction.studies.estimates import (
    arrived,
    contact_free,
    estimated,
    free_text,
    outcome,
)
from physim.reproduction.studies.figures import measure_group
from physim.reproduction.study import Arm, Runs, Study, Table, Verdict

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
