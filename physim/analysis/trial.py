"""A trial: a world is run once, within bounds, and what that shows of its robots is told as facts.

It runs the world's own controller, whichever that is: what checks of a file can only foretell, a
run shows. A world that would take long is not tried.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
import shapely
from shapely.ops import substring

from physim.analysis.metrics import Absent, Figures
from physim.analysis.metrics.distances import nearest_points
from physim.analysis.metrics.progress import LATELY, LITTLE
from physim.errors import ControllerError, Fault, PhysimError, dotted, place_text, plural
from physim.geometry.polygon import circumscribed_radius
from physim.parts.declarations import kept_from_walls
from physim.parts.registry import made_controller
from physim.record import Record
from physim.simulation.arrival import still_distances, still_steps
from physim.simulation.loop import Simulation
from physim.simulation.run import record_run
from physim.world.checks.room import inscribed_radius
from physim.world.faults import describe
from physim.world.layout.scene_builder import scene_of
from physim.world.scene import Layout

MOST_STEPS = 100_000
"""Steps of a run that is tried, of ten robots at most as many: some 4 s"""
MOST_POINTS = 10_000
"""Points of walls of a world that is tried: reading more takes long enough"""
MOST_SECONDS = 10.0
"""[s] of the clock after which a trial ends: a controller of one's own may be slow"""
STANDSTILL = 10.0
"""[s] for which all robots stand when a trial ends: nothing more is expected of it"""
FAR = 4.0
"""circumscribed radii from which on another robot is none of its concern"""
Kept = dict[int, tuple[str, float]]
"""By robot the setting that keeps it from walls, and how far [m]"""
MOST_TOLD = 12
"""Contacts, and likewise robots that do not arrive, that are told one by one"""


@dataclass(frozen=True)
class Trial:
    """What became of a trial."""

    line: str
    """in short, or why there was none"""
    faults: tuple[Fault, ...] = ()
    """warnings at the robots' paths: contacts in the order of time, then who does not arrive, those
    who lack most first; or an error at the controller, where that failed"""


def try_world(
    laid: Layout,
    *,
    trusted: bool = False,
    stop: Callable[[], bool] = lambda: False,
    progress: Callable[[Simulation, float], None] | None = None,
) -> Trial:
    """Run a world that is laid out as `physim run` does, until all arrive or stand, or it is over.

    ``trusted`` allows its controller to be ``module:Class``; when ``stop`` says True it ends. What
    the world expects is not told: robots that do not arrive under ``expect.finished: false``, and
    no more contacts than ``expect.contacts``.
    """
    if why := _too_long(laid):
        return Trial(f"not tried: {why} take long; physim run shows if all arrive")
    try:
        controller = made_controller(laid.world, trusted)
        simulation = Simulation(scene_of(laid), controller=controller)
        ending = _Ending(simulation, stop)
        with record_run(simulation, stop=ending, progress=progress) as record:
            kept = {
                i: (dotted((*driver.where, name)), distance)
                for one, driver in simulation.parts.driving
                for name, distance in [kept_from_walls(one)]
                for i in driver.robots
            }
            return _shown(laid, record, ending, kept)
    except ControllerError as error:
        return Trial("tried, not to the end", (Fault(("controller",), str(error)),))
    except PhysimError as error:  # as of a record too large for the memory
        return Trial(f"not tried: {error}")


def _too_long(laid: Layout) -> str:
    """What makes a run of a world long; empty where it is not."""
    steps, robots = laid.world.time.steps, len(laid.robots)
    points = sum(map(len, (*laid.boundaries.values(), *laid.obstacles)))
    if points <= MOST_POINTS and steps * max(robots / 10.0, 1.0) <= MOST_STEPS:
        return ""
    walls = f" between walls of {points:,} points" if points > MOST_POINTS else ""
    return f"{steps:,} steps of {plural(robots, 'robot')}{walls}"


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


def _shown(laid: Layout, record: Record, ending: _Ending, kept: Kept) -> Trial:
    """What a run shows, in short and of each robot."""
    run, expect = Figures(record), laid.world.expect
    count, left = len(run.episodes) + len(run.grazes), len(run.absent)
    said = "all robots arrive"
    if left:
        do = "under way" if ending.is_cut else f"{'does' if left == 1 else 'do'} not arrive"
        said = f"{left} of {plural(record.robots, 'robot')} {do}"
    contacts = plural(count, "contact") if count else "no contact"
    line = f"tried for {record.steps_run * record.dt:.1f} s{ending.why}: {said}; {contacts}"
    faults: list[Fault] = []
    if expect is None or expect.contacts is None or count > expect.contacts:
        faults += islice(_contacts(laid, record, run), MOST_TOLD)
    if not ending.is_cut and (expect is None or expect.finished is not False):
        for late in sorted(run.absent, key=lambda late: -late.short)[:MOST_TOLD]:
            said = late.sentence(describe(record.names[late.robot]))
            said += _what_keeps(laid, record, late, *kept[late.robot])
            faults.append(Fault(laid.path_entry(late.robot), said))
    return Trial(line, tuple(replace(one, severity="warning") for one in faults))


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


def _what_keeps(laid: Layout, record: Record, late: Absent, by: str, kept: float) -> str:
    """How long a robot would need that is under way as the time is over; else what is near it.

    It waits for a robot that its controller considered in its last decision. A wall that is nearest
    may be one that it is ``kept`` [m] from ``by`` a setting of its controller, on the way ahead.
    """
    i, pose = late.robot, np.asarray(record.moving_pose[-1])
    is_over = record.steps_run == laid.world.time.steps
    if is_over and not late.stands and late.short > 0.0 and LITTLE <= late.pace * LATELY < np.inf:
        needs = math.ceil(late.short / late.pace)
        return f"; time.duration ends too early, it needs about {needs} s more"
    away = {
        k: float(np.hypot(*np.diff(nearest_points(record, i, k, pose), axis=0)[0]))
        for k in range(len(record.bodies))
        if k != i
    }
    mine = record.considered[record.considered["robot"] == i]
    last = mine["other"][mine["step"] == mine["step"].max(initial=-1)]
    near = sorted(away, key=away.__getitem__)
    far = FAR * circumscribed_radius(laid.footprints[i])
    told: list[str] = []
    for k in dict.fromkeys([*near[:1], *[k for k in near if k < record.robots][:1]]):
        if k == near[0] or k in last or away[k] < far:
            who = "it waits for" if k in last else "nearest is" if not told else "then"
            told.append(f"{who} {describe(record.bodies[k].name)}, {away[k]:.2f} m away")
    said = f"; {', '.join(told)}"
    if near[0] >= record.moving:
        line, stop = shapely.LineString(laid.paths[i]), float(record.stop_station[i])
        ahead = substring(line, max(stop - late.short, 0.0), stop)
        room = min(ahead.distance(one) for _, one in (*laid.walls, *laid.solids))
        room -= inscribed_radius(laid.footprints[i])
        if room >= 0.0 and round(room, 2) < kept:
            said += (
                f"; the way ahead leaves {room:.2f} m beside it, but its controller keeps "
                f"{kept:g} m away from walls ({by})"
            )
    return said
