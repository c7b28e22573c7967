"""Formation control, (7) to (10), and the formation error with its sign."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physim import View, parse_world, simulate
from tests.controllers.scenes import scene_of, sensed_at, single_robot
from tests.helpers import STRAIGHT, examples, inside
from tests.oracles import formation as oracle
from tests.oracles.tolerances import ROUNDING
from tests.oracles.view import neighbours

formation_energy = inside("physim.controllers", "formation_energy")
formation_energy_rate = inside("physim.controllers", "formation_energy_rate")
formation_speed, formation_sum = inside("physim.controllers", "formation_speed", "formation_sum")
is_neighbour = inside("physim.controllers", "is_neighbour")
formation_errors = inside("physim.simulation", "formation_errors")

FAR = float("inf")
EVERY_ONE = np.zeros(0, dtype=np.int64)


def test_a_robot_that_lags_speeds_up_and_one_in_the_lead_slows_down() -> None:
    station, lead = np.array([0.0, 5.0]), np.array([0.0, 3.0])
    behind = formation_sum(0, np.arange(2), np.array([1]), 1, station, lead)
    ahead = formation_sum(1, np.arange(2), np.array([0]), 1, station, lead)
    assert behind == pytest.approx(2.0)
    assert ahead == pytest.approx(-2.0)
    assert formation_speed(1.0, 0.05, 0.8, 1.3, behind) == pytest.approx(1.1)
    assert formation_speed(1.0, 0.05, 0.8, 1.3, ahead) == pytest.approx(0.9)
    assert formation_speed(1.0, 0.05, 0.8, 1.3, 100.0) == 1.3
    assert formation_speed(1.0, 0.05, 0.8, 1.3, -100.0) == 0.8


def test_speed_by_7_is_that_of_the_sums() -> None:
    at_bound = {0.8: 0, 1.3: 0}
    for k in range(500):
        rng = np.random.default_rng([30, k])
        n = int(rng.integers(1, 9))
        station, lead = rng.uniform(-20.0, 20.0, n), rng.uniform(-10.0, 10.0, n)
        i = int(rng.integers(n))
        mates = [j for j in range(n) if j != i and rng.random() < 0.6]
        nu_0, alpha = float(rng.uniform(0.5, 1.2)), float(rng.choice([0.005, 0.05]))
        rows = np.array(mates, dtype=np.int64)
        total = formation_sum(i, np.arange(n), rows, len(rows), station, lead)
        found = formation_speed(nu_0, alpha, 0.8, 1.3, total)
        pairs = [(station[j], lead[j]) for j in mates]
        expected = oracle.speed(station[i], lead[i], pairs, nu_0, alpha, 0.8, 1.3)
        assert abs(found - expected) <= ROUNDING
        if expected in at_bound:
            at_bound[expected] += 1
    assert min(at_bound.values()) >= 25
    assert sum(at_bound.values()) <= 475


def test_neighbours_are_those_listed_or_within_range_along_the_reference_path() -> None:
    for k in range(60):
        rng = np.random.default_rng([31, k])
        n = int(rng.integers(1, 7))
        history = single_robot(np.array([[0.0, 0.0], [30.0, 0.0]]), 0.0)
        ((robot,),) = history.moments
        robots = [
            dataclasses.replace(robot, reference_station=float(s))
            for s in np.round(rng.uniform(0.0, 20.0, n), 1)
        ]
        station = np.array([r.reference_station for r in robots])
        reach = 6.0 if n < 2 or rng.random() < 0.5 else abs(station[1] - station[0])
        upper = np.triu(rng.integers(0, 2, (n, n)), 1)
        listed = None if rng.random() < 0.5 else upper + upper.T
        cluster = dataclasses.replace(history.cluster, range=reach, adjacency=listed)
        adjacency = (EVERY_ONE, 0) if listed is None else (listed.ravel(), n)
        scene = scene_of(dataclasses.replace(history, cluster=cluster, moments=[robots]))
        view = View(scene, sensed_at(robots, 0))
        for i in range(n):
            expected = neighbours(robots, cluster, i)
            found = [
                j for j in range(n) if is_neighbour(i, j, station[i], station[j], *adjacency, reach)
            ]
            assert found == expected
            assert [one.index for one in view.observation(i).neighbours] == expected


stations = st.lists(st.floats(-100.0, 100.0), min_size=2, max_size=12)


@examples(25, deep=100)
@given(stations, st.integers(0, 2**31))
def test_energy_and_its_rate_are_those_of_the_sums(values: list[float], seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = len(values)
    station, lead = np.array(values), rng.uniform(-5.0, 5.0, n)
    upper = np.triu(rng.integers(0, 2, (n, n)), 1)
    adjacency = upper + upper.T
    energy = oracle.energy(station, lead, adjacency)
    rate = oracle.energy_rate(station, lead, adjacency, 0.05)
    assert formation_energy(station, lead, adjacency) == pytest.approx(energy, rel=1e-9)
    assert formation_energy_rate(station, lead, adjacency, 0.05) == pytest.approx(rate, rel=1e-9)


@examples(25, deep=100)
@given(stations, st.integers(0, 2**31), st.floats(0.001, 0.1))
def test_energy_identity_10_for_robots_that_all_update_every_step(
    values: list[float], seed: int, dt: float
) -> None:
    """Ideal motion (8) on a straight road: the decay of W is (10) plus its exact remainder."""
    rng = np.random.default_rng(seed)
    n, alpha = len(values), 0.03
    station, lead = np.array(values), rng.uniform(-5.0, 5.0, n)
    adjacency = np.triu(rng.integers(0, 2, (n, n)), 1)
    adjacency = adjacency + adjacency.T
    mates = [np.flatnonzero(row) for row in adjacency]
    inner = np.array(
        [formation_sum(i, np.arange(n), m, len(m), station, lead) for i, m in enumerate(mates)]
    )
    speed = np.array([formation_speed(1.0, alpha, -FAR, FAR, s) for s in inner])
    before = formation_energy(station, lead, adjacency)
    after = formation_energy(station + speed * dt, lead, adjacency)
    rate = formation_energy_rate(station, lead, adjacency, alpha)
    difference = inner[None, :] - inner[:, None]
    remainder = 0.5 * alpha**2 * dt**2 * (adjacency * difference**2).sum()
    assert rate <= 0.0
    assert after - before == pytest.approx(rate * dt + remainder, rel=1e-9, abs=1e-9 * (1 + before))


# The formation error: (1/N) sum of l_ij less (1/N) sum of l*_ij, positive when a robot lags


def test_formation_errors_that_are_recorded_agree_with_the_oracle() -> None:
    history = single_robot(np.array([[0.0, 0.0], [30.0, 0.0]]), 0.0)
    ((robot,),) = history.moments
    for k in range(20):
        rng = np.random.default_rng([32, k])
        n = int(rng.integers(1, 9))
        station, lead = rng.uniform(0.0, 30.0, n), rng.uniform(-5.0, 5.0, n)
        robots = [dataclasses.replace(robot, lead=float(value)) for value in lead]
        scene = scene_of(dataclasses.replace(history, moments=[robots]))
        expected = [oracle.error(i, station, lead) for i in range(n)]
        found = formation_errors(scene, np.stack((station, station + 1.0)))
        assert np.allclose(found, expected, rtol=0.0, atol=ROUNDING)


def test_formation_error_in_the_record_is_positive_for_a_robot_that_lags() -> None:
    """r2 is to follow r1 at 3 m, and starts 5 m behind."""
    text = STRAIGHT.replace("[3.0, -1.0, random]", "[1.0, -1.0, 0.0]")
    with simulate(parse_world(text, overrides=("time.duration=0.2",))) as record:
        rows = record.updates[record.updates["step"] == 0]
        assert rows["robot"].tolist() == [0, 1]
        assert rows["reference_station"] == pytest.approx([6.0, 1.0])
        assert rows["formation_error"] == pytest.approx([-1.0, 1.0])
        assert rows["deviation"] == pytest.approx([0.0, 0.0])
