"""Distances and collision times (11), and the choices by (12) and (13), against slow oracles.

The scenes of `test_mode_switching` meet all of it among everything else; here every robot is in
danger.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.controllers.agreement import hold_against_oracle
from tests.controllers.random_scenes import convex_part, footprint, random_command, random_history
from tests.controllers.scenes import near_field
from tests.helpers import inside
from tests.oracles.collision_times import Question, collision_times
from tests.oracles.distances import smallest_distances
from tests.oracles.motion import placed
from tests.oracles.tolerances import ROUNDING, TIME, TOUCH

smallest_distance = inside("physim.controllers", "smallest_distance")
smallest_time, NearField = inside("physim.controllers", "smallest_time", "NearField")
Bodies, ModeSwitchingSettings = inside("physim.controllers", "Bodies", "ModeSwitchingSettings")
facings, pack_parts = inside("physim.geometry", "facings", "pack_parts")

BY_DISTANCE = {
    "distance_low": 50.0, "distance_high": 50.0, "time_low": 0.0, "time_high": 0.0,
    "update_period": 0.4, "dwell_times": [0.4],
}  # fmt: skip
BY_TIME = {**BY_DISTANCE, "avoidance": "time", "update_period": 0.1, "dwell_times": [0.1]}


@pytest.mark.parametrize(
    ("seed", "mode", "given"),
    [
        (10, "(12)", BY_DISTANCE),
        (11, "(13)", BY_TIME),
        (12, "(13)", {**BY_TIME, "collision_motion": "translation"}),
    ],
    ids=["(12)", "(13)", "(13) in translation"],
)
def test_choice_in_danger(seed: int, mode: str, given: dict[str, object]) -> None:
    cases = []
    for k in range(50):
        rng = np.random.default_rng([seed, k])
        drawn = {"horizon": rng.choice([4.0, 10.0]), "safe_distance": rng.choice([0.2, 1.0])}
        settings = {**given, **{name: float(value) for name, value in drawn.items()}}
        history = random_history(rng, moments=1)
        cases.append((history, ModeSwitchingSettings.model_validate(settings)))
    tally = hold_against_oracle(cases)
    assert tally.faults == []
    assert tally.met[f"mode {mode}"] >= 40
    assert tally.met[f"{mode} with others"] >= 20


@pytest.mark.parametrize("judge_ahead", [0.0, 1.0])
def test_where_no_distance_counts_the_choice_by_12_is_that_of_5(judge_ahead: float) -> None:
    """In danger for a boundary, but no footprint within L of one, and nobody to consider."""
    given = {**BY_DISTANCE, "distance_low": 0.0, "distance_high": 0.0, "boundary_low": 6.0}
    settings = ModeSwitchingSettings.model_validate(
        {**given, "safe_distance": 0.05, "judge_ahead": judge_ahead, "look_ahead": 0.6}
    )
    cases = []
    for k in range(50):
        history = random_history(np.random.default_rng([16, k]), moments=1)
        cases.append((history, settings))
    tally = hold_against_oracle(cases)
    assert tally.faults == []
    assert tally.met["(12) settled by (5)"] >= 20


def crowd(rng: np.random.Generator) -> tuple[list[tuple[np.ndarray, ...]], np.ndarray, np.ndarray]:
    """Footprints, poses (4, 3) and commands (4, 2) of robots in a square of random size."""
    side = rng.choice([4.0, 8.0, 20.0])
    bodies = [footprint(rng) for _ in range(4)]
    pose = rng.uniform(-1.0, 1.0, (4, 3)) * [side / 2.0, side / 2.0, np.pi]
    return bodies, pose, np.array([random_command(rng) for _ in bodies])


def rows_of(
    bodies: list[tuple[np.ndarray, ...]], pose: np.ndarray, command: np.ndarray | None = None
) -> Bodies:
    """The robots as a decision looks at them."""
    order = np.arange(len(bodies))
    command = np.zeros((len(bodies), 2)) if command is None else command
    packed, station = pack_parts(bodies), np.zeros(len(bodies))
    return Bodies(packed, order, order, pose, command, station, facings(pose))


def about(
    bodies: Bodies, rows: np.ndarray, walls: list[np.ndarray], translation: bool = False
) -> tuple[Bodies, NearField]:
    """The robots, and what the first of them sees."""
    packed = pack_parts([[part] for part in walls])
    return bodies, near_field(bodies, rows, packed, translation)


def test_smallest_distance_is_that_of_minkowski_differences() -> None:
    overlaps = 0
    for k in range(1500):
        rng = np.random.default_rng([13, k])
        bodies, pose, _ = crowd(rng)
        rows = np.flatnonzero(rng.random(3) < 0.7) + 1
        found = smallest_distance(*about(rows_of(bodies, pose), rows, []))
        theirs = [placed(part, pose[j]) for j in rows for part in bodies[j]]
        (expected,) = smallest_distances([[placed(p, pose[0]) for p in bodies[0]]], [theirs])
        assert found == expected or abs(found - expected) <= ROUNDING
        overlaps += found < 0.0
    assert overlaps >= 100


@pytest.mark.parametrize("translation", [False, True], ids=["arc", "translation"])
def test_smallest_time_is_that_of_marching(translation: bool) -> None:
    questions, found = [], []
    for k in range(800):
        rng = np.random.default_rng([14, k])
        bodies, pose, command = crowd(rng)
        rows = np.flatnonzero(rng.random(3) < 0.7) + 1
        horizon = float(rng.choice([1.0, 10.0]))
        walls = [convex_part(rng, 1.0, rng.uniform(-8.0, 8.0, 2)), rng.uniform(-8.0, 8.0, (2, 2))]
        others = tuple((bodies[j], pose[j], tuple(command[j])) for j in rows)
        questions.append(
            Question(
                bodies[0], pose[0], tuple(command[0]), others, tuple(walls), horizon, translation
            )
        )
        found.append(
            smallest_time(
                *about(rows_of(bodies, pose, command), rows, walls, translation),
                command[0], horizon, -1.0,
            )
        )  # fmt: skip
    answers = collision_times(questions)
    sure = [(a.time, xi) for a, xi in zip(answers, found, strict=True) if a.sure]
    assert len(sure) >= 0.98 * len(questions)
    wrong = [(t, xi) for t, xi in sure if not (t == xi or -TOUCH <= xi - t <= TIME)]
    assert wrong == []
    assert sum(0.0 < t < np.inf for t, _ in sure) >= 100
    assert sum(t == np.inf for t, _ in sure) >= 100


def test_what_is_enough_leaves_out_only_smaller_times() -> None:
    """With ``enough`` the answer is exact, or some value below it."""
    cut = 0
    for k in range(300):
        rng = np.random.default_rng([15, k])
        bodies, pose, command = crowd(rng)
        rows = np.arange(1, 4)
        wall = [rng.uniform(-8.0, 8.0, (2, 2))]
        enough = float(rng.uniform(0.0, 5.0))
        whole, short = (
            smallest_time(
                *about(rows_of(bodies, pose, command), rows, wall), command[0], 10.0, limit
            )
            for limit in (-1.0, enough)
        )
        assert short == whole or whole <= short < enough
        cut += short > whole
    assert cut >= 5
