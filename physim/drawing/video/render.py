"""A record as a video, or as stills. Shows simulated time only: same record, same frames."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from physim.drawing import palette
from physim.drawing.palette import rgb
from physim.drawing.timeline import Timeline
from physim.drawing.video.canvas import VIEW, WIDTH, Box, Image
from physim.drawing.video.film import (
    MP4,
    Animation,
    VideoFile,
    check_length,
    check_still,
    kind_of,
    rate,
    resized,
    save_still,
    size_at,
)
from physim.drawing.video.ground import ground
from physim.drawing.video.painter import Beside, Painter
from physim.drawing.video.view import View
from physim.errors import PhysimError
from physim.geometry.shapes import FloatArray

if TYPE_CHECKING:
    from physim.record import Record

TILE = (560, 298)
"""[px] width and height of a close-up: shown at this size or somewhat less, names can be read"""
FPS = 25.0
"""of a still, in which labels are where they begin in a film"""
SPEEDS = (1, 2, 4, 5, 8)
"""Playback speeds of the first decade; the others are these times a power of ten."""
MOST_KEPT = 40
"""Colours of modes that a GIF is sure to have."""
HOLD = 1.5
"""[s of video] that the last picture stays, so that the end can be read"""


def playback_speed(duration: float, longest: float = MP4.longest) -> float:
    """Return simulated seconds per second of video: 1, 2, 4, 5, 8, 10, 20 …

    With it ``duration`` [s] takes at most ``longest`` [s of video].
    """
    speeds = (speed * 10.0**power for power in itertools.count() for speed in SPEEDS)
    return next(speed for speed in speeds if duration <= longest * speed * (1.0 + 1e-9))


def frame_times(start: float, end: float, fps: float, speed: float) -> FloatArray:
    """Return the simulated times of all frames (F,) [s].

    From ``start`` to ``end`` [s] inclusive; then the end again for `HOLD` seconds of video.
    """
    last = int(np.ceil((end - start) * fps / speed - 1e-6))
    frames = last + 1 + round(HOLD * fps)
    times: FloatArray = np.minimum(start + np.arange(frames) * (speed / fps), end)
    return times


def render(
    record: Record,
    path: Path | str,
    *,
    beside: Record | None = None,
    start: float = 0.0,
    end: float = math.inf,
    fps: float | None = None,
    speed: float | None = None,
    width: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    stop: Callable[[], bool] | None = None,
    cut_short: Path | str | None = None,
) -> int:
    """Write the video of a record and return the number of frames in it.

    With ``beside`` the two runs go on side by side, the second on the right, until both are over;
    titles say in what their worlds differ. ``start`` and ``end`` [s of simulated time] are those
    of the film; an end after that of the run is the run's.

    The suffix says what is made: H.264 in MP4 (yuv420p, 25 frames a second), GIF (20) or WebP
    (25), which play again and again, or what ``fps`` asks for. ``width`` is 1280 px, of GIF and
    WebP 800, or less. ``speed`` is simulated seconds per second of video; by default the least of
    1, 2, 4, 5, 8, 10, 20 … with which the film lasts at most 80 s (GIF, WebP: 20 s); then the
    last picture stays for 1.5 s, and so many more frames are counted. ``progress(done, total)`` is
    called after each frame. ``stop()`` is asked after each frame; once True, the file is
    completed with the frames so far, and named ``cut_short`` if that is given.

    The file appears under its name only when it is complete. Raises
    `physim.errors.PhysimError` (one line) when it cannot be written or nothing can be shown.
    """
    kind = kind_of(Path(path))
    fps, width = rate(kind, fps), kind.width if width is None else width
    size_at(width)
    timelines = _timelines(record, beside)
    end = min(end, _duration(timelines))
    if not 0.0 <= start < end and (start, end) != (0.0, 0.0):
        raise PhysimError(
            f"from {start:g} s to {end:g} s: nothing to show; allowed: a start of at least 0 s and "
            "before the end, which is at most that of the run"
        )
    speed = _speed(speed, end - start, kind.longest)
    times = frame_times(start, end, fps, speed)
    film: VideoFile | Animation
    if kind.tick:
        check_length(len(np.unique(times)), width)
        film = Animation(path, fps, width, _kept(timelines))
    else:
        film = VideoFile(path, fps, width)
    painter = _painter(timelines, speed, fps)
    done, drawn = 0, math.nan
    with film:
        for time in times.tolist():
            if time != drawn:
                drawn = time
                film.write(painter.paint(time))
            else:
                film.hold()
            done += 1
            if progress is not None:
                progress(done, len(times))
            if stop is not None and done < len(times) and stop():
                if cut_short is not None:
                    film.path = Path(cut_short).absolute()
                break
    return done


def frame_at(
    record: Record,
    time: float,
    *,
    beside: Record | None = None,
    fps: float = FPS,
    speed: float | None = None,
) -> Image:
    """Return the picture (720, 1280, 3) uint8 RGB of a record at ``time`` [s].

    It equals the video's frame of that time but for the places of names, which glide in a video;
    ``beside`` as for `render`. A time outside the record is taken to its nearer end. Raises
    `physim.errors.PhysimError`.
    """
    if not math.isfinite(time):
        raise PhysimError(f"time of a still: {time} given; allowed: a finite number of seconds")
    timelines = _timelines(record, beside)
    duration = _duration(timelines)
    painter = _painter(timelines, _speed(speed, duration, MP4.longest), rate(MP4, fps))
    return painter.paint(min(max(float(time), 0.0), duration))


def close_up(record: Record, time: float, between: tuple[int, int] | None = None) -> Image:
    """Return a small picture (298, 560, 3) uint8 RGB of the robots at ``time`` [s], for a tile.

    With ``between`` it is about a robot and another body (ids), whose distance is marked.
    """
    timeline = Timeline(record)
    box = Box(0, 0, *TILE) if between is None else VIEW
    speed = _speed(None, timeline.duration, MP4.longest)
    view, now = View(timeline, ground(timeline), box, speed, FPS), timeline.at(time)
    view.between = between
    image = np.empty((box.height, box.width, 3), np.uint8)
    marked = view.paint(image, now)
    middle = box.size / 2.0
    if between is not None and marked is not None:
        middle = view.camera.lens(now.time).pixels(marked.points).mean(axis=0)
    left, top = np.clip(middle - np.array(TILE) / 2.0, 0.0, box.size - TILE).astype(int).tolist()
    return np.ascontiguousarray(Box(left, top, *TILE).of(image))


def still(
    record: Record,
    path: Path | str,
    time: float,
    *,
    beside: Record | None = None,
    speed: float | None = None,
    width: int | None = None,
) -> None:
    """Write the picture of a record at ``time`` [s] as PNG; the others as for `render`.

    Raises `physim.errors.PhysimError` (one line) for a time outside the run and for a place that
    cannot be written.
    """
    check_still(Path(path))
    size, over = size_at(width or WIDTH), _duration(_timelines(record, beside))
    if not 0.0 <= time <= over + 1e-9:
        raise PhysimError(f"{time:g} s is outside the run, which goes from 0 to {over:g} s")
    image = frame_at(record, time, beside=beside, speed=speed)
    save_still(Path(path), resized(image, size))


def _timelines(record: Record, beside: Record | None) -> list[Timeline]:
    return [Timeline(one) for one in (record, beside) if one is not None]


def _duration(timelines: list[Timeline]) -> float:
    return max(timeline.duration for timeline in timelines)


def _speed(speed: float | None, duration: float, longest: float) -> float:
    """Return the playback speed for ``duration`` [s] of a run; refuses one that cannot be."""
    if speed is not None and not (math.isfinite(speed) and 1e-3 <= speed <= 1e6):
        raise PhysimError(f"playback speed: {speed} given; allowed: 0.001 to 1000000")
    return playback_speed(duration, longest) if speed is None else float(speed)


def _painter(timelines: list[Timeline], speed: float, fps: float) -> Painter | Beside:
    if len(timelines) == 2:
        return Beside(timelines[0], timelines[1], speed, fps)
    return Painter(timelines[0], speed, fps)


def _kept(timelines: list[Timeline]) -> list[palette.Colour]:
    """Colours that say something: of areas, contacts, modes and robots."""
    modes = [rgb(mode.colour) for one in timelines for mode in one.scene.modes]
    return [*palette.KEYS.values(), *modes[:MOST_KEPT], *palette.ROBOTS]
