"""What two values hold is compared leaf by leaf, and the first difference has a name."""

from __future__ import annotations

import copy
import pickle
import random
from collections import deque
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pytest
from pydantic import BaseModel

from physim.contacts import Phase
from tests.helpers import inside

contents, difference = inside("physim.testing", "contents", "difference")


class Pair(NamedTuple):
    first: Any
    second: Any


@dataclass
class Held:
    value: Any


class Slotted:
    __slots__ = ("__hidden", "value")

    def __init__(self, value: Any) -> None:
        self.value = value
        self.__hidden = value


class Model(BaseModel):
    value: float = 1.0


class Listing(list[int]):
    """A list with an attribute."""

    note = ""


def listing(note: str) -> Listing:
    made = Listing([1])
    made.note = note
    return made


def loop(value: int) -> list[Any]:
    made: list[Any] = [value]
    made.append(made)
    return made


UNLIKE: dict[str, tuple[Any, Any, str]] = {
    "number": (1, 2, "x"),
    "last bit": (0.1, np.nextafter(0.1, 1.0), "x"),
    "NaN": (float("nan"), 0.0, "x"),
    "nothing": (None, 0, "x"),
    "kind of an enumeration": (Phase.BEGAN, Phase.ENDED, "x"),
    "in a list": ([1, [2]], [1, [3]], "x[1][0]"),
    "longer list": ([1], [1, 2], "x[1]"),
    "emptied": ([1], [], "x[0]"),
    "empty things": ([], {}, "x"),
    "key": ({"a": 1}, {"b": 1}, "x['a']"),
    "set": ({1}, {2}, "x"),
    "deque": (deque([1]), deque([2]), "x[0]"),
    "array": (np.zeros((2, 2)), np.array([[0, 0], [5.0, 0]]), "x[1, 0]"),
    "shape": (np.zeros(2), np.zeros(3), "x"),
    "array of objects": (np.array([{}, {"a": 1}]), np.array([{}, {"a": 2}]), "x.tolist()[1]['a']"),
    "named": (Pair(1, 2), Pair(1, 3), "x.second"),
    "dataclass": (Held([1]), Held([2]), "x.value[0]"),
    "slots": (Slotted(1), Slotted(2), "x._Slotted__hidden"),
    "model": (Model(), Model(value=2.0), "x.value"),
    "attribute of a list": (listing("a"), listing("b"), "x.note"),
    "kind": (Held(1), Slotted(1), "x.__class__"),
    "loop": (loop(1), loop(2), "x[0]"),
    "generator": (np.random.default_rng(1), np.random.default_rng(2), "x"),
    "old generator": (np.random.RandomState(1), np.random.RandomState(2), "x"),
    "random": (random.Random(1), random.Random(2), "x"),
}


@pytest.mark.parametrize("what", UNLIKE)
def test_the_first_difference_is_named(what: str) -> None:
    one, other, place = UNLIKE[what]
    found = difference(contents(one, "x"), contents(other, "x"))
    assert found is not None
    assert found.place == place
    assert found.before != found.after


@pytest.mark.parametrize("what", UNLIKE)
def test_copies_hold_the_same(what: str) -> None:
    for value in UNLIKE[what][:2]:
        copies = [copy.deepcopy(value)]
        if what != "slots":  # of a class that pickle does not know how to take apart
            copies.append(pickle.loads(pickle.dumps(value)))
        for other in copies:
            assert difference(contents(value, "x"), contents(other, "x")) is None


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
