"""Shapes, poses and published cases that several geometry tests share."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import shapely

from tests.helpers import inside

pack_parts = inside("physim.geometry", "pack_parts")

CASES = Path(__file__).parents[3] / "shared" / "cases"

BOX = np.array([[-0.9, -0.5], [0.9, -0.5], [0.9, 0.5], [-0.9, 0.5]])


def published(name):
    """Contents of a file of published cases; skips the test where the folder is absent."""
    file = CASES / name
    if not file.exists():
        pytest.skip(f"no {file}")
    return json.loads(file.read_text())


def random_convex(rng, scale=1.0):
    """Convex polygon of 3 to 8 corners in its frame, the origin not always inside."""
    angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, rng.integers(3, 9)))
    radii = rng.uniform(0.3, 1.5, 2)
    points = np.c_[radii[0] * np.cos(angles), radii[1] * np.sin(angles)]
    return scale * (points + rng.uniform(-0.5, 0.5, 2))


def random_body(rng):
    """One to three convex parts, one in four of them a segment."""
    parts = [random_convex(rng, 0.7) for _ in range(rng.integers(1, 4))]
    return [p[:2] if rng.random() < 0.25 else p + rng.uniform(-0.5, 0.5, 2) for p in parts]


def placed(points, pose):
    """Points at a pose, world frame."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return np.asarray(points) @ np.array([[c, s], [-s, c]]) + np.asarray(pose)[:2]


def geometry(points):
    """One part as shapely sees it."""
    if len(points) == 1:
        return shapely.Point(points[0])
    return shapely.LineString(points) if len(points) == 2 else shapely.Polygon(points)


def whole(parts, pose=(0.0, 0.0, 0.0)):
    """Parts of a body at a pose as one shapely collection."""
    return shapely.GeometryCollection([geometry(placed(p, pose)) for p in parts])


def depth_of(a, b):
    """Penetration depth of two overlapping convex parts by their Minkowski difference."""
    corners = (np.asarray(b)[:, None] - np.asarray(a)[None]).reshape(-1, 2)
    hull = shapely.MultiPoint(corners).convex_hull
    return hull.exterior.distance(shapely.Point(0.0, 0.0))


def random_scene(rng, count, spread=4.0):
    """Bodies, their packed shapes, and poses (count, 3)."""
    bodies = [random_body(rng) for _ in range(count)]
    poses = np.c_[rng.uniform(-spread, spread, (count, 2)), rng.uniform(-7.0, 7.0, count)]
    return bodies, pack_parts(bodies), poses


def corridor_walls(length=40.0, step=1.3, obstacle=True):
    """Two bent walls of short segments, 8 m apart, and a box-shaped obstacle."""
    x = np.arange(0.0, length, step)

    def wall(offset):
        line = np.c_[x, 3.0 * np.sin(x / 15.0) + offset]
        return [line[k : k + 2] for k in range(len(line) - 1)]

    bodies = [wall(4.0), wall(-4.0)]
    if obstacle:
        bodies.append([BOX + [length / 2, 5.0]])
    return pack_parts(bodies)
