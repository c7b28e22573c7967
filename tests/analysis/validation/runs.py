"""Small runs for the tests of validation, of robots that drive without looking; and forged ones."""

from __future__ import annotations

import re
from pathlib import Path

import h5py
import numpy as np

import physim
from physim import Decision, Simulation
from physim.analysis.validation import validate
from physim.simulation.engine import Physics
from tests.helpers import facts, inside

record_run = inside("physim.simulation", "record_run")

LANE = """\
name: lane
seed: 1
time: {step: 0.01, duration: 3.0}
corridor: {centreline: [[0, 0], [30, 0]], width: 8.0}
robots:
  - {name: slow, footprint: {length: 1.8, width: 1.0}, pose: [8.0, 0.0, 0.0], path: {offset: 0.0}}
  - {name: fast, footprint: [[1.0, 0.0], [-0.7, 0.55], [-0.3, 0.0], [-0.7, -0.55]],
     pose: [4.6, -1.0, 0.0], path: {offset: 0.0}}
"""

SIDE_BY_SIDE = """\
name: side by side
time: {step: 0.05, duration: 10.0}
boundaries: [[[-90, -90], [90, -90], [90, 90], [-90, 90], [-90, -90]]]
reference_path: [[-60, 0], [60, 0]]
robots:
  - {name: left, footprint: {length: 1.0, width: 0.6}, pose: POSE_0, path: [[-60, 0], [60, 0]]}
  - {name: right, footprint: {length: 1.0, width: 0.6}, pose: POSE_1, path: [[-60, 0], [60, 0]]}
"""


class Drivers:
    """Each robot holds its own command, decided anew every 0.1 s, and looks at nothing."""

    def __init__(self, *commands: tuple[float, float]) -> None:
        self.commands = commands

    def decide(self, observation, memory):
        v, omega = self.commands[observation.index]
        return Decision(v=v, omega=omega, hold=0.1)


DRIVERS = f"{__name__}:Drivers"
"""their name in a record"""


class Careless(Drivers):
    """As on the command line: module:Class."""

    def __init__(self) -> None:
        super().__init__((0.5, 0.0), (1.4, 0.2))


class Idle(Drivers):
    """Nobody ever moves."""

    def __init__(self) -> None:
        super().__init__((0.0, 0.0), (0.0, 0.0))


REAR_END = ((0.5, 0.0), (1.4, 0.2))
"""the fast one comes from behind on a bend and runs into the slow one"""
APART = ((1.0, 0.0), (0.9, 0.05))
INTO_WALL = ((1.4, 0.25), (0.2, 0.0))


def lane(commands, path=None, **changes):
    world = physim.parse_world(LANE, overrides=[f"{key}={value}" for key, value in changes.items()])
    return physim.simulate(world, controller=Drivers(*commands), path=path)


def side_by_side(seed: int, guarded: bool):
    """Two boxes with one heading, 0.2 m apart: the engine's weak spot."""
    rng = np.random.default_rng(seed)
    heading = rng.uniform(-np.pi, np.pi)
    at = rng.uniform(-40, 40, 2)
    beside = at + 0.8 * np.array([-np.sin(heading), np.cos(heading)])
    text = SIDE_BY_SIDE
    for k, (x, y) in enumerate((at, beside)):
        text = text.replace(f"POSE_{k}", f"[{x!r}, {y!r}, {heading!r}]".replace("np.float64", ""))
    text = text.replace("(", "").replace(")", "")
    simulation = Simulation(physim.parse_world(text), controller=Drivers((1.0, 0.0), (1.0, 0.0)))
    scene = simulation.scene
    simulation.physics = Physics(
        scene.shapes, scene.walls, scene.start, scene.mass, scene.dt, _guarded=guarded
    )
    return record_run(simulation)


def edited(record, path: Path, change) -> physim.Record:
    """Copy of a record on disk with its contact table changed: ``change(rows) -> rows``."""
    record.save(path)
    with h5py.File(path, "r+") as file:
        rows = change(file["/contacts"][()])
        file["/contacts"].resize(len(rows), axis=0)
        file["/contacts"][...] = rows
    return physim.Record.load(path)


def tampered(record, folder: Path, change) -> Path:
    """Path of a copy of a record, its open file changed in place by ``change(file)``."""
    path = folder / "tampered.h5"
    record.save(path)
    with h5py.File(path, "r+") as file:
        change(file)
    return path


def judged(record, folder: Path, change, **options):
    """Validation of a record that is changed by ``change(file)``."""
    with physim.Record.load(tampered(record, folder, change)) as forged:
        return validate(forged, **options)


def states(text: str, first: str, *parts: str, within: int = 120) -> bool:
    """Whether ``first`` stands in a text with all other parts at most ``within`` characters away.

    Parts are as of `facts`: words of their own, in any order. Lines may break anywhere.
    """
    text = " ".join(text.split())
    for at in re.finditer(re.escape(first), text):
        start, end = max(at.start() - within, 0), at.end() + within
        if re.search(facts(first, *parts), text[start:end]):
            return True
    return False
