"""Random numbers: from the seed, the purpose and the robot alone."""

from __future__ import annotations

import math

import numpy as np

from physim.randomness import stream
from physim.scene_builder import build_scene
from tests.roads import road


def test_headings_depend_on_seed_purpose_and_robot_alone() -> None:
    free = [[20.0, -10.0, "random"], [30.0, 0.0, "random"], [40.0, 10.0, "random"]]
    heading = build_scene(road(free, seed=5)).start[:, 2]
    assert len(set(heading)) == 3
    assert (np.abs(heading) <= math.pi).all()
    more = [*free, [60.0, 0.0, "random"]]
    assert np.array_equal(build_scene(road(more, seed=5)).start[:3, 2], heading)
    fixed = [free[0], [30.0, 0.0, 1.0], free[2]]
    assert np.array_equal(build_scene(road(fixed, seed=5)).start[[0, 2], 2], heading[[0, 2]])
    other = build_scene(road(free, seed=6)).start[:, 2]
    assert not set(other) & set(heading)
    assert np.array_equal(build_scene(road(free), 5).start[:, 2], heading)


def test_streams_differ_by_each_part_of_their_key_and_stay_what_they_are() -> None:
    keys = [(s, p, i) for s in (0, 1, 2**63) for p in ("heading", "noise") for i in (0, 1)]
    assert len({stream(*key).random() for key in keys}) == len(keys)
    assert stream(7, "heading", 2).random() == GOLDEN


GOLDEN = 0.11372706497649021
