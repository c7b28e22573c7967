"""Pixels of a map image: the header is checked before anything is decoded, and nothing is padded.

Decoders fill what a cut file lacks with black or grey; so a cut PGM or PNG is found here first.
"""

from __future__ import annotations

import re
import zlib
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from physim.importing.drawing import printable, refused
from physim.importing.source import MOST_IMAGE, read_bytes

MOST_PIXELS = 100_000_000
"""Pixels of an image that is decoded: 10 000 x 10 000."""

_PNG = b"\x89PNG\r\n\x1a\n"
_TOKEN = re.compile(rb"(?:\s|#[^\n\r]*[\n\r])*([^\s#]+)")


def read_image(path: Path) -> tuple[Any, Any]:
    """Brightness (rows, columns) from 0 to 1, top row first, and where it is transparent.

    Colours are averaged. Raises ImportSourceError for what is no image, too large or cut short.
    """
    data = read_bytes(path, MOST_IMAGE)
    top = 0.0
    if data[:2] in (b"P2", b"P5"):
        top = _check_pgm(path, data)
        data += b"\n"  # the decoder wants a space after the last number of a P2
    elif data.startswith(_PNG):
        _check_png(path, data)
    else:
        raise refused(path, "is neither PGM (P2, P5) nor PNG")
    level = cv2.utils.logging.getLogLevel()
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    try:
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        pixels = None
    finally:
        cv2.utils.logging.setLogLevel(level)
    if pixels is None or not pixels.size:
        raise refused(path, "cannot be decoded; the image is damaged")
    full = top if data[:2] == b"P5" or top > 255.0 else 255.0 * 257.0 ** (pixels.dtype.itemsize - 1)
    clear = np.zeros(pixels.shape[:2], dtype=bool)
    if pixels.ndim == 3:
        if pixels.shape[2] in (2, 4):
            clear = pixels[:, :, -1] < 0.5 * full
            pixels = pixels[:, :, :-1]
        pixels = pixels.mean(axis=2)
    return np.minimum(pixels.astype(np.float32) / np.float32(full), np.float32(1.0)), clear


def _check_size(path: Path, width: int, height: int) -> None:
    if width < 1 or height < 1:
        raise refused(path, f"an image of {width} x {height} pixels")
    if width * height > MOST_PIXELS:
        raise refused(
            path,
            f"an image of {width} x {height} pixels; at most {MOST_PIXELS:,} are read; crop it or "
            "make its cells larger".replace(",", " ", 2),
        )


def _check_pgm(path: Path, data: bytes) -> float:
    """Check header and length of a PGM; returns its brightest value."""
    numbers, at = [], 2
    for name in ("width", "height", "brightest value"):
        found = _TOKEN.match(data, at, at + 10_000)
        if found is None or not found[1].isdigit() or len(found[1]) > 9:
            given = printable(found[1][:20].decode("ascii", "replace")) if found else "nothing"
            raise refused(path, f'PGM header: {name} is "{given}"; a whole number is needed')
        numbers.append(int(found[1]))
        at = found.end()
    width, height, top = numbers
    _check_size(path, width, height)
    if not 0 < top < 65536:
        raise refused(path, f"PGM header: brightest value {top}; 1 to 65535 are allowed")
    if data[:2] == b"P5":
        there = max(len(data) - at - 1, 0) // (1 if top < 256 else 2)
    else:
        there = len(data[at:].split())
        if b"#" in data[at:]:
            there = len(re.sub(rb"#[^\n\r]*", b"", data[at:]).split())
    if there < width * height:
        raise refused(
            path, f"cut short: {there} of {width * height} pixels ({width} x {height}) are there"
        )
    return float(top)


def _check_png(path: Path, data: bytes) -> None:
    """Walk over the chunks of a PNG: sizes, check sums, and the end that a cut file lacks."""
    at, first = len(_PNG), True
    while True:
        if at + 12 > len(data):
            raise refused(path, f"cut short: the PNG ends after {len(data)} bytes without its end")
        size, kind = int.from_bytes(data[at : at + 4], "big"), data[at + 4 : at + 8]
        if at + 12 + size > len(data):
            raise refused(path, f"cut short: the PNG ends after {len(data)} bytes, within a part")
        body = data[at + 8 : at + 8 + size]
        if zlib.crc32(kind + body) != int.from_bytes(data[at + 8 + size : at + 12 + size], "big"):
            raise refused(path, f"damaged: the check sum of the PNG is wrong near byte {at}")
        if first:
            if kind != b"IHDR" or size != 13:
                raise refused(path, "damaged: the PNG does not begin with its header")
            _check_size(path, int.from_bytes(body[:4], "big"), int.from_bytes(body[4:8], "big"))
        if kind == b"IEND":
            return
        at, first = at + 12 + size, False
