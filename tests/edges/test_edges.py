"""Every trial of `tests.edges`, one test each."""

from __future__ import annotations

import pytest

from tests.edges.item import Item, all_items

TRIALS = [
    pytest.param(item, name, id=f"{item.number}-{item.name}-{name}")
    for item in all_items()
    for name in item.trials
]


@pytest.mark.parametrize(("item", "name"), TRIALS)
def test_edge(item: Item, name: str) -> None:
    item.run(name)


def test_each_item_says_what_holds() -> None:
    for item in all_items():
        assert item.line.endswith("."), item.name
