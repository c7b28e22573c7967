"""Which of (12) and (13) serves in danger mode (Fig. 5), and what happens with neither.

The paper says "by distance" and "by collision time" and not which goes first where both are short.
The worlds are those that cannot do without avoidance.
"""

from __future__ import annotations

from collections.abc import Sequence

from physim.reproduction.studies.drawing import rows_of_measures
from physim.reproduction.studies.estimates import (
    arrived,
    contact_free,
    estimated,
    outcome,
    share_text,
)
from physim.reproduction.studies.figures import measure_group
from physim.reproduction.study import Arm, Study, Table, Verdict

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
