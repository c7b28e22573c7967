"""Frames per second of the video: drawing alone, and drawing with encoding.

Ten robots, 200 wall segments, 330 simulated seconds, on the made-up record of the tests or on a
record given::

    python benchmarks/video.py [RECORD]
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from physim.drawing.timeline import Timeline
from physim.drawing.video import render
from physim.drawing.video.frames import Painter
from physim.drawing.video.render import frame_times, playback_speed
from physim.geometry.shapes import pack_shapes
from physim.record import Record

FPS = 25.0
SEGMENTS = 200


def made_up(folder: Path) -> Any:
    from tests.records import make_record

    record = make_record(folder / "record.h5", robots=10, seconds=330.0, dt=0.05)
    walls = record.walls
    ends = walls.vertices.reshape(-1, 2, 2)
    pieces = SEGMENTS // len(ends) + 1
    share = np.linspace(0.0, 1.0, pieces + 1)[:, None]
    cut = [a + (b - a) * share for a, b in ends]
    parts = [np.stack((line[:-1], line[1:]), axis=1) for line in cut]
    fields = "time dt steps pose clearance boundary_clearance updates contacts bodies names"
    fields += " footprints paths reference stop_station arrived modes accessible safe"
    fields += " safe_distance name seed robots world_text column"
    same = {field: getattr(record, field) for field in fields.split()}
    return SimpleNamespace(**same, walls=pack_shapes([list(part) for part in parts]))


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        record = Record.load(sys.argv[1]) if len(sys.argv) > 1 else made_up(folder)
        duration = float(record.time[-1])
        speed = playback_speed(duration)
        painter = Painter(Timeline(record), speed, FPS)
        times = frame_times(0.0, duration, FPS, speed)
        start = time.perf_counter()
        for moment in times:
            painter.frame(float(moment))
        drawn = len(times) / (time.perf_counter() - start)
        start = time.perf_counter()
        count = render(record, folder / "video.mp4", fps=FPS)
        both = count / (time.perf_counter() - start)
        size = (folder / "video.mp4").stat().st_size / 1e6
        print(f"{count} frames, {len(record.walls.part_start) - 1} wall segments, {size:.1f} MB")
        print(f"drawn:               {drawn:6.0f} frames/s")
        print(f"drawn and encoded:   {both:6.0f} frames/s")


if __name__ == "__main__":
    main()
