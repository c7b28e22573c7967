"""A wall that goes all round is named together with the place along it, wherever it is named."""

from __future__ import annotations

import json

import numpy as np
import pytest

import physim
from physim import build_scene
from physim.analysis.summary import table
from physim.analysis.validation import report, validate
from physim.world.checks import check_world
from tests.analysis.validation.runs import Drivers, edited
from tests.checking.test_robots import DRAWN, changed
from tests.helpers import inside

SeedResult, seed_line = inside("physim.analysis.validation", "SeedResult", "seed_line")
nearest_stretch, stretch_text = inside("physim.world", "nearest_stretch", "stretch_text")

RING = """\
name: ring
time: {step: 0.01, duration: DURATION}
boundaries: [[[-5, -4], [10, -4], [25, -4], [25, 4], [10, 4], [-5, 4], [-5, -4]]]
reference_path: [[0, 0], [20, 0]]
robots:
  - {name: r1, footprint: {length: 1.8, width: 1.0}, pose: [15.0, 2.0, 1.5707963],
     path: [[0, 0], [20, 0]]}
"""
STRETCH = "boundaries[0][3] to [4]"
"""From (25, 4) to (10, 4), which the robot drives at from (15, 2): its front is at y = 2.9."""


@pytest.fixture(scope="module")
def hit():
    return physim.simulate(
        physim.parse_world(RING.replace("DURATION", "2.0")), controller=Drivers((1.0, 0.0))
    )


@pytest.fixture(scope="module")
def near():
    return physim.simulate(
        physim.parse_world(RING.replace("DURATION", "1.0")), controller=Drivers((1.0, 0.0))
    )


def test_a_contact_says_where_along_the_wall(hit):
    (line,) = [line for line in table(physim.summarise(hit)).splitlines() if "deep" in line]
    assert STRETCH in line
    assert ", 4)" in line
    found = validate(hit)
    (one,) = found.contacts
    assert one.along.endswith(STRETCH)
    assert STRETCH in report(found)


def test_a_contact_too_deep_to_be_true_says_where_along_the_wall(hit, tmp_path):
    def deeper(rows):
        rows["depth"] = 0.45
        return rows

    with edited(hit, tmp_path / "record.h5", deeper) as record:
        (line,) = [s for s in table(physim.summarise(record)).splitlines() if "NOT PHYS" in s]
        assert STRETCH in line
        (deep,) = json.loads(physim.summarise(record).to_json())["deep_contacts"]
        assert deep["where"].endswith(STRETCH)


def test_a_seed_of_a_study_says_where_along_the_wall_it_failed(hit):
    assert STRETCH in seed_line(SeedResult.of(1, validate(hit)))


SPIKE = "[25, 4], [11, 4], [TIP], [10.5, 4], [10, 4]"


def test_a_graze_says_where_along_the_wall():
    """A corner of a robot that turns passes the tip of the wall in the middle of a step."""
    out, at = np.hypot(0.9, 0.5) - 1e-3, np.arctan2(0.5, 0.9) + 0.305
    tip = f"{10.0 + out * np.cos(at)}, {out * np.sin(at)}"
    text = RING.replace("[25, 4], [10, 4]", SPIKE.replace("TIP", tip))
    text = text.replace("[15.0, 2.0, 1.5707963]", "[10.0, 0.0, 0.0]").replace("DURATION", "0.6")
    record = physim.simulate(physim.parse_world(text), controller=Drivers((0.0, 1.0)))
    summary = physim.summarise(record)
    assert summary.contacts.count == 0
    (line,) = [line for line in table(summary).splitlines() if "before and after" in line]
    found = validate(record)
    (graze,) = json.loads(summary.to_json())["grazes"]
    for told in (line, graze["where"], " ".join(report(found).split())):
        assert "boundaries[0][4] to [5]" in told
    assert "(10.71, 0.746" in graze["where"]


@pytest.mark.parametrize(
    ("pose", "place"),
    [
        ("[15.0, 3.6, 0.0]", STRETCH),  # it crosses the line
        ("[15.0, 3.5, 0.0]", STRETCH),  # it touches it
        ("[0.0, -3.7, 0.0]", "boundaries[0][0] to [1]"),
    ],
)
def test_an_overlap_at_the_start_says_where_along_the_wall(pose, place):
    text = RING.replace("[15.0, 2.0, 1.5707963]", pose).replace("DURATION", "1.0")
    with pytest.raises(physim.WorldError) as refused:
        build_scene(physim.parse_world(text))
    (fault,) = refused.value.faults
    assert f"at ({pose[1:].split('.')[0]}" in fault.message
    assert place in fault.message


def test_the_nearest_wall_says_where(near):
    rows = dict(line.split("  ", 1) for line in table(physim.summarise(near)).splitlines())
    assert STRETCH in rows["shortest boundary distance"]
    found = validate(near)
    assert found.near_misses.smallest_boundary.along.endswith(STRETCH)
    assert STRETCH in " ".join(report(found).split())


def test_a_check_says_where_along_the_wall_there_is_too_little_room(tmp_path):
    dent = "[[33, 4], [17, 4], [15, 1.3], [13, 4], [-3, 4], [-3, -4]]"
    file = tmp_path / "w.yaml"
    file.write_text(changed(DRAWN, ("[[33, 4], [-3, 4], [-3, -4]]", dent)))
    (warning,) = check_world(file).warnings
    assert "at (15, 1.3), boundaries[1][1] to [2]" in warning.message


def test_the_stretch_is_the_nearest_one_of_the_file():
    line = [[0, 0], [2, 0], [2, 3]]
    assert [nearest_stretch(line, p) for p in ([1, 1], [2, 2], [9, 1], [2, 0])] == [0, 1, 1, 0]
    assert stretch_text([line], "boundary 1", [2, 2]) == "at (2, 2), boundaries[0][1] to [2]"
    assert stretch_text([line], "boundaries[0]", np.array([1, 0])).endswith(
        "boundaries[0][0] to [1]"
    )
    for boundaries, name in ((None, "left wall"), ([line], "obstacle 1"), ([line], "boundary 2")):
        assert stretch_text(boundaries, name, [1, 1]) == "at (1, 1)"
