"""Robots that run into others which they do not see by the rule of priority; judged by runs."""

from __future__ import annotations

from pathlib import Path

import pytest

import physim
from physim.world.file import parse_world
from tests.checking.worlds import check

BLIND = "does not see the other"
FOLLOWING = """\
name: following
time: {step: 0.02, duration: 24.0}
corridor: {centreline: CENTRELINE, width: 7.0}
robots:
  - {name: front, footprint: {length: 1.2, width: 0.7}, pose: [30, 0, 3.1416],
     path: [[38, 0], [2, 0]], limits: {v: 0.4}}
  - {name: rear, footprint: {length: 1.2, width: 0.7}, pose: [34, 0, 3.1416],
     path: [[38, 0], [6, 0]]}
"""
EAST, WEST = "[[0, 0], [40, 0]]", "[[40, 0], [0, 0]]"


@pytest.mark.parametrize("centreline", [EAST, WEST])
def test_who_follows_against_the_reference_path_is_blind(tmp_path, centreline):
    """Told where it is so, and only there: the run has a contact."""
    text = FOLLOWING.replace("CENTRELINE", centreline)
    told = check(tmp_path, text)
    with physim.simulate(parse_world(text)) as record:
        hit = bool(len(record.contacts))
    assert hit == (centreline == EAST)
    assert (BLIND in str(told)) == hit
    assert '"rear" may run into "front"' in str(told) or not hit


def test_others_against_the_reference_path_are_not_told(tmp_path):
    """One alone, two that cross or go another way, and who does not look out at all."""
    text = FOLLOWING.replace("CENTRELINE", EAST)
    for start in (0.0, 0.5):
        beside = text.replace("[38, 0], [6", f"[36, {start}], [6")
        beside = beside.replace("pose: [34, 0,", f"pose: [34, {start},")
        assert BLIND in str(check(tmp_path, beside))
    lone = text.replace("path: [[38, 0], [6, 0]]", "path: {offset: 2}")
    lone = lone.replace("[34, 0, 3.1416]", "[4, 2, 0]")
    crossing = text.replace("[[38, 0], [6, 0]]", "[[34, 3], [33, -3]]")
    merging = text.replace("[[38, 0], [6, 0]]", "[[34, 2.5], [26, 0], [6, 0]]")
    merging = merging.replace("pose: [34, 0, 3.1416]", "pose: [34, 2.5, 3.5]")
    merging = merging.replace("pose: [30, 0,", "pose: [30.5, 0,")  # it comes to lie beside it
    for one in (lone, crossing, merging):
        found = check(tmp_path, one)
        assert not found.errors
        assert BLIND not in str(found)
    assert BLIND not in str(
        check(tmp_path, text + "controller: {type: mode_switching, avoidance: none}\n")
    )


HALL = """\
name: hall
time: {step: 0.02, duration: 240.0}
boundaries: [[[-6, -6], [50, -6], [50, 30], [-6, 30], [-6, -6]]]
reference_path: REFERENCE
robots:
  - {name: fast, footprint: {length: 1.4, width: 0.8}, pose: [1.0, 0.0, 0.0], path: FAST}
  - {name: slow, footprint: {length: 1.4, width: 0.8}, pose: [22.0, 0.0, 0.0], path: SLOW,
     limits: {v: 0.3}}
controller: {type: mode_switching, reverse_in_safe_mode: false}
"""
OUT = "[[0, 0], [40, 0]]"
U_TURN = ("[[1, 0], [30, 0], [30, 8], [8, 8]]", "[[22, 0], [30, 0], [30, 8], [3, 8]]")
CORNER_TURN = ("[[1, 0], [30, 0], [30, 20]]", "[[22, 0], [30, 0], [30, 24]]")
STRAIGHT = ("[[1, 0], [40, 0]]", "[[22, 0], [44, 0]]")
LAP = "[[0, 0], [0, 20], [40, 20], [40, 0], [0, 0]]"
AGAINST_LAP = ("[[1, 0], [40, 0], [40, 20], [6, 20]]", "[[22, 0], [40, 0], [40, 20], [2, 20]]")


@pytest.mark.parametrize(
    ("reference", "ways", "is_blind"),
    [
        (OUT, U_TURN, True),
        ("[[0, 0], [30, 0], [30, 8], [0, 8]]", U_TURN, False),
        ("[[0, 0], [30, 0]]", CORNER_TURN, True),  # beyond the end all stations are equal
        ("[[0, 0], [30, 0], [30, 26]]", CORNER_TURN, False),
        ("[[32, 0], [48, 0]]", STRAIGHT, True),  # before its beginning, too
        ("[[0, 0], [48, 0]]", STRAIGHT, False),
        (LAP, AGAINST_LAP, True),
        ("[[0, 0], [40, 0], [40, 20], [0, 20], [0, 0]]", AGAINST_LAP, False),
    ],
    ids=["U-turn", "U-turn along", "end", "end along", "start", "start along", "lap", "lap along"],
)
def test_who_follows_where_stations_do_not_grow_is_blind(tmp_path, reference, ways, is_blind):
    text = HALL.replace("REFERENCE", reference).replace("FAST", ways[0]).replace("SLOW", ways[1])
    assert (BLIND in str(check(tmp_path, text))) == is_blind
    with physim.simulate(parse_world(text)) as record:
        assert bool(len(record.contacts)) == is_blind


def test_who_waited_behind_another_runs_into_it_where_it_is_blind(tmp_path):
    """Held back from the tenth metre on, up to the corner."""
    text = HALL.replace("REFERENCE", OUT).replace("FAST", U_TURN[0])
    text = text.replace("SLOW", U_TURN[1].replace("[22, 0]", "[8, 0]"))
    text = text.replace("pose: [22.0, 0.0, 0.0]", "pose: [8.0, 0.0, 0.0]")
    assert '"fast" may run into "slow"' in str(check(tmp_path, text))
    with physim.simulate(parse_world(text)) as record:
        assert len(record.contacts)


def test_robots_are_judged_from_where_they_start(tmp_path):
    """What of a path lies behind a robot is nobody's way; the joint of a lap is no turn."""
    text = HALL.replace("REFERENCE", "[[32, 0], [48, 0]]")
    text = text.replace("FAST", "[[-4, 0], [40, 0]]").replace("SLOW", "[[-4, 0], [44, 0]]")
    assert BLIND in str(check(tmp_path, text))
    ahead = text.replace("pose: [1.0,", "pose: [32.0,").replace("pose: [22.0,", "pose: [36.0,")
    assert BLIND not in str(check(tmp_path, ahead))


LANES = """\
name: lanes
time: {step: 0.02, duration: 85.0}
boundaries: [[[-6, -6], [36, -6], [36, 46], [24, 46], [24, 6], [-6, 6], [-6, -6]]]
reference_path: [[0, 0], [30, 0], [30, 42]]
robots:
ROBOTS
controller: {type: mode_switching}
expect: {finished: false}
"""
FAST = """  - {name: fast, footprint: {length: 1.4, width: 0.8}, pose: [11.0, Y, 0.0],
     path: {offset: Y}, limits: {v: 1.0}}"""
SLOW = """  - {name: slow, footprint: {length: 1.4, width: 0.8}, pose: [15.0, Y, 0.0],
     path: {offset: Y}, limits: {v: SPEED}}"""


@pytest.mark.parametrize(
    ("y", "order", "speed", "is_blind"),
    [
        (-2.5, (FAST, SLOW), 0.5, True),
        (-2.5, (SLOW, FAST), 0.5, False),  # of equal stations the first of the file has priority
        (2.5, (FAST, SLOW), 0.5, False),  # on the inside no two stations are equal
        (-2.5, (FAST, SLOW), 1.0, False),  # and who is no faster does not come near
    ],
)
def test_outside_a_corner_all_stations_are_equal(tmp_path, y, order, speed, is_blind):
    robots = "\n".join(order).replace("Y", f"{y}").replace("SPEED", f"{speed}")
    text = LANES.replace("ROBOTS", robots)
    assert (BLIND in str(check(tmp_path, text))) == is_blind
    with physim.simulate(parse_world(text)) as record:
        assert bool(len(record.contacts)) == is_blind


def test_beyond_the_joint_of_a_lap_stations_stay_for_a_while(tmp_path: Path) -> None:
    """A run's own station of a lap goes on at its end there before it leaps back."""
    text = HALL.replace("REFERENCE", "[[0, 10], [0, 0], [30, 0], [30, 20], [0, 20], [0, 10]]")
    way = "[[12, 20], [0, 20], [0, 0], [END, 0]]"
    text = text.replace("FAST", way.replace("END", "18")).replace("SLOW", way.replace("END", "24"))
    text = text.replace("pose: [1.0, 0.0, 0.0]", "pose: [12.0, 20.0, 3.1416]")
    text = text.replace("pose: [22.0, 0.0, 0.0]", "pose: [6.0, 20.0, 3.1416]")
    assert BLIND in str(check(tmp_path, text))
    with physim.simulate(parse_world(text)) as record:
        assert len(record.contacts)


def test_who_creeps_elsewhere_changes_nothing(tmp_path: Path) -> None:
    """Nor is a speed next to nothing a trouble."""
    text = FOLLOWING.replace("CENTRELINE", EAST).replace("width: 7.0", "width: 12.0")
    creeping = """  - {name: third, footprint: {length: 1.2, width: 0.7}, pose: [4, 4, 0],
     path: [[4, 4], [38, 4]], limits: {v: SPEED}}
"""
    for speed in ("0.004", "1.0e-310"):
        assert BLIND in str(check(tmp_path, text + creeping.replace("SPEED", speed)))
    alone = text.replace("limits: {v: 0.4}", "limits: {v: 1.0e-310}").replace(
        "path: [[38, 0], [6, 0]]", "path: [[38, 0], [6, 0]], limits: {v: 1.0e-310}"
    )
    assert BLIND not in str(check(tmp_path, alone))


def test_lanes_that_overlap_are_one_way(tmp_path: Path) -> None:
    text = FOLLOWING.replace("CENTRELINE", EAST)
    text = text.replace("[[38, 0], [2, 0]]", "[[38, 0.2], [2, 0.2]]").replace(
        "[30, 0,", "[30, 0.2,"
    )
    text = text.replace("[[38, 0], [6, 0]]", "[[38, -0.2], [6, -0.2]]").replace(
        "[34, 0,", "[34, -0.2,"
    )
    assert BLIND in str(check(tmp_path, text))
    with physim.simulate(parse_world(text)) as record:
        assert len(record.contacts)


@pytest.mark.parametrize(
    ("gain", "low", "is_told"), [(0.2, 0.4, False), (0.2, 0.8, True), (0.0, 0.4, True)]
)
def test_in_a_formation_who_comes_too_near_slows_down(
    tmp_path: Path, gain: float, low: float, is_told: bool
) -> None:
    """By (7), within its limits: no slower than the lower one, nor without a gain."""
    robots = "\n".join((FAST, SLOW)).replace("Y", "-2.5").replace("SPEED", "0.5")
    text = LANES.replace("ROBOTS", robots)
    text += f"formation: {{gain: {gain}, limits: [{low}, 1.3]}}\n"
    assert (BLIND in str(check(tmp_path, text))) == is_told
    with physim.simulate(parse_world(text)) as record:
        assert bool(len(record.contacts)) == is_told


@pytest.mark.parametrize("gain", [0.02, 0.2])
def test_against_the_reference_path_a_formation_slows_nobody(tmp_path: Path, gain: float) -> None:
    """Who comes nearer is, by its station, ever farther behind its place."""
    text = FOLLOWING.replace("CENTRELINE", EAST)
    text += f"formation: {{gain: {gain}, limits: [0.1, 1.3]}}\n"
    assert BLIND in str(check(tmp_path, text))
    with physim.simulate(parse_world(text)) as record:
        assert len(record.contacts)
