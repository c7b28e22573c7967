"""A message is held against facts, not against a sentence."""

from __future__ import annotations

import re

import pytest

from tests.helpers import facts


@pytest.mark.parametrize(
    ("parts", "found"),
    [
        (("r2", "0.05 s", "v"), True),
        (("0.05 s", "r2"), True),
        (("r2", "omega"), False),
        (("r", "v"), False),  # words of their own: r2 is not r
        (("1.5 m/s)",), True),
        (("05 s",), False),  # nor is 05 a part of 0.05
        (("1",), False),  # nor 1 of 1.5
        (("1.5 m/s]",), False),
    ],
)
def test_every_fact_counts_and_none_is_a_pattern(parts: tuple[str, ...], found: bool) -> None:
    message = "r2 at 0.05 s: command v = 2 m/s\n(within 1.5 m/s)"
    assert bool(re.search(facts(*parts), message)) is found
