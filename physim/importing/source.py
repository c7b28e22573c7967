"""Which kind of source a file is, and its bytes: size and encoding checked before it is read."""

from __future__ import annotations

import re
import stat
from pathlib import Path

from physim.importing.drawing import refused

MOST_TEXT = 20_000_000
"""Bytes of a text that is read."""
MOST_IMAGE = 200_000_000
"""Bytes of an image that is read."""

FORMATS = ("track", "ros-map", "svg", "wkt", "geojson")

SUFFIXES = {
    ".csv": "track",
    ".yaml": "ros-map",
    ".yml": "ros-map",
    ".svg": "svg",
    ".wkt": "wkt",
    ".geojson": "geojson",
}

IMAGES = (".pgm", ".png", ".pnm", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff")


def read_bytes(path: Path, most: int) -> bytes:
    """Bytes of a regular file of at most ``most``; ImportSourceError otherwise."""
    try:
        status = path.stat()
        if stat.S_ISDIR(status.st_mode):
            raise refused(path, "is a folder; name a file")
        if not stat.S_ISREG(status.st_mode):
            raise refused(path, "is not a regular file")
        if status.st_size > most:
            raise refused(path, f"{status.st_size / 1e6:.1f} MB; at most {most / 1e6:.0f} MB")
        with path.open("rb") as file:
            data = file.read(most + 1)
    except FileNotFoundError:
        raise refused(path, "no such file") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise refused(path, f"cannot be read: {reason}") from None
    if len(data) > most:
        raise refused(path, f"more than {most / 1e6:.0f} MB")
    return data


def read_text(path: Path) -> str:
    """Text (UTF-8) of a file, line ends as ``\\n``."""
    data = read_bytes(path, MOST_TEXT)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        message = f"byte 0x{data[error.start]:02x} is not UTF-8; save the file as UTF-8"
        raise refused(path, message, line) from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def format_of(path: Path) -> str:
    """Kind of a source, by its suffix, else by what it begins with."""
    suffix = path.suffix.lower()
    if suffix in IMAGES:
        beside = sorted(p.name for p in path.parent.glob("*.yaml"))[:5]
        near = f"; there: {', '.join(beside)}" if beside else ""
        raise refused(
            path, f"an image alone has no scale; name the map.yaml that belongs to it{near}"
        )
    if suffix in SUFFIXES:
        return SUFFIXES[suffix]
    if suffix in (".gz", ".svgz", ".zip"):
        raise refused(path, "is compressed; unpack it first (Inkscape: save as plain SVG)")
    start = read_bytes(path, MOST_TEXT)[:4000].decode("utf-8", errors="replace").lstrip("\ufeff \n")
    if re.match(r"(<\?xml[^>]*>\s*)?(<!--.*?-->\s*)*<svg\b", start, re.DOTALL):
        return "svg"
    if start.startswith("{"):
        return "geojson"
    if re.match(r"(SRID=\d+;)?\s*[A-Z]*(POLYGON|LINESTRING|COLLECTION|POINT)\b", start, re.I):
        return "wkt"
    if re.search(r"^image\s*:", start, re.MULTILINE):
        return "ros-map"
    if re.match(r"#?\s*x_m\b", start) or re.match(r"[-+0-9.eE \t]+[,;]", start):
        return "track"
    raise refused(path, f"neither name nor content says what it is; --format {'|'.join(FORMATS)}")
