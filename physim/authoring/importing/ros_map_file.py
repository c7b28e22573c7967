"""The YAML of a ROS map: what it says of its image, each refusal with its line."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from physim.authoring.importing.drawing import refused
from physim.authoring.importing.source import read_text
from physim.errors import Location, nearest
from physim.escaping import escaped
from physim.world.file import Document, read_document

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


def read_map_file(path: Path) -> RosMap:
    """What a file says; ImportSourceError with file:line for what no map may say."""
    text = read_text(path)
    if not text.strip():
        raise refused(path, f"the file is empty; a map has {', '.join(KEYS)}", 1)
    return _Yaml(path, read_document(text, escaped(str(path)))).read()


@dataclass(frozen=True)
class _Yaml:
    """Checks of the keys, each refusal with its line."""

    path: Path
    document: Document

    def read(self) -> RosMap:
        values = self._values()
        if {"name", "robots"} <= set(values) and not set(values) & set(KEYS):
            message = "is a world of physim already, and no map; physim run takes it as it is"
            raise refused(self.path, message)
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
        if abs(pose[2]) > 2.0 * math.pi:
            raise self._fault(
                ("origin", 2),
                f"{pose[2]:g} is a yaw in rad, at most a full turn; is it in degrees?",
            )
        resolution = self._number(("resolution",), values["resolution"])
        if not 1e-6 <= resolution <= 1e3:
            raise self._fault(("resolution",), f"{resolution:g} m per cell; must be 1e-6 to 1000")
        negate = values.get("negate", 0)
        if negate not in (0, 1):
            raise self._fault(("negate",), f'must be 0 or 1; given "{escaped(str(negate)[:40])}"')
        mode = values.get("mode", "trinary")
        if mode not in MODES:
            raise self._fault(
                ("mode",), f'must be {", ".join(MODES)}; given "{escaped(str(mode)[:40])}"'
            )
        occupied = self._share("occupied_thresh", values.get("occupied_thresh", OCCUPIED))
        free = self._share("free_thresh", values.get("free_thresh", FREE))
        if free > occupied:
            raise self._fault(("free_thresh",), f"{free:g} is above occupied_thresh, {occupied:g}")
        changes = []
        if unknown:
            changes.append(f"keys left out: {', '.join(escaped(str(key)) for key in unknown)}")
        return RosMap(
            self._image(values["image"]), resolution, (pose[0], pose[1], pose[2]),
            bool(negate), occupied, free, str(mode), tuple(changes),
        )  # fmt: skip

    def _values(self) -> dict[str, Any]:
        values = self.document.values
        if not isinstance(values, dict):
            raise refused(self.path, f"a map is a mapping of keys: {', '.join(KEYS)}", 1)
        return values

    def _fault(self, location: Location, message: str) -> Exception:
        line = self.document.position(location).line
        return refused(self.path, f"{location[0]}: {message}", line)

    def _number(self, location: Location, value: Any) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self._fault(location, f'"{escaped(str(value)[:40])}" is not a number')
        if not math.isfinite(value) or abs(value) > 1e6:
            far = "; of a grid, leave out whole kilometres" if location[0] == "origin" else ""
            raise self._fault(location, f"{value!r} is out of range, at most 1e6{far}")
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
        given = escaped(value[:100])
        try:
            image = (folder / value).resolve()
            is_there = image.exists()
        except (OSError, RuntimeError, ValueError):
            raise self._fault(("image",), f'"{given}" is not the name of a file') from None
        if not image.is_relative_to(folder):
            raise self._fault(
                ("image",), f'"{given}" lies outside the folder of the map; put the image beside it'
            )
        if not is_there:
            there = sorted(p.name for p in folder.iterdir() if p.suffix in (".pgm", ".png"))
            near = nearest(value, there)
            raise self._fault(("image",), f'no file "{given}" in {folder.name or "/"}{near}')
        return self.path.parent / value if not Path(value).is_absolute() else image
