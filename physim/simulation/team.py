"""Several controllers in one run, each for its own robots: a `Team` is one controller of them all.

What its members declare is united: modes and columns of one name must mean the same, since pictures
and tables show them together; a rule is its controller's own, and one of a name that another uses
in another sense is called by its member's number, as ``path_following_2``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.errors import ControllerError
from physim.geometry.shapes import IntArray
from physim.parts.controller import Controller, Decision, Decisions, Observation, Sensed
from physim.parts.declarations import (
    NO_NUMBER,
    STANDARD_COLUMNS,
    Column,
    Declared,
    Mode,
    Rule,
    kept_distance,
)
from physim.parts.registry import OF_ROBOTS, make_part
from physim.simulation.decisions import answered, begun
from physim.world import World
from physim.world.group import Driver
from physim.world.scene import Scene

STANDARD = frozenset(column.name for column in STANDARD_COLUMNS)
"""Columns whose meaning is fixed, however a controller words it."""


class Member(NamedTuple):
    """A controller and the robots that it drives."""

    controller: Controller
    driver: Driver
    declared: Declared
    modes: IntArray
    """numbers of its modes in the team's; of `NO_NUMBER`, at the end, that"""
    rules: IntArray
    """likewise"""
    columns: IntArray


class Team:
    """Controllers of one run, of which each robot has one."""

    def __init__(self, drivers: Sequence[tuple[Controller, Driver]]) -> None:
        """Unite what they declare. Raises ControllerError where two use a name in two senses."""
        modes: dict[str, Mode] = {}
        rules: dict[str, Rule] = {}
        columns: dict[str, Column] = {}
        self.members: list[Member] = []
        for k, (controller, driver) in enumerate(drivers):
            own = Declared.of(controller)
            for mode in own.modes:
                if (other := modes.setdefault(mode.name, mode)) != mode:
                    raise _two_senses("mode", mode, other, driver)
            for column in own.columns:
                known = columns.setdefault(column.name, column)
                if column.unit != known.unit or (
                    column.name not in STANDARD and column.words != known.words
                ):
                    raise _two_senses("column", column, known, driver)
            called = [one.name for one in own.rules]
            for m, rule in enumerate(own.rules):
                if rules.get(rule.name, rule) != rule:
                    called[m] = f"{rule.name}_{k + 1}"
                rules[called[m]] = replace(rule, name=called[m])
            self.members.append(
                Member(
                    controller, driver, own, _numbers((one.name for one in own.modes), modes),
                    _numbers(called, rules), _numbers((one.name for one in own.columns), columns),
                )
            )  # fmt: skip
        self.modes, self.rules = tuple(modes.values()), tuple(rules.values())
        self.columns = tuple(columns.values())
        farthest = max(self.members, key=lambda one: kept_distance(one.controller))
        self.settings = getattr(farthest.controller, "settings", None)
        """of who keeps farthest from walls: pictures show the safe area by them"""

    def decide(self, observation: Observation, memory: Any) -> Decision:
        """Let the controller of the robot decide; its rules are not renamed."""
        for one in self.members:
            if observation.index in one.driver.robots:
                return one.controller.decide(observation, memory)
        raise ControllerError(f"{observation.name} has no controller")

    def batch(self, scene: Scene) -> TeamBatch:
        """Set up the batch form of every member."""
        return TeamBatch(self, scene)


class TeamBatch:
    """Batch form of a `Team` for one run: each member's is asked for its robots that are due."""

    def __init__(self, team: Team, scene: Scene) -> None:
        self.scene, self.members, self.columns = scene, team.members, len(team.columns)
        self.begun = [begun(one.controller, scene, one.declared) for one in team.members]
        self.member = np.zeros(scene.robots, dtype=np.int64)
        for k, one in enumerate(team.members):
            self.member[list(one.driver.robots)] = k

    def memory(self) -> dict[str, NDArray[Any]]:
        """Memories of all members, each under the number of the member and its own name."""
        found = enumerate(memory for _, memory in self.begun)
        return {f"{k}/{name}": one.copy() for k, own in found for name, one in own.items()}

    def decide_due(
        self, sensed: Sensed, due: IntArray, memory: dict[str, NDArray[Any]]
    ) -> Decisions:
        """Decide for robots ``due``; what a member answers is checked under its own name."""
        parts = []
        whose = self.member[due]
        for k, one in enumerate(self.members):
            mine = due[whose == k]
            if not len(mine):
                continue
            begin = f"{k}/"
            own = {key.removeprefix(begin): memory[key] for key in memory if key.startswith(begin)}
            found, _ = answered(self.begun[k][0], self.scene, one.declared, sensed, mine, own)
            memory |= {f"{begin}{name}": array for name, array in own.items()}
            report = np.full((len(mine), self.columns), np.nan)
            report[:, one.columns[:-1]] = found.report
            mode, rule = one.modes[found.mode], one.rules[found.rule]
            parts.append(found._replace(mode=mode, rule=rule, report=report))
        return merged(parts)


def merged(parts: Sequence[Decisions]) -> Decisions:
    """Rows of several answers as one, in the order of robots."""
    if len(parts) == 1:
        return parts[0]
    robot = np.concatenate([one.robot for one in parts])
    order = np.argsort(robot)
    rows = ("command", "hold", "mode", "rule", "report")
    joined = {name: np.concatenate([getattr(one, name) for one in parts])[order] for name in rows}
    counts = np.concatenate([np.diff(one.considered_start) for one in parts])
    first, counts = (np.cumsum(counts) - counts)[order], counts[order]
    start = np.concatenate(([0], np.cumsum(counts)))
    listed = np.arange(start[-1]) + np.repeat(first - start[:-1], counts)
    considered = np.concatenate([one.considered for one in parts])[listed]
    return Decisions(robot=robot[order], considered=considered, considered_start=start, **joined)


def _two_senses(
    word: str, one: Mode | Column, other: Mode | Column, driver: Driver
) -> ControllerError:
    return ControllerError(
        f'controller {driver.type} declares the {word} "{one.name}" as {one!r}, another '
        f"controller of this world as {other!r}; give it another name, or the same meaning"
    )


def _numbers(names: Iterable[str], among: Iterable[str]) -> IntArray:
    """Numbers of some names among others; at the end `NO_NUMBER`, which stays that."""
    known = list(among)
    return np.array([*(known.index(name) for name in names), NO_NUMBER])


def driving(
    world: World, own: Controller, name: str | None = None
) -> tuple[tuple[Controller, Driver], ...]:
    """Controllers of a world, each with its robots; ``own`` is the world's own.

    ``name`` is that of one in its place. Raises ControllerError for a controller of a robot that is
    not registered, and WorldError for its settings.
    """
    return tuple(
        (own, one) if one.is_own
        else (make_part(OF_ROBOTS, one.type, one.settings, where=one.where), one)
        for one in world.drivers(name)
    )  # fmt: skip


def united(drivers: Sequence[tuple[Controller, Driver]]) -> Controller:
    """What decides: the one controller that there is, or a `Team`. Raises as that."""
    return Team(drivers) if len(drivers) > 1 else drivers[0][0]
