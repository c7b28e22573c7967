"""A world as its author writes it: the keys of the world file, with units, bounds and defaults.

Schema, hover text and comments of a saved world come from the descriptions; these begin with
units. The parts of a world stand in the modules beside this one.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    model_validator,
)

from physim.errors import WorldError
from physim.html import labelled
from physim.world.base import Model
from physim.world.faults import describe
from physim.world.group import Driver, Entry, RobotGroup, drivers_of, limited, robot_count
from physim.world.kinds import (
    MOST_POINTS,
    MOST_ROBOTS,
    MOST_SEED,
    MOST_WALLS,
    Label,
    Length,
    Lines,
    Number,
    Polyline,
    Sequence,
    Text,
    Whole,
    either,
)
from physim.world.mover import MOST_MOVERS, Mover, ObstacleEntry
from physim.world.road import RandomCorridor, is_random_corridor
from physim.world.robot import Formation, Robot, Start
from physim.world.run import (
    DEFAULT_RANGE,
    Arrival,
    Choice,
    Choices,
    ControllerChoice,
    Expectation,
    Physics,
    Sensing,
    Time,
    nested_choice,
)


class Corridor(Model):
    """Road of given width along a centreline, closed by caps beyond both ends."""

    centreline: Polyline = Field(description="[m] middle of the corridor, points [x, y]")
    width: Annotated[
        Annotated[
            tuple[Length, ...],
            Field(min_length=2, max_length=MOST_POINTS),
            Sequence,
            Tag("<list>"),
        ]
        | Annotated[Length, Tag("<value>")],
        either("<list>", "<value>"),
    ] = Field(description="[m] full width: one number, or one per point of the centreline")
    end_margin: Annotated[Number, Field(ge=1.0e-3, le=1.0e6)] = Field(
        default=3.0,
        description="[m] distance from either end of the centreline to the cap that closes it",
    )


Road = Annotated[
    Annotated[Corridor, Tag("<corridor>")] | Annotated[RandomCorridor, Tag("<random>")],
    Discriminator(lambda value: "<random>" if is_random_corridor(value) else "<corridor>"),
]


class World(Model):
    """Everything that its author says about a run. Lengths [m], times [s], angles [rad].

    Raises `physim.WorldError`, with every fault found, when made with bad values.
    """

    model_config = ConfigDict(
        json_schema_extra={
            "description": "A world: road, robots and controller of a run, and what it must "
            "satisfy. Lengths [m], times [s], angles [rad]."
        }
    )

    name: Label = Field(description="label of the world")
    description: Text = Field(default="", description="what the world shows, in a sentence")
    seed: Annotated[Whole, Field(ge=0, le=MOST_SEED)] = Field(
        default=0, description="seed of everything random in the run"
    )
    time: Time = Field(description="physics step, and duration of the run")
    corridor: Road | None = Field(
        default=None,
        description="road with a centreline and a width, or drawn by the seed; or give boundaries",
    )
    boundaries: (
        Annotated[tuple[Polyline, ...], Field(min_length=1, max_length=MOST_WALLS), Lines] | None
    ) = Field(default=None, description="[m] walls as polylines; or give a corridor")
    reference_path: Polyline | None = Field(
        default=None, description="[m] path of the formation; the centreline when absent"
    )
    start: Start | None = Field(
        default=None,
        description="region in which robots without a pose are placed by the seed",
    )
    robots: Annotated[
        tuple[Entry, ...],
        Field(min_length=1, max_length=MOST_ROBOTS),
        Sequence,
        AfterValidator(limited),
    ] = Field(
        description="list of robots, in the order of their ids; an entry with a count stands for "
        "many"
    )
    formation: Formation | None = Field(
        default=None,
        description="formation control; without it every robot goes at the controller's speed",
    )
    controller: Annotated[ControllerChoice, BeforeValidator(nested_choice)] = Field(
        default=ControllerChoice(), description="controller of the robots, and its settings"
    )
    sensing: Sensing = Field(
        default=Sensing(), description="what robots sense of one another and of the walls"
    )
    filters: Choices = Field(
        default=(),
        description="parts that change the commands of controllers, in order",
    )
    disturbances: Choices = Field(
        default=(),
        description="parts that make robots depart from their commands, in order",
    )
    arrival: Arrival = Field(default=Arrival(), description="when a robot counts as arrived")
    obstacles: Annotated[tuple[ObstacleEntry, ...], Field(max_length=MOST_WALLS), Lines] = Field(
        default=(),
        description="[m] closed, solid polygons; one with a mass can be pushed: {corners, mass}",
    )
    movers: Annotated[tuple[Mover, ...], Field(max_length=MOST_MOVERS), Sequence] = Field(
        default=(),
        description="list of bodies on timed paths, such as carts and doors: they push robots and "
        "are never pushed",
    )
    expect: Expectation | None = Field(default=None, description="what the run must satisfy")
    physics: Physics = Field(default=Physics(), description="friction and elasticity of contacts")

    def __repr__(self) -> str:
        """Name, seed and size; `to_yaml` gives all of it."""
        size = f"{self.robot_count} robot{'' if self.robot_count == 1 else 's'}"
        return f"<World {describe(self.name)} seed {self.seed}: {size}, {self.time.duration:g} s>"

    def __str__(self) -> str:
        """As its `repr`: the fields of all robots would be a wall of text."""
        return repr(self)

    def _repr_html_(self) -> str:
        """What a notebook shows of it; `physim preview` draws it."""
        formation = "none" if self.formation is None else f"at {self.formation.speed:g} m/s"
        rows = {
            "world": self.name,
            "": self.description,
            "seed": str(self.seed),
            "robots": str(self.robot_count),
            "duration": f"{self.time.duration:g} s, in steps of {self.time.step:g} s",
            "formation": formation,
            "controller": ", ".join(dict.fromkeys(one.type for one in self.drivers())),
        }
        return labelled((label, text) for label, text in rows.items() if text)

    @model_validator(mode="after")
    def _rules(self) -> World:
        """Refuse what lies between several values, which are sound each by itself."""
        from physim.world.rules import rule_faults

        if faults := rule_faults(self):
            raise WorldError(faults)
        return self

    @property
    def robot_count(self) -> int:
        """Number of robots: a group counts as many."""
        return robot_count(self.robots)

    def drivers(self, own: str | None = None) -> tuple[Driver, ...]:
        """Controllers that drive robots of the world, its own first; equal ones once.

        ``own``: what stands in the place of the world's own, where something does.
        """
        choices = ((one.controller, robot_count([one])) for one in self.robots)
        world = self.controller
        return drivers_of(
            (world.type if own is None else own, world.settings),
            ((None if one is None else (one.type, one.settings), n) for one, n in choices),
        )

    @property
    def is_road_random(self) -> bool:
        """Whether the seed draws the road."""
        return isinstance(self.corridor, RandomCorridor)

    @property
    def sensing_range(self) -> float:
        """[m] Within which robots see and consider others and walls."""
        if self.sensing.range is not None:
            return self.sensing.range
        return self.formation.range if self.formation is not None else DEFAULT_RANGE

    def start_of(self, entry: Robot | RobotGroup) -> Start | None:
        """Region in which an entry is placed: its own or the world's; None when it has a pose."""
        has_pose = isinstance(entry, Robot) and entry.pose is not None
        return None if has_pose else entry.start or self.start

    @property
    def stem(self) -> str:
        """The name as part of a file name: letters of any script, digits, ``_`` and ``-`` only."""
        return re.sub(r"[^\w-]+", "_", self.name).strip("_") or "world"

    def changed(self, **changes: Any) -> World:
        """Return this world with some values replaced; checked like a new one (WorldError).

        Whether controller and stages are registered, and have these settings, is checked where they
        are used, by `physim.simulate` or a file that is loaded. A dotted key, such as
        ``robots.0.limits.v``, is changed by ``load_world(name, overrides=["KEY=VALUE"])``.

        A mapping given for a group, as ``formation={"gain": 0.02}``, changes these keys alone, as
        ``--set formation.gain=0.02`` does; with a ``type`` it is another part, without the settings
        of the one before. None for a setting of the controller leaves that setting out.
        """
        values = {key: getattr(self, key) for key in type(self).model_fields}
        return World(
            **values | {key: _changed(values.get(key), new) for key, new in changes.items()}
        )

    def to_yaml(self) -> str:
        """Write the world as YAML text, units as comments; loads back equal."""
        from physim.world.yaml_text import yaml_text

        return yaml_text(self)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the world to a file, whole or not at all, in place of an earlier one.

        Raises PhysimError when it cannot be written.
        """
        from physim.files import write_text

        write_text(Path(path), self.to_yaml())


def _changed(old: Any, new: Any) -> Any:
    """``new`` in place of ``old``, of whose keys a mapping leaves those that it does not name."""
    if not isinstance(old, Model) or not isinstance(new, Mapping):
        return new
    if isinstance(old, Choice):
        named = {"type": old.type} if "type" in old.model_fields_set else {}
        return new if "type" in new else {**named, **old.settings, **new}
    if is_random_corridor(old) != is_random_corridor(new):  # a road of the other kind
        return new
    kept = {key: getattr(old, key) for key in old.model_fields_set}
    return kept | {key: _changed(kept.get(key), value) for key, value in new.items()}
