"""navground: discs in the corridor, without controller, with HL or with ORCA; and head-on.

Two walls, as it likes them best; behaviors see 5 m far, which is its default, and decide every
0.1 s. In a jam the discs are driven into a third wall.
"""

from __future__ import annotations

import tempfile
import time
from importlib.metadata import version
from pathlib import Path
from typing import Any

from common import (
    PACKED,
    PERIOD,
    RADIUS,
    SPACING,
    SPEED,
    STEP,
    WIDTH,
    places,
    rate,
    report,
    road_length,
    task,
)  # fmt: skip
from navground import core, sim

SIGHT = 5.0


def disc(behavior: str, x: float, y: float, speed: float = SPEED) -> Any:
    """One agent that goes along the x axis."""
    kinematics = core.Kinematics.make_type("Ahead")
    kinematics.max_speed, kinematics.max_angular_speed = max(1.0, speed), 1.6
    mind = core.Behavior.make_type(behavior)
    mind.optimal_speed, mind.horizon = speed, SIGHT
    mind.kinematics, mind.radius, mind.safety_margin = kinematics, RADIUS, 0.0
    goal = sim.Task.make_type("Direction")
    goal.direction = (1.0, 0.0)
    senses = [] if behavior == "Dummy" else [sim.state_estimations.BoundedStateEstimation(SIGHT)]
    agent = sim.Agent(
        radius=RADIUS, behavior=mind, kinematics=kinematics, task=goal,
        state_estimations=senses, control_period=PERIOD,
    )  # fmt: skip
    agent.pose = core.Pose2(position=(x, y), orientation=0.0)
    return agent


def corridor(robots: int, behavior: str, jam: bool) -> Any:
    """Robots between two walls, or three."""
    world, length = sim.World(), road_length(robots, jam)
    for y in (-WIDTH / 2, WIDTH / 2):
        world.add_wall(sim.Wall((0.0, y), (length, y)))
    if jam:
        world.add_wall(sim.Wall((length, -WIDTH / 2), (length, WIDTH / 2)))
    for x, y in places(robots, PACKED if jam else SPACING):
        world.add_agent(disc(behavior, x, y))
    return world


def speed(robots: int, kind: str, jam: bool, seconds: float, most: int) -> dict[str, Any]:
    """Rate of the corridor; steps are taken ten at a time, so that Python does not count."""
    world = corridor(robots, kind, jam)

    def again() -> None:
        nonlocal world
        world = corridor(robots, kind, jam)

    def ten() -> None:
        world.run(10, STEP)

    found = rate(ten, 10 * robots, seconds, most // 10, again)
    return {**found, "contacts": len(world.collisions)}


def head_on(speeds: list[float], offsets: list[float], gap: float) -> list[dict[str, Any]]:
    """A disc driven head-on at a wall, from several places: what is told, and when."""
    found = []
    for v in speeds:
        for offset in offsets:
            world = sim.World()
            wall = sim.Wall((gap + RADIUS + offset, -1.0), (gap + RADIUS + offset, 1.0))
            world.add_wall(wall)
            agent = disc("Dummy", 0.0, 0.0, v)
            world.add_agent(agent)
            told, passed = None, False
            for k in range(int(3.0 * (gap + 1.0) / v / STEP) + 5):
                world.run(1, STEP)
                if told is None and world.collisions:
                    told = (k + 1) * STEP
                passed = passed or agent.position[0] > gap + RADIUS + offset
            due = (gap + offset) / v
            found.append(
                {"speed": v, "passed": bool(passed), "late": None if told is None else told - due}
            )
    return found


def video(robots: int, seconds: float) -> dict[str, Any]:
    """Frames a second of an MP4, by processor time and by the wall clock, with the simulation."""
    from navground.sim.ui.video import record_video

    with tempfile.TemporaryDirectory() as folder:
        cpu, wall_clock = time.process_time(), time.perf_counter()
        world = corridor(robots, "HL", False)
        record_video(Path(folder) / "video.mp4", world, STEP, seconds, fps=30)
        cpu, wall_clock = time.process_time() - cpu, time.perf_counter() - wall_clock
    frames = round(30 * seconds)
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
    report(**found, version=version("navground"))


if __name__ == "__main__":
    main()
