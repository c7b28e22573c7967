"""What the check foretells of a run: for each kind one world that is told and one that is not."""

from __future__ import annotations

from math import cos, pi, radians, sin

import pytest

from tests.helpers import dead_end
from tests.world.worlds import CORRIDOR, changed, check, lines, with_facts

SIZE = "footprint: {length: 1.2, width: 0.7}"
WHOLE = "expect: {finished: false}\n"


def following(centreline: str) -> str:
    """Two robots one behind the other from (38, 0) to (2, 0)."""
    return (
        "name: following\ntime: {step: 0.02, duration: 24.0}\n"
        f"corridor: {{centreline: {centreline}, width: 7.0}}\nrobots:\n"
        f"  - {{name: front, {SIZE}, pose: [30, 0, 3.1416],\n"
        "     path: [[38, 0], [2, 0]], limits: {v: 0.4}}\n"
        f"  - {{name: rear, {SIZE}, pose: [34, 0, 3.1416], path: [[38, 0], [6, 0]]}}\n"
    )


def junction(first: float, more: str = "", controller: str = "{type: path_following}") -> str:
    """b comes out of a side arm onto the way of a, which stops 5 m after the junction."""
    hall = "[[-15, -3], [25, -3], [25, 3], [3, 3], [3, 20], [-3, 20], [-3, 3], [-15, 3], [-15, -3]]"
    return (
        "name: junction\ntime: {step: 0.02, duration: 60.0}\n"
        f"boundaries: [{hall}]\nreference_path: [[-12, 0], [22, 0]]\nrobots:\n"
        f"  - {{name: a, {SIZE}, pose: [{-first}, 0, 0], path: [[-12, 0], [5, 0]]}}\n"
        f"  - {{name: b, {SIZE}, pose: [0, 8, -1.5708], path: [[0, 17], [0, 0], [20, 0]]}}\n"
        f"controller: {controller}\n{more}"
    )


def along_walls(width: float) -> str:
    """A corridor whose robots drive 0.1 m from its walls."""
    side = width / 2.0 - 0.6
    return changed(
        CORRIDOR, ("width: 8.0", f"width: {width}"), ("{offset: 1.0}", f"{{offset: {side:.3f}}}"),
        ("{offset: -1.0}", f"{{offset: -{side:.3f}}}"),
    )  # fmt: skip


def hairpin(own: str) -> str:
    """r1 on a path whose legs are 3 m apart, r2 on a path of its own from (2, 1.5)."""
    return (
        "name: hairpin\ntime: {step: 0.02, duration: 150.0}\n"
        "boundaries: [[[-4, -4], [46, -4], [46, 13], [-4, 13], [-4, -4]]]\n"
        "reference_path: [[2, 3], [40, 3], [40, 6], [2, 6]]\n"
        "formation: {gain: 0.05, limits: [0.8, 1.3]}\nrobots:\n"
        f"  - {{name: r1, {SIZE}, pose: [6, 3, 0], path: {{offset: 0}}}}\n"
        f"  - {{name: r2, {SIZE}, pose: [2, 1.5, 0], path: {own}}}\n"
        "controller: {type: path_following}\n"
    )


def four(neighbours: str, spacing: str = "[0, -5, -10, -15]", gap: float = 5.0) -> str:
    """Robots in formation, 4 m apart two by two, with ``gap`` between b and c."""
    robots = "".join(
        f"  - {{name: {name}, {SIZE}, pose: [{x}, 0, 0], path: {{offset: 0}}}}\n"
        for name, x in zip("abcd", (24 + gap, 20 + gap, 20, 16), strict=True)
    )
    return (
        "name: four\ntime: {step: 0.01, duration: 60.0}\n"
        f"corridor: {{centreline: [[0, 0], [80, 0]], width: 6.0}}\nrobots:\n{robots}"
        f"formation: {{gain: 0.1, spacing: {spacing}, {neighbours}}}\nsensing: {{range: 12.0}}\n"
    )


def circle(radius: float) -> list[list[float]]:
    angles = [2.0 * pi * k / 48 for k in range(48)] + [0.0]
    return [[round(radius * cos(a), 4), round(radius * sin(a), 4)] for a in angles]


def ring(*degrees: float, more: str = "") -> str:
    """Robots on a closed path of 10 m radius, counter-clockwise from 0 degrees."""
    lap = circle(10.0)
    robots = "".join(
        f"  - {{name: r{k}, footprint: {{length: 1.0, width: 0.6}}, path: {lap}, pose: "
        f"[{10 * cos(a):.3f}, {10 * sin(a):.3f}, {a + pi / 2:.3f}]}}\n"
        for k, a in enumerate(map(radians, degrees), 1)
    )
    return (
        "name: ring\ntime: {step: 0.02, duration: 90.0}\n"
        f"boundaries: [{circle(13.0)}, {circle(7.0)}]\nreference_path: {lap}\n{more}"
        f"robots:\n{robots}controller: {{type: path_following}}\n"
    )


def lasso(pose: str) -> str:
    return (
        "name: lasso\ntime: {step: 0.02, duration: 60.0}\n"
        "boundaries: [[[-10, -15], [30, -15], [30, 25], [-10, 25], [-10, -15]]]\n"
        "reference_path: [[0, -12], [20, -12]]\nrobots:\n"
        f"  - {{name: r1, footprint: {{length: 1.0, width: 0.6}}, pose: {pose},\n"
        "     path: [[0, 0], [10, 0], [10, 10], [0.1, 10], [0.1, -5]]}\n"
        "controller: {type: path_following}\n"
    )


def two_legs(y: float, path: str = "{offset: 0}", more: str = "") -> str:
    """A corridor that comes back 5.2 m beside itself, beyond a wall; a robot beside the way out."""
    return (
        "name: hairpin\ntime: {step: 0.01, duration: 10}\ncorridor:\n"
        "  centreline: [[0, 0], [30, 0], [34, 0], [34, 5.2], [30, 5.2], [0, 5.2]]\n"
        "  width: [8, 8, 2, 2, 2, 2]\nrobots:\n"
        f"  - {{name: r1, footprint: {{length: 0.8, width: 0.4}}, pose: [8, {y}, 0],\n"
        f"     path: {path}}}\n{more}"
    )


BESIDE = "[[8, 3], [27, 3], [31, 0], [34, 0], [34, 5.2], [0, 5.2]]"
FORMATION = "formation: {gain: 0.05, speed: 0.8, limits: [0.5, 1.0]}\n"


def hall(pose: str) -> str:
    return (
        "name: far\ntime: {step: 0.02, duration: 90}\n"
        "boundaries: [[[0, 0], [40, 0], [40, 30], [0, 30], [0, 0]]]\n"
        "reference_path: [[2, 19], [36, 19]]\nrobots:\n"
        f"  - {{name: a, {SIZE}, pose: {pose}, path: {{offset: 0}}}}\n"
    )


def alone(margin: float, more: str = "") -> str:
    """A small robot without a formation whose end wall lies ``margin`` [m] beyond its path."""
    end = 12 + margin
    return (
        "name: alone\ntime: {step: 0.01, duration: 20.0}\n"
        f"boundaries: [[[-2, -2], [{end}, -2], [{end}, 2], [-2, 2], [-2, -2]]]\n"
        "reference_path: [[0, 0], [12, 0]]\nrobots:\n"
        "  - {name: r1, footprint: {length: 0.8, width: 0.5}, pose: [2, 0, 0], path: {offset: 0}}\n"
        f"{more}"
    )


def same_stop(offset: float, more: str = "") -> str:
    return (
        "name: two\ntime: {step: 0.01, duration: 30.0}\n"
        "corridor: {centreline: [[0, 0], [20, 0]], width: 8.0}\nrobots:\n"
        "  - {name: a, footprint: &box {length: 1.8, width: 1.0}, pose: [6.0, 1.5, 0.0],\n"
        "     path: {offset: 1.5}}\n"
        f"  - {{name: b, footprint: *box, pose: [3.0, -1.0, 0.0], path: {{offset: {offset}}}}}\n"
        f"controller: {{type: path_following}}\n{more}"
    )


TOLD = {
    "who follows against the reference path is blind":
        (following("[[0, 0], [40, 0]]"), following("[[40, 0], [0, 0]]"),
         "robots[1].path", "does not see the other", '"rear"', '"front"'),
    "who stops in the way of another":
        (junction(2.0), junction(11.9),
         "robots[0].path", "in the way of", '"a"', '"b"', "17.00 m", "(5, 0)"),
    "but in a run that is not to finish":
        (junction(2.0), junction(2.0, WHOLE), "robots[0].path", "in the way of"),
    "or in a formation":
        (junction(2.0), junction(2.0, "formation: {}\n"), "robots[0].path", "in the way of"),
    "a threshold of danger beyond the room":
        (CORRIDOR + "controller: {boundary_low: 3.5}\n",
         changed(CORRIDOR, ("width: 8.0", "width: 8.0, end_margin: 4.0"))
         + "controller: {boundary_low: 2.4}\n",
         "controller.boundary_low", "danger mode", "below 3.5 m", '"a"', "at most 2.5 m",
         "1 other robot"),
    "a path in danger all along":
        (along_walls(3.2), along_walls(4.2), "robots[0].path.offset", "danger area", '"a"',
         "1 more robot", "less than 1 m", "1.6 m", "1.03 m"),
    "an error of formation at the stops":
        (hairpin("[[2, 1.5], [38, 1.5]]"),
         hairpin("[[2, 1.5], [41.5, 1.5], [41.5, 7.5], [2, 7.5]]"),
         "robots[1].path", "the formation error will be", "r2", "21.5 m"),
    "neighbours out of range":
        (four("range: 4.99"), four("range: 6.0"),
         "formation.range", "whatever the gain", "5 m ahead", "in formation"),
    "neighbours out of range at the start":
        (four("range: 6.0", gap=9.0), four("range: 1.0, neighbours: all", gap=9.0),
         "formation.range", "whatever the gain", "9 m ahead", "at the start", '"b"', '"c"'),
    "neighbours in two parts":
        (four("neighbours: [[a, b], [c, d]]"), four("neighbours: [[d, a], [a, b], [c, b]]"),
         "formation.neighbours", "whatever the gain", '"c", "d"'),
    "a lap from just before the joint":
        (ring(-10.0), ring(0.0),
         "robots[0].path", "not a lap", "r1", "closed path", "1.74 m"),
    "a formation on both sides of the joint":
        (ring(12.0, -12.0, more="formation: {}\n"), ring(36.0, 12.0, more="formation: {}\n"),
         "reference_path", "both sides of its joint", '"r1"', '"r2"', "2.09", "60.69"),
    "a start nearer to a later leg":
        (lasso("[0, 0.3, 0]"), lasso("[0.1, 0.3, -1.57]"),
         "robots[0].path", "faces", "station 0.00 m", "0.30 m away", "skips 39.60 m"),
    "the path beyond a wall":
        (two_legs(3.0), two_legs(2.5), "robots[0].pose", "beyond a wall or an obstacle",
         "2.2 m from its path", "65.20 m"),
    "the reference path beyond a wall":
        (two_legs(3.0, BESIDE, FORMATION), two_legs(3.0, BESIDE), "robots[0].pose",
         "beyond a wall or an obstacle", "2.2 m from the reference path", "8.00 m", "3 m away"),
    "a start far from its path":
        (hall("[19, 4, 0]"), hall("[4, 10, 0]"),
         "robots[0].pose", "15 m away", "(19, 19)"),
    "an end wall below the threshold":
        (dead_end(1.0), dead_end(1.06),
         "end_margin", "may never arrive", '"r1"', "0.1 m", "0.15 m", "1.05 m"),
    "a stop close behind another":
        (dead_end(3.0, [4.7, 2.0]), dead_end(3.0, [4.9, 2.0]),
         "robots[1]", "may never arrive", '"r2"', "0.9 m"),
    "a stop in the danger area":
        (alone(0.7), alone(1.05), "robots[0]", "may never arrive", "0.3 m", "safe_distance"),
    "a stop in the danger area in a formation":
        (alone(0.7), alone(0.7, "formation: {}\n"), "robots[0]", "may never arrive"),
    "stops in one place":
        (same_stop(1.5), same_stop(0.4), "robots[1].path.offset", "cannot stand there",
         '"a"', '"b"', "(20, 1.5)", "20.00 m", "0 m", "1.8 m"),
    "stops in one place, in formation":
        (same_stop(1.5), same_stop(1.5, "formation: {spacing: [0.0, -3.0]}\n"),
         "robots[1].path.offset", "cannot stand there"),
}  # fmt: skip


@pytest.mark.parametrize("name", TOLD)
def test_what_is_foretold(tmp_path, name):
    told, untold, where, *parts = TOLD[name]
    (_, warnings), (_, others) = lines(check(tmp_path, told)), lines(check(tmp_path, untold))
    assert with_facts(warnings, where, *parts), warnings
    assert not with_facts(others, parts[0]), others
