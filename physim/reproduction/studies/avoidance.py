"""Which of (12) and (13) serves in danger mode (Fig. 5), and what happens with neither.

The paper says "by distance" and "by collision time" and not which goes first where both are short.
The worlds are those that cannot do without avoidance.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from physim.plots.style import WIDTH
from physim.record import Record
from physim.reproduction.studies.drawing import prepared, rows_of_measures
from physim.reproduction.studies.estimates import column, estimate, freely, outcome, share_text
from physim.reproduction.studies.figures import figures, rule_shares, safety
from physim.reproduction.study import Arm, Measures, Study, Verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WORLDS = ("ten_robots", "crowded_start", "three_robots", "nonconvex")
KINDS = {
    "distance_first": "(12) first",
    "time_first": "(13) first",
    "distance": "(12) alone",
    "time": "(13) alone",
    "none": "none",
}
FIRST, LATER, *_, NONE = range(len(KINDS))

Runs = Sequence[Measures]


def measure(record: Record) -> Measures:
    """Contacts, distance kept, whether all arrived, and the share of decisions by each rule."""
    return {**safety(record), **figures(record, "finished"), **rule_shares(record)}


def _free(runs: Runs) -> tuple[int, int]:
    return freely(runs, "contacts", lambda value: value == 0.0)


def _arrived(runs: Runs) -> int:
    return freely(runs, "finished", lambda value: value > 0.0)[0]


def _of(arms: Sequence[Runs], kind: int) -> list[Runs]:
    """Runs of one kind of avoidance, world by world."""
    return list(arms[kind :: len(KINDS)])


def conclude(arms: Sequence[Runs]) -> Sequence[Verdict]:
    """Is avoidance needed, and does what the worlds ship with keep robots apart?"""
    without, first, later = (_of(arms, kind) for kind in (NONE, FIRST, LATER))
    shipped = [later[k] if WORLDS[k] == "crowded_start" else first[k] for k in range(len(WORLDS))]
    free = [_free(runs) for runs in shipped]
    bare = [_free(runs) for runs in without]
    needed = [b[1] - b[0] >= 0.5 * b[1] for b in bare]
    safe = [f[0] >= 0.95 * f[1] for f in free]
    both = [s and n for s, n in zip(safe, needed, strict=True)]
    wider = [
        estimate(column(a, "between_robots")).low > estimate(column(b, "between_robots")).high
        for a, b in zip(first, later, strict=True)
    ]
    finish = [_arrived(a) >= _arrived(b) for a, b in zip(first, later, strict=True)]
    return (
        Verdict(
            "Robots avoid collisions by (12) and (13)",
            "in words only",
            "; ".join(
                f"{world}: free of contact {share_text(*f)}, without avoidance {share_text(*b)}"
                for world, f, b in zip(WORLDS, free, bare, strict=True)
            ),
            outcome(all(both), any(both)),
            "Met where nine and a half tenths of the runs are free of contact with avoidance, and "
            "at most half without.",
        ),
        Verdict(
            "Distances first, then collision times: robots stay farther apart",
            "the order is not told (Fig. 5)",
            "; ".join(
                f"{world}: shortest distance between robots "
                f"{estimate(column(a, 'between_robots')).text(2, 'm')} against "
                f"{estimate(column(b, 'between_robots')).text(2, 'm')}, finished {_arrived(a)} "
                f"against {_arrived(b)} of {len(a)}"
                for world, a, b in zip(WORLDS, first, later, strict=True)
            ),
            outcome(all(wider) and all(finish), any(wider)),
            "In crowds the foremost robot may stand for ever among others that avoid it; "
            "crowded_start therefore ships with collision times first.",
        ),
    )  # fmt: skip


def draw(figure: Figure, arms: Sequence[Runs]) -> None:
    """Distance kept and shares of the rules, for every kind in every world."""
    prepared(figure, "Which rule decides in danger mode", height=7.2, width=WIDTH)
    rows_of_measures(
        figure,
        [arm.label for arm in STUDY.arms],
        arms,
        (
            ("between_robots", "shortest distance\nbetween robots [m]", False),
            ("by_distance", "share of decisions\nby (12) [–]", False),
            ("by_time", "share of decisions\nby (13) [–]", False),
        ),
        ["{} of {} free of contact,\n{} finished".format(*_free(a), _arrived(a)) for a in arms],
    )


STUDY = Study(
    name="avoidance",
    title="Which rule decides in danger mode",
    claim="Avoidance by distance (12) and by collision time (13), each first, each alone, neither.",
    arms=tuple(
        Arm(f"{world}, {label}", world, (f"controller.avoidance={kind}",))
        for world in WORLDS
        for kind, label in KINDS.items()
    ),
    measure=measure,
    conclude=conclude,
    draw=draw,
    seeds=50,
)
