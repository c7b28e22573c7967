"""The runs whose records are forged: short, and real."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np

import physim
from physim import SaveAt
from tests.analysis.forgeries.parts import Heard, Ramp, Slip

LANE = """\
name: lane
seed: 4
time: {step: 0.01, duration: 30.0}
corridor: {centreline: [[0, 0], [10, 0], [20, 3]], width: [6, 4, 6]}
robots:
  - {name: r1, footprint: {length: 1.6, width: 0.9}, pose: [4.6, 0.4, random], path: {offset: 0.0}}
  - {name: r2, footprint: [[0.9, 0.0], [-0.7, 0.5], [-0.4, 0.0], [-0.7, -0.5]],
     pose: [3.0, -1.2, 0.4], path: {offset: -0.4}}
  - {name: r3, footprint: {length: 1.4, width: 1.0}, pose: [1.4, 0.9, random], path: {offset: 0.4}}
formation: {gain: 0.05, speed: 1.0, limits: [0.8, 1.3], spacing: [0.0, -2.2, -4.4]}
controller: {type: mode_switching, time_low: 1.5, time_high: 3.0, horizon: 4.0}
expect: {contacts: 0, min_distance: 0.01, finished: true}
"""


def free(path: Path) -> None:
    """The paper's controller, contact-free, all robots arrive."""
    physim.simulate(physim.parse_world(LANE), path=path).close()


def touching(path: Path) -> None:
    """Robots that look at nothing and touch each other and the walls."""
    world = physim.parse_world(
        LANE, overrides=["controller={type: path_following}", "time.duration=12"]
    )
    physim.simulate(world, path=path).close()


def staged(path: Path) -> None:
    """A filter and a disturbance, given from Python, behind the paper's controller."""
    world = physim.parse_world(LANE, overrides=["time.duration=6"])
    physim.simulate(world, filters=[Ramp()], disturbances=[Slip()], path=path).close()


RUNS: dict[str, Callable[[Path], None]] = {"free": free, "touching": touching, "staged": staged}


def interrupted(path: Path) -> None:
    """Stopped after 3 s."""
    steps = iter(range(1, 301))
    world = physim.parse_world(LANE)
    physim.simulate(world, path=path, stop=lambda: next(steps) == 300).close()


def killed(path: Path) -> None:
    """As the file of a run looks that was killed after its last burst of writing."""
    interrupted(path)
    with h5py.File(path, "r+") as file:
        file.attrs.modify("ended", np.array(b"running", dtype="S16"))
        file.attrs.modify("steps_run", np.int64(0))
        for name in ("step", "pose", "clearance", "boundary_clearance"):
            file[f"steps/{name}"].resize(271, axis=0)


def broken(path: Path) -> None:
    """Broke off with an error of its controller."""

    class Breaks:
        def decide(self, observation, memory):
            if observation.time > 1.0:
                raise ValueError("no more")
            return physim.Decision(v=0.5, omega=0.0, hold=0.1)

    try:
        physim.simulate(physim.parse_world(LANE), controller=Breaks(), path=path)
    except physim.ControllerError:
        return
    raise AssertionError("the controller did not break")


def misled(path: Path) -> None:
    """With a sense stage: what robots knew is not in the record."""
    world = physim.parse_world(LANE, overrides=["time.duration=5"])
    physim.simulate(world, sensing=[Heard()], path=path).close()


def coarse(path: Path) -> None:
    """Every 7th sample only, and no table of considered robots."""
    save = SaveAt(every=7, tables=("updates", "contacts"))
    physim.simulate(physim.parse_world(LANE), save=save, path=path).close()


UNUSUAL: dict[str, Callable[[Path], None]] = {
    "interrupted": interrupted, "killed": killed, "broken off": broken, "misled": misled,
    "coarse": coarse,
}  # fmt: skip
"""Runs that are as they should be, though unlike others."""
