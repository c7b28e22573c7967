"""A made-up office, and the ways to write it down; ``python -m tests.importing.plans`` makes the
samples.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import shapely

from physim.authoring.importing import Imported

SAMPLES = Path(__file__).parent / "samples"

CELL = 0.1


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


def main() -> None:
    plan = office()
    free, corner = free_cells(plan)
    free[40:42, 60:61] = False  # a speck of two cells
    unknown = np.where(free, 254, 0)
    unknown[:3, :] = 205
    cv2.imwrite(str(SAMPLES / "office.png"), unknown.astype(np.uint8))
    (SAMPLES / "office.yaml").write_text(map_yaml("office.png", CELL, corner, mode="trinary"))
    plan = shapely.set_precision(plan, 0.001)
    (SAMPLES / "office.wkt").write_text(f"# a made-up office [m]\n{plan.wkt}\n")
    feature = {
        "type": "Feature",
        "properties": {"name": "office"},
        "geometry": shapely.geometry.mapping(plan),
    }
    collection = {"type": "FeatureCollection", "features": [feature]}
    (SAMPLES / "office.geojson").write_text(json.dumps(collection) + "\n")


if __name__ == "__main__":
    main()


def only(imported: Imported, word: str) -> str:
    """The one change that speaks of something."""
    found = [change for change in imported.changes if word in change]
    assert len(found) == 1, imported.changes
    assert found[0] in imported.text.replace("\n#   ", " ")
    return found[0]
