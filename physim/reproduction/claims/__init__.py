"""The claims of the paper by figure, and the figures of a run that they are judged by."""

from __future__ import annotations

from collections.abc import Callable

from physim.record import Record
from physim.reproduction.claims.modes import (
    claims_in_words,
    claims_of_figure_8,
    measure_effort,
    measure_modes,
)
from physim.reproduction.claims.motion import (
    SNAPSHOTS,
    claims_of_figure_1,
    claims_of_figure_2,
    claims_of_figure_7,
    measure_formation,
    measure_path_following,
)
from physim.reproduction.claims.space import (
    claims_of_figure_3,
    claims_of_figure_3a,
    claims_of_figure_4,
    claims_of_figure_6,
    measure_distances,
    measure_space,
)
from physim.reproduction.study import PAIR_TIMES, WORDS, Measures, Part

MEASURES: tuple[Callable[[Record], Measures], ...] = (
    measure_path_following,
    measure_formation,
    measure_distances,
    measure_space,
    measure_modes,
    measure_effort,
)


def measures(record: Record) -> Measures:
    """All figures of a run that claims are judged by; absent where they have no meaning."""
    return {name: value for measure in MEASURES for name, value in measure(record).items()}


def parts() -> tuple[Part, ...]:
    """Every part of the paper that reports something, in its order."""
    one, three, ten = "single_robot", "three_robots", "ten_robots"
    return (
        Part("1", "Figure 1: one robot follows its path", one,
             ("trajectories", "deviation", "speeds"), claims_of_figure_1(), film=True),
        Part("2", "Figure 2: three robots in formation", three,
             ("trajectories", "formation", "deviation"), claims_of_figure_2(), film=True,
             snapshots=SNAPSHOTS),
        Part("3", "Figure 3: distances and collision times of the three robots", three,
             ("distances", PAIR_TIMES, "collision_times"), claims_of_figure_3(), bare=True),
        Part("3a", "Figure 3a: safe and danger area", three,
             ("trajectories",), claims_of_figure_3a(), snapshots=SNAPSHOTS),
        Part("4", "Figure 4: corridor width", ten, ("width",), claims_of_figure_4()),
        Part("6", "Figure 6: ten robots", ten,
             ("trajectories", "distances", PAIR_TIMES, "collision_times"),
             claims_of_figure_6(), bare=True, film=True),
        Part("7", "Figure 7: formation errors, speeds and deviations of the ten robots", ten,
             ("formation", "speeds", "deviation"), claims_of_figure_7()),
        Part("8", "Figure 8: modes of the ten robots", ten, ("modes",), claims_of_figure_8(),
             bare=True),
        Part(WORDS, "Claims in words", ten, (), claims_in_words()),
    )  # fmt: skip
