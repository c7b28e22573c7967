"""Small worlds, and a controller made of a function, for tests of the loop and of files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from physim import Decision, Observation
from physim.world import World

THREE = [[20.0, -10.0, 0.3], [30.0, 0.0, -2.0], [40.0, 10.0, 0.0]]
"""Start poses of three robots [m, m, rad]."""
BOX = {"length": 1.8, "width": 1.0}


def road(
    poses: Sequence[Sequence[Any]],
    *,
    step: float = 0.01,
    duration: float = 10.0,
    limits: dict[str, float] | None = None,
    **more: Any,
) -> World:
    """A road of 200 m by 40 m; every robot has a straight path through its own start.

    ``more`` are further keys of the world.
    """
    robots = [
        {
            "name": f"r{i + 1}",
            "footprint": BOX,
            "pose": list(pose),
            "path": [[0.0, pose[1]], [200.0, pose[1]]],
            **({"limits": limits} if limits else {}),
        }
        for i, pose in enumerate(poses)
    ]
    values: dict[str, Any] = {
        "name": "road",
        "time": {"step": step, "duration": duration},
        "corridor": {"centreline": [[0.0, 0.0], [200.0, 0.0]], "width": 40.0},
        "robots": robots,
    }
    return World(**{**values, **more})


class Says:
    """A controller made of a function of the observation."""

    def __init__(self, decide: Callable[[Observation], Any]) -> None:
        self.answer = decide
        self.asked: list[tuple[int, int]] = []

    def decide(self, observation: Observation, memory: Any) -> Decision:
        self.asked.append((observation.index, round(observation.time / observation.dt)))
        answer: Decision = self.answer(observation)
        return answer


ROBOT = (
    "  - {{name: r{k}, footprint: {{length: 1.8, width: 1.0}}, pose: [{x}, 0, 0], "
    "path: {{offset: 0.0}}}}\n"
)


def dead_end(margin: float, starts: Sequence[float] = (2.0,), width: float = 6.0) -> str:
    """A world of 12 m whose end wall lies ``margin`` [m] beyond the path; robots at ``starts``."""
    robots = "".join(ROBOT.format(k=k + 1, x=x) for k, x in enumerate(starts))
    return (
        "name: dead_end\ntime: {step: 0.01, duration: 20.0}\n"
        f"corridor: {{centreline: [[0, 0], [12, 0]], width: {width}, end_margin: {margin}}}\n"
        f"robots:\n{robots}"
        "formation: {gain: 0.05, speed: 1.0, limits: [0.8, 1.3], range: 10.0}\n"
        "controller: {type: mode_switching}\n"
    )


STRAIGHT = """\
# A straight corridor with two boxes, one behind the other.
name: straight
seed: 3
time: {step: 0.01, duration: 30.0}  # [s]
corridor: {centreline: [[0, 0], [30, 0]], width: 8.0}  # [m]
robots:
  - name: r1
    footprint: {length: 1.8, width: 1.0}  # [m]
    pose: [6.0, 1.0, 0.0]  # [m, m, rad]
    path: [[0.0, 1.0], [30.0, 1.0]]  # [m]
  - name: r2
    footprint: {length: 1.8, width: 1.0}
    pose: [3.0, -1.0, random]
    path: {offset: -1.0}
formation: {gain: 0.05, speed: 1.0, spacing: [0.0, -3.0]}
controller: {type: mode_switching, look_ahead: 2.0}
expect: {contacts: 0}
"""
