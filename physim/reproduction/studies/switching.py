"""Collision time and distance together against either alone in the switching of modes (Fig. 5).

A threshold of 0 switches one off: no distance or time is below it. "Time only" has no threshold of
the distance to boundaries either.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from physim.plots.style import WIDTH
from physim.record import Record
from physim.reproduction.studies.drawing import prepared, rows_of_measures
from physim.reproduction.studies.estimates import (
    column,
    estimate,
    freely,
    outcome,
    share_text,
)
from physim.reproduction.studies.figures import figures, safety
from physim.reproduction.study import Arm, Measures, Study, Verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Runs = Sequence[Measures]

NO_TIME = ("controller.time_low=0.0", "controller.time_high=0.0")
NO_DISTANCE = (
    "controller.distance_low=0.0",
    "controller.distance_high=0.0",
    "controller.boundary_low=0.0",
)
WORLDS = ("ten_robots", "three_robots")
WAYS = (("both", ()), ("distance only", NO_TIME), ("time only", NO_DISTANCE))


def measure(record: Record) -> Measures:
    """Contacts, distance kept, whether all arrived and when, share of danger mode."""
    return {**safety(record), **figures(record, "finished", "time_to_finish", "danger_share")}


def _free(runs: Runs) -> tuple[int, int]:
    return freely(runs, "contacts", lambda value: value == 0.0)


def _arrived(runs: Runs) -> tuple[int, int]:
    return freely(runs, "finished", bool)


def better(both: Runs, alone: Runs) -> bool:
    """Whether runs with both are better: no worse in any respect, and clearly better in one.

    Respects: runs free of contact, runs that finish, distance kept (intervals apart).
    """
    kept, lost = estimate(column(both, "kept")), estimate(column(alone, "kept"))
    no_worse = (
        _free(both)[0] >= _free(alone)[0]
        and _arrived(both)[0] >= _arrived(alone)[0]
        and kept.high >= lost.low
    )
    clearly = (
        _free(both)[0] > _free(alone)[0]
        or _arrived(both)[0] > _arrived(alone)[0]
        or kept.low > lost.high
    )
    return no_worse and clearly


def conclude(arms: Sequence[Runs]) -> Sequence[Verdict]:
    """For each of the two left out: are both together better, in both worlds, in one, in none?"""
    verdicts = []
    for k, what in ((1, "distance"), (2, "collision time")):
        wins, told = [], []
        for w, world in enumerate(WORLDS):
            both, alone = arms[len(WAYS) * w], arms[len(WAYS) * w + k]
            wins.append(better(both, alone))
            told.append(f"{world}: {_compared(both, alone)}")
        verdicts.append(
            Verdict(
                f"Collision time and distance together do better than {what} alone",
                "in words only",
                "; ".join(told),
                outcome(all(wins), any(wins)),
                "The five thresholds of Fig. 5 are lost; these are ours.",
            )
        )
    return tuple(verdicts)


def _compared(both: Runs, alone: Runs) -> str:
    kept = [estimate(column(runs, "kept")).text(3, "m") for runs in (both, alone)]
    return (
        f"free of contact {share_text(*_free(both))} against {share_text(*_free(alone))}, "
        f"finished {_arrived(both)[0]} against {_arrived(alone)[0]}, shortest distance to "
        f"anything {kept[0]} against {kept[1]}"
    )


def draw(figure: Figure, arms: Sequence[Runs]) -> None:
    """Distance kept, share of danger mode and time to finish of every way to switch."""
    prepared(figure, "Switching by distance, by time, by both", height=3.6, width=WIDTH)
    rows_of_measures(
        figure,
        [arm.label for arm in STUDY.arms],
        arms,
        (
            ("kept", "shortest distance\nto anything [m]", False),
            ("danger_share", "share of time\nin danger mode [–]", False),
            ("time_to_finish", "time to finish [s]", False),
        ),
        [
            "{} of {} free of contact\n{} finished".format(*_free(mine), _arrived(mine)[0])
            for mine in arms
        ],
    )


STUDY = Study(
    name="switching",
    title="Switching by time and distance",
    claim="Collision time and distance together switch better than either alone.",
    arms=tuple(
        Arm(f"{world.replace('_', ' ')},\n{label}", world, overrides)
        for world in WORLDS
        for label, overrides in WAYS
    ),
    measure=measure,
    conclude=conclude,
    draw=draw,
)
