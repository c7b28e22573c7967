"""Clearances the plain way: every robot against every other, and against every part of a wall."""

from __future__ import annotations

import numpy as np

from physim.geometry import Shapes
from tests.helpers import inside

Clearances, bounding_discs = inside("physim.geometry", "Clearances", "bounding_discs")
pair_distance, set_frames = inside("physim.geometry", "pair_distance", "set_frames")
body_distance, FloatArray = inside("physim.geometry", "body_distance", "FloatArray")


def clearances(poses: FloatArray, shapes: Shapes, walls: Shapes) -> Clearances:
    """What `physim.geometry.clearance.clearances` must give, bit for bit."""
    return Clearances(*map(np.array, zip(*(_sample(p, shapes, walls) for p in poses), strict=True)))


def wall_distances(shapes: Shapes, i: int, pose: FloatArray, walls: Shapes) -> list[float]:
    """Signed distances [m] of robot i at ``pose`` (3,) from each part of the walls, on its own."""
    parts, still = len(walls.part_start) - 1, np.zeros(3)
    single = walls._replace(body_start=np.arange(parts + 1), radius=np.full(parts, np.nan))
    return [body_distance(single, k, still, shapes, i, pose) for k in range(parts)]


def _sample(pose: FloatArray, shapes: Shapes, walls: Shapes) -> tuple[object, ...]:
    robots = len(pose)
    frame = np.empty((robots, 6))
    set_frames(np.ascontiguousarray(pose), bounding_discs(shapes), frame)
    apart = np.full((robots, robots), np.nan)
    for i in range(robots):
        for j in range(i + 1, robots):
            apart[i, j] = apart[j, i] = pair_distance(shapes, i, j, frame)
    nearest = np.where(np.isnan(apart), np.inf, apart)
    farthest = np.where(np.isnan(apart), -np.inf, apart)
    gaps = np.array([wall_distances(shapes, i, pose[i], walls) for i in range(robots)])
    body = np.repeat(np.arange(len(walls.body_start) - 1), np.diff(walls.body_start))
    pair = divmod(int(farthest.argmax()), robots) if robots > 1 else (-1, -1)
    return (
        nearest.min(axis=1),
        nearest.argmin(axis=1) if robots > 1 else np.array([-1]),
        gaps.min(axis=1),
        robots + body[gaps.argmin(axis=1)],
        farthest.max(),
        *pair,
    )
