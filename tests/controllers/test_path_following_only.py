"""Path following alone: target (3) and choice (5), and nothing else."""

from __future__ import annotations

import dataclasses

import numpy as np

from tests.controllers.random_scenes import random_history
from tests.controllers.scenes import observations
from tests.helpers import inside
from tests.oracles import path_following, paths
from tests.oracles.choice import smallest
from tests.oracles.tolerances import ROUNDING

PathFollowing = inside("physim.controllers", "PathFollowing")
AT_STOP, SAFE = inside("physim.parts", "AT_STOP", "SAFE")

LOOK_AHEAD, PERIOD, JUDGE_AHEAD, ARRIVAL = 2.0, 0.1, 0.5, 0.06
OMEGAS = [-np.pi / 2, -np.pi / 4, 0.0, np.pi / 4, np.pi / 2]


def test_decisions_agree_with_the_oracle() -> None:
    controller = PathFollowing()
    arrived = capped = limited = own = 0
    for k in range(60):
        rng = np.random.default_rng([70, k])
        history = random_history(rng, moments=1)
        (robots,) = history.moments
        for me, observation in zip(robots, observations(history, 0), strict=True):
            decision = controller.decide(observation, None)
            target, _ = paths.target(me.path, me.station, LOOK_AHEAD)
            assert decision.hold == PERIOD
            assert decision.memory is None
            if me.station >= me.stop_station - ARRIVAL:
                assert (decision.v, decision.omega, decision.mode) == (0.0, 0.0, AT_STOP)
                arrived += 1
                continue
            nu = min(history.cluster.speed, me.limits[0])
            left = paths.lengths(me.path)[-1] - me.station
            ahead = path_following.judging_time(JUDGE_AHEAD, left, nu)
            pairs = path_following.pairs([1.0], nu, me.omegas or OMEGAS)
            right, _ = smallest(
                path_following.judgements(me.pose, pairs[:, None], [PERIOD], ahead, target)
            )
            assert (decision.v, decision.omega) in [tuple(pairs[c]) for c in right]
            assert decision.mode == SAFE
            told = decision.report
            assert list(told) == ["target_x", "target_y"]
            assert np.allclose(list(told.values()), target, rtol=0.0, atol=ROUNDING)
            assert len(decision.considered) == 0
            capped += ahead < JUDGE_AHEAD
            limited += nu == me.limits[0]
            own += me.omegas is not None
    assert min(arrived, capped, limited, own) >= 7


def test_it_is_deaf_to_others_and_to_walls() -> None:
    controller = PathFollowing()
    for k in range(10):
        history = random_history(np.random.default_rng([71, k]), moments=1)
        for observation in observations(history, 0):
            alone = dataclasses.replace(observation, others=(), walls=(), neighbours=())
            assert repr(controller.decide(alone, None)) == repr(
                controller.decide(observation, None)
            )
