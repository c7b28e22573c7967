"""The trial's free flow with any number of wall segments; run in its folder, whose files it uses.

Its own ``measure.py`` asks for no number of segments; settings and steps are those of that file.
"""

from __future__ import annotations

import os
import sys
from typing import Any

import numpy as np
from common import SPEED, STEP, rate, report, task

sys.path.insert(0, os.getcwd())

import guard2
from host import Host
from world import Corridor


def main() -> None:
    """Do what is asked."""
    asked, kept, count = task(), [], 0
    robots = asked["robots"]
    corridor: Any
    host: Any
    corridor = host = None
    command = np.c_[np.full(robots, SPEED), np.zeros(robots)]

    def again() -> None:
        nonlocal corridor, host, count
        corridor = Corridor(robots, noise=0.1, physics=False, nseg=asked["segments"])
        corridor.mk()
        if robots > 10:
            corridor.sp.use_spatial_hash(0.6, robots * 10)
        kept.append(guard2.install(corridor))  # which the engine calls: it must not be collected
        host, count = Host(corridor), 0

    def step() -> None:
        nonlocal count
        corridor.t = count * STEP
        corridor.pose[...] = host.pose
        corridor.decide()
        command[:, 0], command[:, 1] = corridor.v, corridor.om
        host.step(command, STEP)
        count += 1

    report(**rate(step, robots, asked["seconds"], asked["most"], again))


if __name__ == "__main__":
    main()
