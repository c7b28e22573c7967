"""The one palette: what must be told apart can be, also without red or green cones."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray

from physim import PAPER_MODES
from tests.drawing import palette

# Machado, Oliveira and Fernandes (2009), severity 1, for linear RGB
SEEN_BY = {
    "all cones": np.eye(3),
    "no red": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
         [-0.003882, -0.048116, 1.051998]]
    ),
    "no green": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
         [-0.011820, 0.042940, 0.968881]]
    ),
}  # fmt: skip
# Ottosson (2020)
TO_CONES = np.array(
    [[0.4122214708, 0.5363325363, 0.0514459929], [0.2119034982, 0.6806995451, 0.1073969566],
     [0.0883024619, 0.2817188376, 0.6299787005]]
)  # fmt: skip
TO_OKLAB = np.array(
    [[0.2104542553, 0.7936177850, -0.0040720468], [1.9779984951, -2.4285922050, 0.4505937099],
     [0.0259040371, 0.7827717662, -0.8086757660]]
)  # fmt: skip


def oklab(colour: palette.Colour, eye: str) -> NDArray[np.float64]:
    """Colour as an eye sees it, hundredths of Oklab: 100 from black to white."""
    value = np.array(colour) / 255.0
    linear = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    cones = TO_CONES @ np.clip(SEEN_BY[eye] @ linear, 0.0, 1.0)
    return np.asarray(100.0 * TO_OKLAB @ np.cbrt(cones))


def apart(a: palette.Colour, b: palette.Colour) -> float:
    """Least distance of two colours over all eyes."""
    return min(float(np.linalg.norm(oklab(a, eye) - oklab(b, eye))) for eye in SEEN_BY)


MODES = [palette.rgb(mode.colour) for mode in PAPER_MODES]


def test_the_eyes_see_black_and_white_as_they_are() -> None:
    for eye in SEEN_BY:
        assert oklab((255, 255, 255), eye) == pytest.approx([100.0, 0.0, 0.0], abs=0.1)
    assert apart((255, 0, 0), (0, 200, 0)) < apart((0, 0, 255), (255, 255, 0)) / 3.0


def test_robots_are_told_apart_and_from_contacts_and_modes() -> None:
    pairs = itertools.combinations((*palette.ROBOTS, palette.CONTACT), 2)
    assert min(apart(*pair) for pair in pairs) >= 9.0
    first = itertools.combinations(palette.ROBOTS[:4], 2)
    assert min(apart(*pair) for pair in first) >= 20.0
    assert min(apart(a, b) for a in palette.ROBOTS for b in MODES) >= 5.0


def test_modes_of_the_paper_are_told_apart_and_from_contacts() -> None:
    pairs = itertools.combinations((*MODES, palette.CONTACT), 2)
    assert min(apart(*pair) for pair in pairs) >= 10.0


def test_a_mover_is_told_apart_from_all_else() -> None:
    others = [*palette.ROBOTS, *MODES, palette.CONTACT, palette.UNDECIDED, palette.SAFE_AREA]
    assert min(apart(palette.MOVER, other) for other in others) >= 10.0


def test_the_danger_area_is_darker_than_the_safe_one() -> None:
    light = [oklab(c, "all cones")[0] for c in (palette.DANGER_AREA, palette.SAFE_AREA)]
    assert light[0] < light[1] - 4.0


def test_colours_are_written_and_read_alike() -> None:
    for colour in palette.ROBOTS:
        assert palette.rgb(palette.hexed(colour)) == colour
    assert palette.hexed(palette.CONTACT) == "#d55e00"
