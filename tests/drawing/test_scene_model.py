"""One scene model: the same from a world, a scene and a record, so that pictures agree."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from physim import PAPER_MODES, Mode, build_scene
from physim.record import RecordWriter
from physim.world import World
from physim.world.file import load_world, parse_world
from tests.drawing import palette
from tests.drawing.preview.worlds import NARROW
from tests.helpers import examples, inside
from tests.helpers.records import DECLARED, ELL, make_record

SceneModel, outline, region = inside("physim.drawing", "SceneModel", "outline", "region")
split_at = inside("physim.drawing", "split_at")
FloatArray = inside("physim.geometry", "FloatArray")
NO_NUMBER = inside("physim.parts", "NO_NUMBER")
shipped_worlds = inside("physim.world.file", "shipped_worlds")
lay_out = inside("physim.world.layout", "lay_out")

L = 0.8


@examples(25, deep=200)
@given(st.lists(st.tuples(*[st.integers(0, 12)] * 4), max_size=9))
def test_a_region_is_that_of_rings_taken_one_after_the_other(boxes: list[tuple[int, ...]]) -> None:
    """Even-odd, whatever their order: beside each other, one in another, across each other."""
    rings = [
        np.array([[x, y], [x + w + 1, y], [x + w + 1, y + h + 1], [x, y + h + 1]], dtype=float)
        for x, y, w, h in boxes
    ]
    area = shapely.Polygon()
    for ring in rings:
        area = area.symmetric_difference(shapely.Polygon(ring))
    assert region(rings).equals(area)


def both_models(world: World) -> list[SceneModel]:
    """Of the world laid out, and of a record with its first sample."""
    scene, layout = build_scene(world), lay_out(world)
    area = scene.area
    out = RecordWriter(
        None, scene, world.to_yaml(), accessible=area.accessible_rings, safe=area.safe_rings(L),
        safe_distance=L, declared=DECLARED,
    )  # fmt: skip
    none = np.full((1, scene.robots), np.inf)
    wheels = np.zeros_like(none) if scene.steers else None
    out.append_steps(np.zeros(1, dtype=np.int64), scene.moving_start[None], none, none, wheels)
    out.close("duration", steps_run=0, rejected=0, wall_clock={})
    return [
        SceneModel.of_layout(layout, DECLARED.modes, L),
        SceneModel.of_record(out.record()),
    ]


def length(pieces: list[FloatArray]) -> float:
    return sum(float(shapely.LineString(piece).length) for piece in pieces)


MANY = ("hundred_robots", "thousand_robots", "jam")
WORLDS = [
    pytest.param(name, marks=pytest.mark.deep) if name in MANY else name
    for name in (*sorted(shipped_worlds()), "obstacles")
]


@pytest.mark.parametrize("name", WORLDS)
def test_it_is_the_same_from_every_source(name: str) -> None:
    world = parse_world(NARROW) if name == "obstacles" else load_world(name)
    first, *others = both_models(world)
    for other in others:
        for field in ("name", "seed", "bodies", "names", "colours", "modes", "safe_distance"):
            assert getattr(first, field) == getattr(other, field), field
        for field in ("start", "reference", "stop_station", "stops"):
            assert np.allclose(getattr(first, field), getattr(other, field), atol=1e-6), field
        for field in ("boundaries", "paths", "accessible", "safe"):
            for one, two in zip(getattr(first, field), getattr(other, field), strict=True):
                assert np.allclose(one, two, rtol=0.0, atol=1e-9), field
        for field in ("outlines", "obstacles"):
            for one, two in zip(getattr(first, field), getattr(other, field), strict=True):
                missed = shapely.Polygon(one).symmetric_difference(shapely.Polygon(two)).area
                assert missed < 1e-4 * shapely.Polygon(one).area, field
        for one, two in zip(first.path_pieces, other.path_pieces, strict=True):
            for mine, others_ in zip(one, two, strict=True):
                assert length(mine) == pytest.approx(length(others_), abs=1e-6)
        assert np.allclose(first.extent, other.extent, atol=1e-5)


def test_colours_are_those_of_the_palette_and_of_the_controller() -> None:
    with make_record(robots=12, seconds=0.5) as record:
        model = SceneModel.of_record(record)
        assert np.array_equal(model.start, record.pose[0])
    assert model.colours[:10] == palette.ROBOTS
    assert model.colours[10:] == palette.ROBOTS[:2]
    for number, mode in enumerate(PAPER_MODES):
        assert palette.hexed(model.mode_colour(number)) == mode.colour
    assert model.mode_colour(NO_NUMBER) == palette.UNDECIDED


def test_a_world_is_shown_with_the_modes_of_its_controller_and_without_areas() -> None:
    modes = (Mode("go", "#010203"), Mode("wait", "#a0b0c0"))
    model = SceneModel.of_layout(lay_out(load_world("three_robots")), modes)
    assert [model.mode_colour(k) for k in (0, 1)] == [(1, 2, 3), (160, 176, 192)]
    assert (model.safe, model.safe_distance) == ((), 0.0)
    assert all(not danger for _, danger in model.path_pieces)


def test_an_outline_has_no_seams() -> None:
    whole = shapely.Polygon(outline(ELL))
    assert whole.area == pytest.approx(sum(shapely.Polygon(part).area for part in ELL), rel=1e-4)
    assert len(whole.simplify(1e-5).exterior.coords) == 7  # six corners


@pytest.mark.parametrize("seed", range(8))
def test_a_line_is_cut_as_shapely_cuts_it_as_a_whole(seed: int) -> None:
    rng = np.random.default_rng(seed)
    yard = shapely.box(0.0, 0.0, 40.0, 8.0) - shapely.box(18.0, 3.0, 22.0, 9.0)
    area = yard - shapely.Point(30.0, 4.0).buffer(1.5)
    line = np.stack((np.linspace(-5.0, 45.0, 30), rng.uniform(-2.0, 10.0, 30)), axis=1)
    whole = shapely.LineString(line)
    ways = zip(split_at(line, area), (whole & area, whole - area), strict=True)
    for found, expected in ways:
        assert len(found) == len(shapely.get_parts(shapely.line_merge(expected)))
        assert shapely.MultiLineString(found).length == pytest.approx(expected.length)
        assert shapely.hausdorff_distance(shapely.MultiLineString(found), expected) < 1e-9
        assert all(np.diff(piece[:, 0]).min() > 0.0 for piece in found)  # as the line goes
