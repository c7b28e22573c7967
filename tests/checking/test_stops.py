"""Walls and robots too near ahead of where robots are to stop are told."""

from __future__ import annotations

from math import cos, sin
from pathlib import Path

import pytest

from physim import simulate
from physim.world.file import parse_world
from tests.checking.worlds import check, check_finding, lines
from tests.helpers import dead_end, inside

shipped_worlds = inside("physim.world.file", "shipped_worlds")

TWO = """\
name: two
time: {step: 0.01, duration: 30.0}
corridor: {centreline: [[0, 0], [20, 0]], width: 8.0}
robots:
  - {name: a, footprint: {length: 1.8, width: 1.0}, pose: [6.0, 1.5, 0.0], path: {offset: 1.5}}
  - {name: b, footprint: {length: 1.8, width: 1.0}, pose: [3.0, -1.0, 0.0], path: {offset: -1.0}}
controller: {type: path_following}
"""


def told(folder: Path, text: str) -> list[str]:
    return [line for line in lines(check(folder, text))[1] if "may never arrive" in line]


def test_an_end_wall_below_the_threshold_is_told_with_the_margin_that_mends_it(tmp_path):
    (line,) = told(tmp_path, dead_end(1.0))
    for part in ("end_margin", '"r1"', "0.1 m", "0.15 m", "1.05 m"):
        assert part in line
    assert told(tmp_path, dead_end(1.06)) == []


def test_a_run_that_is_not_to_finish_may_stop_anywhere(tmp_path):
    assert told(tmp_path, dead_end(1.0) + "expect: {finished: false}\n") == []


@pytest.mark.parametrize(("spacing", "warned"), [(2.7, True), (2.9, False)])
def test_a_robot_that_stops_close_behind_another_is_told(tmp_path, spacing, warned):
    """It would meet the one that stands within time_low below 1 m, at 1 m/s."""
    found = told(tmp_path, dead_end(3.0, [2.0 + spacing, 2.0]))
    assert len(found) == warned
    if warned:
        assert '"r2"' in found[0]
        assert "0.9 m" in found[0]


def test_a_wall_beside_a_stop_is_no_matter_of_the_end_margin(tmp_path):
    text = TWO.replace(
        "pose: [6.0, 1.5, 0.0], path: {offset: 1.5}", "pose: [6.0, 3, 0.0], path: {offset: 3.6}"
    )
    text = text.replace("path_following", "mode_switching")
    (line,) = told(tmp_path, text)
    assert "robots[0].path" in line
    assert "beside" in line
    assert "end_margin" not in line


def alone(margin: float, slant: float = 0.0) -> str:
    """A small robot without a formation whose end wall lies ``margin`` [m] beyond its path."""
    wall = [(-2, -2), (12 + margin + slant, -2), (12 + margin - slant, 2), (-2, 2), (-2, -2)]
    return (
        "name: alone\ntime: {step: 0.01, duration: 20.0}\n"
        f"boundaries: [{[list(point) for point in wall]}]\n"
        "reference_path: [[0, 0], [12, 0]]\nrobots:\n"
        "  - {name: r1, footprint: {length: 0.8, width: 0.5}, pose: [2, 0, 0], path: {offset: 0}}\n"
    )


@pytest.mark.parametrize(
    ("margin", "slant", "arrives"),
    [(0.65, 0.0, False), (0.95, 0.0, False), (1.05, 0.0, True), (0.9, 0.4, False)],
)
def test_a_stop_in_the_danger_area_is_told_where_the_robot_would_stand_before_it(
    tmp_path, margin, slant, arrives
):
    text = alone(margin, slant)
    assert simulate(parse_world(text)).ended == ("finished" if arrives else "duration")
    found = told(tmp_path, text)
    assert len(found) == (not arrives)
    if not slant and not arrives:
        assert f"{1.0 - margin:.4g} m" in found[0]
        assert "safe_distance" in found[0]


def test_a_stop_in_the_danger_area_harms_no_formation_and_no_path_beside_a_wall(tmp_path):
    assert told(tmp_path, alone(0.7) + "formation: {}\n") == []
    assert told(tmp_path, alone(0.7) + "controller: {safe_distance: 0.6}\n") == []
    forward = alone(0.7) + "controller: {reverse_in_safe_mode: false}\n"
    assert told(tmp_path, forward) == []
    assert simulate(parse_world(forward)).ended == "finished"
    assert told(tmp_path, alone(1.05).replace("{offset: 0}", "{offset: 1.2}")) == []
    assert told(tmp_path, alone(0.7) + "expect: {finished: false}\n") == []


def overlapping(folder: Path, text: str) -> list[str]:
    return [line for line in lines(check(folder, text))[1] if "cannot stand there" in line]


@pytest.mark.parametrize(
    ("offset", "now", "needed", "earlier"),
    [(1.5, "0 m", "1.8 m", "1.8 m"), (1.0, "0.5 m", "1.868 m", "1.8 m"), (0.4, "", "", "")],
)
def test_robots_that_stop_in_one_place_are_told(tmp_path, offset, now, needed, earlier):
    """1.8 m long and 1 m wide, they stop side by side with `offset` - 1.5 m between them."""
    (line,) = overlapping(tmp_path, TWO.replace("offset: -1.0", f"offset: {offset}")) or [""]
    facts = ('"a"', '"b"', f"(20, {offset:g})", "20.00 m", now, needed, earlier)
    assert bool(line) == bool(now)
    if line:
        check_finding(line, "6:92 robots[1].path.offset", *facts)


@pytest.mark.parametrize("turn", [0.0, 0.3, 0.64, 1.1, 2.0])
def test_robots_that_stop_on_one_another_do_not_stop_behind_one_another(tmp_path, turn):
    """By rounding one of them, both or neither stopped "0 m behind" the other, too."""
    c, s = cos(turn), sin(turn)
    poses = "".join(
        f"  - {{name: {name}, footprint: {{length: 1.8, width: 1.0}}, path: {{offset: 1.5}}, "
        f"pose: [{x * c - 1.5 * s}, {x * s + 1.5 * c}, {turn}]}}\n"
        for name, x in (("a", 7.0), ("b", 3.0))
    )
    world = TWO.replace("[20, 0]", f"[{20 * c}, {20 * s}]").replace(
        "path_following", "mode_switching"
    )
    head, _, tail = world.partition("  - ")
    world = head + poses + "controller:" + tail.partition("controller:")[2]
    assert len(overlapping(tmp_path, world)) == 1
    assert told(tmp_path, world) == []


def test_paths_that_end_across_each_other_are_told(tmp_path):
    """One heads up, one along, and both stop where they cross."""
    up = TWO.replace("{offset: -1.0}", "[[18.5, -3.0], [18.5, 1.0]]")
    (line,) = overlapping(tmp_path, up.replace("{offset: 1.5}", "[[0, 1.5], [18, 1.5]]"))
    check_finding(line, "6:83 robots[1].path", '"a"', '"b"', "(18.5, 1)", "0.9 m")


def test_no_word_of_stops_in_a_run_that_is_not_to_finish_or_that_keeps_them_apart(tmp_path):
    same = TWO.replace("offset: -1.0", "offset: 1.5")
    assert overlapping(tmp_path, same)
    assert not overlapping(tmp_path, same + "expect: {finished: false}\n")
    assert not overlapping(tmp_path, same + "formation: {spacing: [0.0, -3.0]}\n")
    assert not overlapping(tmp_path, same + "formation: {spacing: initial}\n")


def test_of_a_crowd_that_stops_in_one_place_one_line_counts_the_pairs(tmp_path):
    extra = "".join(
        f"  - {{name: c{k}, footprint: {{length: 1.8, width: 1.0}}, pose: [{12 + 3 * k}, 0, 0], "
        "path: {offset: 1.5}}\n"
        for k in range(2)
    )
    crowd = TWO.replace("offset: -1.0", "offset: 1.5").replace("controller:", f"{extra}controller:")
    (line,) = overlapping(tmp_path, crowd)
    assert "5 more pairs" in line


@pytest.mark.parametrize("name", shipped_worlds())
def test_no_shipped_world_is_told(name):
    from physim.world.checks import check_world

    assert not [w for w in check_world(name).warnings if "stops" in w.message]


@pytest.mark.parametrize("shift", [(0.0, 0.0), (-0.8, 0.0), (0.8, 0.0), (0.0, 0.45), (-0.7, -0.4)])
def test_what_lies_ahead_is_ahead_of_the_footprint_wherever_the_reference_point_is(
    tmp_path: Path, shift: tuple[float, float]
) -> None:
    """The footprint stands in the same place: only the point that follows the path is another.

    A post on the left and one on the right are ahead of its corners, and of nothing else.
    """
    x, y = shift
    corners = [(x + a, y + b) for a, b in ((-0.9, -0.5), (0.9, -0.5), (0.9, 0.5), (-0.9, 0.5))]
    outline = [[round(a, 3), round(b, 3)] for a, b in corners]

    def world(margin: float, side: int) -> str:
        near, far = 20.9 + margin, 21.2 + margin
        low, high = sorted((0.42 * side, 0.47 * side))
        return (
            "name: shifted\ntime: {step: 0.01, duration: 30.0}\n"
            "boundaries: [[[-9, -4], [30, -4], [30, 4], [-9, 4], [-9, -4]]]\n"
            f"obstacles: [[[{near}, {low}], [{far}, {low}], [{far}, {high}], [{near}, {high}]]]\n"
            f"reference_path: [[{-x}, {-y}], [{20 - x}, {-y}]]\n"
            f"robots:\n  - {{name: a, footprint: {outline}, pose: [{2 - x}, {-y}, 0], "
            f"path: [[{-x}, {-y}], [{20 - x}, {-y}]]}}\ncontroller: {{type: mode_switching}}\n"
        )

    def near(margin: float, side: int) -> list[str]:
        found = told(tmp_path, world(margin, side))
        return [line for line in found if "boundary_low" in line]

    for side in (-1, 1):
        (line,) = near(0.1, side)
        assert "0.1 m before obstacles[0]" in line
        assert near(0.16, side) == []
