"""A record as a video, or as stills. Shows simulated time only: same record, same frames.

H.264 in an MP4 that browsers play: yuv420p, index at the front. The encoder runs in this
process, so a Ctrl-C in the terminal cannot end it before its time, and in a thread of its
own, so that drawing and encoding share the cores. The file is written under another name in
the same folder and gets its own name when complete.
"""

from __future__ import annotations

import itertools
import math
import os
import queue
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import av
import cv2
import numpy as np

from physim.drawing.timeline import Timeline
from physim.drawing.video.frames import Beside, Painter
from physim.drawing.video.layout import HEIGHT, WIDTH, Image
from physim.errors import PhysimError, RecordError
from physim.geometry.shapes import FloatArray

if TYPE_CHECKING:
    from physim.record import Record


SUFFIXES = (".mp4", ".m4v")
OPTIONS = {"preset": "veryfast", "crf": "20", "x264-params": "subme=1:bframes=1"}
"""Two settings quicker than the preset: two fifths less work for files a fifth larger."""
LIMITED, BT601, BT709 = 1, 5, 1
"""Numbers of H.264 (ITU-T H.273) for range, matrix, and primaries and transfer."""
WAITING = 6
"""Frames drawn ahead of the encoder."""


class VideoFile:
    """Writes frames (720, 1280, 3) uint8 RGB; use in a ``with`` block.

    Leaving the block normally completes the file; leaving it by an error removes it. Raises
    `physim.errors.RecordError` for a suffix other than .mp4 and for a place that cannot be
    written.
    """

    def __init__(self, path: Path | str, fps: float) -> None:
        self.path = Path(path).absolute()
        check_path(self.path)
        self._part = self.path.with_name(f".video-{os.getpid()}-{threading.get_ident()}.part")
        self._fps = fps
        self._frames: queue.Queue[Image | None] = queue.Queue(WAITING)
        self._fault: BaseException | None = None
        self._count = 0
        self._thread = threading.Thread(target=self._work, name="video encoder", daemon=True)

    def __enter__(self) -> VideoFile:
        """Open the file."""
        try:
            self._part.touch()
            self._open()
        except (OSError, av.FFmpegError) as fault:
            self._part.unlink(missing_ok=True)
            raise unwritable(self.path, fault) from fault
        self._thread.start()
        return self

    def _open(self) -> None:
        from fractions import Fraction

        options = {"movflags": "+faststart"}
        self._file: Any = av.open(f"file:{self._part}", "w", format="mp4", options=options)
        rate = Fraction(self._fps).limit_denominator(1001)
        self._stream: Any = self._file.add_stream("libx264", rate=rate, options=dict(OPTIONS))
        self._stream.width, self._stream.height = WIDTH, HEIGHT
        self._stream.pix_fmt = "yuv420p"
        context = self._stream.codec_context
        # OpenCV's conversion (2.5 times as fast as swscale's) is that of BT.601, limited range;
        # the file says so, and players follow it.
        context.color_range, context.colorspace = LIMITED, BT601
        context.color_primaries = context.color_trc = BT709

    def write(self, frame: Image) -> None:
        """Take one frame; it must not be changed afterwards. Raises what the encoder met."""
        if self._fault is not None:
            raise unwritable(self.path, self._fault) from self._fault
        self._frames.put(frame)

    def _work(self) -> None:
        while (frame := self._frames.get()) is not None:
            if self._fault is None:
                try:
                    self._encode(frame)
                except BaseException as fault:
                    self._fault = fault

    def _encode(self, frame: Image) -> None:
        planes = cv2.cvtColor(frame, cv2.COLOR_RGB2YUV_I420).astype(np.uint8, copy=False)
        picture = av.VideoFrame.from_ndarray(planes, format="yuv420p")
        picture.pts = self._count
        self._count += 1
        for packet in self._stream.encode(picture):
            self._file.mux(packet)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Complete the file and give it its name, or remove it after an error."""
        self._frames.put(None)
        self._thread.join()
        try:
            if kind is None and self._fault is None:
                for packet in self._stream.encode(None):
                    self._file.mux(packet)
            self._file.close()
            if kind is None and self._fault is None:
                os.replace(self._part, self.path)
        except (OSError, av.FFmpegError) as fault:
            self._fault = self._fault or fault
        finally:
            self._part.unlink(missing_ok=True)
        if kind is None and self._fault is not None:
            raise unwritable(self.path, self._fault) from self._fault


def check_path(path: Path) -> None:
    """Refuse a path that no video can be written to."""
    if path.suffix.lower() not in SUFFIXES:
        raise RecordError(
            f'{path}: cannot write a video as "{path.suffix}"; allowed: {", ".join(SUFFIXES)}; '
            f'did you mean "{path.with_suffix(".mp4").name}"?'
        )
    try:
        folder, parent = path.is_dir(), path.parent.is_dir()
    except OSError as fault:  # for one, a name that is too long
        raise unwritable(path, fault) from fault
    if folder:
        raise RecordError(f"{path}: cannot write the video: this is a folder; name a file in it")
    if not parent:
        raise RecordError(f"{path}: cannot write the video: there is no folder {path.parent}")


def unwritable(path: Path, fault: BaseException) -> RecordError:
    """Say in one line why a video cannot be written."""
    reason = getattr(fault, "strerror", None) or str(fault) or type(fault).__name__
    return RecordError(f"{path}: cannot write the video: {reason}")


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
        drawn, picture = math.nan, None
        for time in times.tolist():
            if picture is None or time != drawn:
                drawn, picture = time, painter.frame(time)
            video.write(picture)
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
