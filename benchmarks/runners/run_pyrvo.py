"""pyrvo: the ORCA of RVO2 alone, points with a radius that turn at once; no robots, no drives."""

from __future__ import annotations

from importlib.metadata import version

import pyrvo
from common import RADIUS, SPEED, STEP, WIDTH, places, rate, report, road_length, task

SIGHT = 5.0


def corridor(robots: int) -> pyrvo.RVOSimulator:
    """Robots between two walls."""
    simulator = pyrvo.RVOSimulator(STEP, SIGHT, 10, 5.0, 5.0, RADIUS, 1.0)
    length, half = road_length(robots), WIDTH / 2
    for y in (-half, half):
        simulator.add_obstacle([(0.0, y), (length, y)])
    simulator.process_obstacles()
    for x, y in places(robots):
        simulator.set_agent_pref_velocity(simulator.add_agent((x, y)), (SPEED, 0.0))
    return simulator


def main() -> None:
    """Do what is asked."""
    asked = task()
    simulator = corridor(asked["robots"])

    def again() -> None:
        nonlocal simulator
        simulator = corridor(asked["robots"])

    def step() -> None:
        simulator.do_step()

    found = rate(step, asked["robots"], asked["seconds"], asked["most"], again)
    report(**found, version=version("pyrvo"))


if __name__ == "__main__":
    main()
