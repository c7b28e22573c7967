"""A ROS map: ``map.yaml`` and its image, as map_server and nav2 read them, and its outlines.

Occupancy is 1 - brightness, or brightness with ``negate: 1``. A cell is free below
``free_thresh``, occupied above ``occupied_thresh``, unknown between them; robots may go where it
is free alone. ``mode: raw`` takes the pixels' values for occupancy in percent, and 255 for
unknown.

Outlines of the free cells are exact along the edges of cells, then simplified and checked. Free
cells that meet at a corner alone do not make a passage.
"""

from __future__ import annotations

from math import cos, sin, tau
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import shapely
from pydantic import BeforeValidator, Field
from scipy import ndimage

from physim.authoring.importing.area import MOST_OBSTACLES, SMALLEST, Clearance
from physim.authoring.importing.drawing import DIGITS, Drawing, Shape, listed, place, refused
from physim.authoring.importing.options import Options
from physim.authoring.importing.source import read_image, read_text
from physim.errors import Fault, WorldError, nearest
from physim.geometry.shapes import FloatArray
from physim.world.base import Model
from physim.world.file import read_document
from physim.world.kinds import Flag, Number, Sequence, Text

SPECK = 2.0
"""[cells] Occupied patches up to this many are left out unless the user says otherwise."""
DOT, MANY = 10.0, 100
"""[cells] of a patch that may be noise, and how many of them make that likely"""
MOST_LOST = 0.1
"""[-] share of its area that a hole may lose or gain when outlines are simplified"""
MOST_EDGES = 1_000_000
"""Edges of cells in the outline of the free region."""
MOST_BORDERS = 4_000_000
"""Edges between free and other cells of a map: it has no more patches than a quarter of them."""
WORTH = 0.01
"""[-] share of the largest free region from which on another may be meant"""
HARDLY, FEW = 2.0, 10.0
"""[%] of free cells below which a map is refused, and doubted, if most would be free with
another negate or mode"""
UNKNOWN = 205.0 / 255.0
"""[-] brightness that map_saver gives to what is unknown"""

Coordinate = Annotated[Number, Field(ge=-1e6, le=1e6)]
Yaw = Annotated[Number, Field(ge=-tau, le=tau)]
Share = Annotated[Number, Field(ge=0.0, le=1.0)]


class RosMap(Model):
    """The YAML of a map; ``origin`` x, y [m], yaw [rad] of the lower left corner of its image."""

    image: Text
    resolution: Annotated[Number, Field(ge=1e-6, le=1e3)]
    origin: Annotated[tuple[Coordinate, Coordinate, Yaw], Sequence]
    negate: Annotated[Flag, BeforeValidator(lambda v: bool(v) if v in (0, 1) else v)] = False
    occupied_thresh: Share = 0.65
    free_thresh: Share = 0.196
    mode: Literal["trinary", "scale", "raw"] = "trinary"

    def free(self, brightness: Any, clear: Any) -> Any:
        """(rows, columns) bool of the cells that are free, as they lie in the image.

        Departure from nav2, which averages opacity with the colours in ``trinary`` mode: so white
        that is transparent is unknown as here, but grey of unknown cells that is opaque is free.
        """
        if self.mode == "raw":
            return np.round(brightness * 255.0) / 100.0 < self.free_thresh
        occupancy = brightness if self.negate else 1.0 - brightness
        return (occupancy < self.free_thresh) & ~clear


def read_ros_map(path: Path, options: Options) -> Drawing:
    """Read a map into a drawing: outlines of its free region, or of that at ``--from``.

    Raises ImportSourceError, where several free regions may be meant, too.
    """
    drawing = Drawing(kind="ROS map", path=path)
    found, image = _read_yaml(drawing)
    brightness, clear = read_image(image)
    free = found.free(brightness, clear)
    rows, columns = free.shape
    cell = found.resolution * options.unit
    told = "what is unknown counts as occupied"
    _check_free(drawing, found, brightness, clear)
    if (free & (np.abs(brightness - UNKNOWN) < 1e-3)).any():
        told = "grey 205, which map_saver writes for unknown, counts as free"
        drawing.doubt = f"{told} below free_thresh {found.free_thresh:g}; 0.196 takes it as unknown"
        drawing.changes.append(f"WARNING: {drawing.doubt}")
    drawing.facts.append(
        f"{columns} x {rows} cells of {cell:g} m from {image.name}, "
        f"{columns * cell:.1f} x {rows * cell:.1f} m, {100.0 * free.mean():.0f} % free; {told}"
    )
    x, y, yaw = found.origin
    region = _outlined(
        drawing, np.flipud(free).copy(), cell, (x * options.unit, y * options.unit, yaw), options
    )
    drawing.shapes = [Shape("place", region)]
    return drawing


def _check_free(drawing: Drawing, found: RosMap, brightness: Any, clear: Any) -> None:
    """Name another negate or mode where hardly a cell is free; refuse it where next to none is."""

    def share(**other: Any) -> float:
        return 100.0 * float(found.model_copy(update=other).free(brightness, clear).mean())

    own, negate = share(), not found.negate
    others = {f"negate: {negate:d}": share(negate=negate), "mode: trinary": share(mode="trinary")}
    meant = [f"with {key} {one:.0f} %" for key, one in others.items() if one > 50.0]
    said = f"{own:.2g} % of the cells are free"
    if max(others.values()) > own:
        drawing.doubt = f"{said}: see negate, mode"
    said += f", {', '.join(meant)} would be" if meant else "; see negate, mode and free_thresh"
    if own == 0.0 or (meant and own < HARDLY):
        raise drawing.refusal(said + "; if it is right, crop the image" * bool(meant))
    if meant and own < FEW:
        drawing.changes.append(f"WARNING: {said}")


def _read_yaml(drawing: Drawing) -> tuple[RosMap, Path]:
    """What a map says, and the path of its image; ImportSourceError with the line of a fault."""
    path, keys = drawing.path, list(RosMap.model_fields)
    text = read_text(path)
    document = read_document(text, str(path)) if text.strip() else None
    values = document.values if document else None
    if document is None or not isinstance(values, dict):
        raise refused(path, f"a map is a mapping of keys: {', '.join(keys)}", 1)
    if {"name", "robots"} <= set(values) and not set(values) & set(keys):
        message = "is a world of physim, not a map; use it with physim run"
        raise refused(path, message)
    others = [key for key in values if key not in keys]
    if others and {"image", "resolution", "origin"} <= set(values):
        drawing.changes.append(f"keys left out: {', '.join(str(key) for key in others)}")
        values = {key: value for key, value in values.items() if key in keys}
    try:
        found = RosMap(**values)
        if found.free_thresh > found.occupied_thresh:
            said = f"{found.free_thresh:g} is above occupied_thresh, {found.occupied_thresh:g}"
            raise WorldError([Fault(("free_thresh",), said)])
        return found, _image(path, found.image)
    except WorldError as error:
        fault = error.faults[0]
        raise refused(path, str(fault), document.position(fault.location).line) from None


def _image(path: Path, name: str) -> Path:
    """The image beside the map, never a file elsewhere; WorldError for another name."""
    folder, given = path.parent.resolve(), name[:100]
    try:
        image = (folder / name).resolve()
        is_there = image.is_file()
    except (OSError, RuntimeError, ValueError):
        said = f'"{given}" is not the name of a file'
    else:
        if image.is_relative_to(folder) and is_there:
            return image if Path(name).is_absolute() else path.parent / name
        there = sorted(p.name for p in folder.iterdir() if p.suffix in (".pgm", ".png"))
        said = f'no file "{given}" in {folder.name or "/"}{nearest(name, there)}'
        if not image.is_relative_to(folder):
            said = f'"{given}" lies outside the folder of the map; put the image beside it'
    raise WorldError([Fault(("image",), said)])


def _outlined(
    drawing: Drawing, free: Any, cell: float, origin: tuple[float, float, float], options: Options
) -> Any:
    """Shapely polygon [m] of the free region that is meant; what is left out is listed.

    ``free`` (rows, columns) bool, the lowest row first; ``cell`` [m] the side of a cell;
    ``origin`` x, y [m] and yaw [rad] of the lower left corner.
    """
    x, y, yaw = origin
    turn = np.array([[cos(yaw), sin(yaw)], [-sin(yaw), cos(yaw)]])

    def placed(cells: FloatArray) -> FloatArray:
        return np.asarray(cells * cell @ turn + (x, y))

    borders = sum(np.count_nonzero(np.diff(free, axis=axis)) for axis in (0, 1))
    if borders > MOST_BORDERS:
        raise drawing.refusal(
            f"{borders} edges between free and other cells, at most {MOST_BORDERS} are worked on: "
            "is it noise? Smooth the image or make its cells larger"
        )
    specks = SPECK * cell * cell if options.specks is None else options.specks
    labels, area = _patches(~free, 8, cell)
    small = (area > 0.0) & (area <= specks * (1.0 + 1e-9))

    def speck(k: int) -> str:
        middle = np.argwhere(labels == k).mean(axis=0)[::-1]
        return f"speck of {area[k]:.4g} m² at {place(placed(middle + 0.5))}: left out (--specks)"

    drawing.changes += listed(sorted(np.flatnonzero(small), key=lambda k: -area[k]), speck)
    free |= small[labels]
    at = None
    if options.origin is not None:
        at = np.floor(turn @ (np.array(options.origin) - (x, y)) / cell).astype(int)
    cells = _polygon(drawing, _region(drawing, free, cell, placed, at))
    sizes = np.sort([shapely.Polygon(hole).area for hole in cells.interiors])  # [cells]
    if (excess := len(sizes) - MOST_OBSTACLES) > 0:
        raise drawing.refusal(
            f"{len(sizes)} occupied patches within the free region would be obstacles; at most "
            f"{MOST_OBSTACLES} are read: is it noise? --specks {_area(sizes[excess - 1], cell)} "
            "leaves out the smallest"
        )
    if (dots := int(np.searchsorted(sizes, DOT, "right"))) >= MANY:
        told = (
            f"{dots} obstacles of at most {DOT:g} cells: if they are noise, "
            f"--specks {_area(sizes[dots - 1], cell)} leaves them out"
        )
        drawing.changes.append(f"WARNING: {told}")
        drawing.doubt = "; ".join(filter(None, (drawing.doubt, told)))
    exact = shapely.transform(cells, placed)
    if max(exact.bounds[2] - exact.bounds[0], exact.bounds[3] - exact.bounds[1]) < SMALLEST:
        raise drawing.refusal(
            f"the place is {exact.area:.3g} m² large; check resolution and --scale"
        )
    tolerance = cell if options.tolerance is None else options.tolerance
    simple = _simplified(drawing, exact, tolerance)
    moved = max(_farthest(simple, exact), _farthest(exact, simple))
    drawing.facts.append(
        f"outlines along the edges of cells, simplified within {tolerance:g} m: moved by at most "
        f"{moved:.4f} m, area {exact.area:.2f} to {simple.area:.2f} m²"
    )
    return simple


def _area(cells: float, cell: float) -> str:
    """Area of so many cells [m²], as --specks takes it."""
    return f"{cells * cell * cell:.10g}"


def _patches(cells: Any, connectivity: Literal[4, 8], cell: float) -> tuple[Any, Any]:
    """Labels of connected cells, from 1, and the area [m²] of each label; that of 0 is 0."""
    labels, _ = ndimage.label(cells, ndimage.generate_binary_structure(2, connectivity // 4))
    area = np.bincount(labels.ravel()) * cell * cell
    area[0] = 0.0
    return labels, area


def _region(drawing: Drawing, free: Any, cell: float, placed: Any, at: Any) -> Any:
    """Cells of the free region at a cell (column, row), or of the largest; the others are listed.

    Refused where it may be another that is meant: the margin round a track may be the largest.
    """
    labels, area = _patches(free, 4, cell)
    order = np.argsort(-area, kind="stable")[:-1]

    def told(k: int) -> str:
        own = labels == k
        rows, columns = ndimage.find_objects(own.view(np.int8))[0]
        walled = np.pad(own[rows, columns], 1)  # the edge of the image is a wall
        inner = ndimage.distance_transform_cdt(walled)[1:-1, 1:-1]
        row, column = np.unravel_index(np.argmax(inner), inner.shape)
        deepest = np.array([columns.start + column, rows.start + row])
        return f"{area[k]:.4g} m² about {place(placed(deepest + 0.5))}"

    chosen = int(order[0])
    if at is not None:
        (column, row), (rows, columns) = at, free.shape
        if not (0 <= column < columns and 0 <= row < rows) or not free[row, column]:
            raise drawing.refusal("--from: not in a free cell of the map")
        chosen = int(labels[row, column])
    else:
        edge = {*labels[0], *labels[-1], *labels[:, 0], *labels[:, -1]}
        large = [k for k in order if area[k] >= WORTH * area[chosen]]
        if len(large) > 1 and not edge.isdisjoint(large):
            regions = "; ".join(told(k) for k in large[:5])
            raise drawing.lack(
                f"{len(large)} free regions, and the map is free at the edge of the image: which "
                f"is the place? --from X,Y in one of them: {regions}"
            )
    left = [k for k in order if k != chosen]
    drawing.changes += listed(left, lambda k: f"free region of {told(k)}: not connected, left out")
    return labels == chosen


def _polygon(drawing: Drawing, region: Any) -> Any:
    """Exact outline of a region [cells], lower left corner of the map at (0, 0)."""
    padded = np.pad(region, 1)
    flat, steep = padded[1:, :] != padded[:-1, :], padded[:, 1:] != padded[:, :-1]
    count = int(flat.sum() + steep.sum())
    if count > MOST_EDGES:
        raise drawing.refusal(
            f"the outline of the free region has {count} edges, at most {MOST_EDGES} are read; "
            "larger --specks or a smoother map"
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


def _simplified(drawing: Drawing, exact: Any, tolerance: float) -> Any:
    """Valid polygon on the millimetre grid, within ``tolerance`` of the exact one.

    Holes that would lose or gain too much of their area stay as they are.
    """
    grid = 10.0**-DIGITS
    areas = [shapely.Polygon(hole).area for hole in exact.interiors]
    for share in (1.0, 0.5, 0.25, 0.0):
        simple = shapely.simplify(exact, max(share * tolerance - grid, 0.0))
        holes = [
            kept if abs(shapely.Polygon(kept).area / area - 1.0) <= MOST_LOST else hole
            for kept, hole, area in zip(simple.interiors, exact.interiors, areas, strict=True)
        ]
        found = shapely.Polygon(simple.exterior, holes)
        if found.is_valid:
            found = shapely.set_precision(found, grid)
            parts = [one for one in shapely.get_parts(found) if one.geom_type == "Polygon"]
            if len(parts) == 1 and len(parts[0].interiors) == len(holes):
                return parts[0]
    raise drawing.refusal("its outlines cannot be rounded to the millimetre; smooth the map")


def _farthest(a: Any, b: Any) -> float:
    """[m] Largest distance of a corner of ``a`` to the outline of ``b``."""
    return float(Clearance(b).of(shapely.points(shapely.get_coordinates(a))).max())
