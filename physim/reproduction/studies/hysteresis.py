"""Hysteresis of the switching on and off: mode switches a minute (Fig. 5).

Off: danger ends at the thresholds at which it begins. Boundaries have one threshold in either case.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from physim.plots.style import WIDTH
from physim.record import Record
from physim.reproduction.studies.drawing import prepared, rows_of_measures
from physim.reproduction.studies.estimates import column, estimate, freely, outcome, share_text
from physim.reproduction.studies.figures import figures, safety
from physim.reproduction.study import Arm, Measures, Study, Verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LOW = {"ten_robots": 1.5, "three_robots": 2.0}
"""[s] time_low of the shipped worlds"""
WORLDS = tuple(LOW)


def measure(record: Record) -> Measures:
    """Mode switches a minute, share of danger mode, contacts and distance kept."""
    return {**figures(record, "mode_switches", "danger_share"), **safety(record)}


def conclude(arms: Sequence[Sequence[Measures]]) -> Sequence[Verdict]:
    """Whether hysteresis makes modes switch less often."""
    fewer, seen, told = [], [], []
    for w, world in enumerate(WORLDS):
        on, off = (estimate(column(arms[2 * w + k], "mode_switches")) for k in (0, 1))
        fewer.append(on.high < off.low)
        seen.append(on.median < off.median)
        free = [freely(arms[2 * w + k], "contacts", lambda v: v == 0.0) for k in (0, 1)]
        told.append(
            f"{world}: {on.text(1)} with, {off.text(1)} without, a robot and minute; free of "
            f"contact {share_text(*free[0])} with, {share_text(*free[1])} without"
        )
    return (
        Verdict(
            "Hysteresis makes robots switch modes less often",
            "five thresholds, two of them upper ones (Fig. 5)",
            "; ".join(told),
            outcome(all(fewer), any(seen)),
            "The paper names the thresholds, not their values or the rate of switches.",
        ),
    )


def draw(figure: Figure, arms: Sequence[Sequence[Measures]]) -> None:
    """Mode switches, share of danger mode and distance kept, with hysteresis and without."""
    prepared(figure, "Hysteresis of the mode switching", height=2.9, width=WIDTH)
    rows_of_measures(
        figure,
        [arm.label for arm in STUDY.arms],
        arms,
        (
            ("mode_switches", "mode switches\n[1/min per robot]", False),
            ("danger_share", "share of time\nin danger mode [–]", False),
            ("kept", "shortest distance\nto anything [m]", False),
        ),
    )


def without(world: str) -> tuple[str, ...]:
    """Upper thresholds at the lower ones: no hysteresis."""
    return (f"controller.time_high={LOW[world]}", "controller.distance_high=0.5")


STUDY = Study(
    name="hysteresis",
    title="Hysteresis",
    claim="Upper thresholds above the lower ones keep modes from switching to and fro.",
    arms=tuple(
        Arm(f"{world.replace('_', ' ')},\nhysteresis {word}", world, overrides)
        for world in WORLDS
        for word, overrides in (("on", ()), ("off", without(world)))
    ),
    measure=measure,
    conclude=conclude,
    draw=draw,
)
