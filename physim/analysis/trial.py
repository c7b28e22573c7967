"""A trial: a world is run once, within bounds, and what that shows of its robots is told as facts.

It runs the world's own controller, whichever that is: what checks of a file can only foretell, a
run shows. A world that would take long is not tried.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np

from physim.analysis.metrics import Figures
from physim.analysis.metrics.distances import nearest_points
from physim.errors import ControllerError, Fault, PhysimError, place_text, plural
from physim.geometry.polygon import circumscribed_radius
from physim.parts.registry import CONTROLLER, make_part
from physim.record import Record
from physim.simulation.arrival import still_distances, still_steps
from physim.simulation.loop import Simulation
from physim.simulation.run import is_warm, record_run
from physim.world import World
from physim.world.faults import describe
from physim.world.layout.scene_builder import build_scene
from physim.world.scene import Layout

MOST_STEPS = 100_000
"""Steps of a run that is tried, of ten robots at most as many: some 4 s"""
MOST_POINTS = 10_000
"""Points of walls of a world that is tried: reading more takes long enough"""
MOST_SECONDS = 10.0
"""[s] of the clock after which a trial ends: a controller of one's own may be slow"""
STANDSTILL = 10.0
"""[s] for which all robots stand when a trial ends: nothing more is expected of it"""
LATELY = 2.0
"""[s] before the end whose speed says how long a robot would need"""
FAR = 4.0
"""circumscribed radii from which on another robot is none of its concern"""
MOST_TOLD = 12
"""Contacts, and likewise robots that do not arrive, that are told one by one"""


@dataclass(frozen=True)
class Trial:
    """What became of a trial."""

    line: str
    """in short, or why there was none"""
    faults: tuple[Fault, ...] = ()
    """at the robots' paths: contacts in the order of time, then who does not arrive, those who
    lack most first; at the controller where that failed"""


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
    no more contacts than ``expect.contacts``.
    """
    if why := _too_long(world):
        return Trial(f"not tried: {why} take long; physim run shows if all arrive")
    if not is_warm():
        return Trial(
            "not tried: nothing is compiled yet; physim run does it, and shows if all arrive"
        )
    try:
        choice = world.controller
        controller = make_part(CONTROLLER, choice.type, choice.settings, trusted=trusted)
        simulation = Simulation(build_scene(world), controller=controller)
        ending = _Ending(simulation, stop)
        with record_run(simulation, stop=ending, progress=progress) as record:
            return _shown(simulation.scene.layout, record, ending)
    except ControllerError as error:
        return Trial("tried, not to the end", (Fault(("controller",), str(error)),))
    except PhysimError as error:  # as of a record too large for the memory
        return Trial(f"not tried: {error}")


def _too_long(world: World) -> str:
    """What makes a run of a world long; empty where it is not."""
    steps = round(world.time.duration / world.time.step)
    solids = [getattr(one, "outline", one) for one in world.obstacles or ()]
    points = sum(len(line) for line in (*(world.boundaries or ()), *solids))
    if points <= MOST_POINTS and steps * max(world.robot_count / 10.0, 1.0) <= MOST_STEPS:
        return ""
    walls = f" between walls of {points:,} points" if points > MOST_POINTS else ""
    return f"{steps:,} steps of {plural(world.robot_count, 'robot')}{walls}"


@dataclass
class _Ending:
    """Says when a trial ends before its run does, and ``why``."""

    simulation: Simulation
    stop: Callable[[], bool]
    why: str = ""
    is_cut: bool = False
    """by the clock: what robots would have done is not known"""

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
            self.is_cut = True
        return bool(self.why) or self.stop()


def _shown(laid: Layout, record: Record, ending: _Ending) -> Trial:
    """What a run shows, in short and of each robot."""
    run, expect = Figures(record), laid.world.expect
    count = len(run.episodes) + len(run.grazes)
    left = len(run.absent)
    do = "does" if left == 1 else "do"
    arrive = f"{left} of {plural(record.robots, 'robot')} {do} not arrive"
    if ending.is_cut:
        arrive = f"{left} of {plural(record.robots, 'robot')} under way"
    contacts = plural(count, "contact") if count else "no contact"
    line = (
        f"tried for {record.steps_run * record.dt:.1f} s{ending.why}: "
        f"{arrive if left else 'all robots arrive'}; {contacts}"
    )
    faults: list[Fault] = []
    if expect is None or expect.contacts is None or count > expect.contacts:
        faults += islice(_contacts(laid, record, run), MOST_TOLD)
    if not ending.is_cut and (expect is None or expect.finished is not False):
        faults += _absent(laid, record, run)
    return Trial(line, tuple(faults))


def _contacts(laid: Layout, record: Record, run: Figures) -> Iterator[Fault]:
    """Contacts in the order of time, each of a robot that no earlier one has told of."""
    told: set[int] = set()
    for one in sorted([*run.episodes, *run.grazes], key=lambda one: one.time):
        robots = {k for k in (one.a, one.b) if k < record.robots}
        if not robots <= told:
            told |= robots
            yield Fault(
                laid.path_entry(one.a),
                f"{describe(record.names[one.a])} touches {describe(record.bodies[one.b].name)} "
                f"at {place_text(*one.place, 4)} after {one.time:.1f} s",
            )


def _absent(laid: Layout, record: Record, run: Figures) -> Iterator[Fault]:
    """Robots that do not arrive, what is nearest to each, and who of the others is.

    It waits for a robot that its controller considered in its last decision. Of one that is under
    way when the time is over, how long it would need.
    """
    pose, rows, robots = np.asarray(record.pose[-1]), record.considered, record.robots
    back = max(len(record.pose) - 1 - round(LATELY / (record.dt * record.record_every)), 0)
    lately = (len(record.pose) - 1 - back) * record.dt * record.record_every
    for late in sorted(run.absent, key=lambda late: -late.short)[:MOST_TOLD]:
        i = late.robot
        said = late.sentence(describe(record.names[i]))
        speed = float(np.hypot(*(pose[i, :2] - record.pose[back, i, :2]))) / max(lately, record.dt)
        is_over = record.steps_run == laid.world.time.steps
        if is_over and not late.stands and late.short > 0.0 and speed * LATELY > late.tolerance:
            said += f"; time.duration is over, and it needs about {late.short / speed:.0f} s more"
        elif len(record.bodies) > 1:
            away = {
                k: float(np.hypot(*np.diff(nearest_points(record, i, k, pose), axis=0)[0]))
                for k in range(len(record.bodies))
                if k != i
            }
            mine = rows[rows["robot"] == i]
            last = mine["other"][mine["step"] == mine["step"].max(initial=-1)]
            nearest = min(away, key=away.__getitem__)
            others = [k for k in away if k < robots]
            near = dict.fromkeys([nearest, *sorted(others, key=away.__getitem__)[:1]])
            far = FAR * circumscribed_radius(laid.footprints[i])
            told = [
                f"{'it waits for' if k in last else 'nearest to it is' if k == nearest else 'then'}"
                f" {describe(record.bodies[k].name)}, {away[k]:.2f} m away"
                for k in near
                if k == nearest or k in last or away[k] < far
            ]
            said += f"; {', '.join(told)}"
        yield Fault(laid.path_entry(i), said)
