"""Signed distances against shapely, the Minkowski difference, and published cases."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from physim.errors import PhysimError
from physim.geometry import (
    closest_points,
    polyline,
    shortest_distance,
    signed_distance,
)
from tests.geometry.cases import (
    corridor_walls,
    depth_of,
    geometry,
    placed,
    published,
    random_convex,
    random_scene,
    whole,
)
from tests.helpers import examples, inside
from tests.oracles.clearances import wall_distances

body_distance, body_separation = inside("physim.geometry", "body_distance", "body_separation")
Frame, pack_parts, Part = inside("physim.geometry", "Frame", "pack_parts", "Part")
part_gap, part_witness = inside("physim.geometry", "part_gap", "part_witness")

ROUNDING = 1e-14  # shapes of metres at the origin


def distance(a, b):
    rx, ry = b[0]
    frame = Frame(1.0, 0.0, rx, ry, rx, ry)
    return part_gap(Part(a, 0, len(a)), Part(b, 0, len(b)), frame, np.inf)


def check_pair(a, b, tolerance=ROUNDING):
    """Value, witness and normal of two convex parts in one frame."""
    a, b = np.array(a, dtype=float), np.array(b, dtype=float)
    rx, ry = b[0]
    frame = Frame(1.0, 0.0, rx, ry, rx, ry)
    found = part_witness(Part(a, 0, len(a)), Part(b, 0, len(b)), frame)
    d, nx, ny, ax, ay, bx, by = found
    normal, point_a, point_b = np.array([nx, ny]), np.array([ax, ay]), np.array([bx, by])
    A, B = geometry(a), geometry(b)
    assert d == distance(a, b)
    assert abs(np.hypot(*normal) - 1.0) < 1e-12
    assert A.distance(shapely.Point(point_a)) <= tolerance
    assert B.distance(shapely.Point(point_b)) <= tolerance
    assert np.abs(point_b - point_a - d * normal).max() <= 2 * tolerance
    if d > 0.0:
        assert abs(d - A.distance(B)) <= tolerance
    else:
        assert A.distance(B) <= tolerance
        if len(a) > 2 or len(b) > 2:
            assert abs(-d - depth_of(a, b)) <= tolerance
        # Moving b by the depth along the normal frees it, up to rounding; by less does not.
        assert distance(a, b - d * normal) >= -2 * tolerance
    return d


@examples(25, deep=100)
@given(st.integers(0, 2**32 - 1))
def test_random_parts_agree_with_shapely_and_minkowski(seed):
    rng = np.random.default_rng(seed)
    for _ in range(5):
        a = placed(random_convex(rng), (*rng.uniform(-2, 2, 2), rng.uniform(-4, 4)))
        b = placed(random_convex(rng), (*rng.uniform(-2, 2, 2), rng.uniform(-4, 4)))
        check_pair(a, b)
        check_pair(a, b[:2])
        check_pair(a[:2], b)
        check_pair(a[1:3], b[:2])
        check_pair(a, b[:1])


SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
DEGENERATE = {
    "sides touch": (SQUARE, SQUARE + [1.0, 0.3], 0.0),
    "sides touch, longer": (SQUARE, 3.0 * SQUARE + [1.0, -1.0], 0.0),
    "corners touch": (SQUARE, SQUARE + [1.0, 1.0], 0.0),
    "sides face": (SQUARE, 3.0 * SQUARE + [1.5, -1.0], 0.5),
    "corner to corner": (SQUARE, SQUARE + [4.0, 5.0], 5.0),
    "same": (SQUARE, SQUARE, -1.0),
    "inside": (SQUARE, 0.2 * SQUARE + [0.1, 0.4], -0.3),
    "gap of 1e-9": (SQUARE, SQUARE + [1.0 + 1e-9, 0.25], 1e-9),
    "overlap of 1e-9": (SQUARE, SQUARE + [1.0 - 1e-9, 0.25], -1e-9),
    "segment on a side": (SQUARE, [[1.0, 0.2], [1.0, 0.7]], 0.0),
    "segment along a side, apart": (SQUARE, [[1.0, 2.0], [1.0, 3.0]], 1.0),
    "segment through": (SQUARE, [[-1.0, 0.5], [2.0, 0.5]], -0.5),
    "segment touches with its end": (SQUARE, [[1.0, 0.5], [2.0, 0.5]], 0.0),
    "point inside": (SQUARE, [[0.25, 0.5]], -0.25),
    "point on the side": (SQUARE, [[1.0, 0.5]], 0.0),
    "point in line with a side": (SQUARE, [[3.0, 1.0]], 2.0),
    "points": ([[0.0, 0.0]], [[3.0, 4.0]], 5.0),
    "collinear segments apart": ([[0.0, 0.0], [1.0, 0.0]], [[3.0, 0.0], [4.0, 0.0]], 2.0),
    "collinear, tilted": ([[0.0, 0.0], [0.3, 0.1]], [[0.9, 0.3], [1.2, 0.4]], 0.4**0.5),
    "collinear segments meet": ([[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [2.0, 0.0]], 0.0),
    "collinear segments overlap": ([[0.0, 0.0], [2.0, 0.0]], [[1.0, 0.0], [3.0, 0.0]], 0.0),
    "collinear, 1e-9 apart": ([[0.0, 0.0], [1.0, 0.0]], [[1.0 + 1e-9, 0.0], [2.0, 0.0]], 1e-9),
    "parallel segments": ([[0.0, 0.0], [4.0, 0.0]], [[1.0, 2.0], [2.0, 2.0]], 2.0),
    "parallel, past the end": ([[0.0, 0.0], [1.0, 0.0]], [[4.0, 4.0], [6.0, 4.0]], 5.0),
    "crossing segments": ([[0.0, 0.0], [2.0, 0.0]], [[1.0, -1.0], [1.0, 3.0]], -1.0),
    "sliver side on": ([[0.0, 0.0], [1.0, 0.0], [0.5, 1e-9]], SQUARE + [0.0, 1.0], 1.0 - 1e-9),
    "sliver end on": ([[0.0, 0.0], [1.0, 0.0], [0.5, 1e-9]], [[2.0, 0.0], [3.0, 0.0]], 1.0),
    "sliver, flat": ([[0.0, 0.0], [1.0, 0.0], [0.5, 1e-15]], [[2.0, 0.0], [3.0, 0.0]], 1.0),
    "tiny": (1e-8 * SQUARE, 1e-8 * SQUARE + [3e-8, 0.0], 2e-8),
    "tiny and large": (1e-8 * SQUARE, 1e3 * SQUARE + [1e-3, -500.0], 1e-3 - 1e-8),
}


@pytest.mark.parametrize("offset", [(0.0, 0.0), (10_000.0, -10_000.0)], ids=["near", "10 km"])
@pytest.mark.parametrize("name", DEGENERATE)
def test_degenerate_parts(name, offset):
    a, b, expected = DEGENERATE[name]
    a, b = np.array(a) + offset, np.array(b) + offset
    tolerance = 1e-13 if offset == (0.0, 0.0) else 1e-11  # 10 km: corners are rounded to 2e-12
    assert distance(a, b) == pytest.approx(expected, abs=tolerance)
    assert distance(b, a) == pytest.approx(expected, abs=tolerance)
    if name not in ("sliver, flat",):
        check_pair(a, b, tolerance)
        check_pair(b, a, tolerance)


@examples(25, deep=100)
@given(st.integers(0, 2**32 - 1))
def test_bodies_agree_with_shapely(seed):
    rng = np.random.default_rng(seed)
    bodies, shapes, poses = random_scene(rng, 6)
    for i in range(6):
        for j in range(i):
            d = body_distance(shapes, i, poses[i], shapes, j, poses[j])
            exact = whole(bodies[i], poses[i]).distance(whole(bodies[j], poses[j]))
            assert max(d, 0.0) == pytest.approx(exact, abs=ROUNDING)
            parts = [
                distance(placed(p, poses[i]), placed(q, poses[j]))
                for p in bodies[i]
                for q in bodies[j]
            ]
            assert d == pytest.approx(min(parts), abs=ROUNDING)
            other = body_distance(shapes, j, poses[j], shapes, i, poses[i])
            assert other == pytest.approx(d, abs=ROUNDING)


@examples(25, deep=100)
@given(st.integers(0, 2**32 - 1))
def test_body_witness_lies_on_both(seed):
    rng = np.random.default_rng(seed)
    bodies, shapes, poses = random_scene(rng, 2, spread=2.0)
    found = body_separation(shapes, 0, poses[0], shapes, 1, poses[1])
    d, normal = found[0], np.array(found[1:3])
    a, b = np.array(found[3:5]), np.array(found[5:7])
    assert d == body_distance(shapes, 0, poses[0], shapes, 1, poses[1])
    assert whole(bodies[0], poses[0]).distance(shapely.Point(a)) < 1e-14
    assert whole(bodies[1], poses[1]).distance(shapely.Point(b)) < 1e-14
    assert np.abs(b - a - d * normal).max() < 1e-14


@examples(25, deep=100)
@given(st.integers(0, 2**32 - 1))
def test_walls_agree_with_shapely(seed):
    rng = np.random.default_rng(seed)
    bodies, shapes, _ = random_scene(rng, 1)
    walls = corridor_walls()
    starts = walls.part_start
    lines = [walls.vertices[starts[k] : starts[k + 1]] for k in range(len(starts) - 1)]
    for _ in range(5):
        pose = np.array([rng.uniform(0, 40), rng.uniform(-8, 8), rng.uniform(-4, 4)])
        d = min(
            body_distance(walls, w, np.zeros(3), shapes, 0, pose)
            for w in range(len(walls.body_start) - 1)
        )
        body = whole(bodies[0], pose)
        exact = min(body.distance(geometry(line)) for line in lines)
        assert max(d, 0.0) == pytest.approx(exact, abs=2e-14)
        # The disc bound skips parts; without it the value is the same.
        assert d == min(wall_distances(shapes, 0, pose, walls))


def test_public_forms():
    ell = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]
    assert signed_distance(ell, SQUARE + [1.5, 1.5]) == 0.5
    assert shortest_distance(ell, SQUARE + [0.5, 0.5]) == 0.0
    assert signed_distance(ell, SQUARE + [0.5, 0.5]) < 0.0
    assert shortest_distance(polyline([[3, 0], [3, 5], [4, 7]]), SQUARE) == 2.0
    found = closest_points(SQUARE, SQUARE + [3.0, 0.5])
    assert (found.distance, found.normal) == (2.0, (1.0, 0.0))
    assert (found.point_a, found.point_b) == ((1.0, 0.75), (3.0, 0.75))


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        (3, "array"),
        ([], "no points"),
        ("abc", "not an array of numbers"),
        ([[0, 0], [1, np.nan], [2, 5]], "not finite"),
        ([[0, 0], [1, 1], [1, 0], [0, 1]], "crosses"),
        ([SQUARE, 5], r"\(n, 2\)"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], r"\(n, 2\)"),
    ],
)
def test_bad_shapes_are_refused(shape, words):
    with pytest.raises(PhysimError, match=words):
        shortest_distance(SQUARE, shape)


def shape_of(wkt_or_geometry):
    """Our form of a shapely geometry; None where it has holes, is invalid or is empty."""
    g = shapely.from_wkt(wkt_or_geometry) if isinstance(wkt_or_geometry, str) else wkt_or_geometry
    parts = []
    for part in shapely.get_parts(g):
        if part.geom_type.startswith(("Multi", "Geometry")):
            parts += shape_of(part) or []
        elif part.is_empty:
            continue
        elif part.geom_type == "Polygon":
            if len(part.interiors) or not part.is_valid:
                return None
            parts.append(np.array(part.exterior.coords)[:-1])
        else:
            points = np.array(part.coords)
            parts += list(polyline(points)) if len(points) > 1 else [points]
    return parts or None


def test_published_distances():
    cases = published("distance_cases.json")["cases"]
    used = 0
    for case in cases:
        a, b = shape_of(case["a"]), shape_of(case["b"])
        if a is None or b is None:
            continue
        used += 1
        d = shortest_distance(a, b)
        assert d == pytest.approx(case["distance"], abs=case["tol"]), case["id"]
        assert d == pytest.approx(case["shapely"], abs=1e-11), case["id"]
    assert used > 150


def engine_shape(shape):
    """Points and the radius around them (a circle is a point with a radius)."""
    if "circle" in shape:
        return [shape["circle"][:2]], shape["circle"][2]
    if "point" in shape:
        return [shape["point"]], 0.0
    return shape.get("polygon") or shape["segment"], 0.0


def test_engine_distances():
    cases = published("engine_unit_tests.json")["distance"]
    for case in (c for c in cases if c.get("usable", True)):
        a, ra = engine_shape(case["a"])
        b, rb = engine_shape(case["b"])
        found = closest_points(a, b)
        d = found.distance - ra - rb
        if "intersects" in case:
            assert (d <= 0.0) == case["intersects"], case["id"]
            continue
        assert max(d, 0.0) == pytest.approx(case["distance"], abs=case["tol"]), case["id"]
        if "signed_distance" in case:
            assert d == pytest.approx(case["signed_distance"], abs=case["tol"]), case["id"]
        for key, point in (("nearest_a", found.point_a), ("nearest_b", found.point_b)):
            if key in case:
                assert point == pytest.approx(case[key], abs=case["tol"]), case["id"]


def test_a_wall_of_many_segments_is_its_nearest_segment():
    """Bit for bit, as if each segment were a wall by itself."""
    rng = np.random.default_rng(5)
    ell = [
        [(-0.5, -0.3), (0.5, -0.3), (0.5, 0.0), (-0.5, 0.0)],
        [(-0.5, 0.0), (-0.2, 0.0), (-0.2, 0.5), (-0.5, 0.5)],
    ]
    away = [[(2.0 + x, 1.0 + y) for x, y in part] for part in ell]  # not about its origin
    robots, still = pack_parts([ell, away]), np.zeros(3)
    for _ in range(60):
        points = rng.uniform(-4.0, 4.0, (30, 2)).round(rng.integers(0, 3))
        parts = [
            points[k : k + 2].tolist() for k in range(29) if (points[k] != points[k + 1]).any()
        ]
        parts.insert(rng.integers(len(parts)), [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])
        whole, alone = pack_parts([parts]), pack_parts([[part] for part in parts])
        for i in (0, 1):
            pose = np.array([*rng.uniform(-4, 4, 2), rng.uniform(-4, 4)])
            each = [body_separation(robots, i, pose, alone, j, still) for j in range(len(parts))]
            nearest = min(one[0] for one in each)
            found = body_separation(robots, i, pose, whole, 0, still)
            assert found in [one for one in each if one[0] == nearest]
            assert found[0] == nearest


@pytest.mark.parametrize("away", [1e3, 5e4, 1e6])
def test_a_shallow_overlap_is_one_far_from_the_origin_too(away):
    # A box with one corner 1e-8 to 1e-6 m beyond a wall: the same as near the origin, to the
    # rounding of a coordinate there.
    rng = np.random.default_rng(3)
    rounding = 8.0 * np.spacing(away)
    deep = 0
    for _ in range(400):
        turn, lean = rng.uniform(-np.pi, np.pi), rng.uniform(0.1, 1.4)
        box = placed([(-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3)], (0.0, 0.0, lean))
        box = np.array(box) - (0.0, min(y for _, y in box) + 10 ** rng.uniform(-8, -6))
        middle = np.array(placed([(0.0, 0.0)], (*rng.uniform(-1.0, 1.0, 2) * away, turn))[0])
        wall = placed([(-3.0, 0.0), (4.0, 0.0)], (*middle, turn))
        here = placed([box.mean(axis=0)], (*middle, turn))[0]
        shapes = pack_parts([[np.ascontiguousarray(box - box.mean(axis=0))], [wall]])
        pose = np.array([[*here, turn], [0.0, 0.0, 0.0]])
        exact = -depth_of(
            np.array(placed(shapes.vertices[:4], (*(pose[0, :2] - wall[0]), turn))),
            np.array(wall) - wall[0],
        )
        found = body_distance(shapes, 0, pose[0], shapes, 1, pose[1])
        assert found == pytest.approx(exact, abs=rounding)
        deep += exact < -rounding
    assert deep > 100
