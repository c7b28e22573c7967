"""What does not move, as the page draws it: areas, walls, paths, shapes and names."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from physim.drawing.crowd import NAMED
from physim.drawing.scene_model import Area, SceneModel, shape
from physim.geometry.shapes import FloatArray

DECIMALS = 3
"""of lengths [m]"""
KEYS = {"accessible area": "floor", "danger area": "danger", "safe area": "safe"}
"""What areas are called, and the name of their colour."""

Points = list[list[float]]


def place(scene: SceneModel) -> dict[str, Any]:
    """The scene as plain values, lengths [m], world frame unless said."""
    shapes, which = _shapes(scene.footprints)
    low, high = scene.extent
    return {
        "areas": [_area(area) for area in scene.areas],
        "walls": [_points(line) for line in scene.boundaries],
        "obstacles": [_points(ring) for ring in scene.solid_rings],
        "reference": _points(scene.reference),
        "paths": _paths(scene),
        "stops": _points(scene.stops),
        "shapes": shapes,
        "shape": which,
        "extent": [_point(low), _point(high)],
        "bodies": [{"kind": body.kind, "name": body.name} for body in scene.bodies],
    }


def _area(area: Area) -> dict[str, Any]:
    return {
        "name": area.name, "key": KEYS[area.name], "rings": [_points(ring) for ring in area.rings]
    }  # fmt: skip


def _paths(scene: SceneModel) -> list[dict[str, Any]]:
    """Each path once: who follows it, and its pieces in the safe area and outside of it."""
    followers: dict[bytes, list[int]] = {}
    for robot, path in enumerate(scene.paths):
        followers.setdefault(path.tobytes(), []).append(robot)
    crowd = scene.robots > NAMED
    return [
        {
            "robots": [-1] if crowd else robots,
            "safe": [_points(line) for line in scene.path_pieces[robots[0]][0]],
            "danger": [_points(line) for line in scene.path_pieces[robots[0]][1]],
        }
        for robots in followers.values()
    ]


def _shapes(
    footprints: Sequence[Sequence[FloatArray]],
) -> tuple[list[dict[str, Any]], list[int]]:
    """Every different footprint once, in the robot's frame, and which of them each robot has."""
    number: dict[tuple[bytes, ...], int] = {}
    shapes: list[dict[str, Any]] = []
    which = []
    for parts in footprints:
        key = tuple(part.tobytes() for part in parts)
        if key not in number:
            number[key] = len(shapes)
            drawn = shape(parts)
            shapes.append(
                {
                    "rings": [_points(ring) for ring in drawn.rings],
                    "mark": _points(drawn.mark),
                    "eccentric": bool(drawn.eccentric),
                }
            )
        which.append(number[key])
    return shapes, which


def _points(line: Iterable[FloatArray]) -> Points:
    return [_point(point) for point in line]


def _point(point: FloatArray) -> list[float]:
    return [round(float(value), DECIMALS) + 0.0 for value in point]
