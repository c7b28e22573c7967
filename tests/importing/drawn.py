"""Places with drawn robots: parts of a hall, and where the robots of what was made of it go."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from physim.authoring.importing import Imported
from tests.helpers import inside

offset_polyline = inside("physim.geometry", "offset_polyline")

HALL = ("boundary", shapely.box(0, 0, 50, 20))
WAY = ("path", shapely.LineString([(3, 5), (47, 5)]))
LOOP = [(0, 0), (24, 0), (24, 14), (0, 14), (0, 0)]


def paths_of(made: Imported) -> list[Any]:
    """Points of each robot's path, of the reference path where it is that."""
    return [
        np.asarray(
            made.world.reference_path if not isinstance(one.path, tuple | list) else one.path
        )
        for one in made.world.robots
    ]


def box(x: float, y: float, length: float = 1.8, width: float = 1.0) -> Any:
    return shapely.box(x - length / 2, y - width / 2, x + length / 2, y + width / 2)


def ways_of(made: Imported) -> list[float]:
    """[m] from each robot to the end of its path, at which the first of them stops."""
    found = []
    for one, path in zip(made.world.robots, paths_of(made), strict=True):
        if not isinstance(one.path, tuple | list) and one.path is not None:
            path = offset_polyline(path, np.full(len(path), one.path.offset))
        line = shapely.LineString(path)
        found.append(line.length - line.project(shapely.Point(one.pose[:2])))
    return found
