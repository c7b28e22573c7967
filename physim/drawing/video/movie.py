"""A film of pictures: H.264 in an MP4 that browsers play, yuv420p, index at the front.

The encoder runs in this process, so a Ctrl-C in the terminal cannot end it before its time, and in
a thread of its own, so that drawing and encoding share the cores. The file is written under another
name in the same folder and gets its own name when complete.
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

from physim.drafts import discard, draft_of
from physim.drawing.video.animation import resized
from physim.drawing.video.files import kind_of, size_at, unwritable
from physim.drawing.video.layout import WIDTH, Image

OPTIONS = {"preset": "ultrafast", "x264-params": "qp=25:bframes=3:b-adapt=0:weightb=0"}
"""Drawings are flat and mostly move as a whole: to search them for what could be saved costs more
than it saves. As near to the drawing (45.5 dB for ten robots, 44.4 dB for a thousand) as "veryfast"
at crf 20 with subme=1 and bframes=1, for half the work and files 1.4 times as large."""
THREADS = 1
"""of the encoder; more take more time of the processor in all"""
LIMITED, BT601, BT709 = 1, 5, 1
"""Numbers of H.264 (ITU-T H.273) for range, matrix, and primaries and transfer."""
WAITING = 4
"""Frames drawn ahead of the encoder."""
HOLD = "the last frame again"


class Planes:
    """A frame as the encoder takes it; its memory is used again and again."""

    def __init__(self, size: tuple[int, int]) -> None:
        wide, high = size
        self._memory: Image = np.empty((high * 3 // 2, wide), np.uint8)
        self._planes: list[Image] = []
        if high % 4 == 0:
            self.frame: Any = av.VideoFrame.from_numpy_buffer(self._memory, "yuv420p")
            return
        # other heights PyAV divides wrongly into planes
        self.frame = av.VideoFrame(*size, "yuv420p")
        self._planes = [
            np.frombuffer(memoryview(plane), np.uint8).reshape(-1, plane.line_size)[
                :, : plane.width
            ]
            for plane in self.frame.planes
        ]

    def fill(self, frame: Image) -> None:
        """Convert a frame (h, w, 3) RGB, where possible right into what the encoder reads."""
        cv2.cvtColor(frame, cv2.COLOR_RGB2YUV_I420, self._memory)
        flat, first = self._memory.reshape(-1), 0
        for plane in self._planes:
            plane[:] = flat[first : first + plane.size].reshape(plane.shape)
            first += plane.size


class VideoFile:
    """Writes frames (720, 1280, 3) uint8 RGB; use in a ``with`` block.

    Leaving the block normally completes the file; leaving it by an error removes it. Raises
    `physim.errors.RecordError` for a suffix other than .mp4 and for a place that cannot be
    written.
    """

    def __init__(self, path: Path | str, fps: float, width: int = WIDTH) -> None:
        self.path = Path(path).absolute()
        kind_of(self.path)
        self._part = draft_of(self.path)
        self._size = size_at(width)
        self._fps = fps
        self._frames: queue.Queue[Planes | str | None] = queue.Queue(WAITING)
        self._free: queue.SimpleQueue[Planes] = queue.SimpleQueue()
        for _ in range(WAITING):
            self._free.put(Planes(self._size))
        self._fault: BaseException | None = None
        self._count = 0
        self._thread = threading.Thread(target=self._work, name="video encoder", daemon=True)

    def __enter__(self) -> VideoFile:
        """Open the file."""
        try:
            self._part.touch()
            self._open()
        except (OSError, av.FFmpegError) as fault:
            discard(self._part)
            raise unwritable(self.path, fault) from fault
        self._thread.start()
        return self

    def _open(self) -> None:
        from fractions import Fraction

        options = {"movflags": "+faststart"}
        self._file: Any = av.open(f"file:{self._part}", "w", format="mp4", options=options)
        rate = Fraction(self._fps).limit_denominator(1001)
        self._stream: Any = self._file.add_stream("libx264", rate=rate, options=dict(OPTIONS))
        self._stream.width, self._stream.height = self._size
        self._stream.pix_fmt = "yuv420p"
        context = self._stream.codec_context
        context.thread_count = THREADS
        # OpenCV's conversion (2.5 times as fast as swscale's) is that of BT.601, limited range;
        # the file says so, and players follow it.
        context.color_range, context.colorspace = LIMITED, BT601
        context.color_primaries = context.color_trc = BT709

    def write(self, frame: Image) -> None:
        """Take one frame, which may be changed afterwards. Raises what the encoder met."""
        self._check()
        planes = self._free.get()
        planes.fill(resized(frame, self._size))
        self._frames.put(planes)

    def hold(self) -> None:
        """Take the last frame once more. Raises what the encoder met."""
        self._check()
        self._frames.put(HOLD)

    def _check(self) -> None:
        if self._fault is not None:
            raise unwritable(self.path, self._fault) from self._fault

    def _work(self) -> None:
        """Encode what comes; a frame is free again when the next has come."""
        last: Planes | None = None
        while (given := self._frames.get()) is not None:
            if isinstance(given, Planes):
                if last is not None:
                    self._free.put(last)
                last = given
            if last is not None and self._fault is None:
                try:
                    self._encode(last)
                except BaseException as fault:
                    self._fault = fault

    def _encode(self, planes: Planes) -> None:
        planes.frame.pts = self._count
        self._count += 1
        for packet in self._stream.encode(planes.frame):
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
            discard(self._part)
        if kind is None and self._fault is not None:
            raise unwritable(self.path, self._fault) from self._fault
