"""Scenes in which candidates are equally good, so that the tie-breaks of (5) decide."""

from __future__ import annotations

import dataclasses

import numpy as np

from tests.controllers.random_scenes import convex_part
from tests.controllers.scenes import History, single_robot
from tests.helpers import inside

ModeSwitchingSettings = inside("physim.controllers", "ModeSwitchingSettings")


def equal_case(rng: np.random.Generator) -> tuple[History, ModeSwitchingSettings]:
    """A robot for which two turns, or all speeds, end equally near to its target.

    No wall is in sight. Standing robots (nu = 0) turn only: turns by 0 and w are equally good when
    the target lies half of w's turn to the side, turns by w and -w when it lies behind, and with
    two equal dwell times the order of turns does not matter. A robot on its way that faces
    backwards may turn to either side.
    """
    kind = rng.choice(["beside", "behind", "two dwell times", "on the way"])
    period, turn = 0.1, float(rng.uniform(0.3, 1.6))
    ahead = float(rng.choice([0.0, 0.5]))
    dwell = [period]
    if kind == "two dwell times":
        ahead, dwell = 0.0, [period / 2.0, period / 2.0]
    settings = ModeSwitchingSettings(
        update_period=period,
        dwell_times=dwell,
        judge_ahead=ahead,
        omegas=rng.permutation([-turn, 0.0, turn, turn / 2.0]).tolist(),
        reverse_in_safe_mode=True if kind != "on the way" and rng.random() < 0.5 else None,
    )
    aside = {
        "beside": 0.5 * turn * max(period, ahead) * rng.choice([-1.0, 1.0]),
        "two dwell times": rng.uniform(-1.0, 1.0) * turn * period,
    }.get(str(kind), np.pi)
    if kind == "beside":
        settings = settings.model_copy(
            update={"omegas": rng.permutation([0, turn, -turn]).tolist()}
        )
    course = rng.uniform(-np.pi, np.pi)
    direction = np.array([np.cos(course), np.sin(course)])
    origin = rng.uniform(-20.0, 20.0, 2)
    path = np.array([origin, origin + 40.0 * direction])
    history = single_robot(path, 10.0)
    (robot,) = history.moments[0]
    robot = dataclasses.replace(
        robot,
        parts=(convex_part(rng, 0.5, (0.0, 0.0)),),
        pose=np.array([*robot.pose[:2], course - aside]),
    )
    nu = 1.0 if kind == "on the way" else 0.0
    cluster = dataclasses.replace(history.cluster, v_min=nu, v_max=nu)
    return dataclasses.replace(history, cluster=cluster, moments=[[robot]]), settings
