"""A ROS map: ``map.yaml`` and its image, as map_server and nav2 read them.

Occupancy is 1 - brightness, or brightness with ``negate: 1``. A cell is free below
``free_thresh``, occupied above ``occupied_thresh``, unknown between them; robots may go where it is
free alone. ``mode: raw`` takes the pixels' values for occupancy in percent, and 255 for unknown.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from physim.errors import Location, nearest
from physim.importing.drawing import Drawing, Options, printable, refused
from physim.importing.image_file import read_image
from physim.importing.outlines import outline_map
from physim.importing.source import read_text
from physim.world_file import Document, located, read_document

KEYS = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode")
MODES = ("trinary", "scale", "raw")
OCCUPIED, FREE = 0.65, 0.196
"""map_server's thresholds where the file gives none"""


@dataclass(frozen=True)
class RosMap:
    """The YAML of a map: ``origin`` x, y [m], yaw [rad] of the lower left corner of its image."""

    image: Path
    resolution: float
    origin: tuple[float, float, float]
    negate: bool
    occupied: float
    free: float
    mode: str
    changes: tuple[str, ...]


def read_ros_map(path: Path, options: Options) -> Drawing:
    """Read a map into a drawing: outlines of its largest free region, or of that at ``--from``."""
    text = read_text(path)
    if not text.strip():
        raise refused(path, f"the file is empty; a map has {', '.join(KEYS)}", 1)
    found = _Yaml(path, read_document(text, printable(str(path)))).read()
    brightness, clear = read_image(found.image)
    free = _free(found, brightness, clear)
    drawing = Drawing(kind="ROS map")
    rows, columns = free.shape
    cell = found.resolution * options.unit
    drawing.facts.append(
        f"{columns} x {rows} cells of {cell:g} m from {printable(found.image.name)}, "
        f"{columns * cell:.1f} x {rows * cell:.1f} m, {100.0 * free.mean():.0f} % free; "
        "what is unknown counts as occupied"
    )
    drawing.changes += found.changes
    x, y, yaw = found.origin
    origin = (x * options.unit, y * options.unit, yaw)
    outline_map(path, drawing, np.flipud(free), cell, origin, options)
    return drawing


def _free(found: RosMap, brightness: Any, clear: Any) -> Any:
    """(rows, columns) bool, top row first."""
    if found.mode == "raw":
        percent = np.round(brightness * 255.0)
        return percent / 100.0 < found.free
    occupancy = brightness if found.negate else 1.0 - brightness
    free = occupancy < found.free
    return free & ~clear if found.mode == "scale" else free


@dataclass(frozen=True)
class _Yaml:
    """Checks of the keys, each refusal with its line."""

    path: Path
    document: Document

    def read(self) -> RosMap:
        values = self._values()
        unknown = [key for key in values if key not in KEYS]
        for key in ("image", "resolution", "origin"):
            if key not in values:
                near = nearest(key, [str(name) for name in unknown])
                meant = next((name for name in unknown if near and f'"{name}"' in near), None)
                line = 1 if meant is None else self.document.position((meant,)).line
                message = f"{key}: missing; a map has {', '.join(KEYS)}{near}"
                raise refused(self.path, message, line)
        origin = values["origin"]
        if not isinstance(origin, list) or len(origin) not in (2, 3):
            raise self._fault(("origin",), "must be [x, y, yaw] in m and rad")
        pose = [self._number(("origin", k), v) for k, v in enumerate(origin)] + [0.0]
        resolution = self._number(("resolution",), values["resolution"])
        if not 1e-6 <= resolution <= 1e3:
            raise self._fault(("resolution",), f"{resolution:g} m per cell; must be greater than 0")
        negate = values.get("negate", 0)
        if negate not in (0, 1):
            raise self._fault(("negate",), f'must be 0 or 1; given "{printable(str(negate)[:40])}"')
        mode = values.get("mode", "trinary")
        if mode not in MODES:
            raise self._fault(("mode",), f'must be {", ".join(MODES)}; given "{mode}"'[:200])
        occupied = self._share("occupied_thresh", values.get("occupied_thresh", OCCUPIED))
        free = self._share("free_thresh", values.get("free_thresh", FREE))
        if free > occupied:
            raise self._fault(("free_thresh",), f"{free:g} is above occupied_thresh, {occupied:g}")
        changes = []
        if unknown:
            changes.append(f"keys left out: {', '.join(printable(str(key)) for key in unknown)}")
        return RosMap(
            self._image(values["image"]), resolution, (pose[0], pose[1], pose[2]),
            bool(negate), occupied, free, str(mode), tuple(changes),
        )  # fmt: skip

    def _values(self) -> dict[str, Any]:
        if self.document.faults:
            raise located((), self.document)
        values = self.document.values()
        if not isinstance(values, dict):
            raise refused(self.path, f"a map is a mapping of keys: {', '.join(KEYS)}", 1)
        return values

    def _fault(self, location: Location, message: str) -> Exception:
        line = self.document.position(location).line
        return refused(self.path, f"{location[0]}: {message}", line)

    def _number(self, location: Location, value: Any) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self._fault(location, f'"{printable(str(value)[:40])}" is not a number')
        if not math.isfinite(value) or abs(value) > 1e6:
            raise self._fault(location, f"{value!r} is out of range, at most 1e6")
        return float(value)

    def _share(self, key: str, value: Any) -> float:
        share = self._number((key,), value)
        if not 0.0 <= share <= 1.0:
            raise self._fault((key,), f"{share:g}; must be from 0 to 1")
        return share

    def _image(self, value: Any) -> Path:
        """The image beside the map; never a file elsewhere, whatever the map says."""
        if not isinstance(value, str) or not value.strip() or "\0" in value:
            raise self._fault(("image",), "must be the name of a file")
        folder = self.path.parent.resolve()
        try:
            image = (folder / value).resolve()
        except (OSError, RuntimeError, ValueError):
            raise self._fault(("image",), "is not the name of a file") from None
        shown = printable(value[:100])
        if not image.is_relative_to(folder):
            raise self._fault(
                ("image",), f'"{shown}" lies outside the folder of the map; put the image beside it'
            )
        if not image.exists():
            there = sorted(p.name for p in folder.iterdir() if p.suffix in (".pgm", ".png"))
            near = nearest(value, there)
            raise self._fault(("image",), f'no file "{shown}" in {folder.name or "/"}{near}')
        return self.path.parent / value if not Path(value).is_absolute() else image
