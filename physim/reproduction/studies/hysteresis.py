"""Hysteresis of the switching on and off: mode switches a minute (Fig. 5).

Off: danger ends at the thresholds at which it begins. Boundaries have one threshold in either case.
"""

from __future__ import annotations

from collections.abc import Sequence

from physim.reproduction.studies.drawing import rows_of_measures
from physim.reproduction.studies.estimates import contact_free, estimated, outcome, share_text
from physim.reproduction.studies.figures import measure_group
from physim.reproduction.study import Arm, Study, Table, Verdict

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
