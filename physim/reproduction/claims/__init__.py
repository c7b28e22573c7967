"""The claims of the paper by figure, and the figures of a run that they are judged by."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from physim.record import Record
from physim.reproduction.claims import avoidance, effort, following, formation, modes, space
from physim.reproduction.claims.claim import Claim
from physim.reproduction.study import Measures

PAIR_TIMES = "pair_times"
"""The picture that only a reproduction has: collision times of all pairs."""


@dataclass(frozen=True)
class Part:
    """A figure of the paper, or its words: what it shows, the world, the pictures, the claims."""

    figure: str
    title: str
    world: str
    pictures: tuple[str, ...]
    """of `physim.plots`, or `PAIR_TIMES`"""
    claims: tuple[Claim, ...]
    null: bool = False
    """whether its claims are held against runs without avoidance, too"""
    film: bool = False
    snapshots: float | None = None
    """[s] between the robots in the map"""


def parts() -> tuple[Part, ...]:
    """Every part of the paper that reports something, in its order."""
    one, three, ten = "single_robot", "three_robots", "ten_robots"
    every = formation.SNAPSHOTS
    return (
        Part("1", "Figure 1: one robot follows its path", one,
             ("trajectories", "deviation", "speeds"), following.claims(), film=True),
        Part("2", "Figure 2: three robots in formation", three,
             ("trajectories", "formation", "deviation"), formation.claims_of_three(), film=True,
             snapshots=every),
        Part("3", "Figure 3: distances and collision times of the three robots", three,
             ("distances", PAIR_TIMES, "collision_times"), avoidance.claims_of_three(), null=True),
        Part("3a", "Figure 3a: safe and danger area", three,
             ("trajectories",), space.claims_of_three(), snapshots=every),
        Part("4", "Figure 4: corridor width", ten, ("width",), space.claims_of_ten()),
        Part("6", "Figure 6: ten robots", ten,
             ("trajectories", "distances", PAIR_TIMES, "collision_times"),
             avoidance.claims_of_ten(), null=True, film=True),
        Part("7", "Figure 7: formation errors, speeds and deviations of the ten robots", ten,
             ("formation", "speeds", "deviation"), formation.claims_of_ten()),
        Part("8", "Figure 8: modes of the ten robots", ten, ("modes",), modes.claims(), null=True),
        Part(effort.WORDS, "Claims in words", ten, (), effort.claims()),
    )  # fmt: skip


def measures(record: Record) -> Measures:
    """All figures of a run that claims are judged by; absent where they have no meaning."""
    found: dict[str, float] = {}
    for one in MEASURES:
        found.update(one(record))
    return found


MEASURES: tuple[Callable[[Record], Measures], ...] = (
    following.measure,
    formation.measure,
    avoidance.measure,
    space.measure,
    modes.measure,
    effort.measure,
)
