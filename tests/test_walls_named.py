"""A wall that goes all round is named together with the place along it, wherever it is named."""

from __future__ import annotations

import pytest

import physim
from physim import build_scene
from physim.analysis.summary import table
from physim.analysis.validation import validate
from tests.analysis.validation.runs import Drivers
from tests.helpers import inside

report = inside("physim.analysis.validation", "report")

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


def test_a_contact_says_where_along_the_wall(hit):
    (line,) = [line for line in table(physim.summarise(hit)).splitlines() if "deep" in line]
    assert STRETCH in line
    assert ", 4)" in line
    found = validate(hit)
    (one,) = found.contacts
    assert one.along.endswith(STRETCH)
    assert STRETCH in report(found)


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
