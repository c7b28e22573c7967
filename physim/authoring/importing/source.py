"""What is read from disk: which kind of source a file is, its text, and the pixels of an image.

Size and encoding are checked before a file is read, the header of an image before anything is
decoded. Decoders fill what a cut file lacks with black or grey; so a cut PGM or PNG is found
here first.
"""

from __future__ import annotations

import os
import re
import stat
import zlib
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from physim.authoring.importing.drawing import refused
from physim.escaping import escaped

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


DECLARATION = re.compile(r"\s*<\?xml\s[^>]{0,200}\?>")
ENCODING = re.compile(r"\bencoding\s*=\s*[\"']([^\"'>]*)[\"']")
ENTITY = re.compile(r"&(?!(?:amp|lt|gt|quot|apos);)[A-Za-z_][\w.-]*;")
DOCTYPE = "<!DOCTYPE"
KIND = re.compile(DOCTYPE + r"[^>\[]*\[[^\]]*")
"""A document type, up to the end of what it declares"""
PARAMETER = re.compile(r"%[A-Za-z_][\w.-]*;")


def read_xml(path: Path) -> str:
    """Text of an XML file, without its declaration, in whose encoding it has been checked to be.

    Raises ImportSourceError where it declares another than UTF-8 and it matters.
    """
    text = read_text(path)
    if DOCTYPE in text and "<!ENTITY" not in text:
        _check_entities(path, text)
    declaration = DECLARATION.match(text)
    found = ENCODING.search(declaration[0]) if declaration is not None else None
    if declaration is None or found is None:
        return text
    try:
        same = found[1].lower() in ("utf-8", "utf8") or (
            text.isascii() and text.encode("ascii").decode(found[1]) == text
        )
    except (LookupError, ValueError):
        same = False
    if not same:
        message = f'declares the encoding "{escaped(found[1])[:40]}"; save the file as UTF-8'
        raise refused(path, message, 1)
    return "\n" * declaration[0].count("\n") + text[declaration.end() :].lstrip(" ")


def _check_entities(path: Path, text: str) -> None:
    """Refuse entities that are declared elsewhere: a parser may pass over them."""
    bare = without_comments(text)
    kind = KIND.match(bare, bare.find(DOCTYPE))
    found = PARAMETER.search(bare, kind.start(), kind.end()) if kind is not None else None
    found = found or ENTITY.search(bare)
    if found is not None:
        line = bare.count("\n", 0, found.start()) + 1
        raise refused(path, f"has the XML entity {escaped(found[0])[:40]}; save it without", line)


def without_comments(text: str) -> str:
    """An XML text with the line ends of its comments alone."""
    first, *others = text.split("<!--")
    parts = [first]
    for one in others:
        comment, _, rest = one.partition("-->")
        parts += ["\n" * comment.count("\n"), rest]
    return "".join(parts)


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
    if re.match(r"(<\?xml[^>]*>)?\s*(<!DOCTYPE[^>]*>)?\s*<(\w+:)?svg\b", without_comments(start)):
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


MOST_PIXELS = 50_000_000
"""Pixels of an image that is decoded, about 7000 x 7000: up to 18 bytes each are needed."""

MOST_SIDE = 1_000_000
"""Pixels of a side: OpenCV decodes a little more of a PGM, libpng none of a PNG."""

STDERR = 2
"""Descriptor of standard error."""
_PNG = b"\x89PNG\r\n\x1a\n"
_TOKEN = re.compile(rb"(?:\s|#[^\n\r]*[\n\r])*([^\s#]+)")


def read_image(path: Path) -> tuple[Any, Any]:
    """Brightness (rows, columns) from 0 to 1, top row first, and where it is transparent.

    Colours are averaged. Raises ImportSourceError for what is no image, too large or cut short.
    """
    data = read_bytes(path, MOST_IMAGE)
    top, unknown = 0.0, None
    if data[:2] in (b"P2", b"P5"):
        top = _check_pgm(path, data)
        data += b"\n"  # the decoder wants a space after the last number of a P2
    elif data.startswith(_PNG):
        unknown = _check_png(path, data)
    else:
        raise refused(path, "is neither PGM (P2, P5) nor PNG")
    with _silent_decoder():
        try:
            pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
        except cv2.error:
            pixels = None
    if pixels is None or not pixels.size:
        raise refused(path, "cannot be decoded; the image is damaged")
    full = top if data[:2] == b"P5" or top > 255.0 else 255.0 * 257.0 ** (pixels.dtype.itemsize - 1)
    clear = np.zeros(pixels.shape[:2], dtype=bool)
    if pixels.ndim == 2 and unknown is not None:
        clear = pixels == unknown
    elif pixels.ndim == 3:
        if pixels.shape[2] in (2, 4):
            clear = pixels[:, :, -1] < 0.5 * full
            pixels = pixels[:, :, :-1]
        pixels = pixels.mean(axis=2)
    return np.minimum(pixels.astype(np.float32) / np.float32(full), np.float32(1.0)), clear


@contextmanager
def _silent_decoder() -> Iterator[None]:
    """Keep decoders from writing: OpenCV to its log, libpng to standard error itself."""
    level = cv2.utils.logging.getLogLevel()
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    with ExitStack() as undone:
        undone.callback(cv2.utils.logging.setLogLevel, level)
        with suppress(OSError):  # standard error is closed: nothing to keep quiet
            kept = os.dup(STDERR)
            undone.callback(os.close, kept)
            undone.callback(os.dup2, kept, STDERR)
            nowhere = os.open(os.devnull, os.O_WRONLY)
            undone.callback(os.close, nowhere)
            os.dup2(nowhere, STDERR)
        yield


def _check_size(path: Path, width: int, height: int) -> None:
    if width < 1 or height < 1:
        raise refused(path, f"an image of {width} x {height} pixels")
    if max(width, height) > MOST_SIDE:
        raise refused(
            path,
            f"an image of {width} x {height} pixels; at most {MOST_SIDE} a side are read; crop it",
        )
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
            given = escaped(found[1][:20].decode("ascii", "replace")) if found else "nothing"
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
        if len(data) > MOST_TEXT:
            raise refused(
                path,
                f"{len(data) / 1e6:.1f} MB of pixels as text (P2); at most {MOST_TEXT / 1e6:.0f} "
                "MB; save it as P5",
            )
        there = len(data[at:].split())
        if b"#" in data[at:]:
            there = len(re.sub(rb"#[^\n\r]*", b"", data[at:]).split())
    if there < width * height:
        raise refused(
            path, f"cut short: {there} of {width * height} pixels ({width} x {height}) are there"
        )
    return float(top)


def _check_png(path: Path, data: bytes) -> float | None:
    """Walk over the chunks of a PNG: sizes, check sums, and the end that a cut file lacks.

    Returns the brightness of a grey image's cells that are transparent, which OpenCV takes for any
    other, scaled as it scales them; None where there are none.
    """
    at, first = len(_PNG), True
    bits, colours, clear = 8, 0, None
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
            bits, colours = body[8], body[9]
        if kind == b"tRNS" and not colours and size == 2 and clear is None:
            grey = int.from_bytes(body, "big") % 2**bits
            clear = grey * (255.0 / (2**bits - 1) if bits < 8 else 1.0)
        if kind == b"IEND":
            return clear
        at, first = at + 12 + size, False
