"""Files of films and stills, there whole or not at all: MP4, GIF and WebP, PNG.

An MP4 is H.264 that browsers play, yuv420p, index at the front. ffmpeg, which comes with
imageio-ffmpeg, encodes it beside this process while the next frame is drawn. GIF and WebP are for
slides and play again and again; their frames are kept packed until all are there, as all have one
set of colours.
"""

from __future__ import annotations

import os
import queue
import re
import signal
import subprocess
import tempfile
import threading
import zlib
from collections.abc import Iterator, Sequence
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple, Self

import numpy as np
import PIL.Image
from imageio_ffmpeg import get_ffmpeg_exe

from physim.drawing.palette import Colour
from physim.drawing.video.canvas import HEIGHT, WIDTH, Image
from physim.errors import PhysimError, RecordError
from physim.files import discard, draft, draft_of


class Kind(NamedTuple):
    """A kind of film, and what it is made like where nothing else is asked for."""

    fps: float
    """frames a second of film"""
    longest: float
    """[s] length, without the hold at the end, above which the next playback speed is taken"""
    width: int
    """[px]"""
    tick: int = 0
    """[ms] of which each frame lasts a whole number; 0 where any rate can be held"""


SLIDES = 20.0
"""[s] Whoever speaks over a slide waits no longer for the film to begin anew."""
MP4 = Kind(25.0, 80.0, WIDTH)
KINDS = {
    ".mp4": MP4,
    ".m4v": MP4,
    ".gif": Kind(20.0, SLIDES, 800, tick=10),
    ".webp": Kind(25.0, SLIDES, 800, tick=1),
}
"""By suffix."""
STILL = ".png"
MOST_FPS = 50.0
"""of a film whose frames last whole ticks: programs that show it slow down shorter ones"""
MOST_PIXELS = 250_000_000
"""of all frames of a GIF or WebP: writing takes up to 5 bytes of memory for each"""

# Names


def kind_of(path: Path) -> Kind:
    """Return the kind of film that a path names. Raises RecordError where it names none."""
    return KINDS[_suffix(path, list(KINDS), "a video")]


def check_still(path: Path) -> None:
    """Raise RecordError where a path names no still."""
    _suffix(path, [STILL], "a still")


def named(path: Path, suffix: str) -> str:
    """Name of a file with another suffix; that of a folder such as ``.`` is none of a file."""
    return path.with_suffix(suffix).name if path.name.strip(".") else f"run{suffix}"


def _suffix(path: Path, allowed: Sequence[str], what: str) -> str:
    """Suffix of a path that can be written to. Raises RecordError."""
    suffix = path.suffix.lower()
    if suffix not in allowed:
        raise RecordError(
            f'{path}: cannot write {what} as "{path.suffix}"; allowed: {", ".join(allowed)}; '
            f'did you mean "{named(path, allowed[0])}"?'
        )
    try:
        folder, parent = path.is_dir(), path.parent.is_dir()
    except OSError as fault:  # for one, a name that is too long
        raise _unwritable(path, fault) from fault
    if folder:
        raise RecordError(f"{path}: cannot write {what}: this is a folder; name a file in it")
    if not parent:
        raise RecordError(f"{path}: cannot write {what}: there is no folder {path.parent}")
    return suffix


def _unwritable(path: Path, fault: BaseException) -> RecordError:
    reason = getattr(fault, "strerror", None) or str(fault) or type(fault).__name__
    return RecordError(f"{path}: cannot write it: {reason}")


def rate(kind: Kind, fps: float | None, name: str = "fps") -> float:
    """Frames a second, ``fps`` or those of the kind.

    Raises PhysimError, about what has a ``name``, where the kind cannot hold them.
    """
    if fps is None:
        return kind.fps
    most = MOST_FPS if kind.tick else 240.0
    if not 1.0 <= fps <= most:
        raise PhysimError(f"{name} {fps:g}: allowed: 1 to {most:g} frames a second")
    held = [k for k in range(1, int(MOST_FPS) + 1) if 1000 % (kind.tick * k or 1) == 0]
    if kind.tick > 1 and fps not in held:
        *some, last = map(str, held)
        near = min(held, key=lambda whole: abs(whole - fps))
        raise PhysimError(
            f"{name} {fps:g}: allowed in a GIF, whose frames last whole hundredths of a second: "
            f"{', '.join(some)} or {last}; the nearest is {near}"
        )
    return fps


def size_at(width: int) -> tuple[int, int]:
    """Return the width and height [px] of a picture made ``width`` wide, both even.

    Raises PhysimError for a width that is odd, or none between 160 and that of the drawing.
    """
    if not (160 <= width <= WIDTH and width % 2 == 0):
        raise PhysimError(f"width: {width} given; allowed: an even number from 160 to {WIDTH}")
    return width, 2 * round(width * HEIGHT / WIDTH / 2.0)


def check_length(frames: int, width: int) -> None:
    """Raise PhysimError where a GIF or WebP has more frames than can be held."""
    wide, high = size_at(width)
    if frames * wide * high > MOST_PIXELS:
        raise PhysimError(
            f"{frames} frames of {wide} x {high}: too many for a GIF or WebP, which holds at most "
            f"{MOST_PIXELS // (wide * high)} of that size; --from and --to show less of the run, "
            "--speed, --fps and --width take fewer or smaller ones, and an .mp4 holds any number"
        )


# Files


class Film:
    """Takes frames (720, 1280, 4) uint8, as a canvas has them; use in a ``with`` block.

    Leaving the block normally completes the file; leaving it by an error leaves none. Raises
    `physim.errors.PhysimError` for a place that cannot be written.
    """

    def __init__(self, path: Path | str, fps: float, width: int = WIDTH) -> None:
        self.path = Path(path).absolute()
        self._kind = kind_of(self.path)
        self._part = draft_of(self.path)
        self._fps, self._size = fps, size_at(width)

    def __enter__(self) -> Self:
        """Open the file."""
        try:
            self._part.touch()
            self._open()
        except (OSError, RuntimeError) as fault:  # the second where there is no ffmpeg
            discard(self._part)
            raise _unwritable(self.path, fault) from fault
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Complete the file and give it its name, or remove it after an error."""
        try:
            self._close(whole=kind is None)
            if kind is None:
                os.replace(self._part, self.path)
        except OSError as fault:
            if kind is None:
                raise _unwritable(self.path, fault) from fault
        finally:
            discard(self._part)

    def _open(self) -> None:
        """Begin the draft."""

    def _close(self, whole: bool) -> None:
        """End the draft, which is kept where it is ``whole``."""
        raise NotImplementedError


ENCODER = (
    "-c:v", "libx264", "-preset", "ultrafast", "-threads", "1",
    "-x264-params", "qp=25:bframes=3:b-adapt=0:weightb=0",
    "-pix_fmt", "yuv420p", "-colorspace", "bt470bg", "-color_range", "tv",
    "-color_primaries", "bt709", "-color_trc", "bt709", "-movflags", "+faststart", "-f", "mp4",
)  # fmt: skip
"""Drawings are flat and mostly move as a whole: to search them for what could be saved costs more
than it saves. More threads take more time of the processor in all."""


BUFFERS = 3
"""Frames of a film under way: one drawn, one waiting, one handed over"""


class VideoFile(Film):
    """A film as MP4."""

    def _open(self) -> None:
        wide, high = self._size
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the film
        source = "-f", "rawvideo", "-pix_fmt", "bgr24", "-s", f"{wide}x{high}"
        rate = "-r", str(Fraction(self._fps).limit_denominator(1001))
        options = "-v", "error", "-y", *source, *rate, "-i", "-", *ENCODER
        # A Ctrl-C in the terminal must not end it before its time: it is in a session of its own,
        # and deaf until it is there, as is the one that is asked for its version when it is found.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
        try:
            self._encoder = subprocess.Popen(
                [get_ffmpeg_exe(), *options, f"file:{self._part}"], stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL, stderr=self._errors, start_new_session=True,
                pipesize=1 << 18,
            )  # fmt: skip
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        self._free: queue.SimpleQueue[Image] = queue.SimpleQueue()
        self._full: queue.SimpleQueue[Image | None] = queue.SimpleQueue()
        for _ in range(BUFFERS):
            self._free.put(np.empty((high, wide, 3), np.uint8))
        self._feeder = threading.Thread(target=self._feed, daemon=True)
        self._feeder.start()

    def _feed(self) -> None:
        """Hand frames to the encoder while the next one is drawn."""
        assert self._encoder.stdin is not None
        while (frame := self._full.get()) is not None:
            with suppress(OSError):  # it has ended, as the next frame or the end finds out
                self._encoder.stdin.write(frame.data)
            self._free.put(frame)

    def write(self, frame: Image) -> None:
        """Take one frame, which may be changed afterwards. Raises what the encoder met."""
        if frame.shape[1::-1] != self._size:
            frame = np.asarray(resized(picture_of(frame), self._size))
        self._last = self._free.get()
        for k in range(3):  # ffmpeg converts blue, green, red in half the time of other orders
            self._last[..., 2 - k] = frame[..., k]
        self._take(self._last)

    def hold(self) -> None:
        """Take the last frame once more. Raises what the encoder met."""
        again = self._free.get()
        again[:] = self._last
        self._take(again)

    def _take(self, frame: Image) -> None:
        if self._encoder.poll() is not None:
            raise self._fault()
        self._full.put(frame)

    def _close(self, whole: bool) -> None:
        try:
            if not whole:
                self._encoder.kill()
            self._full.put(None)
            self._feeder.join()
            if whole:
                self._encoder.communicate()
                if self._encoder.returncode:
                    raise self._fault()
        finally:
            self._encoder.kill()
            self._encoder.communicate()
            self._errors.close()

    def _fault(self) -> PhysimError:
        """What the encoder, which has ended, said last."""
        self._errors.seek(0)
        said = self._errors.read().decode(errors="replace").strip().splitlines()
        reason = f" ended with code {self._encoder.returncode}"
        if said:  # without the part of ffmpeg that says it
            reason = ": " + re.sub(r"^\[.*?\] ", "", said[-1])
        return RecordError(f"{self.path}: cannot write it: ffmpeg{reason}")


SAMPLES = 40
"""Frames from which the colours of an animation are chosen."""
COLOURS = 255
"""of an animation; one more says that a pixel stays as it was"""
APART = 8
"""Levels from a colour that is kept within which no other is taken."""
PLAIN = PIL.Image.Dither.NONE
GIF: dict[str, Any] = {"transparency": COLOURS, "optimize": True}
WEBP: dict[str, Any] = {"lossless": True, "quality": 20, "method": 1}
"""Of 255 colours and without loss a drawing takes no more room than blurred at quality 80."""


class Animation(Film):
    """A film as GIF or WebP."""

    def __init__(self, path: Path | str, fps: float, width: int, kept: Sequence[Colour]) -> None:
        """``kept`` are colours that must not be lost, however few pixels have them."""
        super().__init__(path, fps, width)
        self._kept = kept
        self._packed: list[bytes] = []
        self._lasts: list[int] = []

    def write(self, frame: Image) -> None:
        """Take one frame, which may be changed afterwards."""
        packed = zlib.compress(resized(picture_of(frame), self._size).tobytes("raw", "RGB"), 1)
        if self._packed and packed == self._packed[-1]:
            self.hold()
            return
        self._packed.append(packed)
        self._lasts.append(1)

    def hold(self) -> None:
        """Take the last frame once more."""
        self._lasts[-1] += 1

    def _close(self, whole: bool) -> None:
        if not whole:
            return
        tick = self._kind.tick  # all frames together last as long as the film
        ends = np.rint(np.cumsum([0, *self._lasts]) * (1000.0 / self._fps / tick)) * tick
        lasts = np.diff(ends).astype(int).tolist()
        step = -(-len(self._packed) // SAMPLES)
        table = Table(np.concatenate(list(self._frames(step))), self._kept)
        pictures: Iterator[PIL.Image.Image] = map(table.indexed, self._frames())
        how = GIF
        if self.path.suffix.lower() == ".webp":
            pictures, how = (picture.convert("RGB") for picture in pictures), WEBP
        next(pictures).save(
            self._part, self.path.suffix[1:], save_all=True, append_images=pictures, loop=0,
            duration=lasts if len(lasts) > 1 else lasts[0], **how,
        )  # fmt: skip

    def _frames(self, step: int = 1) -> Iterator[Image]:
        wide, high = self._size
        for packed in self._packed[::step]:
            yield np.frombuffer(zlib.decompress(packed), np.uint8).reshape(high, wide, 3)


class Table:
    """The colours of an animation: those that say something, and of blended edges the usual ones.

    What counts in a drawing is rare: the colour of a contact, of a sign in the legend. Methods that
    choose colours by how many pixels have them lose these, so they are given, and kept.
    """

    def __init__(self, samples: Image, kept: Sequence[Colour]) -> None:
        """``samples`` (h, w, 3) show what the frames do."""
        own = np.unique(np.array(kept, np.uint8), axis=0)
        usual = PIL.Image.fromarray(samples).quantize(COLOURS, PIL.Image.Quantize.MAXCOVERAGE)
        others = np.array(usual.getpalette(), np.uint8).reshape(-1, 3)
        apart = np.abs(others[:, None].astype(int) - own).max(axis=2).min(axis=1)
        colours = np.concatenate((own, others[apart > APART]))[:COLOURS]
        rest = np.repeat(own[:1], COLOURS + 1 - len(colours), axis=0)
        self._palette = PIL.Image.new("P", (1, 1))
        self._palette.putpalette(np.concatenate((colours, rest)).tobytes())
        self._mistaken: list[tuple[int, Image]] = []  # Pillow looks colours up in steps of 4
        found = np.asarray(self.indexed(own[None]))[0].tolist()
        self._mistaken = [(k, own[k]) for k, number in enumerate(found) if k != number]

    def indexed(self, frame: Image) -> PIL.Image.Image:
        """Return a frame (h, w, 3) in these colours, each pixel in the nearest."""
        picture = PIL.Image.fromarray(frame).quantize(palette=self._palette, dither=PLAIN)
        for k, colour in self._mistaken:
            mask = (frame == colour).all(axis=2)
            picture.paste(k, mask=PIL.Image.fromarray(mask))
        return picture


# Stills


def picture_of(frame: Image) -> PIL.Image.Image:
    """Return a frame (h, w, 4) as a picture, which shows what it holds now or later."""
    high, wide = frame.shape[:2]
    return PIL.Image.frombuffer("RGBX", (wide, high), frame, "raw", "RGBX", 0, 1)


def rgb_of(frame: Image) -> Image:
    """Return a copy (h, w, 3) of a frame (h, w, 4)."""
    return np.ascontiguousarray(frame[..., :3])


def resized(picture: PIL.Image.Image, size: tuple[int, int]) -> PIL.Image.Image:
    """Return a picture of another ``size`` (width, height); the same one where it has it."""
    return picture if picture.size == size else picture.resize(size, PIL.Image.Resampling.BOX)


def save_still(path: Path, image: Image) -> None:
    """Write a picture (h, w, 3) uint8 RGB as PNG, whole or not at all. Raises PhysimError."""
    try:
        with draft(path.absolute()) as part:
            PIL.Image.fromarray(image).save(part, "png", optimize=True)
    except OSError as fault:
        raise _unwritable(path, fault) from fault
