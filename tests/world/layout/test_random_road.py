"""Roads that the seed draws: what is stated holds, or the world is refused."""

from __future__ import annotations

import hashlib
import re
from itertools import combinations
from math import ceil
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from physim import simulate
from physim.errors import WorldError
from physim.world import World
from physim.world.checks import check_world
from physim.world.file import load_world, parse_world
from tests.helpers import examples, facts, inside
from tests.helpers.same import differences

lay_out = inside("physim.world.layout", "lay_out")
Layout = inside("physim.world", "Layout")
drawn_text = inside("physim.authoring", "drawn_text")

Array = NDArray[np.float64]

GAP = 0.3
"""[m] stated least distance of an obstacle to another and to a wall"""
AS_ROUNDED = 1e-9
BOTH_ROUNDED = 1e-3 * 2.0**0.5 + AS_ROUNDED
"""[m] Two points rounded to millimetres: each moves by up to half of that along both axes."""
PER_POINT = 0.0015
"""[m] by which rounding to millimetres may change the length of a piece"""
CORNERS = 1.006
"""[-] by which the distance to a corner of a wall may exceed half the width: turns of 12 degrees"""


def values(offsets: tuple[float, ...] = (0.0,), seed: int = 1, **road: Any) -> dict[str, Any]:
    """Keys of a world in which boxes stand one behind another on a drawn road."""
    robots = [
        {
            "name": f"b{k + 1}",
            "footprint": {"length": 1.2, "width": 0.8},
            "pose": [2.0 + 3.0 * k, offset, 0.0],
            "path": {"offset": offset},
        }
        for k, offset in enumerate(offsets)
    ]
    return {
        "name": "drawn",
        "seed": seed,
        "time": {"step": 0.01, "duration": 1.0},
        "corridor": {"random": {"length": 90.0, "width": [5.0, 8.0], **road}},
        "robots": robots,
    }


def world(*offsets: float, seed: int = 1, **road: Any) -> World:
    return World(**values(offsets or (0.0,), seed, **road))


def segments(lines: list[Array]) -> tuple[Array, Array]:
    """Both ends (S, 2) of the pieces of polylines."""
    return np.vstack([line[:-1] for line in lines]), np.vstack([line[1:] for line in lines])


def distances(points: Array, ends: tuple[Array, Array]) -> Array:
    """Shortest distance (K,) of points to segments, by projecting each point on each."""
    a, b = ends
    along = b - a
    share = ((points[:, None] - a) * along).sum(-1) / (along * along).sum(-1)
    feet = a + np.clip(share, 0.0, 1.0)[..., None] * along
    return np.asarray(np.hypot(*np.moveaxis(points[:, None] - feet, -1, 0)).min(axis=1))


def sampled(line: Array, step: float) -> Array:
    """Points along a polyline, its own ones among them."""
    pieces = [
        a + np.linspace(0.0, 1.0, 1 + ceil(np.hypot(*(b - a)) / step))[:, None] * (b - a)
        for a, b in zip(line, line[1:], strict=False)
    ]
    return np.vstack(pieces)


def closed(ring: Array) -> Array:
    return np.vstack([ring, ring[:1]])


def centreline(laid: Layout) -> Array:
    assert laid.centreline is not None
    return laid.centreline


def check_road(laid: Layout, road: dict[str, Any]) -> None:
    """All that is stated of a drawn road, worked out anew."""
    line, walls = centreline(laid), laid.boundaries
    left, right = walls["left wall"], walls["right wall"]
    low, high = road["width"]

    assert line[0].tolist() == [0.0, 0.0]
    assert line[1][1] == 0.0 < line[1][0]
    length = np.hypot(*np.diff(line, axis=0).T).sum()
    assert abs(length - road["length"]) <= PER_POINT * len(line)

    for wall in (left, right):
        along = (np.diff(wall[1:-1], axis=0) * np.diff(line, axis=0)).sum(axis=1)
        assert (along > 0.0).all(), "a wall runs backwards"
    points = sampled(line, 0.4)
    gaps = [distances(points, segments([wall])) for wall in (left, right)]
    assert min(gaps[0].min(), gaps[1].min()) >= 0.5 * low - BOTH_ROUNDED
    assert max(gaps[0].max(), gaps[1].max()) <= 0.5 * high * CORNERS
    station = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    end = int(np.argmin(np.abs(station - road["ends"])))
    assert abs(station[end] - road["ends"]) <= PER_POINT
    assert (line[: end + 1, 1] == 0.0).all()
    assert np.allclose(left[1 : end + 1, 1], 0.5 * high, rtol=0.0, atol=3e-4)
    last = station[-1] - station[::-1]
    other = int(np.argmin(np.abs(last - road["ends"])))
    assert abs(last[other] - road["ends"]) <= PER_POINT * (other + 1)
    wide = np.hypot(*(left - right).T)[1:-1][::-1][:other]
    assert np.allclose(wide, high, rtol=0.0, atol=6e-4)

    assert np.array_equal(walls["start cap"], [left[0], right[0]])
    assert np.array_equal(walls["end cap"], [left[-1], right[-1]])
    sides = shapely.LineString(left), shapely.LineString(right)
    assert sides[0].is_simple
    assert sides[1].is_simple
    assert not sides[0].intersects(sides[1])
    inside = shapely.Polygon(np.vstack([left, right[::-1]]))
    assert inside.is_valid

    solids = [shapely.Polygon(outline) for outline in laid.obstacles]
    for tip, inner in (line[:2], line[:-3:-1]):  # straight, so these are rectangles
        along = (inner - tip) / np.hypot(*(inner - tip))
        stretch = shapely.LineString([tip, tip + (road["ends"] - 5e-3) * along])
        free = stretch.buffer(0.5 * high - 5e-3, cap_style="flat")
        assert not any(free.intersects(solid) for solid in solids), "an obstacle at an end"
    wanted = round(road["clutter"] * (road["length"] - 2.0 * road["ends"]) / 100.0)
    assert abs(len(solids) - wanted) <= 1  # the length as rounded
    for outline, solid in zip(laid.obstacles, solids, strict=True):
        assert inside.contains(solid)
        assert solid.exterior.distance(inside.exterior) >= GAP
        across = max(np.hypot(*(a - b)) for a, b in combinations(outline, 2))
        assert 0.5 * road["sizes"][0] - 2e-3 <= across <= road["sizes"][1] + 2e-3
    assert all(one.distance(other) >= GAP for one, other in combinations(solids, 2))

    rings = [closed(outline) for outline in laid.obstacles]
    clear = distances(sampled(laid.reference, 0.05), segments([*walls.values(), *rings]))
    passage = laid.passage
    assert passage is not None
    assert 2.0 * clear.min() >= passage - 2.0 * AS_ROUNDED


@st.composite
def roads(draw: Any) -> dict[str, Any]:
    low = draw(st.floats(2.0, 9.0))
    high = low + draw(st.floats(0.0, 5.0))
    turns = sorted([draw(st.floats(0.05, 2.6)), draw(st.floats(0.05, 2.6))])
    radius = 0.5 * high + draw(st.floats(0.9, 8.0))
    size = draw(st.floats(0.2, 1.5))
    bends = sorted([draw(st.integers(0, 5)), draw(st.integers(0, 5))])
    return {
        "length": draw(st.floats(20.0, 160.0)),
        "bends": bends,
        "turns": turns,
        "radii": [radius, radius + draw(st.floats(0.0, 9.0))],
        "width": [low, high],
        "clutter": draw(st.floats(0.0, 25.0)),
        "sizes": [size, size + draw(st.floats(0.0, 1.5))],
        "passage": draw(st.floats(0.5, 1.05)) * low,
        "ends": draw(st.floats(4.0, 15.0)),
    }


@examples(20, deep=100)
@given(roads(), st.integers(0, 10**15))
def test_a_road_is_as_stated_or_refused(road: dict[str, Any], seed: int) -> None:
    laid = drawn_or_refused(road, seed)
    if isinstance(laid, WorldError):
        assert laid.faults
        assert all(fault.location[:2] == ("corridor", "random") for fault in laid.faults)
    else:
        check_road(laid, road)
        own = world(seed=seed, **road)
        again = parse_world(own.to_yaml())
        assert again == own
        assert coordinates(lay_out(again)) == coordinates(laid)


def drawn_or_refused(road: dict[str, Any], seed: int) -> Layout | WorldError:
    try:
        return lay_out(world(seed=seed, **road))
    except WorldError as error:
        return error


USUAL = {
    "length": 110.0, "bends": [3, 5], "turns": [0.4, 1.4], "radii": [8.0, 14.0], "clutter": 14.0,
    "width": [4.5, 9.0], "sizes": [0.8, 2.2], "passage": 3.4, "ends": 17.0,
}  # fmt: skip


def test_the_shipped_road_is_as_stated_with_every_seed() -> None:
    shipped = load_world("random_road")
    written = shipped.corridor.random
    assert {key: getattr(written, key) for key in USUAL} == {
        key: tuple(value) if isinstance(value, list) else value for key, value in USUAL.items()
    }
    for seed in range(10):
        check_road(lay_out(shipped, seed), USUAL)


def coordinates(laid: Layout) -> bytes:
    parts = [centreline(laid), laid.reference, *laid.obstacles, *laid.boundaries.values()]
    return np.vstack(parts).tobytes()


def test_the_seed_decides_to_the_last_bit() -> None:
    drawn = [coordinates(lay_out(world(seed=seed, clutter=10.0))) for seed in range(8)]
    again = [coordinates(lay_out(world(seed=0, clutter=10.0), seed)) for seed in range(8)]
    assert drawn == again
    assert len(set(drawn)) == 8


def test_roads_are_those_of_earlier_versions() -> None:
    """A record holds the seed of its road alone: it is simulated again on the same one."""
    laid = lay_out(world(seed=5, clutter=10.0))
    millimetres = np.round(1000.0 * np.vstack([centreline(laid), laid.reference, *laid.obstacles]))
    found = hashlib.sha256(millimetres.astype(np.int64).tobytes()).hexdigest()
    assert found[:16] == "0c34b21fe0ce92fa"


def test_clutter_leaves_the_road_and_both_leave_starts_as_they_are() -> None:
    shipped = load_world("random_road")
    bare = load_world("random_road", overrides=["corridor.random.clutter=0.0"])
    one, other = lay_out(shipped, 3), lay_out(bare, 3)
    assert len(one.obstacles) > len(other.obstacles) == 0
    assert differences(one.boundaries, other.boundaries) == []
    assert np.array_equal(one.reference, other.reference)
    assert np.array_equal(one.start, other.start)
    wider = load_world("random_road", overrides=["corridor.random.width=[4.6, 9.2]"])
    assert np.array_equal(centreline(lay_out(wider, 3)), centreline(one))


def test_a_drawn_world_is_still_written_as_its_author_wrote_it() -> None:
    own = world(0.5, -0.5, clutter=5.0)
    laid = lay_out(own)
    assert laid.obstacles
    assert laid.world == own == parse_world(own.to_yaml())


def test_the_plain_world_moves_as_the_drawn_one() -> None:
    short = {"time": {"step": 0.01, "duration": 4.0}}
    shipped = load_world("random_road", overrides=["seed=4"]).changed(**short)
    plain = parse_world(drawn_text("plain", "random_road", 4)).changed(**short)
    assert not plain.is_road_random
    assert plain.obstacles
    with simulate(shipped) as one, simulate(plain) as other:
        assert np.array_equal(one.pose, other.pose)
        assert np.array_equal(one.clearance, other.clearance)
        assert np.array_equal(one.boundary_clearance, other.boundary_clearance)
        assert np.array_equal(one.updates, other.updates)
        assert one.world == shipped


def test_the_passage_when_none_is_stated() -> None:
    """Both boxes reach 0.7211 m from their reference points; 0.3 m more, on either side."""
    laid = lay_out(world(0.4, -0.9, width=[6.0, 8.0]))
    assert laid.passage == pytest.approx(2.0 * (0.9 + 0.52**0.5 + 0.3), abs=1e-3)
    with pytest.raises(WorldError, match=facts("corridor.random.width", "3.843 m", "3.8 m")):
        lay_out(world(0.4, -0.9, width=[3.8, 8.0]))


ROAD = ("corridor", "random")


@pytest.mark.parametrize(
    ("given_", "where", "said"),
    [
        ({"width": [8.0, 5.0]}, "width", ("8.0", "5.0", "[least, greatest]")),
        ({"bends": [4, 2]}, "bends", ("4", "2", "[least, greatest]")),
        ({"turns": [1.0, 0.5]}, "turns", ("1.0", "0.5")),
        ({"passage": 5.5}, "passage", ("5.5 m", "wider", "5.0 m")),
        ({"passage": 0.7}, "passage", ("0.7 m", "too narrow", "robots[0]", "0.8 m")),
        ({"radii": [4.9, 9.0]}, "radii", ("4.9 m", "8 m wide", "5 m")),
        ({"width": [1.5, 1.8]}, "width", ("1.8 m", "1.9 m", "no radii")),
        ({"ends": 46.0}, "length", ("90.0 m", "46.0 m")),
        ({"bends": 30}, "bends", ("30", "60 m")),
        ({"clutter": 50.0, "passage": 4.9, "width": 5.0}, "clutter", ("30", "4.9 m", "less")),
        ({"length": 1e9}, "length", ("5000",)),
        ({"bends": 10**9}, "bends", ("at most 200",)),
        ({"clutter": 1e9}, "clutter", ("at most 50",)),
        ({"width": "wide"}, "width", ("number", "wide")),
        ({"shapes": ["boxes"]}, "shapes", ('did you mean "box"',)),
        ({"shapes": []}, "shapes", ("at least 1",)),
        ({"passages": 3.0}, "passages", ('did you mean "passage"',)),
        ({"turns": [0.1, 9.0]}, "turns", ("at most 3.14159265358979", "9.0")),
    ],
)
def test_bad_values_are_refused(given_: dict[str, Any], where: str, said: tuple[str, ...]) -> None:
    with pytest.raises(WorldError) as caught:
        lay_out(world(**given_))
    (fault,) = caught.value.faults
    assert fault.location[:3] == (*ROAD, where)
    assert re.search(facts(*said), fault.message)


def test_only_paths_lie_beside_a_drawn_road() -> None:
    for key in ("reference_path", "obstacles", "boundaries"):
        with pytest.raises(WorldError, match=key):
            World(**{**values(), key: [[[0, 0], [30, 0], [30, 2]]]})
    own = values((0.0, 0.0))
    own["robots"][1]["path"] = [[0, 0], [30, 0]]
    with pytest.raises(WorldError, match=facts("robots[1].path", "{offset}")):
        World(**own)
    with pytest.raises(WorldError, match=facts("robots[1].path.offset", "9 m", "8 m radius")):
        lay_out(world(0.0, 9.0))


FILE = """\
name: drawn
seed: 3
time: {step: 0.01, duration: 1.0}
corridor:
  random: {length: 90.0, width: [5.0, 8.0], clutter: 8.0}
robots:
  - {name: r1, footprint: {length: 1.2, width: 0.8}, pose: [2.0, 0.0, 0.0], path: {offset: 0.0}}
"""


def checked(tmp_path: Any, text: str, **keys: Any) -> Any:
    file = tmp_path / "w.yaml"
    file.write_text(text)
    return check_world(file, **keys)


def test_faults_of_a_drawn_road_stand_where_it_is_asked_for(tmp_path: Any) -> None:
    crowded = FILE.replace("clutter: 8.0", "clutter: 50.0, passage: 4.8, sizes: [1.9, 2.0]")
    (error,) = checked(tmp_path, crowded).errors
    assert (error.line, error.key) == (5, "corridor.random.clutter")
    assert error.column == crowded.splitlines()[4].index("50.0") + 1
    outside = FILE.replace("pose: [2.0,", "pose: [-2.8,")
    (error,) = checked(tmp_path, outside).errors
    assert (error.line, error.key) == (7, "robots[0].pose")
    (error,) = checked(tmp_path, outside.replace("[5.0, 8.0]", "[8.0, 5.0]")).errors
    assert (error.line, error.key) == (5, "corridor.random.width")


def test_winding_roads_stay_away_from_themselves() -> None:
    """Most roads that are drawn first cross themselves here; none that is kept comes near."""
    winding = {"bends": 7, "turns": [1.9, 2.6], "radii": [5.0, 6.0], "width": [6.0, 6.0],
               "length": 160.0, "ends": 6.0, "passage": 3.0}  # fmt: skip
    kept = 0
    for seed in range(1, 13):
        try:
            laid = lay_out(world(seed=seed, **winding))
        except WorldError:
            continue
        kept += 1
        left, right = laid.boundaries["left wall"], laid.boundaries["right wall"]
        inside = shapely.Polygon(np.vstack([left, right[::-1]]))
        assert inside.is_valid
        wider = shapely.LineString(centreline(laid)).buffer(3.45, cap_style="flat")
        assert len(wider.interiors) == 0, "two parts of the road nearly touch"
    assert kept >= 2
