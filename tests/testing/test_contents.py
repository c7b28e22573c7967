"""What two values hold is compared leaf by leaf, and the first difference has a name."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from physim.contacts import Phase
from tests.helpers import inside

contents, difference = inside("physim.testing", "contents", "difference")


@dataclass
class Held:
    value: Any


class Slotted:
    __slots__ = ("__hidden", "value")

    def __init__(self, value: Any) -> None:
        self.value = value
        self.__hidden = value


def loop(value: int) -> list[Any]:
    made: list[Any] = [value]
    made.append(made)
    return made


UNLIKE: dict[str, tuple[Any, Any, str]] = {
    "number": (1, 2, "x"),
    "NaN": (float("nan"), 0.0, "x"),
    "kind of an enumeration": (Phase.BEGAN, Phase.ENDED, "x"),
    "in a list": ([1, [2]], [1, [3]], "x[1][0]"),
    "longer list": ([1], [1, 2], "x[1]"),
    "key": ({"a": 1}, {"b": 1}, "x['a']"),
    "set": ({1}, {2}, "x"),
    "array": (np.zeros((2, 2)), np.array([[0, 0], [5.0, 0]]), "x[1, 0]"),
    "array of objects": (np.array([{}, {"a": 1}]), np.array([{}, {"a": 2}]), "x.tolist()[1]['a']"),
    "dataclass": (Held([1]), Held([2]), "x.value[0]"),
    "slots": (Slotted(1), Slotted(2), "x._Slotted__hidden"),
    "kind": (Held(1), Slotted(1), "x.__class__"),
    "loop": (loop(1), loop(2), "x[0]"),
    "generator": (np.random.default_rng(1), np.random.default_rng(2), "x"),
}


@pytest.mark.parametrize("what", UNLIKE)
def test_the_first_difference_is_named(what: str) -> None:
    one, other, place = UNLIKE[what]
    for value in (one, other):
        assert difference(contents(value, "x"), contents(copy.deepcopy(value), "x")) is None
    found = difference(contents(one, "x"), contents(other, "x"))
    assert found is not None
    assert found.place == place
    assert found.before != found.after


def test_what_a_function_keeps_counts_where_it_is_asked_for() -> None:
    def made() -> tuple[Any, list[int]]:
        kept = [0]

        def function(default: list[int] = []) -> None:  # noqa: B006
            kept.append(len(default))

        return function, kept

    function, kept = made()
    before = contents(function, "f", functions=True)
    plain = contents(function, "f")
    kept[0] = 7
    assert difference(plain, contents(function, "f")) is None
    found = difference(before, contents(function, "f", functions=True))
    assert found == ("f's kept[0]", "0", "7")
    function.calls = 1
    found = difference(before, contents(function, "f", functions=True) | {"f's kept[0]": 0})
    assert found == ("f.calls", "nothing", "1")


def test_no_more_is_looked_at_than_allowed() -> None:
    assert len(contents(list(range(100)), "x", most=10)) == 10
