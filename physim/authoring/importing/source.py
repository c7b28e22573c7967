"""What is read from disk: which kind of source a file is, its text, and the pixels of an image."""

from __future__ import annotations

import io
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from PIL import Image

from physim import files
from physim.authoring.importing.drawing import refused

MOST_TEXT = 20_000_000
"""Bytes of a text that is read"""
MOST_IMAGE = 200_000_000
"""Bytes of an image that is read"""
MOST_PIXELS = 50_000_000
"""Pixels of an image that is decoded, about 7000 x 7000"""
MOST_SIDE = 1_000_000
"""Pixels of a side"""


class Format(NamedTuple):
    """Module and function that read a kind of source, suffixes of its files, and options that are
    not for all kinds.
    """

    reader: str
    suffixes: tuple[str, ...]
    options: tuple[str, ...]


FORMATS = {
    "track": Format("track.read_track", (".csv",), ("start", "gap", "open")),
    "ros-map": Format("ros_map.read_ros_map", (".yaml", ".yml"), ("specks", "tolerance")),
    "svg": Format(
        "svg.read_svg", (".svg",), ("tolerance", "boundary", "close", "ignore", "ignore_others")
    ),
    "wkt": Format("vector.read_wkt", (".wkt",), ("close",)),
    "geojson": Format(
        "vector.read_geojson", (".geojson", ".json"), ("close", "ignore", "ignore_others")
    ),
}
IMAGES = (".pgm", ".png", ".pnm", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff")


def format_of(path: Path) -> str:
    """Kind of a source by its suffix; ImportSourceError where that says none."""
    suffix = path.suffix.lower()
    for name, one in FORMATS.items():
        if suffix in one.suffixes:
            return name
    if suffix in IMAGES:
        raise refused(path, "an image alone has no scale; name the map.yaml that belongs to it")
    if suffix in (".gz", ".svgz", ".zip"):
        raise refused(path, "is compressed; unpack it first (Inkscape: save as plain SVG)")
    read_bytes(path, MOST_TEXT)  # one that cannot be read is told as such
    raise refused(path, f"its suffix does not say what it is; --format {'|'.join(FORMATS)}")


def read_bytes(path: Path, most: int) -> bytes:
    """Bytes of a regular file of at most ``most``; ImportSourceError otherwise."""
    try:
        return files.read_bytes(path, most)
    except files.UnreadableError as error:
        raise refused(path, str(error), error.line) from None


def read_text(path: Path) -> str:
    """Text (UTF-8) of a file, line ends as ``\\n``."""
    try:
        text = files.read_text(path, MOST_TEXT)
    except files.UnreadableError as error:
        raise refused(path, str(error), error.line) from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def read_image(path: Path) -> tuple[Any, Any]:
    """Brightness (rows, columns) from 0 to 1, top row first, and where it is transparent.

    Colours are averaged. Raises ImportSourceError for what is no image, too large or cut short.
    """
    data = read_bytes(path, MOST_IMAGE)
    if data[:2] not in (b"P2", b"P5") and data[:4] != b"\x89PNG":
        raise refused(path, "is neither PGM (P2, P5) nor PNG")
    try:
        with warnings.catch_warnings():  # of size: that is looked at here
            warnings.simplefilter("ignore")
            image: Any = Image.open(io.BytesIO(data), formats=("PPM", "PNG"))
            width, height = image.size
            if width * height > MOST_PIXELS or max(width, height) > MOST_SIDE:
                raise Image.DecompressionBombError(f"{width} x {height} pixels")
            image.load()
    except Image.DecompressionBombError as error:
        raise refused(
            path,
            f"{error}; at most {MOST_PIXELS:,} are read, {MOST_SIDE:,} a side; crop it or make its "
            "cells larger",
        ) from None
    except (OSError, ValueError, SyntaxError, EOFError, OverflowError) as error:
        reason = str(error)[:80]
        raise refused(path, f"cannot be decoded: {reason}; is it cut short or damaged?") from None
    clear = image.info.get("transparency")
    if image.mode == "P" or (clear is not None and not image.mode.startswith("I")):
        image = image.convert("RGBA")
    pixels = np.asarray(image.convert("L") if image.mode == "1" else image)
    full = np.float32(65535.0 if image.mode.startswith("I") else 255.0)
    unknown = pixels == clear if pixels.ndim == 2 else np.zeros(pixels.shape[:2], dtype=bool)
    if pixels.ndim == 3:
        if pixels.shape[2] in (2, 4):
            unknown = pixels[:, :, -1] < 0.5 * full
            pixels = pixels[:, :, :-1]
        pixels = pixels.mean(axis=2)
    return np.minimum(pixels.astype(np.float32) / full, np.float32(1.0)), unknown
