"""Decisions are checked quickly and, where that has a doubt, thoroughly: both say the same."""

from __future__ import annotations

import math

import numpy as np
import pytest

from physim import Column, Decisions, Mode, Rule, build_scene
from physim.errors import ControllerError
from tests.helpers import inside, road

Declared = inside("physim.parts", "Declared")
check_commands, checked = inside("physim.simulation", "check_commands", "checked")
outside, plainly_fine = inside("physim.simulation", "outside", "plainly_fine")

SCENE = build_scene(road([[2.0, y, 0.0] for y in (-2.0, 0.0, 2.0)]))
DECLARED = Declared(
    modes=(Mode("a", "#000000"), Mode("b", "#ffffff")), rules=(Rule("r"),), columns=(Column("c"),)
)
NUMBERS = {
    "command": (0.0, -0.5, 0.3, 1.0, 1.0 + 1e-12, 1.7, math.nan, -math.inf),
    "hold": (0.0, 0.05, 0.1, 0.3, 1e9, math.inf, -1e-9, math.nan),
    "mode": (-1, 0, 1, 2, -2),
    "rule": (-1, 0, 1),
}
RIGHT = {"command": 5, "hold": 6, "mode": 3, "rule": 2}
"""how many of them are, at the front"""


def drawn(rng, due, wrong):
    """Decisions of the robots due; with numbers that are wrong now and then, or without."""
    many = len(due)

    def some(name, *shape):
        right = RIGHT[name]
        return rng.choice(NUMBERS[name] if rng.random() < wrong else NUMBERS[name][:right], shape)

    others = [rng.permutation(np.setdiff1d(range(3), [i]))[: rng.integers(0, 3)] for i in due]
    considered = np.concatenate((*others, np.zeros(0))).astype(np.int64)
    start = np.cumsum([0, *map(len, others)])
    if len(considered) and rng.random() < wrong:
        considered[rng.integers(0, len(considered))] = rng.choice([0, 1, 2, 3, -1])
    if rng.random() < wrong:
        start[rng.integers(0, len(start))] = rng.integers(-1, 7)
    return Decisions(
        due, some("command", many, 2), some("hold", many), some("mode", many), some("rule", many),
        np.zeros((many, 1)), considered, start,
    )  # fmt: skip


def test_the_quick_check_passes_what_the_thorough_one_passes() -> None:
    rng = np.random.default_rng(0)
    passed = refused = 0
    for _ in range(3000):
        due = np.flatnonzero(rng.random(3) < 0.6)
        if not len(due):
            continue
        step = int(rng.integers(0, 1000))
        decisions = drawn(rng, due, rng.choice([0.0, 0.2]))
        quick, slow = (f(SCENE, step, due, decisions, DECLARED) for f in (plainly_fine, thorough))
        assert (quick is None) == (slow is None)
        if quick is not None:
            assert quick.tobytes() == slow.tobytes()
            passed += 1
        else:
            refused += 1
    assert passed > 500
    assert refused > 500


def thorough(scene, step, due, decisions, declared):
    try:
        return checked(scene, step, due, decisions, declared)
    except ControllerError:
        return None


@pytest.mark.parametrize("others", [[1, 1], [2, 1, 2], [1, 0]])
def test_a_robot_considers_each_other_once(others: list[int]) -> None:
    """Twice, and not even all robots there are: no record may hold that."""
    due = np.array([0])
    fine = drawn(np.random.default_rng(0), due, 0.0)
    start = np.array([0, len(others)])
    wrong = fine._replace(considered=np.array(others), considered_start=start)
    assert plainly_fine(SCENE, 0, due, wrong, DECLARED) is None
    with pytest.raises(ControllerError, match=r"considered lists .* each once"):
        checked(SCENE, 0, due, wrong, DECLARED)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("hold", np.zeros((3, 1))),
        ("mode", np.zeros(2, dtype=np.int64)),
        ("report", np.zeros((3, 2))),
        ("considered_start", np.zeros(3, dtype=np.int64)),
        ("considered", np.ones((2, 1), dtype=np.int64)),
        ("command", np.zeros((2, 2))),
    ],
)
def test_wrong_shapes_are_left_to_the_thorough_check(name, value) -> None:
    due = np.arange(3)
    fine = drawn(np.random.default_rng(0), due, 0.0)
    assert plainly_fine(SCENE, 0, due, fine, DECLARED) is not None
    other = fine._replace(**{name: value})
    assert plainly_fine(SCENE, 0, due, other, DECLARED) is None
    with pytest.raises(ControllerError, match="shape"):
        checked(SCENE, 0, due, other, DECLARED)


def test_other_types_and_layouts_pass_by_the_thorough_check() -> None:
    due = np.arange(3)
    fine = drawn(np.random.default_rng(0), due, 0.0)
    for other in (
        fine._replace(command=np.asfortranarray(fine.command)),
        fine._replace(hold=fine.hold.astype(np.float32)),
        fine._replace(mode=fine.mode.astype(np.int8)),
        fine._replace(considered=[], considered_start=np.zeros(4, dtype=np.int64)),
        fine._replace(considered_start=fine.considered_start.astype(np.uint64)),
    ):
        assert plainly_fine(SCENE, 7, due, other, DECLARED) is None
        assert checked(SCENE, 7, due, other, DECLARED).dtype == np.int64


@pytest.mark.parametrize("value", NUMBERS["command"])
def test_commands_from_outside_are_checked_alike(value: float) -> None:
    for column in (0, 1):
        given = np.zeros((3, 2))
        given[1, column] = value
        said = [refusal(check_commands, SCENE, 0.0, None, given), refusal(outside, SCENE, 0, given)]
        assert said[0] == said[1]
        assert bool(said[0]) == (not abs(value) <= SCENE.limits[1, column] * (1 + 1e-9))


def test_a_command_that_single_precision_rounds_up_is_told_in_full() -> None:
    """The limit itself, by a network in single precision, is 1.60000002."""
    given = np.zeros((3, 2))
    given[1, 1] = np.float32(SCENE.limits[1, 1])
    assert given[1, 1] > SCENE.limits[1, 1]
    said = refusal(outside, SCENE, 0, given)
    assert "1.60000002 rad/s" in said
    assert "within 1.6 rad/s" in said


def test_complex_commands_from_outside_are_no_numbers() -> None:
    """numpy would drop the imaginary part, such as that of a root of a quadratic."""
    assert "(N, 2)" in refusal(outside, SCENE, 0, np.zeros((3, 2), complex))


def refusal(check, *arguments) -> str:
    try:
        check(*arguments)
    except ControllerError as error:
        return str(error)
    return ""
