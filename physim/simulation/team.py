"""Several controllers in one run, each for its own robots: a `Team` is one controller of them all.

What its members declare is united: modes and columns of one name must mean the same, since pictures
and tables show them together; a rule is its controller's own, and one of a name that another uses
in another sense is called by its member's number, as ``path_following_2``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from physim.errors import ControllerError
from physim.geometry.shapes import IntArray
from physim.parts.controller import Controller, Decisions
from physim.parts.declarations import (
    NO_NUMBER,
    STANDARD_COLUMNS,
    Column,
    Mode,
    Rule,
    kept_distance,
)
from physim.parts.registry import OF_ROBOTS, make_part
from physim.simulation.decisions import Asked, answered
from physim.simulation.forms import Memory, first_memory
from physim.simulation.observation import View
from physim.world import World
from physim.world.group import Driver
from physim.world.scene import Scene

STANDARD = frozenset(column.name for column in STANDARD_COLUMNS)
"""Columns whose meaning is fixed, however a controller words it."""


class Member(NamedTuple):
    """A controller and the robots that it drives."""

    asked: Asked
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
        self.member_of: dict[int, int] = {}
        """the member that drives each robot"""
        for k, (controller, driver) in enumerate(drivers):
            asked = Asked.of(controller)
            own = asked.declared
            self.member_of |= dict.fromkeys(driver.robots, k)
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
                    asked, _numbers((one.name for one in own.modes), modes),
                    _numbers(called, rules), _numbers((one.name for one in own.columns), columns),
                )
            )  # fmt: skip
        self.modes, self.rules = tuple(modes.values()), tuple(rules.values())
        self.columns = tuple(columns.values())
        farthest = max((one for one, _ in drivers), key=kept_distance)
        self.settings = getattr(farthest, "settings", None)
        """of who keeps farthest from walls: pictures show the safe area by them"""

    def start(self, scene: Scene) -> Memory:
        """Memories of all members, each under the number of the member and its own name."""
        found = ((k, first_memory(one.asked.form, scene)) for k, one in enumerate(self.members))
        return {f"{k}/{name}": array for k, own in found for name, array in own.items()}

    def decide_all(self, view: View, due: IntArray, memory: Memory) -> Decisions:
        """Decide for robots ``due``; what a member answers is checked under its own name."""
        parts = []
        whose = np.array([self.member_of[i] for i in due.tolist()])
        for k, one in enumerate(self.members):
            mine = due[whose == k]
            if not len(mine):
                continue
            begin = f"{k}/"
            own = {key.removeprefix(begin): memory[key] for key in memory if key.startswith(begin)}
            found, _ = answered(one.asked, view, mine, own)
            memory |= {f"{begin}{name}": array for name, array in own.items()}
            report = np.full((len(mine), len(self.columns)), np.nan)
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
