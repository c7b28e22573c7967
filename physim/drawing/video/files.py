"""Which kind of film or still a path names, and files that are there whole or not at all."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from physim.drawing.video.layout import HEIGHT, WIDTH
from physim.errors import PhysimError, RecordError


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
        raise unwritable(path, fault) from fault
    if folder:
        raise RecordError(f"{path}: cannot write {what}: this is a folder; name a file in it")
    if not parent:
        raise RecordError(f"{path}: cannot write {what}: there is no folder {path.parent}")
    return suffix


def unwritable(path: Path, fault: BaseException) -> RecordError:
    """Say in one line why a film or a still cannot be written."""
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
    ticks = 1000.0 / kind.tick / fps if kind.tick > 1 else 1.0
    if abs(ticks - round(ticks)) > 1e-9:
        held = [whole for whole in range(1, int(MOST_FPS) + 1) if 1000 % (kind.tick * whole) == 0]
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
