"""The formation as a run will measure it at the stops, foretold and driven."""

from __future__ import annotations

from math import pi
from pathlib import Path

import numpy as np
import pytest
import shapely

from physim import build_scene, simulate
from physim.world.checks import measured as measuring
from physim.world.file import parse_world
from tests.checking.worlds import check, lines, with_facts
from tests.helpers import inside

followed = inside("physim.record", "followed")
formation_errors = inside("physim.simulation", "formation_errors")

HAIRPIN = [[2, 3], [40, 3], [40, 6], [2, 6]]


def world(own: list[list[float]], y: float, formation: bool = True) -> str:
    """Robot r1 on a hairpin path whose legs are 3 m apart, r2 on a path of its own."""
    x, _ = own[0]
    return (
        "name: hairpin\ntime: {step: 0.02, duration: 150.0}\n"
        "boundaries: [[[-4, -4], [46, -4], [46, 13], [-4, 13], [-4, -4]]]\n"
        f"reference_path: {HAIRPIN}\n"
        + "formation: {gain: 0.05, limits: [0.8, 1.3]}\n"
        * formation
        + "robots:\n"
        "  - {name: r1, footprint: {length: 1.0, width: 0.6}, pose: [6, 3, 0],\n"
        "     path: {offset: 0}}\n"
        f"  - {{name: r2, footprint: {{length: 1.0, width: 0.6}}, pose: [{x}, {y}, 0],\n"
        f"     path: {own}}}\n"
        "controller: {type: path_following}\n"
    )


BESIDE = [[2, 1.5], [41.5, 1.5], [41.5, 7.5], [2, 7.5]]
WRONG_LEG = [[2, 4.8], [38, 4.8]]
"""nearer to the second leg: at its beginning it is at the reference path's end"""
HALF = [[2, 1.5], [38, 1.5]]


@pytest.mark.parametrize(("own", "off"), [(BESIDE, 0.0), (HALF, 21.5)])
def test_what_will_be_off_is_told(tmp_path: Path, own: list[list[float]], off: float) -> None:
    """By as much as a run's own formation error would be there."""
    text = world(own, own[0][1])
    told = with_facts(lines(check(tmp_path, text))[1], "r2", "the formation error will be")
    assert bool(told) == (off > 0.0)
    error = np.abs(formation_errors(build_scene(parse_world(text)), _at_stops(text))).max()
    assert error == pytest.approx(off, abs=0.5)
    assert not told or f"will be {error:.4g} m" in told[0]
    alone = lines(check(tmp_path, world(own, own[0][1], formation=False)))[1]
    assert not with_facts(alone, "the formation error will be")


def test_a_projection_that_moves_on_at_the_stop_is_followed(tmp_path: Path) -> None:
    """It looks some way ahead in a step, and would go on in the next one."""
    text = (
        "name: moving on\ntime: {step: 0.04, duration: 200.0}\n"
        "boundaries: [[[-9, -9], [30, -9], [30, 15], [-9, 15], [-9, -9]]]\n"
        "reference_path: [[0, 0], [17.226, 0], [17.226, 5.711], [0, 5.711]]\n"
        "formation: {gain: 0.05, spacing: initial}\nrobots:\n"
        "  - {name: r1, footprint: {length: 0.8, width: 0.5}, pose: [3.6, -0.8, 0],\n"
        "     path: [[0, -0.8], [7.164, -0.8], [0, 4.911]]}\n"
        "  - {name: r2, footprint: {length: 0.8, width: 0.5}, pose: [1, 0, 0], path: {offset: 0}}\n"
        "controller: {type: path_following}\n"
    )
    assert with_facts(lines(check(tmp_path, text))[1], "formation error") == []
    record = simulate(parse_world(text))
    for robot in (0, 1):
        last = record.updates[record.updates["robot"] == robot][-1]
        assert abs(last["formation_error"]) < 0.1


@pytest.mark.parametrize("kink", [[], [[30, 1.5], [29, 1.51]]])
def test_it_is_told_whatever_else_is(tmp_path: Path, kink: list[list[float]]) -> None:
    """A path that turns back somewhere is no reason for what it is at the end."""
    text = world([HALF[0], *kink, HALF[1]], 1.5)
    told = lines(check(tmp_path, text))[1]
    assert len(with_facts(told, "the formation error will be")) == 1
    assert bool(with_facts(told, "turns back")) == bool(kink)
    against = lines(check(tmp_path, world(WRONG_LEG, WRONG_LEG[0][1])))[1]
    assert with_facts(against, "r2", "runs against the reference path")
    assert with_facts(against, "r2", "the formation error will be")


def _at_stops(text: str) -> np.ndarray:
    scene = build_scene(parse_world(text))
    paths = [
        scene.paths.points[a:b]
        for a, b in zip(scene.paths.start[:-1], scene.paths.start[1:], strict=True)
    ]
    found = measuring.measured(
        paths, scene.reference.points, scene.start, scene.shapes.radius, scene.stop_station
    )
    assert found is not None
    return found[0]


@pytest.mark.parametrize("own", [BESIDE, HALF])
def test_and_it_is_so_in_a_run(own: list[list[float]]) -> None:
    """Where the robots have arrived: within the tolerance of that."""
    text = world(own, own[0][1])
    with simulate(parse_world(text)) as record:
        assert (record.arrived >= 0).all()
        last = followed(record)[-1, :, 2]
    assert last == pytest.approx(_at_stops(text), abs=0.3)


def test_ways_are_followed_over_every_turn() -> None:
    """On a spiral whose turns are 1.6 m apart, against its own stations."""
    turns = np.linspace(0.0, 6.0 * pi, 400)
    spiral = np.stack(
        [(4.0 + 0.25 * turns) * np.cos(turns), (4.0 + 0.25 * turns) * np.sin(turns)], 1
    )
    whole = shapely.LineString(spiral).length
    start = np.array([[*spiral[0], 0.0], [*spiral[20], 0.0]])
    radius, stops = np.full(2, 0.5), np.array([whole, whole - 7.0])
    found = measuring.measured([spiral, spiral], spiral, start, radius, stops)
    assert found is not None
    assert found[0] == pytest.approx(stops, abs=1e-6)
    assert found[1] == pytest.approx(0.0, abs=1e-6)


def test_who_starts_beside_its_path_comes_onto_it() -> None:
    """Where it would be measured elsewhere, had it stayed as far beside it."""
    way = np.array([[0.0, 0.0], [30.0, 0.0], [30.0, 30.0]])
    start, stops = np.array([[2.0, 4.0, 0.0]]), np.array([45.0])
    found = measuring.measured([way], way, start, np.array([0.5]), stops)
    assert found is not None
    assert found[0] == pytest.approx(stops, abs=1e-6)


def test_what_comes_back_is_known() -> None:
    way = np.array([[0.0, 0.0], [30.0, 0.0]])
    own = np.array([[0.0, 1.0], [20.0, 1.0], [20.0, 2.0], [12.0, 2.0], [12.0, 3.0], [30.0, 3.0]])
    start = np.array([[0.0, 1.0, 0.0]])
    found = measuring.measured([own], way, start, np.array([0.5]), np.array([48.0]))
    assert found is not None
    assert found[0] == pytest.approx([30.0], abs=0.3)
    assert found[1] == pytest.approx([8.0], abs=0.3)


def test_ways_too_long_to_be_followed_are_not(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor packed, where the paths are; a start may be as far from its path."""
    length = 1.1 * measuring.MOST_PLACES * measuring.STEP
    far, near = (np.array([[0.0, 0.0], [long, 0.0]]) for long in (length, 0.3))
    start, radius = np.array([[0.0, length, 0.0]]), np.array([0.5])
    assert measuring.measured([near], near, start, radius, np.array([0.2])) is None
    monkeypatch.setattr(measuring, "pack_polylines", None)
    args = np.zeros((1, 3)), radius, np.array([length])
    assert measuring.measured([far], far, *args) is None


def test_beside_an_error_nobody_is_foretold_from_where_none_was_drawn(tmp_path: Path) -> None:
    """Robots of the seed's are not placed then; without the error nothing is told either."""
    text = (
        "name: drawn\ntime: {step: 0.02, duration: 90.0}\n"
        "corridor: {centreline: [[0, 0], [60, 0]], width: 8.0}\n"
        "robots:\n"
        "  - {name: a, footprint: &box {length: 1.0, width: 0.6}, path: {offset: 1},\n"
        "     start: {region: [[8, 0.5], [10, 0.5], [10, 1.5], [8, 1.5]], heading: 0.0}}\n"
        "  - {name: b, footprint: *box, path: {offset: -1},\n"
        "     start: {region: [[4, -1.5], [6, -1.5], [6, -0.5], [4, -0.5]], heading: 0.0}}\n"
        "formation: {spacing: [0, -8]}\n"
    )
    for one in (text, text + "physics: {friction: -1.0}\n"):
        errors, warnings = lines(check(tmp_path, one))
        assert bool(errors) == ("friction" in one)
        assert warnings == []
