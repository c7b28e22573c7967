"""A record as a video, or as stills. Shows simulated time only: same record, same frames."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from physim.drawing.timeline import Timeline
from physim.drawing.video.frames import Beside, Painter
from physim.drawing.video.layout import Image
from physim.drawing.video.movie import VideoFile, check_path
from physim.errors import PhysimError
from physim.geometry.shapes import FloatArray

if TYPE_CHECKING:
    from physim.record import Record


FPS = 25.0

SPEEDS = (1, 2, 4, 5, 8)
"""Playback speeds of the first decade; the others are these times a power of ten."""
LONGEST = 80.0
"""[s] length of a video, without the hold, above which the next playback speed is taken"""
HOLD = 1.5
"""[s of video] that the last picture stays, so that the end can be read"""


def playback_speed(duration: float) -> float:
    """Return simulated seconds per second of video: 1, 2, 4, 5, 8, 10, 20 …"""
    speeds = (speed * 10.0**power for power in itertools.count() for speed in SPEEDS)
    return next(speed for speed in speeds if duration <= LONGEST * speed * (1.0 + 1e-9))


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
    fps: float = FPS,
    speed: float | None = None,
    progress: Callable[[int, int], None] | None = None,
    stop: Callable[[], bool] | None = None,
    cut_short: Path | str | None = None,
) -> int:
    """Write the video of a record and return the number of frames in it.

    With ``beside`` the two runs go on side by side, the second on the right, until both are over;
    titles say in what their worlds differ. ``start`` and ``end`` [s of simulated time] are those
    of the film; an end after that of the run is the run's.

    H.264 in MP4, 1280 x 720, yuv420p, ``fps`` frames per second of video. ``speed`` is simulated
    seconds per second of video; by default the least of 1, 2, 4, 5, 8, 10, 20 … with which the
    film lasts at most 80 s; then the last picture stays for 1.5 s, and so many more frames are
    counted. ``progress(done, total)`` is called after each frame. ``stop()`` is
    asked after each frame; once True, the file is completed with the frames so far, and named
    ``cut_short`` if that is given.

    The file appears under its name only when it is complete. Raises
    `physim.errors.PhysimError` (one line) when it cannot be written or nothing can be shown.
    """
    check_path(Path(path))
    timelines = _timelines(record, beside)
    end = min(end, _duration(timelines))
    if not 0.0 <= start < end and (start, end) != (0.0, 0.0):
        raise PhysimError(
            f"from {start:g} s to {end:g} s: nothing to show; allowed: a start of at least 0 s and "
            "before the end, which is at most that of the run"
        )
    painter, chosen = _painter(timelines, fps, speed, end - start)
    times = frame_times(start, end, fps, chosen)
    done = 0
    with VideoFile(path, fps) as video:
        drawn = math.nan
        for time in times.tolist():
            if time != drawn:
                drawn = time
                video.write(painter.paint(time))
            else:
                video.hold()
            done += 1
            if progress is not None:
                progress(done, len(times))
            if stop is not None and done < len(times) and stop():
                if cut_short is not None:
                    video.path = Path(cut_short).absolute()
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
    painter, _ = _painter(timelines, fps, speed, duration)
    return painter.frame(min(max(float(time), 0.0), duration))


def _timelines(record: Record, beside: Record | None) -> list[Timeline]:
    """Of one run, or of two."""
    return [Timeline(one) for one in (record, beside) if one is not None]


def _duration(timelines: Sequence[Timeline]) -> float:
    """[s] of the longer run."""
    return max(timeline.duration for timeline in timelines)


def _painter(
    timelines: Sequence[Timeline], fps: float, speed: float | None, duration: float
) -> tuple[Painter | Beside, float]:
    """What draws the frames, and the playback speed; refuses what was given.

    ``duration`` [s] is what is shown.
    """
    if not (math.isfinite(fps) and 1.0 <= fps <= 240.0):
        raise PhysimError(f"fps: {fps} given; allowed: 1 to 240 frames per second")
    if speed is not None and not (math.isfinite(speed) and 1e-3 <= speed <= 1e6):
        raise PhysimError(f"playback speed: {speed} given; allowed: 0.001 to 1000000")
    chosen = playback_speed(duration) if speed is None else float(speed)
    if len(timelines) == 2:
        return Beside(timelines[0], timelines[1], chosen, fps), chosen
    return Painter(timelines[0], chosen, fps), chosen
