"""Many robots in one entry of ``robots``: how many, and what they have in common.

A group stands for robots one by one (`each_robot`): names by number, paths in turn, footprints
drawn by the seed. Each robot draws from (seed, "footprint", robot), so that no other draw shifts.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, NamedTuple

from pydantic import AfterValidator, Discriminator, Field, Tag
from pydantic_core import PydanticCustomError

from physim.errors import Location
from physim.world.base import Model
from physim.world.kinds import MOST_ROBOTS, Label, Sequence, Whole
from physim.world.robot import Footprint, Limits, Mass, Multiples, Robot, RobotPath, Speeds, Start
from physim.world.run import OfDrive, OfRobots

NUMBER = "{number}"
"""What is replaced in the name of a group."""
SEVERAL = Field(min_length=1, max_length=1_000)
"""Footprints, and paths as many again, of one group."""


def _pattern(text: str) -> str:
    if NUMBER not in text:
        raise PydanticCustomError("label", f"must hold {NUMBER}, which makes names differ")
    return text


class RobotGroup(Model):
    """Robots alike: all placed by the seed."""

    count: Annotated[Whole, Field(ge=1, le=MOST_ROBOTS)] = Field(
        description="number of robots that this entry stands for"
    )
    name: Annotated[Label, AfterValidator(_pattern)] = Field(
        default=f"r{NUMBER}",
        description=f"names; {NUMBER} stands for the number of the robot in the world, from 1",
    )
    footprint: Footprint | None = Field(
        default=None,
        description="[m] footprint of all robots, as for one robot (or give footprints)",
    )
    footprints: Annotated[tuple[Footprint, ...], SEVERAL, Sequence] | None = Field(
        default=None,
        description="[m] list of footprints; the seed draws one of them for each robot",
    )
    start: Start | None = Field(
        default=None,
        description="region in which the seed places them; without it the world's start",
    )
    path: RobotPath | None = Field(
        default=None, description="[m] path of all robots, as for one robot (or give paths)"
    )
    paths: Annotated[tuple[RobotPath, ...], SEVERAL, Sequence] | None = Field(
        default=None,
        description="[m] list of paths, used in turn: the first robot has the first path; after "
        "the last path the list begins again",
    )
    limits: Limits = Field(default=Limits(), description="largest commands of each robot")
    drive: OfDrive = None
    mass: Mass = None
    speeds: Multiples = None
    omegas: Speeds = None
    controller: OfRobots = None

    @property
    def shapes(self) -> tuple[Any, ...]:
        """Footprints that its robots may have."""
        return (self.footprint,) if self.footprints is None else self.footprints

    @property
    def is_drawn(self) -> bool:
        """Whether the seed decides over footprints."""
        return len(self.shapes) > 1

    def robot(self, number: int, place: int, seed: int) -> Robot:
        """Robot ``number`` of a world, from 0, which is number ``place`` of the group, from 0."""
        shapes, drawn = self.shapes, 0
        if self.is_drawn:
            from physim.randomness import stream  # worlds are read without numpy

            drawn = int(stream(seed, "footprint", number).integers(len(shapes)))
        return Robot.model_construct(
            name=self.name.replace(NUMBER, str(number + 1)),
            footprint=shapes[drawn],
            pose=None,
            start=self.start,
            path=self.path if self.paths is None else self.paths[place % len(self.paths)],
            limits=self.limits,
            drive=self.drive,
            mass=self.mass,
            speeds=self.speeds,
            omegas=self.omegas,
            controller=self.controller,
        )


def is_group(value: Any) -> bool:
    """Whether an entry of ``robots``, as read or as a model, is a group."""
    if not isinstance(value, Mapping):
        return isinstance(value, RobotGroup)
    return not value.keys().isdisjoint(("count", "footprints", "paths"))


Entry = Annotated[
    Annotated[Robot, Tag("<robot>")] | Annotated[RobotGroup, Tag("<group>")],
    Discriminator(lambda value: "<group>" if is_group(value) else "<robot>"),
]


def limited(entries: tuple[Any, ...]) -> tuple[Any, ...]:
    """The entries, if they stand for no more robots than a world may hold."""
    if (count := robot_count(entries)) > MOST_ROBOTS:
        lengths = {"max_length": MOST_ROBOTS, "actual_length": count}
        raise PydanticCustomError("too_long", "too long", lengths)
    return entries


def robot_count(entries: Iterable[Robot | RobotGroup]) -> int:
    """Number of robots that entries stand for."""
    return sum(one.count if isinstance(one, RobotGroup) else 1 for one in entries)


def each_robot(
    entries: Iterable[Robot | RobotGroup], seed: int
) -> tuple[tuple[Robot, ...], tuple[int, ...]]:
    """The robots that entries stand for under a seed, and for each the number of its entry."""
    robots: list[Robot] = []
    where: list[int] = []
    for e, one in enumerate(entries):
        if isinstance(one, RobotGroup):
            robots += [one.robot(len(where) + place, place, seed) for place in range(one.count)]
        else:
            robots.append(one)
        where += [e] * (len(robots) - len(where))
    return tuple(robots), tuple(where)


Named = tuple[str, Mapping[str, Any]]
"""Type and settings of a controller"""


class Driver(NamedTuple):
    """A controller of a world, and the robots that it drives."""

    type: str
    settings: Mapping[str, Any]
    robots: tuple[int, ...]
    entries: tuple[int, ...]
    """those of ``robots`` of the world that stand for them"""
    is_own: bool
    """whether it is the world's own; else the first of the entries names it"""

    @property
    def where(self) -> Location:
        """Where the world names it."""
        return ("controller",) if self.is_own else ("robots", self.entries[0], "controller")


def drivers_of(own: Named, entries: Iterable[tuple[Named | None, int]]) -> tuple[Driver, ...]:
    """Who drives whom: the world's ``own`` controller, then those of entries, equal ones once.

    ``entries`` give the controller of each, None for the world's, and for how many robots it
    stands. The world's own is left out where every robot has another.
    """
    found: list[tuple[Named, list[int], list[int]]] = [(own, [], [])]
    robots = 0
    for e, (named, count) in enumerate(entries):
        one = next((one for one in found if named is None or one[0] == named), None)
        if one is None:
            assert named is not None
            found.append(one := (named, [], []))
        one[1].append(e)
        one[2].extend(range(robots, robots + count))
        robots += count
    return tuple(
        Driver(*named, tuple(some), tuple(written), k == 0)
        for k, (named, written, some) in enumerate(found)
        if some
    )
