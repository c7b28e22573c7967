"""IR-SIM: rectangles with contact and commands from outside, discs with its RVO; head-on; video.

Two walls, as it likes them best.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from importlib.metadata import version
from pathlib import Path
from typing import Any

os.environ.setdefault("MPLBACKEND", "Agg")

import irsim
import numpy as np
import yaml
from common import (
    LENGTH_OF_ROBOT,
    PACKED,
    RADIUS,
    SPACING,
    SPEED,
    STEP,
    WIDTH,
    WIDTH_OF_ROBOT,
    places,
    rate,
    report,
    road_length,
    task,
)  # fmt: skip

RECTANGLE = {"name": "rectangle", "length": LENGTH_OF_ROBOT, "width": WIDTH_OF_ROBOT}


def wall(a: list[float], b: list[float]) -> dict[str, Any]:
    """A segment that stands."""
    return {
        "shape": {"name": "linestring", "vertices": [a, b]}, "state": [0.0, 0.0, 0.0],
        "static": True,
    }  # fmt: skip


def make(robots: list[dict[str, Any]], walls: list[dict[str, Any]], contact: bool, length: float,
         **how: Any) -> Any:  # fmt: skip
    """Environment of a world file written for it."""
    world = {
        "height": WIDTH + 2.0, "width": length + 10.0, "offset": [-5.0, -WIDTH / 2 - 1.0],
        "step_time": STEP, "sample_time": STEP, "collision_mode": "contact" if contact else "stop",
    }  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "world.yaml"
        file.write_text(yaml.safe_dump({"world": world, "robot": robots, "obstacle": walls}))
        return irsim.make(str(file), **{"headless": True, "log_level": "ERROR", **how})


def robot(x: float, y: float, goal: float, rvo: bool, speed: float = SPEED) -> dict[str, Any]:
    """One robot with differential drive."""
    one: dict[str, Any] = {
        "kinematics": {"name": "diff"}, "state": [x, y, 0.0], "goal": [goal, y, 0.0],
        "vel_max": [max(1.0, speed), 1.6], "vel_min": [-max(1.0, speed), -1.6],
    }  # fmt: skip
    if rvo:
        behavior = {"name": "rvo", "vxmax": SPEED, "vymax": SPEED, "acce": 1.0, "factor": 1.0}
        return {**one, "shape": {"name": "circle", "radius": RADIUS}, "behavior": behavior}
    return {**one, "shape": RECTANGLE}


def corridor(robots: int, rvo: bool, jam: bool, **how: Any) -> Any:
    """Robots between two walls, or three."""
    length, half = road_length(robots, jam), WIDTH / 2
    walls = [wall([0.0, y], [length, y]) for y in (-half, half)]
    if jam:
        walls.append(wall([length, -half], [length, half]))
    goal = length + 5.0 if jam else length - 1.0
    spacing = PACKED if jam else SPACING
    return make(
        [robot(x, y, goal, rvo) for x, y in places(robots, spacing)], walls, not rvo, length, **how
    )


def speed(robots: int, kind: str, jam: bool, seconds: float, most: int) -> dict[str, Any]:
    """Rate of the corridor."""
    rvo = kind == "rvo"
    env = corridor(robots, rvo, jam)
    ids, forward = list(range(robots)), [np.array([[SPEED], [0.0]])] * robots
    used = False

    def again() -> None:
        nonlocal env, used
        if used:
            env = corridor(robots, rvo, jam)
        used = True

    def step() -> None:
        if rvo:
            env.step()
        else:
            env.step(forward, ids)

    found = rate(step, robots, seconds, most, again)
    return {**found, "contacts": sum(bool(one.collision) for one in env.robot_list)}


def head_on(speeds: list[float], offsets: list[float], gap: float) -> list[dict[str, Any]]:
    """A rectangle driven head-on at a wall, from several places: what is told, and when."""
    found = []
    for v in speeds:
        for offset in offsets:
            x = gap + LENGTH_OF_ROBOT / 2 + offset
            env = make([robot(0.0, 0.0, 2 * x, False, v)], [wall([x, -1.0], [x, 1.0])], True, 40.0)
            found.append(
                {"speed": v, **watch(env, np.array([[v], [0.0]]), x, int(3.0 * gap / STEP))}
            )
    return found


def watch(env: Any, command: np.ndarray, x: float, steps: int) -> dict[str, Any]:
    """Whether a robot that speeds up, as its grip allows, is held at x, and told of."""
    told = due = None
    one, fronts = env.robot_list[0], [LENGTH_OF_ROBOT / 2]
    for k in range(1, steps):
        env.step([command], [0])
        fronts.append(float(one.state[0, 0]) + LENGTH_OF_ROBOT / 2)
        if due is None and fronts[-1] > x - 1e-3:  # at the speed of the step before
            due = (k - 1 + (x - fronts[-2]) / (fronts[-2] - fronts[-3])) * STEP
        if told is None and (one.collision or one.contact.in_contact):
            told = k * STEP
        if fronts[-1] > x + 2.0:
            break
    late = None if told is None or due is None else told - due
    return {"passed": fronts[-1] - LENGTH_OF_ROBOT / 2 > x, "late": late}


def video(robots: int, seconds: float) -> dict[str, Any]:
    """Frames a second of an MP4, by processor time and by the wall clock, with the simulation."""
    with tempfile.TemporaryDirectory() as folder:
        sys.path.insert(0, folder)  # beside the script, it would write its pictures
        from irsim.config import path_param

        path_param.bind(path_param.PathManager())
        env = corridor(robots, False, False, headless=False, display=False, save_ani=True)
        forward, ids, frames = [np.array([[SPEED], [0.0]])] * robots, list(range(robots)), 0
        cpu, wall_clock = time.process_time(), time.perf_counter()
        for k in range(int(seconds / STEP)):
            env.step(forward, ids)
            if k % 2 == 0:
                env.render(0.0)
                frames += 1
        env.end(0.0, ani_name="video", suffix=".mp4")
        cpu, wall_clock = time.process_time() - cpu, time.perf_counter() - wall_clock
        made = list(Path(folder).rglob("*.mp4"))
        if not made:
            raise SystemExit("IR-SIM wrote no MP4")
    return {"frames": frames, "rate": frames / cpu, "wall": frames / wall_clock, "seconds": cpu}


def main() -> None:
    """Do what is asked."""
    asked = task()
    if asked["what"] == "head_on":
        found: dict[str, Any] = {
            "runs": head_on(asked["speeds"], asked["offsets"], asked["gap"]), "step": STEP
        }  # fmt: skip
    elif asked["what"] == "video":
        found = video(asked["robots"], asked["seconds"])
    else:
        found = speed(
            asked["robots"], asked["kind"], asked["jam"], asked["seconds"], asked["most"]
        )  # fmt: skip
    report(**found, version=version("ir-sim"))


if __name__ == "__main__":
    main()
