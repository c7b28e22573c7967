"""A ROS map: ``map.yaml`` and its image, as map_server and nav2 read them, and its outlines.

Occupancy is 1 - brightness, or brightness with ``negate: 1``. A cell is free below
``free_thresh``, occupied above ``occupied_thresh``, unknown between them; robots may go where it
is free alone. ``mode: raw`` takes the pixels' values for occupancy in percent, and 255 for
unknown.

Outlines of the free cells are exact along the edges of cells, then simplified and checked. Free
cells that meet at a corner alone do not make a passage.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import shapely

from physim.authoring.importing.drawing import DIGITS, MOST_LISTED, Drawing, listed, place, refused
from physim.authoring.importing.enclosure import MOST_OBSTACLES, check_size
from physim.authoring.importing.lines import Outline
from physim.authoring.importing.options import Options
from physim.authoring.importing.ros_map_file import RosMap, read_map_file
from physim.authoring.importing.source import read_image
from physim.escaping import escaped
from physim.geometry.shapes import FloatArray

SPECK = 2.0
"""[cells] Occupied patches up to this many are left out unless the user says otherwise."""
LARGEST_CELL = 2.0
"""[m] of a cell from which on the scale is doubted: robots are no longer"""
MOST_LOST = 0.1
"""[-] share of its area that a ring may lose or gain when it is simplified"""
MOST_EDGES = 1_000_000
"""Edges of cells in the outline of the free region."""
MOST_BORDERS = 4_000_000
"""Edges between free and other cells of a map: it has no more patches than a quarter of them."""


def outline_map(
    path: Path,
    drawing: Drawing,
    free: Any,
    cell: float,
    origin: tuple[float, float, float],
    options: Options,
) -> None:
    """Fill in boundaries, obstacles and area of a drawing from free cells.

    ``free`` (rows, columns) bool, the lowest row first; ``cell`` [m] the side of a cell;
    ``origin`` x, y [m] and yaw [rad] of the lower left corner.
    """
    tolerance = cell if options.tolerance is None else options.tolerance
    specks = SPECK * cell * cell if options.specks is None else options.specks
    free = free.copy()
    if not free.any():
        raise refused(path, "no cell of the map is free; see negate and free_thresh")
    _check_borders(path, free)
    centre = _Centres(cell, origin)
    drawing.changes += _fill_specks(free, specks, cell, centre)
    region = _region(path, drawing, free, cell, centre, options.origin)
    cells = _polygon(path, region)
    _check_holes(path, len(cells.interiors))
    exact = shapely.transform(cells, lambda at: centre.placed(at * cell))
    x0, y0, x1, y1 = exact.bounds
    check_size(path, np.array([x1 - x0, y1 - y0]))
    polygon = _simplified(path, exact, tolerance)
    moved = max(_farthest(polygon, exact), _farthest(exact, polygon))
    drawing.facts.append(
        f"outlines along the edges of cells, simplified within {tolerance:g} m: moved by at most "
        f"{moved:.4f} m (Hausdorff distance), area {exact.area:.2f} to {polygon.area:.2f} m²"
    )
    drawing.area = polygon
    drawing.add_outline(polygon)


def _check_borders(path: Path, free: Any) -> None:
    """Refuse noise, as memory grows with the number of patches."""
    borders = sum(np.count_nonzero(np.diff(free, axis=axis)) for axis in (0, 1))
    if borders > MOST_BORDERS:
        raise refused(
            path,
            f"{borders} edges between free and other cells, at most {MOST_BORDERS} are worked on: "
            "is it noise? Smooth the image or make its cells larger",
        )


@dataclass(frozen=True)
class _Centres:
    """From cells to the world."""

    cell: float
    origin: tuple[float, float, float]

    def placed(self, points: FloatArray) -> FloatArray:
        """Points [m] from the lower left corner in the frame of the world."""
        x, y, yaw = self.origin
        c, s = cos(yaw), sin(yaw)
        return np.asarray(points @ np.array([[c, s], [-s, c]]) + (x, y))

    def of(self, cells: FloatArray) -> FloatArray:
        """Middles of cells (column, row)."""
        return self.placed((np.asarray(cells) + 0.5) * self.cell)

    def column_row(self, point: tuple[float, float]) -> tuple[int, int]:
        """Cell that a point of the world lies in."""
        x, y, yaw = self.origin
        c, s = cos(yaw), sin(yaw)
        column, row = np.array([[c, s], [-s, c]]) @ (point[0] - x, point[1] - y) // self.cell
        return int(column), int(row)


def _fill_specks(free: Any, most: float, cell: float, centre: _Centres) -> list[str]:
    """Free the cells of small occupied patches; returns what was left out, largest first."""
    count, labels, stats, middles = cv2.connectedComponentsWithStats(
        (~free).astype(np.uint8), connectivity=8
    )
    area = stats[:, cv2.CC_STAT_AREA] * cell * cell
    small = (area <= most * (1.0 + 1e-9)) & (np.arange(count) > 0)
    free |= small[labels] & ~free
    order = np.flatnonzero(small)[np.argsort(-area[small], kind="stable")]
    return listed(
        list(order),
        lambda k: (
            f"speck of {area[k]:.4g} m² at {place(centre.of(middles[k]))}: left out (--specks)"
        ),
    )


def _region(
    path: Path,
    drawing: Drawing,
    free: Any,
    cell: float,
    centre: _Centres,
    inside: tuple[float, float] | None,
) -> Any:
    """Cells of the largest free region, or of the one at ``inside``; the others are listed."""
    _, labels, stats, middles = cv2.connectedComponentsWithStats(
        free.astype(np.uint8), connectivity=4
    )
    area = stats[:, cv2.CC_STAT_AREA].astype(np.float64)
    area[0] = -1.0
    chosen = int(np.argmax(area))
    if inside is not None:
        column, row = centre.column_row(inside)
        rows, columns = free.shape
        if not (0 <= column < columns and 0 <= row < rows) or not free[row, column]:
            raise refused(path, f"--from {place(inside)}: not in a free cell of the map")
        chosen = int(labels[row, column])
    others = [k for k in np.argsort(-area, kind="stable") if k not in (0, chosen)]
    drawing.changes += listed(
        others,
        lambda k: (
            f"free region of {area[k] * cell * cell:.4g} m² about "
            f"{place(centre.of(middles[k]))}: not connected, left out"
        ),
    )
    if len(others) > MOST_LISTED:
        rest = area[others].sum() * cell * cell
        drawing.changes.append(f"free regions left out: {rest:.4g} m² in all")
    return labels == chosen


def _polygon(path: Path, region: Any) -> Any:
    """Exact outline of a region [cells], lower left corner of the map at (0, 0)."""
    padded = np.pad(region, 1)
    flat, steep = padded[1:, :] != padded[:-1, :], padded[:, 1:] != padded[:, :-1]
    count = int(flat.sum() + steep.sum())
    if count > MOST_EDGES:
        raise refused(
            path,
            f"the outline of the free region has {count} edges, at most {MOST_EDGES} are read; "
            "larger --specks or a smoother map",
        )
    sides = np.vstack([_sides(flat, steep), _sides(steep.T, flat.T)[:, :, ::-1]]).astype(np.float64)
    faces = shapely.get_parts(shapely.polygonize(shapely.linestrings(sides)))
    inner = shapely.get_coordinates(shapely.point_on_surface(faces))
    column, row = (np.floor(inner[:, k]).astype(int) for k in (0, 1))
    own = faces[region[row, column]]
    # Cells of one region may meet at a corner: one polygon still, joined there.
    return max(own, key=shapely.area)


def _sides(flat: Any, steep: Any) -> Any:
    """(k, 2, 2) ends, column and row, of the straight sides that are flat, from corner to corner.

    ``flat`` (R - 1, C) and ``steep`` (R, C - 1) say between which cells of a padded map there is an
    edge.
    """
    corner = np.zeros((flat.shape[0], flat.shape[1] + 1), dtype=np.bool_)
    corner[:, 1:-1] = steep[:-1] | steep[1:]  # a side ends where one of the others does
    before = np.pad(flat[:, :-1], ((0, 0), (1, 0)))
    after = np.pad(flat[:, 1:], ((0, 0), (0, 1)))
    rows, first = np.nonzero(flat & (corner[:, :-1] | ~before))
    _, last = np.nonzero(flat & (corner[:, 1:] | ~after))
    return np.stack([np.stack([first - 1, rows], 1), np.stack([last, rows], 1)], axis=1)


def _check_holes(path: Path, count: int) -> None:
    """Refuse more holes than a world has obstacles before their outlines are worked on."""
    if count > MOST_OBSTACLES:
        raise refused(
            path,
            f"{count} occupied patches within the free region would be obstacles; at most "
            f"{MOST_OBSTACLES} are read: is it noise? Larger --specks or a smoother map",
        )


def _simplified(path: Path, exact: Any, tolerance: float) -> Any:
    """Valid polygon on the millimetre grid, within ``tolerance`` of the exact one."""
    grid = 10.0**-DIGITS
    for share in (1.0, 0.5, 0.25, 0.0):
        rings = [
            _simple_ring(ring, max(share * tolerance - grid, 0.0))
            for ring in (exact.exterior, *exact.interiors)
        ]
        simple = _on_grid(shapely.Polygon(rings[0], rings[1:]), grid)
        kept = len(getattr(simple, "interiors", ())) == len(exact.interiors)
        if simple.geom_type == "Polygon" and simple.is_valid and kept and not simple.is_empty:
            return simple
    parts = [one for one in shapely.get_parts(simple) if one.geom_type == "Polygon"]
    if len(parts) != 1:
        raise refused(path, "its outlines cannot be rounded to the millimetre; smooth the map")
    return parts[0]


def _on_grid(polygon: Any, grid: float) -> Any:
    """Polygon rounded to a grid; an empty one where rings cross, each simplified by itself."""
    try:
        return shapely.set_precision(polygon, grid)
    except shapely.errors.GEOSException:
        return shapely.Polygon()


def _simple_ring(ring: Any, tolerance: float) -> Any:
    """Ring with fewer corners, within a tolerance; a small one keeps its area, with a smaller."""
    line, exact = shapely.LineString(ring), shapely.Polygon(ring)
    for share in (1.0, 0.5, 0.25):  # as a line: a polygon's first corner would move farther
        points = shapely.get_coordinates(shapely.simplify(line, share * tolerance))
        lost = abs(shapely.Polygon(points).area - exact.area) if len(points) > 3 else np.inf
        if lost <= MOST_LOST * exact.area:
            return shapely.LinearRing(points)
    return shapely.simplify(ring, 0.0)


def _farthest(a: Any, b: Any) -> float:
    """[m] Largest distance of a corner of ``a`` to the outline of ``b``."""
    return float(Outline(b).distances(shapely.points(shapely.get_coordinates(a))).max())


def read_ros_map(path: Path, options: Options) -> Drawing:
    """Read a map into a drawing: outlines of its largest free region, or of that at ``--from``."""
    found = read_map_file(path)
    brightness, clear = read_image(found.image)
    free = _free(found, brightness, clear)
    drawing = Drawing(kind="ROS map")
    rows, columns = free.shape
    cell = found.resolution * options.unit
    drawing.facts.append(
        f"{columns} x {rows} cells of {cell:g} m from {escaped(found.image.name)}, "
        f"{columns * cell:.1f} x {rows * cell:.1f} m, {100.0 * free.mean():.0f} % free; "
        "what is unknown counts as occupied"
    )
    if cell > LARGEST_CELL:
        drawing.changes.append(
            f"check the scale: cells of {cell:g} m; a map's resolution is in metres, 0.05 for 5 cm "
            "(--scale 0.001 for millimetres)"
        )
    drawing.changes += found.changes
    x, y, yaw = found.origin
    origin = (x * options.unit, y * options.unit, yaw)
    outline_map(path, drawing, np.flipud(free), cell, origin, options)
    return drawing


def _free(found: RosMap, brightness: Any, clear: Any) -> Any:
    """(rows, columns) bool, top row first.

    Departure from nav2, which averages opacity with the colours in ``trinary`` mode: so white that
    is transparent is unknown as here, but grey of unknown cells that is opaque becomes free.
    """
    if found.mode == "raw":
        percent = np.round(brightness * 255.0)
        return percent / 100.0 < found.free
    occupancy = brightness if found.negate else 1.0 - brightness
    return (occupancy < found.free) & ~clear
