"""A planted fault is found, by any number of workers; without it nothing is.

`python -m benchmarks.falsify --planted 100` measures a hundred trials; here are a few of them.
"""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.planted import MIDDLE, Planted, Twin, planted_world
from tests.helpers import inside

executor = inside("physim.campaigns", "executor")
accepted, by_executor = inside("physim.campaigns.falsify", "accepted", "by_executor")
in_this_process, judge_world = inside("physim.campaigns.falsify", "in_this_process", "judge_world")
ROBOTS, hunt, Space = inside("physim.campaigns.falsify", "ROBOTS", "hunt", "Space")

NAME, SOUND = "benchmarks.planted:Planted", "benchmarks.planted:Sound"
MOST = 5000


@pytest.fixture(scope="module")
def space() -> Space:
    return Space(planted_world())


@pytest.mark.deep
def test_the_twin_is_the_simulator_up_to_the_first_contact(space: Space) -> None:
    """So that trials made with it are trials of the search in the simulator."""
    random, twin, failed = np.random.default_rng(4), Twin(space.world), 0
    near = (MIDDLE - space.low[2]) / (space.high[2] - space.low[2])
    for k in range(24):
        point = random.random(6)
        if k % 2:  # towards the band, from where the other lies ahead
            point[:3] = 0.4 + 0.3 * point[0], 0.1, near + 2e-4 * (point[2] - 0.5)
            point[4] = 0.9
        world = space.at(point).world
        run, twins = judge_world(world), twin.judge(world)
        assert run.failed == twins.failed
        if run.touched is not None and twins.touched is not None:
            assert run.touched == twins.touched
            failed += 1
        else:
            assert run.clearance == pytest.approx(twins.clearance, abs=1e-9)
    assert 3 <= failed <= 12


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.deep)])
def test_the_fault_is_found(space: Space, seed: int) -> None:
    accepts = accepted(NAME)
    found = hunt(space, Twin(space.world).evaluate, accepts, budget=MOST, seed=seed)
    assert found.failed
    assert found.runs < MOST
    assert found.world is not None
    run = judge_world(found.world)
    assert run.touched is not None
    assert run.touched.kind == ROBOTS
    assert accepts(found.world) == ""
    heading = found.world.robots[0].pose[2]
    band = Planted.Settings().band
    assert abs((heading - MIDDLE + np.pi) % (2.0 * np.pi) - np.pi) <= band


@pytest.mark.deep
def test_without_the_fault_nothing_is_found() -> None:
    space = Space(planted_world(SOUND))
    found = hunt(space, Twin(space.world).evaluate, accepted(SOUND), budget=1500, seed=2)
    assert (found.failed, found.failures, found.runs) == (False, 0, 1500)
    assert found.judged is not None
    assert found.judged.clearance is not None
    assert found.first is not None
    assert 0.0 < found.judged.clearance < 0.5 < found.first


@pytest.mark.deep
def test_the_result_is_the_same_whoever_does_the_runs(space: Space) -> None:
    accepts = accepted(NAME)
    here = hunt(space, in_this_process(), accepts, budget=60, seed=1)
    assert len(here.history) > 1
    with executor(2) as workers:
        there = hunt(space, by_executor(workers, space.world), accepts, budget=60, seed=1)
    assert there == here
