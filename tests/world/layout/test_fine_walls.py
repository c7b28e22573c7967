"""Walls with a point every millimetre are the walls that they look like."""

from __future__ import annotations

import re

import numpy as np
import pytest

import physim
from physim import build_scene
from physim.analysis.summary import summarise, table
from tests.helpers import facts
from tests.world.worlds import DRAWN, changed, check, lines

SIDES = "  - [[-3, -4], [33, -4], [33, 4]]\n  - [[33, 4], [-3, 4], [-3, -4]]\n"
FINE = 9_000
"""points a side"""


def points(first: tuple[float, float], last: tuple[float, float], count: int = FINE) -> str:
    """Points of a straight line as a world file has them."""
    line = np.linspace(first, last, count)
    return ", ".join(f"[{x:.9g}, {y:.9g}]" for x, y in line.tolist())


def finely_drawn() -> str:
    """The drawn world, its two long walls finely sampled, all of them one closed boundary."""
    ring = f"  - [{points((-3, -4), (33, -4))}, {points((33, 4), (-3, 4))}, [-3, -4]]\n"
    return changed(DRAWN, (SIDES, ring))


def test_a_finely_drawn_road_is_the_same_road(tmp_path):
    found = check(tmp_path, finely_drawn())
    assert lines(found) == lines(check(tmp_path, DRAWN)) == ([], [])
    fine, plain = (build_scene(physim.parse_world(text)) for text in (finely_drawn(), DRAWN))
    assert len(fine.walls.part_start) == len(plain.walls.part_start) == 5
    assert fine.area.polygon.equals(plain.area.polygon)
    (ring,) = fine.area.safe_rings(1.0)
    assert np.ptp(ring, axis=0) == pytest.approx((34.0, 6.0))


def test_a_run_without_a_safe_area_says_so(tmp_path):
    narrow = changed(
        DRAWN,
        ("time: {step: 0.01, duration: 60.0}", "time: {step: 0.01, duration: 0.1}"),
        (SIDES, "  - [[-3, -1.4], [33, -1.4], [33, 1.4], [-3, 1.4], [-3, -1.4]]\n"),
        ("[6.0, 1.0, 0.0]", "[6.0, 0.0, 0.0]"), ("[3.0, -1.0, 0.0]", "[3.0, 0.0, 0.0]"),
        ("[[0, 1], [30, 1]]", "[[0, 0], [30, 0]]"), ("offset: -1.0", "offset: 0.0"),
    )  # fmt: skip
    for distance, is_told in ((1.5, True), (1.3, False)):
        settings = f"controller: {{type: mode_switching, safe_distance: {distance}}}\n"
        world = physim.parse_world(narrow + settings)
        summary = summarise(physim.simulate(world))
        assert summary.no_safe_area == (distance if is_told else None)
        assert bool(re.search(facts("WARNING", "1.5 m", "safe area"), table(summary))) is is_told
        assert len(summary.warnings) == is_told
    plain = physim.simulate(physim.parse_world(narrow), controller="path_following")
    assert summarise(plain).warnings == ()  # it keeps no distance
