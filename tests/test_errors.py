"""Words that messages are made of."""

from __future__ import annotations

import pytest

from physim.errors import plural


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ((0, "robot"), "0 robots"),
        ((1, "robot"), "1 robot"),
        ((2, "robot"), "2 robots"),
        ((1, "stretch", "stretches"), "1 stretch"),
        ((2, "stretch", "stretches"), "2 stretches"),
    ],
)
def test_plural(given, told) -> None:
    assert plural(*given) == told
