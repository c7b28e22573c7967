"""How safe a run was, as one number, its signed swept clearance [m]; and who runs and judges worlds
for a search.

It is the least of three figures of a record: the shortest distance of two robots, and that of a
robot and a boundary or obstacle, over the samples of all physics steps, negative where shapes
overlap, by their depth; and minus the depth of every contact between two samples, by exact
geometry.

So it is at most 0 if and only if something touched, at a sample or between two: contacts between
samples are found without a miss, and the sign never errs. How deep a contact is the engine decides:
of runs with contacts the worse is that whose severest contact closed faster (`Judged.aim`). The
size may err to the high side, never to the low one. A gap that opens and closes within a step
without contact is that of the nearer sample: too large by at most half of what the two travel in
the step. The depth of a contact is that at its samples, after the engine has eased the two apart.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import TimeoutError
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from physim.analysis.metrics import Episode, Figures, Graze
from physim.campaigns.one_run import one_line, ready
from physim.campaigns.pool import POLL_SECONDS, Job, LostError, OverdueError, Stop, Workers, never
from physim.campaigns.spec import usual_limit
from physim.errors import WorldError
from physim.parts.declarations import NO_NUMBER
from physim.parts.registry import made_controller
from physim.record import Record
from physim.simulation.loop import Simulation
from physim.simulation.recorder import SaveAt
from physim.simulation.run import record_run
from physim.world import World
from physim.world.checks.check import check_world
from physim.world.file import parse_world

ROBOTS, MOVER, WALL = "robots", "mover", "wall"
"""Kinds of failure: two robots touch; a robot touches a mover or what can be pushed; a boundary or
an obstacle that stands."""
LEADS = (1 / 64, 1 / 32, 1 / 16, 1 / 8, 1 / 4, 1 / 2, 3 / 4)
"""[-] of the time until the first contact: so long before it is each of the moments kept"""
NEEDED = SaveAt(every=1, tables=("contacts", "updates"))  # severity is of single steps


class Moment(NamedTuple):
    """Where all robots were at a recorded sample."""

    time: float
    """[s]"""
    poses: tuple[tuple[float, float, float], ...]
    """[m, m, rad] of each robot"""


class Touched(NamedTuple):
    """The first contact of a run, at a sample or between two."""

    kind: str
    """`ROBOTS`, `MOVER` or `WALL`"""
    pair: tuple[str, str]
    """names of the two bodies"""
    time: float
    """[s] of the first sample in contact, or of the sample after a contact between two"""
    modes: tuple[str, str] = ("", "")
    """names of the modes in which the two were by their last decisions; "" where there is none"""


@dataclass(frozen=True)
class Judged:
    """What a run says about safety. One that broke off has a ``reason`` and no clearance."""

    clearance: float | None
    """[m] the signed swept clearance; None where the run broke off"""
    pair: tuple[str, str] = ("", "")
    """names of the two that came nearest, or overlapped most"""
    time: float = 0.0
    """[s] when they did"""
    touched: Touched | None = None
    """None where nothing touched"""
    reason: str = ""
    """why there was no run, or why it broke off: one line"""
    before: tuple[Moment, ...] = field(default=(), compare=False)
    """moments before the first contact, the last of them first"""
    closing: float = field(default=0.0, compare=False)
    """[m/s] closing speed of the severest contact; 0 without one, and of contacts between samples
    alone"""
    refused: bool = False
    """the world was no world that can be run; otherwise the run broke off"""

    @property
    def failed(self) -> bool:
        """Whether something touched."""
        return self.touched is not None

    @property
    def aim(self) -> float | None:
        """What a search makes least: the clearance [m]; of contacts, minus the closing speed [m/s].

        None where the run broke off.
        """
        return -self.closing if self.failed else self.clearance


Evaluate = Callable[[Sequence[World]], Iterable[Judged]]
"""Runs worlds and judges them, in their order. Whoever asks may look at the first few only. Raises
`StoppedError`."""
Accepts = Callable[[World], str]
"""The first error of a world; empty where there is none."""


class StoppedError(Exception):
    """The search was told to stop in the middle of a run."""


def judged(record: Record) -> Judged:
    """Judge a record that holds the contacts and extremes of a whole run."""
    run, names = Figures(record), [body.name for body in record.bodies]
    touches: list[Episode | Graze] = [*run.episodes, *run.grazes]
    near = (one for one in (run.nearest, run.nearest_wall) if one is not None)
    found = [(one.value, one.time, one.a, one.b or 0) for one in near]
    found += [(-one.depth, one.time, one.a, one.b) for one in run.grazes]
    # touching within the contact tolerance is touching, though the distance may be above 0
    found += [(0.0, one.time, one.a, one.b) for one in touches]
    if not found:
        return Judged(float("inf"))
    value, time, a, b = min(found)
    if not touches:
        return Judged(value, (names[a], names[b]), time)
    first = min(touches, key=lambda one: (one.step, one.a, one.b))
    other = MOVER if first.b < record.moving else WALL
    touched = Touched(
        ROBOTS if first.robots else other, (names[first.a], names[first.b]), first.time,
        (_mode(record, first.a, first.step), _mode(record, first.b, first.step)),
    )  # fmt: skip
    wanted = [first.step - max(1, round(share * first.step)) for share in LEADS]
    rows = np.searchsorted(record.steps, wanted, side="right") - 1
    before = tuple(
        Moment(
            at * record.dt,
            tuple((x, y, h) for x, y, h in record.pose_at(at)[: record.robots].tolist()),
        )
        for at in dict.fromkeys(record.steps[rows].tolist())
        if at > 0
    )
    closing = 0.0 if run.severest is None else run.severest[1].closing
    return Judged(value, (names[a], names[b]), time, touched, before=before, closing=closing)


def _mode(record: Record, body: int, step: int) -> str:
    """Name of the mode of a body's last decision before a step; "" where it made none."""
    rows = record.updates[: int(np.searchsorted(record.updates["step"], step))]
    mine = rows["mode"][rows["robot"] == body]
    return "" if not len(mine) or mine[-1] == NO_NUMBER else record.modes[mine[-1]].name


def judge_world(world: World, stop: Stop = never) -> Judged:
    """Run a world in this process and judge the run; raises StoppedError when ``stop`` says so."""
    try:
        simulation = Simulation(world, controller=made_controller(world, trusted=True))
        with record_run(simulation, save=NEEDED, stop=stop) as record:
            if record.ended == "interrupted":
                raise StoppedError
            return judged(record)
    except (StoppedError, KeyboardInterrupt):
        raise
    except BaseException as error:  # what a controller of one's own may raise
        return Judged(None, reason=one_line(error), refused=isinstance(error, WorldError))


def in_this_process(stop: Stop = never) -> Evaluate:
    """Evaluate worlds one after the other."""
    return lambda worlds: (judge_world(world, stop) for world in worlds)


def by_executor(executor: Workers, world: World, stop: Stop = never) -> Evaluate:
    """Evaluate worlds by some workers; a run that one of them does not survive, or
    that takes too long, is one that broke off. All have controller and stages of ``world``."""
    limit, code = usual_limit(world), world.controller.type

    def evaluate(worlds: Sequence[World]) -> Iterator[Judged]:
        texts = (one.to_yaml() for one in worlds)
        jobs = (Job("a run", judge_text, (text,), limit, ready, code) for text in texts)
        futures = [executor.begin(job) for job in jobs]
        try:
            for future in futures:
                while True:
                    try:
                        found: Judged | None = future.result(timeout=POLL_SECONDS)
                        break
                    except TimeoutError:
                        if stop():
                            raise StoppedError from None
                    except (LostError, OverdueError) as error:
                        found = Judged(None, reason=one_line(error))
                        break
                if found is None:
                    raise StoppedError
                yield found
        finally:
            for future in futures:
                future.cancel()

    return evaluate


def judge_text(text: str, stop: Stop = never) -> Judged | None:
    """Run a world that is given as text, in a worker; None when it was stopped."""
    try:
        return judge_world(parse_world(text, check_controller=False), stop)
    except StoppedError:
        return None


def accepted(controller: str | None = None) -> Accepts:
    """Ask the check; ``controller`` is the one that the command line named, if it did."""

    def accepts(world: World) -> str:
        with tempfile.TemporaryDirectory(prefix="physim-") as folder:
            file = Path(folder) / "world.yaml"
            world.save(file)
            errors = check_world(file, controller=controller).errors
        return errors[0].message if errors else ""

    return accepts
