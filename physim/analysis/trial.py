"""A trial: a world is run once, within bounds, and what that shows of its robots is told as facts.

It runs the world's own controller, whichever that is: what checks of a file can only foretell, a
run shows. A world that would take long is not tried.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from physim.analysis.metrics import Figures
from physim.analysis.metrics.contacts import Touch
from physim.analysis.metrics.walls import nearest_points
from physim.errors import Fault, Location, place_text, plural
from physim.parts.registry import CONTROLLER, make_part
from physim.record import Record
from physim.simulation.arrival import still_distances, still_steps
from physim.simulation.loop import Simulation
from physim.simulation.run import is_warm, record_run
from physim.world import World
from physim.world.faults import describe
from physim.world.layout.scene_builder import build_scene
from physim.world.scene import path_location

MOST_STEPS = 100_000
"""Steps of a run that is tried, of ten robots at most as many: some 4 s"""
MOST_POINTS = 10_000
"""Points of walls of a world that is tried: reading more takes long enough"""
MOST_SECONDS = 10.0
"""[s] of the clock after which a trial ends: a controller of one's own may be slow"""
STANDSTILL = 10.0
"""[s] for which all robots stand when a trial ends: nothing more is expected of it"""


@dataclass(frozen=True)
class Fact:
    """What a trial shows of one robot: that it touches a body, or does not arrive, or both."""

    location: Location
    """where the path of the robot is written"""
    message: str
    robot: str
    touches: str | None = None
    """the body that it touches first"""
    time: float | None = None
    """[s] when"""
    place: tuple[float, float] | None = None
    """[m] where"""
    short: float | None = None
    """[m] along its path that it lacks to its stop station when the trial ends"""
    nearest: str | None = None
    """the body nearest to it then, where it stands short of its stop"""
    distance: float | None = None
    """[m] to that body"""
    waits: bool = False
    """whether that body is a robot which its controller considered in its last decision"""

    @property
    def fault(self) -> Fault:
        """The fact as checks have theirs."""
        return Fault(self.location, self.message)

    def as_json(self) -> dict[str, Any]:
        """Return the figures as JSON holds them; location and message stand in its finding."""
        return {k: v for k, v in vars(self).items() if k not in ("location", "message")}


@dataclass(frozen=True)
class Trial:
    """What became of a trial."""

    line: str
    """in short, or why there was none"""
    facts: tuple[Fact, ...] = ()
    """at most one a robot: contacts in the order of time, then those who do not arrive, those who
    lack most first"""


def try_world(
    world: World,
    *,
    trusted: bool = False,
    stop: Callable[[], bool] = lambda: False,
    progress: Callable[[Simulation, float], None] | None = None,
) -> Trial:
    """Run a world as `physim run` does, until all arrive, all stand, or its duration is over.

    ``trusted`` allows its controller to be ``module:Class``; when ``stop`` says True it ends. What
    the world expects is not told: robots that do not arrive under ``expect.finished: false``, and
    no more contacts than ``expect.contacts``. Raises PhysimError as a run does.
    """
    if why := _too_long(world):
        return Trial(f"not tried: {why} take long; physim run shows if all arrive")
    if not is_warm():
        return Trial(
            "not tried: nothing is compiled yet; physim run does it, and shows if all arrive"
        )
    controller = make_part(
        CONTROLLER, world.controller.type, world.controller.settings, trusted=trusted
    )
    simulation = Simulation(build_scene(world), controller=controller)
    ending = _Ending(simulation, stop)
    with record_run(simulation, stop=ending, progress=progress) as record:
        return _shown(world, record, ending.why)


def _too_long(world: World) -> str:
    """What makes a run of a world long; empty where it is not."""
    steps = round(world.time.duration / world.time.step)
    solids = [getattr(one, "outline", one) for one in world.obstacles or ()]
    points = sum(len(line) for line in (*(world.boundaries or ()), *solids))
    if points <= MOST_POINTS and steps * max(len(world.robots) / 10.0, 1.0) <= MOST_STEPS:
        return ""
    walls = f" between walls of {points:,} points" if points > MOST_POINTS else ""
    return f"{steps:,} steps of {plural(len(world.robots), 'robot')}{walls}"


@dataclass
class _Ending:
    """Says when a trial ends before its run does, and ``why``."""

    simulation: Simulation
    stop: Callable[[], bool]
    why: str = ""

    def __post_init__(self) -> None:
        self.until = time.perf_counter() + MOST_SECONDS
        self.every = still_steps(self.simulation.scene.dt)
        self.pose, self.since = self.simulation.pose, 0.0
        self.near = still_distances(self.simulation.scene.shapes.radius[: len(self.pose)])[:, None]

    def __call__(self) -> bool:
        if self.simulation.step_number % self.every:
            return self.stop()
        now, pose = self.simulation.time, self.simulation.pose
        if (np.abs(pose - self.pose) > self.near).any():
            self.pose, self.since = pose, now
        if now - self.since >= STANDSTILL:
            self.why = f", the last {STANDSTILL:g} s of which all robots stand"
        elif time.perf_counter() > self.until:
            self.why = f" of {self.simulation.scene.world.time.duration:g} s, as it takes long"
        return bool(self.why) or self.stop()


def _shown(world: World, record: Record, why: str) -> Trial:
    """What a run shows, in short and of each robot."""
    run, expect = Figures(record), world.expect
    met: list[Touch] = sorted([*run.episodes, *run.grazes], key=lambda one: one.time)
    left = len(run.absent)
    do = "does" if left == 1 else "do"
    arrive = f"{left} of {plural(record.robots, 'robot')} {do} not arrive"
    contacts = plural(len(met), "contact") if met else "no contact"
    line = (
        f"tried for {record.steps_run * record.dt:.1f} s{why}: "
        f"{arrive if left else 'all robots arrive'}; {contacts}"
    )
    facts: dict[int, Fact] = {}
    if expect is None or expect.contacts is None or len(met) > expect.contacts:
        firsts = {(one.a, one.b): one for one in reversed(met)}  # of each pair
        for one in sorted(firsts.values(), key=lambda one: one.time):
            free = [k for k in (one.a, one.b) if k < record.robots and k not in facts]
            if free:
                facts[free[0]] = _contact(world, record, one, free[0])
    if expect is None or expect.finished is not False:
        for late in sorted(run.absent, key=lambda late: -late.short):
            i = late.robot
            name = describe(record.names[i])
            near = _nearest(record, i) if late.stands else {}
            said = late.sentence(name)
            if near:
                how = "it waits for" if near["waits"] else "nearest to it is"
                said += f"; {how} {describe(near['nearest'])}, {near['distance']:.2f} m away"
            known = facts.get(i)
            facts[i] = (
                Fact(path_location(world, i), said, record.names[i], short=late.short, **near)
                if known is None
                else replace(known, message=f"{known.message}; {said}", short=late.short, **near)
            )
    return Trial(line, tuple(facts.values()))


def _contact(world: World, record: Record, one: Touch, robot: int) -> Fact:
    """The first contact of a robot."""
    name, other = record.names[robot], record.bodies[one.a + one.b - robot].name
    said = (
        f"{describe(name)} touches {describe(other)} at {place_text(*one.place, 4)} after "
        f"{one.time:.1f} s"
    )
    return Fact(path_location(world, robot), said, name, other, one.time, one.place)


def _nearest(record: Record, robot: int) -> dict[str, Any]:
    """Body nearest to a robot at the end, how far it is, and whether the robot waits for it."""
    pose = np.asarray(record.pose[-1])
    apart = {
        k: float(np.hypot(*np.diff(nearest_points(record, robot, k, pose), axis=0)[0]))
        for k in range(len(record.bodies))
        if k != robot
    }
    if not apart:
        return {}
    nearest = min(apart, key=lambda k: apart[k])
    rows = record.considered
    mine = rows[rows["robot"] == robot]
    considered = mine["other"][mine["step"] == mine["step"].max(initial=-1)]
    return {
        "nearest": record.bodies[nearest].name,
        "distance": apart[nearest],
        "waits": bool(nearest in considered),
    }
