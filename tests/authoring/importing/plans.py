"""Made-up places, the ways to write them down, and what a test asks of a world made of one."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from physim.authoring.importing import Imported, ImportSourceError, Options, import_world
from physim.world.checks import check_world
from tests.helpers import inside

accessible_area, offset_polyline = inside(
    "physim.world.ground", "accessible_area", "offset_polyline"
)

SAMPLES = Path(__file__).parent / "samples"
CELL = 0.1
METRES = Options(scale=1.0)
LINE = 'fill="none" stroke="black"'
HALL = ("boundary", shapely.box(0, 0, 50, 20))
WAY = ("path", shapely.LineString([(3, 5), (47, 5)]))
LOOP = [(0, 0), (24, 0), (24, 14), (0, 14), (0, 0)]
WALLS = '<path id="boundary" d="M 0,0 24,0 24,14 0,14 Z"/>'
PATH = '<path id="path" d="M 2,7 L 20,7"/>'


def office() -> Any:
    """Corridor of 3 m along two rooms, open to it by doors of 2.4 m, with a pillar in each."""
    outer = shapely.box(0.0, 0.0, 24.0, 14.0)
    walls = [
        shapely.box(-0.1, 3.0, 4.0, 3.2),
        shapely.box(6.4, 3.0, 16.0, 3.2),
        shapely.box(18.4, 3.0, 24.1, 3.2),
        shapely.box(11.9, 3.0, 12.1, 14.1),
        shapely.box(5.5, 8.0, 6.3, 8.8),
        shapely.Point(18.0, 8.5).buffer(0.5),
    ]
    return outer.difference(shapely.union_all(walls))


def free_cells(plan: Any, cell: float = CELL, margin: int = 3) -> tuple[Any, tuple[float, float]]:
    """Free cells (rows, columns), top row first, and the lower left corner [m]."""
    x0, y0, x1, y1 = plan.bounds
    columns, rows = (round(d / cell) + 2 * margin for d in (x1 - x0, y1 - y0))
    corner = (x0 - margin * cell, y0 - margin * cell)
    xs = corner[0] + (np.arange(columns) + 0.5) * cell
    ys = corner[1] + (np.arange(rows) + 0.5) * cell
    return np.flipud(shapely.contains_xy(plan, *np.meshgrid(xs, ys))), corner


def pgm(pixels: Any, plain: bool = False) -> bytes:
    rows, columns = pixels.shape
    head = f"{'P2' if plain else 'P5'}\n# made here\n{columns} {rows}\n255\n".encode()
    if not plain:
        return head + pixels.astype(np.uint8).tobytes()
    return head + b"\n".join(b" ".join(str(v).encode() for v in row) for row in pixels.tolist())


def map_yaml(image: str, cell: float, corner: tuple[float, float], **more: object) -> str:
    keys = {"image": image, "resolution": cell, "origin": [*map(float, corner), 0.0], "negate": 0,
            "occupied_thresh": 0.65, "free_thresh": 0.196, **more}  # fmt: skip
    return "".join(f"{key}: {value}\n" for key, value in keys.items())


def write_map(folder: Path, free: Any, corner: tuple[float, float], cell: float = CELL) -> Path:
    """``map.yaml`` and ``map.pgm`` in a folder."""
    (folder / "map.pgm").write_bytes(pgm(np.where(free, 254, 0)))
    path = folder / "map.yaml"
    path.write_text(map_yaml("map.pgm", cell, corner))
    return path


def svg_path(line: Any) -> str:
    return "M " + " L ".join(f"{x:.9g},{y:.9g}" for x, y in np.asarray(line))


def svg(body: str, size: str = 'width="240mm" height="140mm" viewBox="0 0 24 14"') -> str:
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
        'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" '
        f"{size}>\n{body}\n</svg>\n"
    )


def check_says(message: str, parts: str) -> None:
    """Assert that a message says all parts, whole and in order; `` … `` stands between them.

    A part is a place, a key, what was given or what is allowed; not how the sentence puts it.
    """
    at = 0
    for part in parts.split(" … "):
        before = r"(?<![\w.-])" if part[0].isalnum() else ""
        after = r"(?![\w-]|\.\d)" if part[-1].isalnum() else ""
        found = re.compile(before + re.escape(part) + after).search(message, at)
        assert found, f'"{part}" is not said, or not in this order: {message}'
        at = found.end()


def only(imported: Imported, word: str) -> str:
    """The one change that speaks of something."""
    found = [change for change in imported.changes if word in change]
    assert len(found) == 1, imported.changes
    assert found[0] in imported.text.replace("\n#   ", " ")
    return found[0]


def box(x: float, y: float, length: float = 1.8, width: float = 1.0) -> Any:
    return shapely.box(x - length / 2, y - width / 2, x + length / 2, y + width / 2)


def paths_of(made: Imported) -> list[Any]:
    """Points of each robot's path, of the reference path where it is that."""
    return [
        np.asarray(
            made.world.reference_path if not isinstance(one.path, tuple | list) else one.path
        )
        for one in made.world.robots
    ]


def ways_of(made: Imported) -> list[float]:
    """[m] from each robot to the end of its path, at which the first of them stops."""
    found = []
    for one, path in zip(made.world.robots, paths_of(made), strict=True):
        if not isinstance(one.path, tuple | list) and one.path is not None:
            path = offset_polyline(path, np.full(len(path), one.path.offset))
        line = shapely.LineString(path)
        found.append(line.length - line.project(shapely.Point(one.pose[:2])))
    return found


def geojson(folder: Path, parts: list[tuple[str, Any]]) -> Path:
    path = folder / "plan.geojson"
    features = [
        {
            "type": "Feature",
            "properties": {"role": role.split(" ")[0], "name": role.partition(" ")[2]},
            "geometry": shapely.geometry.mapping(shape),
        }
        for role, shape in parts
    ]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    return path


def drawing(folder: Path, body: str, extent: float = 60.0) -> Path:
    path = folder / "plan.svg"
    path.write_text(svg(body, f'width="{extent:g}" height="{extent:g}"'))
    return path


def free_area(made: Imported, folder: Path) -> float:
    """[m²] that the robots of a world may use; its check must find no error."""
    world = folder / "made.yaml"
    world.write_text(made.text)
    found = check_world(world)
    assert not found.errors
    assert found.layout is not None
    assert found.layout.world == made.world
    boundaries = [np.asarray(line) for line in made.world.boundaries or ()]
    obstacles = [np.asarray(getattr(one, "outline", one)) for one in made.world.obstacles or ()]
    path = np.asarray(made.world.reference_path)
    return float(accessible_area(boundaries, obstacles, path).polygon.area)


def refusal(path: Path, options: Options = METRES) -> str:
    with pytest.raises(ImportSourceError) as caught:
        import_world(path, options)
    assert "\n" not in str(caught.value)
    return str(caught.value)
