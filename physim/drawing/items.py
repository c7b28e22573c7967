"""What is drawn of a scene: areas, obstacles, paths, walls, stops, robots at the start.

Film, plots, preview and page walk this one list, each with its own pen and in the order given. It
says once what goes over what, what is dashed, which paths are shared and what of a crowd is drawn
alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from physim.drawing import palette
from physim.drawing.crowd import NAMED
from physim.drawing.palette import Colour
from physim.drawing.scene_model import SceneModel, closed, placed
from physim.geometry.shapes import FloatArray

DASH, DOTS = (5.0, 5.0), (2.0, 5.0)
"""Dash and gap over the width of a line: of a path in the danger area, of the way of a mover."""
PUSHED = "obstacle to push"


class Level(IntEnum):
    """What has a higher one is drawn over what has a lower."""

    AREA, SOLID, REFERENCE, PATH, WALL, STOP, ROBOT = range(7)


class Item(NamedTuple):
    """Lines of one colour, or what they enclose; world frame [m]."""

    what: str
    """as a legend calls it: safe area, danger area, accessible area, obstacle, reference path,
    path, way of a mover, boundary, stop, robot, heading, wheel, mover, obstacle to push"""
    lines: Sequence[FloatArray]
    """(n, 2) each: lines; rings by the even-odd rule where ``width`` is 0; of stops points (1, 2),
    as many as there are robots in ``robots``"""
    key: str | int
    """of its colour: a name in `palette.KEYS`, or the index of the only robot it belongs to"""
    width: float
    """of its lines, over that of the thinnest; 0: filled"""
    level: Level
    dash: tuple[float, float] | None = None
    robots: tuple[int, ...] = ()
    """that it belongs to, by index; of a path those that follow it"""

    @property
    def colour(self) -> Colour:
        """On white; that of a path is a light one, over which the robot's own line is seen."""
        own = palette.keyed(self.key)
        return palette.mix(own, palette.WHITE, palette.PATH_TINT) if self.what == "path" else own


def items(scene: SceneModel) -> list[Item]:
    """All that is drawn of a scene, in the order of drawing.

    A path of one robot has that robot's colour, dashed outside of the safe area. Paths that
    robots share, and paths, stops and robots of a crowd, have one colour for all, each path once.
    """
    edges = [closed(ring) for ring in scene.solid_rings]
    areas = [Item("accessible area", scene.accessible, "floor", 0.0, Level.AREA)]
    if scene.safe_distance > 0.0:
        areas = [
            Item("danger area", scene.accessible, "danger", 0.0, Level.AREA),
            Item("safe area", scene.safe, "safe", 0.0, Level.AREA),
        ]
    found = [
        *areas,
        Item("obstacle", scene.solid_rings, "obstacle", 0.0, Level.SOLID),
        Item("reference path", (scene.reference,), "reference", 2.0, Level.REFERENCE),
        *_paths(scene),
        Item(
            "way of a mover",
            [line for way in scene.ways for line in way],
            "way",
            1.5,
            Level.PATH,
            DOTS,
        ),
        Item("obstacle", edges, "wall", 1.0, Level.WALL),
        Item("boundary", scene.boundaries, "wall", 3.0, Level.WALL),
    ]
    stops, known = scene.stops, bool(np.isfinite(scene.start).all())
    straight = scene.wheels_at(scene.start, np.zeros(scene.robots))
    for robots, key in _together(scene):
        places = [stops[i][None] for i in robots]
        found.append(Item("stop", places, key, 1.0, Level.STOP, robots=robots))
        if known:
            bodies = [
                placed(ring, scene.start[i]) for i in robots for ring in scene.shapes[i].rings
            ]
            marks = [placed(scene.shapes[i].mark, scene.start[i]) for i in robots]
            found.append(Item("robot", bodies, key, 0.0, Level.ROBOT, robots=robots))
            found.append(Item("heading", marks, "paper", 0.0, Level.ROBOT, robots=robots))
            wheels = [line for i in robots if i in straight for line in straight[i]]
            found.append(Item("wheel", wheels, "ink", 1.0, Level.ROBOT, robots=robots))
    if np.isfinite(scene.moved_start).all():
        for key, what in (("mover", "mover"), ("obstacle", PUSHED)):
            pairs = zip(scene.moved_starting, scene.moved_keys, strict=True)
            rings = [ring for ring, kind in pairs if kind == key]
            found.append(Item(what, rings, key, 0.0, Level.ROBOT))
            found.append(Item(what, [closed(ring) for ring in rings], "wall", 1.0, Level.ROBOT))
    return [item for item in found if item.lines]


def _together(scene: SceneModel) -> list[tuple[tuple[int, ...], str | int]]:
    """Robots that are drawn alike, and the key of their colour: each its own, or a crowd."""
    if scene.robots > NAMED:
        return [(tuple(range(scene.robots)), "band")]
    return [((i,), i) for i in range(scene.robots)]


def _paths(scene: SceneModel) -> list[Item]:
    followers: dict[bytes, tuple[int, ...]] = {}
    for robot, path in enumerate(scene.paths):
        followers[path.tobytes()] = (*followers.get(path.tobytes(), ()), robot)
    groups = [(robots, [robots]) for robots in followers.values()]
    if scene.robots > NAMED:
        groups = [(tuple(range(scene.robots)), list(followers.values()))]
    found = []
    for robots, each in groups:
        key: str | int = robots[0] if len(robots) == 1 else "band"
        for k, dash in ((0, None), (1, DASH)):
            lines = [line for one in each for line in scene.path_pieces[one[0]][k]]
            found.append(Item("path", lines, key, 1.0, Level.PATH, dash, robots))
    return found
