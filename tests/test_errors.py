"""Words that messages are made of."""

from __future__ import annotations

import pytest

from physim.errors import amount_text, place_text, plural


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


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ((1.5, -4.0), "(1.5, -4)"),
        ((0.12345678, 4321.0987), "(0.123457, 4321.1)"),
        ((0.12345678, 4321.0987, 4), "(0.1235, 4321.1)"),
        ((432100.5, 5812345.257), "(432100.5, 5812345.26)"),
        ((-432070.0, 812398.996, 4), "(-432070, 812399)"),
    ],
)
def test_places_are_told_to_the_centimetre_far_from_the_origin(given, told) -> None:
    assert place_text(*given) == told


def test_small_amounts_keep_two_digits_and_large_ones_have_commas() -> None:
    """The impulses of a robot of 0.15 kg were all 0.0 N s."""
    told = [amount_text(x, 1) for x in (0.00798, 0.39, 0.0, 12.34, -0.02, 12345.6)]
    assert told == ["0.0080", "0.39", "0.0", "12.3", "-0.020", "12,345.6"]
