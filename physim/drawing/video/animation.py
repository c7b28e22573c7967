"""A film for slides: GIF or WebP, which play by themselves again and again. Written by imageio.

Frames are kept packed until all are there: a GIF has one set of colours, chosen from all of the
film; a WebP has the same ones. The file is written under another name and gets its own when it is
complete.
"""

from __future__ import annotations

import io
import os
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import cv2
import numpy as np

from physim.drafts import discard, draft_of
from physim.drawing.palette import Colour
from physim.drawing.video.files import kind_of, size_at, unwritable
from physim.drawing.video.indexed import MOST, Indexer, chosen_colours
from physim.drawing.video.layout import Image
from physim.errors import PhysimError

MOST_PIXELS = 250_000_000
"""of all frames together: writing takes up to 5 bytes of memory for each"""
SAMPLES = 40
"""Frames from which the colours of a GIF are chosen."""
WEBP = {"lossless": True, "quality": 20, "method": 1}
"""Of 255 colours and without loss a drawing takes no more room than blurred at quality 80."""


class Animation:
    """Takes frames (720, 1280, 3) uint8 RGB; use in a ``with`` block.

    Leaving the block normally writes the file; leaving it by an error leaves none. Raises
    `physim.errors.PhysimError` for a place that cannot be written, and when the frames are more
    than a program could hold.
    """

    def __init__(self, path: Path | str, fps: float, width: int, kept: Sequence[Colour]) -> None:
        """``kept`` are colours that must not be lost, however few pixels have them."""
        self.path = Path(path).absolute()
        self._kind, self._suffix = kind_of(self.path), self.path.suffix.lower()
        self._part = draft_of(self.path)
        self._fps, self._size, self._kept = fps, size_at(width), kept
        self._frames: list[bytes] = []
        self._lasts: list[int] = []

    def __enter__(self) -> Animation:
        """See whether the file can be written."""
        try:
            self._part.touch()
        except OSError as fault:
            raise unwritable(self.path, fault) from fault
        return self

    def write(self, frame: Image) -> None:
        """Take one frame, which may be changed afterwards."""
        packed = zlib.compress(resized(frame, self._size).tobytes(), 1)
        if self._frames and packed == self._frames[-1]:
            self.hold()
            return
        self._frames.append(packed)
        self._lasts.append(1)

    def hold(self) -> None:
        """Take the last frame once more."""
        self._lasts[-1] += 1

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Write the file and give it its name, or leave nothing after an error."""
        try:
            if kind is None:
                self._part.write_bytes(self._packed())
                os.replace(self._part, self.path)
        except OSError as fault:
            raise unwritable(self.path, fault) from fault
        finally:
            discard(self._part)

    def _packed(self) -> bytes:
        """The file, made in memory: imageio tells errors of a disk by tracebacks of its own."""
        from imageio import v3 as imageio

        durations = self._durations()
        # of a single picture Pillow takes no list
        duration = durations if len(durations) > 1 else durations[0]
        how: dict[str, Any] = {"duration": duration, "loop": 0}
        step = -(-len(self._frames) // SAMPLES)
        colours = chosen_colours(self._unpacked(step), self._kept)
        pictures: Iterator[Image] = map(Indexer(colours), self._unpacked())
        if self._suffix == ".gif":
            table = np.zeros((MOST + 1, 3), np.uint8)
            table[: len(colours)] = colours
            how |= {"palette": table.tobytes(), "transparency": MOST, "optimize": True}
        else:
            pictures = (colours[numbers] for numbers in pictures)
            how |= WEBP
        file: Any
        with io.BytesIO() as made:
            with imageio.imopen(made, "w", plugin="pillow", extension=self._suffix) as file:
                for picture in pictures:
                    file.write(picture, is_batch=False, **how)
            return made.getvalue()

    def _unpacked(self, step: int = 1) -> Iterator[Image]:
        wide, high = self._size
        for packed in self._frames[::step]:
            yield np.frombuffer(zlib.decompress(packed), np.uint8).reshape(high, wide, 3)

    def _durations(self) -> list[int]:
        """How long each frame is seen [ms]: whole ticks, and together as long as the film."""
        tick = self._kind.tick
        ends = np.rint(np.cumsum([0, *self._lasts]) * (1000.0 / self._fps / tick)) * tick
        return [int(length) for length in np.diff(ends)]


def check_length(frames: int, width: int) -> None:
    """Raise PhysimError where a film has more frames than can be held."""
    wide, high = size_at(width)
    if frames * wide * high > MOST_PIXELS:
        raise PhysimError(
            f"{frames} frames of {wide} x {high}: too many for a GIF or WebP, which holds at most "
            f"{MOST_PIXELS // (wide * high)} of that size; --from and --to show less of the run, "
            "--speed, --fps and --width take fewer or smaller ones, and an .mp4 holds any number"
        )


def resized(frame: Image, size: tuple[int, int]) -> Image:
    """Return a picture of another ``size`` (width, height); the same one where it has it."""
    high, wide = frame.shape[:2]
    if (wide, high) == size:
        return frame
    return np.asarray(cv2.resize(frame, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)


def save_still(path: Path, image: Image) -> None:
    """Write a picture (h, w, 3) uint8 RGB as PNG, whole or not at all. Raises PhysimError."""
    from imageio import v3 as imageio

    part = draft_of(path.absolute())
    try:
        packed = imageio.imwrite(
            "<bytes>", image, plugin="pillow", extension=path.suffix.lower(), optimize=True
        )
        part.write_bytes(packed)
        os.replace(part, path)
    except OSError as fault:
        raise unwritable(path, fault) from fault
    finally:
        discard(part)
