"""Check that a controller keeps to the rules: `check_controller`.

It is made anew as often as a rule needs it, and tried in worlds and in `situations`: small worlds
in which a robot meets what it seldom meets.
"""

from __future__ import annotations

import copy
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import Any

import numpy as np

from physim.errors import ControllerError, PhysimError, WorldError, plural
from physim.parts.controller import Controller, DecidesAll
from physim.parts.registry import CONTROLLER, checked_settings, find_part, made_part
from physim.parts.user_code import place_of
from physim.parts.world_checks import drive_faults, robot_faults
from physim.simulation.forms import per_robot
from physim.testing.rules import Finding, FindingLog, check_all, check_one_by_one
from physim.testing.trial import Make, method_of, run_trial
from physim.world import World
from physim.world.file import load_world, parse_world, read_world
from physim.world.file.files import shipped_worlds
from physim.world.layout.scene_builder import build_scene
from physim.world.scene import Scene


@dataclass(frozen=True)
class Candidate:
    """A controller by its class and settings, or by an object that is copied."""

    name: str
    kind: type[Any]
    settings: Mapping[str, Any] | None
    """None: those of a world that has this controller, else the controller's own"""
    given: Controller | None
    """the object; it is never asked itself"""

    def maker(self, world: World | None = None) -> Make:
        """How to make it for a world.

        Raises ControllerError where it cannot be made or copied, WorldError with a fault for each
        setting that is wrong.
        """
        if self.given is not None:
            original = _copy(self.given, self.name)
            return lambda: _copy(original, self.name)
        settings = self.settings
        if settings is None:
            settings = world.controller.settings if world and self._is_in(world) else {}
        made, faults = checked_settings(self.kind, settings, CONTROLLER.key)
        if faults:
            raise WorldError(faults)

        def make() -> Controller:
            controller: Controller = made_part(CONTROLLER, self.kind, made, self.name)
            return controller

        return make

    def _is_in(self, world: World) -> bool:
        """Whether it is the world's own controller: settings without a type are anybody's."""
        choice, name = world.controller, world.controller.type
        if choice.settings and "type" not in choice.model_fields_set:
            return True
        if ":" in name:
            return name in (self.name, f"{self.kind.__module__}:{self.kind.__qualname__}")
        try:
            return self.kind is find_part(CONTROLLER, name)
        except ControllerError:
            return False


def candidate(
    controller: type[Any] | Controller | str, settings: Mapping[str, Any] | None
) -> Candidate:
    """Take a class, an object, a registered name or ``module:Class``. Raises ControllerError."""
    if isinstance(controller, str):
        return Candidate(
            controller, find_part(CONTROLLER, controller, trusted=True), settings, None
        )
    kind = controller if isinstance(controller, type) else type(controller)
    if lacking := CONTROLLER.lacking(controller):
        raise ControllerError(f"{kind.__name__} has no method {lacking}{place_of(kind)}")
    if isinstance(controller, type):
        return Candidate(kind.__name__, kind, settings, None)
    if settings is not None:
        raise ControllerError(
            f"settings go with a class or a name; the {kind.__name__} given is made already"
        )
    return Candidate(kind.__name__, kind, None, controller)


def _copy(controller: Controller, name: str) -> Controller:
    try:
        return copy.deepcopy(controller)
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        reason = " ".join(str(error).split())[:200]
        raise ControllerError(
            f"the {name} given cannot be copied ({type(error).__name__}: {reason}); give its class"
        ) from error


WorldLike = World | str | os.PathLike[str]
"""A world, its file, or the name of a shipped one."""
SECONDS = 2.0
"""[s] of each world, unless asked otherwise"""
MOST_ROBOTS = 100
"""Robots of the largest world tried unasked: each is asked seven times for every decision"""

HEAD = "{{name: situation, time: {{step: 0.02, duration: 60.0}}, {}}}"

SITUATIONS = {
    "nobody in sight": """
        corridor: {centreline: [[0, 0], [60, 0]], width: 8},
        robots: [
          {name: a, footprint: {length: 1.8, width: 1.0}, pose: [40, 1, 0.2], path: {offset: 0}},
          {name: b, footprint: {length: 1.8, width: 1.0}, pose: [5, -1, 0], path: {offset: 0}}],
        formation: {range: 10}""",
    "no wall in sight": """
        corridor: {centreline: [[0, 0], [60, 0]], width: 60, end_margin: 20},
        robots: [
          {name: a, footprint: {length: 1.8, width: 1.0}, pose: [24, 1, 0], path: {offset: 1}},
          {name: b, footprint: {length: 1.4, width: 1.2}, pose: [20, 0, 0.5], path: {offset: 0}},
          {name: alone, footprint: {length: 1.8, width: 1.0}, pose: [45, 0, 0], path: {offset: 0}}],
        formation: {range: 6}""",
    "at the end of the path": """
        corridor: {centreline: [[0, 0], [40, 0]], width: 10},
        robots: [
          {name: at, footprint: {length: 1.8, width: 1.0}, pose: [20, 2, 0],
           path: [[0, 2], [20, 2]]},
          {name: past, footprint: {length: 1.8, width: 1.0}, pose: [23, 0, 0.5],
           path: [[0, 0], [20, 0]]},
          {name: before, footprint: {length: 1.8, width: 1.0}, pose: [19.4, -2, 0],
           path: [[0, -2], [20, -2]]}]""",
    "facing backwards": """
        corridor: {centreline: [[0, 0], [40, 0]], width: 10},
        robots: [
          {name: back, footprint: {length: 1.8, width: 1.0}, pose: [20, 2, 3.141592653589793],
           path: {offset: 2}},
          {name: right, footprint: [[0.9, 0], [-0.9, 0.5], [-0.5, 0], [-0.9, -0.5]],
           pose: [16, 0, -1.5707963267948966], path: {offset: 0}},
          {name: askew, footprint: {length: 1.8, width: 1.0}, pose: [14, -2, 2.6],
           path: {offset: -2}}],
        formation: {range: 10}""",
    "overlapping": """
        corridor: {centreline: [[0, 0], [40, 0]], width: 8},
        robots: [
          {name: a, footprint: {length: 1.8, width: 1.0}, pose: [12, 0, 0], path: {offset: 0}},
          {name: b, footprint: {length: 1.4, width: 1.2}, pose: [9, 0, 0.4], path: {offset: 0}},
          {name: in_wall, footprint: {length: 1.8, width: 1.0}, pose: [20, 2, 0],
           path: {offset: 2}}],
        formation: {range: 10}""",
}  # fmt: skip
"""Small worlds in which a robot meets what it seldom meets, each named after what it starts with:
corridor, robots and formation, as a world file writes them."""

OVERLAPPING = ((1, (11.2, 0.3, 0.4)), (2, (20.0, 3.8, 0.2)))
"""Start poses that no world may have: robot and pose [m, m, rad]."""


def situations() -> dict[str, Scene]:
    """Scenes by name; ``Simulation(scene, controller=MyController())`` runs one."""
    scenes = {
        name: build_scene(parse_world(HEAD.format(text))) for name, text in SITUATIONS.items()
    }
    overlapping = scenes["overlapping"]
    start = np.array(overlapping.start)
    for i, pose in OVERLAPPING:
        start[i] = pose
    return {**scenes, "overlapping": replace(overlapping, start=start)}


@dataclass(frozen=True)
class WorldResult:
    """What was found in one world."""

    world: str
    situation: bool
    """whether it is one of `situations` rather than a world asked for"""
    decisions: int
    findings: tuple[Finding, ...]
    skipped: str = ""
    """why the controller was not tried: what it says of the robots; empty where it was"""

    def as_json(self) -> dict[str, Any]:
        """Return the result as JSON holds it, without its findings."""
        return {
            "world": self.world,
            "situation": self.situation,
            "decisions": self.decisions,
            "skipped": self.skipped or None,
        }

    def lines(self) -> list[str]:
        """A line a finding, or one that says why there can be none."""
        return (
            [f"skipped: {self.world}: {self.skipped}"]
            if self.skipped
            else [*map(str, self.findings)]
        )


def check_controller(
    controller: type[Any] | Controller | str,
    *,
    worlds: Sequence[WorldLike] | None = None,
    seconds: float = SECONDS,
    settings: Mapping[str, Any] | None = None,
    report: Callable[[str], object] = print,
) -> list[Finding]:
    """Check that a controller keeps to every `Rule`, so that its runs mean what they show.

    In a test of your own: ``assert not check_controller(MyController)``.

    It decides for the first ``seconds`` of every world, and in the `situations` of this package:
    nobody or no wall in sight, at the end of the path, facing backwards, overlapping others. Then
    it is asked for the same decisions again: by new instances, in other orders, from copies of its
    memory, about seven times in all. `decide_all` is asked for all at once, and with what each may
    know alone; where there is `decide` too they have to agree, bit for bit or within ``agreement``.

    ``controller`` is a class, an object (it is copied, never asked itself), a registered name or
    ``module:Class``. ``worlds`` are worlds, files or names, without it all shipped ones
    of at most `MOST_ROBOTS` robots.
    ``settings`` are checked as those in a world file; without them a world's own count where the
    controller is its own.

    Returns one finding for each rule and world: the first, with the number of others like it.
    ``report`` gets each as a line, and a line for each world whose robots the controller refuses
    (`robot_faults`), in which it is not tried.

    Raises ControllerError where the controller cannot be made or suits no world given, WorldError
    for worlds or settings that are wrong.
    """
    found: list[Finding] = []
    chosen = candidate(controller, settings)
    for part in check_worlds(chosen, worlds, seconds):
        for line in part.lines():
            report(line)
        found += part.findings
    return found


def worlds_to_try(worlds: Sequence[WorldLike] | None) -> list[WorldLike]:
    """Worlds to be tried: those given, else all shipped of at most `MOST_ROBOTS` robots."""
    if worlds is None:
        return [one for one in shipped_worlds() if load_world(one).robot_count <= MOST_ROBOTS]
    return [worlds] if isinstance(worlds, World | str | os.PathLike) else list(worlds)


def check_worlds(
    chosen: Candidate,
    worlds: Sequence[WorldLike] | None,
    seconds: float = SECONDS,
    begins: Callable[[str], object] = lambda name: None,
) -> Iterator[WorldResult]:
    """Try a controller in one world after the other, then in each situation.

    ``begins`` gets the name of each before it is tried. Raises as `check_controller` does.
    """
    if not (isfinite(seconds) and seconds > 0.0):
        raise PhysimError(f"seconds = {seconds:g}; it must be a time greater than 0 s")
    tried, refusal = False, ""
    given = worlds_to_try(worlds)
    for one in given:
        # whatever controller a file names is not made, but for this one
        world = one if isinstance(one, World) else read_world(one, check_controller=False)[0]
        if any(entry.controller for entry in world.robots):  # it drives them all
            alike = (entry.model_copy(update={"controller": None}) for entry in world.robots)
            world = world.model_copy(update={"robots": tuple(alike)})
        name = world.name if isinstance(one, World) else str(one)
        begins(name)
        part = _check_scene(name, build_scene(world), chosen.maker(world), seconds)
        tried = tried or not part.skipped
        refusal = refusal or part.skipped
        yield part
    if given and not tried:
        raise ControllerError(
            f"{chosen.name} suits the robots of none of {plural(len(given), 'world')}, so nothing "
            f"could be checked: {refusal}"
        )
    make = chosen.maker()
    for name, scene in situations().items():
        begins(name)
        yield replace(_check_scene(name, scene, make, seconds), situation=True)


def _check_scene(name: str, scene: Scene, make: Make, seconds: float) -> WorldResult:
    """Try a controller in one world."""
    controller = make()
    own = scene.layout
    faults = [
        one for by in scene.world.drivers() for one in drive_faults(controller, own.world, by)
    ]
    if faults := faults or robot_faults(controller, own.robots, own.entries):
        more = f" (and {len(faults) - 1} more)" if len(faults) > 1 else ""
        return WorldResult(name, False, 0, (), f"{faults[0]}{more}")
    plain = per_robot(controller)
    found = FindingLog(name, place_of(method_of(plain)).strip(" ()"))
    trial = run_trial(scene, plain, seconds)
    check_one_by_one(trial, plain, lambda: per_robot(make()), found)
    another = make()
    if isinstance(another, DecidesAll):
        check_all(trial, another, found)
    return WorldResult(name, False, len(trial.asked), found.findings())
