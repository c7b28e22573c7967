"""H.264 in an MP4 that browsers play: yuv420p, index at the front.

The encoder runs in this process, so a Ctrl-C in the terminal cannot end it before its time, and
in a thread of its own, so that drawing and encoding share the cores. The file is written under
another name in the same folder and gets its own name when complete.
"""

from __future__ import annotations

import os
import queue
import threading
from pathlib import Path
from types import TracebackType
from typing import Any

import av
import cv2
import numpy as np

from physim.errors import RecordError
from physim.video.layout import HEIGHT, WIDTH, Image

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
