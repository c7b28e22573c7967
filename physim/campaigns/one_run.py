"""One run of a campaign, from its spec to its row, in whatever process that is."""

from __future__ import annotations

import functools
import re
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

from physim._version import __version__
from physim.analysis.metrics import DEFINITIONS, Figures, Metric, Moment
from physim.analysis.metrics.distances import HORIZON, shortest_pair_collision_time
from physim.campaigns.pool import Stop, never
from physim.campaigns.rows import COLUMNS, ERROR, Row, installed
from physim.campaigns.sources import changed_source
from physim.campaigns.spec import RunSpec, engine
from physim.errors import PhysimError, WorldError
from physim.json_text import plain
from physim.parts.registry import made_controller
from physim.parts.user_code import broken_by
from physim.record import Record
from physim.simulation.loop import Simulation
from physim.simulation.run import record_run, simulate
from physim.world import World
from physim.world.file.loading import load_world, parse_world
from physim.world.layout.scene_builder import build_scene, reseeded
from physim.world.scene import Scene

METRICS = tuple(name for name in DEFINITIONS if name in COLUMNS)
"""Those that have a column of their name"""
KEEP = ("none", "failed", "all")
"""Which records are kept: those of no run, of runs that were not contact-free, of all"""
ADDRESS = re.compile(r"\b0x[0-9a-fA-F]{6,16}\b")
READY_WORLD, READY_SECONDS = "three_robots", 0.2
SCENES = 32
"""Worlds that a worker has ready at a time"""


class Taken(NamedTuple):
    """What is sent back of a run."""

    row: Row
    image: bytes | None = None
    """the record as a file, where it is to be kept and could not be written by the worker"""


def run_one(spec: RunSpec) -> Row:
    """Row of a run, done in this process. What fails in it is told in the row.

    Raises PhysimError for what is no run.
    """
    if not isinstance(spec, RunSpec):
        raise PhysimError(f"run_one takes a run, as spec_of(world, seed) gives it, not {spec!r}")
    taken = take(spec, "none", None)
    assert taken is not None
    return taken.row


def take(
    spec: RunSpec, keep: str, folder: Path | None, judged: bool = False, stop: Stop = never
) -> Taken | None:
    """Do a run; None when it was stopped. With ``judged`` it is validated, too.

    A record that is to be kept is written to ``folder``, as KEY.h5, or comes back as bytes where
    that is None.
    """
    began, cpu = time.perf_counter(), time.process_time()
    found: dict[str, Any] = {}
    image = None
    try:
        with record_run(simulation_of(spec), stop=stop) as record:
            if record.ended == "interrupted":
                return None
            if name := changed_source(spec.sources, _world(spec.text, spec.controller)):
                raise PhysimError(
                    f"{name}, which the run is made of, was changed since the runs were begun; a "
                    "file that runs write to must not be there when they begin"
                )
            found = figures(record) | {
                name: record.wall_clock.get(name) for name in ("decision_median", "decision_99")
            }
            if judged:
                from physim.analysis.validation import judge

                validation = judge(record, None)
                found |= {"verdict": validation.verdict, "unexplained": validation.unexplained}
            row = _row(spec, **found)
            if keep == "all" or (keep == "failed" and not row.contact_free):
                image = _keep(record, spec, folder)
                found |= {"record": f"records/{spec.key}.h5", "digest": record.digest()}
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        found = {**found, "ended": ERROR, "reason": one_line(error)}
    found["wall_seconds"] = time.perf_counter() - began
    # of a process that a controller began the clock starts anew
    found["cpu_seconds"] = max(0.0, time.process_time() - cpu)
    return Taken(_row(spec, **found), image)


@functools.cache
def ready() -> None:
    """Load into this process what runs need, by one that is thrown away."""
    world = load_world(READY_WORLD, overrides=[f"time.duration={READY_SECONDS}"])
    with simulate(world) as record:
        figures(record)


def row_without_run(spec: RunSpec, ended: str, reason: str) -> Row:
    """Row of a run of which nothing came back."""
    return _row(spec, ended=ended, reason=reason)


def simulation_of(spec: RunSpec) -> Simulation:
    """Simulation of a run, ready to begin. Raises PhysimError where it cannot be made."""
    try:
        scene = reseeded(_scene(spec.text, spec.controller), spec.seed)
    except WorldError:  # perhaps of the seed 0 alone
        scene = build_scene(_world(spec.text, spec.controller), spec.seed)
    return Simulation(scene, controller=made_controller(scene.world, trusted=True))


def _keep(record: Record, spec: RunSpec, folder: Path | None) -> bytes | None:
    """Save a record in a folder, or give it as the bytes of a file."""
    if folder is not None:
        record.save(folder / f"{spec.key}.h5")
        return None
    with tempfile.TemporaryDirectory() as place:
        file = Path(place) / "record.h5"
        record.save(file)
        return file.read_bytes()


def figures(record: Record) -> dict[str, Any]:
    """Columns of a row that come from the record. PhysimError where one's own metric fails."""
    run, names = Figures(record), [body.name for body in record.bodies]
    own = {name: Metric.of(what, run) for name, what in sorted(installed().definitions.items())}

    def pair(of: Metric | Moment | None) -> str:
        return "" if of is None else ", ".join(names[i] for i in of.bodies)

    meeting = shortest_pair_collision_time(record)
    soonest = HORIZON if meeting is None else meeting.value
    severest, collision, least = run.metric("closing_speed"), run.collision_time, run.least
    return {
        **{name: plain(run.value(name)) for name in METRICS},
        "ended": record.ended,
        "seconds": record.steps_run * record.dt,
        "robots": record.robots,
        "first_contact_pair": pair(run.metric("first_contact")),
        "severest_contact_pair": pair(severest),
        "severest_contact_time": None if severest is None else severest.time,
        "least_distance": None if least is None else plain(least.value),
        "least_distance_pair": pair(least),
        "least_distance_time": None if least is None else least.time,
        "shortest_collision_time_pair": pair(collision),
        "shortest_collision_time_time": None if collision is None else collision.time,
        "shortest_pair_collision_time": soonest if record.robots > 1 else None,
        "not_arrived": ", ".join(names[one.robot] for one in run.absent),
        "stood": ", ".join(names[one.robot] for one in run.absent if one.stands),
        "metrics": {name: float(one.value) for name, one in own.items() if one is not None},
    }


def one_line(error: BaseException) -> str:
    """An error on one line, the same in every process: without addresses in memory."""
    if isinstance(error, PhysimError):
        told = " ".join(str(error).split())[:500]
    else:
        told = broken_by(error)
    return ADDRESS.sub("0x...", told).encode(errors="replace").decode()


def _row(spec: RunSpec, **found: Any) -> Row:
    return Row(
        run=spec.key, world=spec.world, seed=spec.seed, settings=spec.settings,
        controller=spec.controller, physim=__version__, engine=engine(),
        world_hash=spec.world_hash, **found,
    )  # fmt: skip


@functools.lru_cache(maxsize=SCENES)
def _world(text: str, controller: str) -> World:
    own = controller if ":" in controller else None
    return parse_world(text, "world of the run", controller=own)


@functools.lru_cache(maxsize=SCENES)
def _scene(text: str, controller: str) -> Scene:
    """Scene of a world with the seed 0, of which those of other seeds are made."""
    return build_scene(_world(text, controller))
