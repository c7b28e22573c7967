"""Frames per second of the video: drawing alone, and drawing with encoding.

By processor time, of this process and the encoder, and by the wall clock; the still at the end of a
video is not counted. On the shipped world of ten robots and on a corridor with a thousand, or on
records given::

    python benchmarks/video.py [RECORD ...]
"""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import physim
from physim.drawing.timeline import Timeline
from physim.drawing.video.film import VideoFile
from physim.drawing.video.render import Painter, frame_times, playback_speed
from physim.record import Record

FPS = 25.0
STILL = 38
"""Frames at the end of a video that show its last moment."""
SPACING = 1.2
"""[m] between lanes, and between robots in a lane"""


def corridor(robots: int, segments: int = 200, seconds: float = 12.0) -> physim.World:
    """Robots in eight lanes of a straight corridor, drawn up with a little noise."""
    random = np.random.default_rng(0)
    lane, row = np.arange(robots) % 8, np.arange(robots) // 8
    x, y = 3.0 + SPACING * row, SPACING * (lane - 3.5)
    poses = np.column_stack((x, y, np.zeros(robots))) + random.normal(0.0, 0.05, (robots, 3))
    line = [[float(at), 0.0] for at in np.linspace(0.0, x.max() + 60.0, segments // 2 - 1)]
    return physim.World(
        name=f"corridor of {robots}",
        time={"step": 0.05, "duration": seconds},
        corridor={"centreline": line, "width": 10.0, "end_margin": 3.0},
        robots=[
            {
                "name": f"r{i + 1}",
                "footprint": {"length": 0.5, "width": 0.3},
                "pose": pose,
                "path": {"offset": float(offset)},
                "limits": {"v": 1.0, "omega": 1.6},
            }
            for i, (pose, offset) in enumerate(zip(poses.tolist(), y, strict=True))
        ],
        formation={"speed": 0.8, "limits": [0.64, 1.0], "spacing": "initial", "range": 10.0},
        controller={
            "type": "mode_switching", "look_ahead": 1.0, "distance_low": 0.15,
            "distance_high": 0.25, "time_low": 0.5, "time_high": 1.0, "boundary_low": 0.05,
            "safe_distance": 0.3, "longest_interval": 0.1,
        },
    )  # fmt: skip


def records(paths: list[str]) -> Iterator[Record]:
    if paths:
        yield from map(Record.load, paths)
    else:
        yield physim.simulate(physim.load_world("ten_robots"))
        yield physim.simulate(corridor(1000))


def spent() -> float:
    """Seconds of processor time of this process and of encoders that have ended."""
    used = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in used)


def rates(frames: int, work: Callable[[], None]) -> str:
    """Frames per second of processor time, and of the wall clock."""
    processor, wall = spent(), time.perf_counter()
    work()
    processor, wall = spent() - processor, time.perf_counter() - wall
    return f"{frames / processor:6.0f} frames/s of processor time, {frames / wall:6.0f} by the wall"


def measure(record: Record, folder: Path) -> None:
    timeline = Timeline(record)
    speed = playback_speed(timeline.duration)
    times = frame_times(0.0, timeline.duration, FPS, speed)[:-STILL].tolist()
    path = folder / "video.mp4"
    painter = Painter(timeline, speed, FPS)

    def draw() -> None:
        for moment in times:
            painter.paint(moment)

    def draw_and_encode() -> None:
        with VideoFile(path, FPS) as video:
            for moment in times:
                video.write(painter.paint(moment))

    segments = len(record.walls.part_start) - 1
    print(f"{record.name}: {record.robots} robots, {segments} wall segments, {len(times)} frames")
    print(f"  drawn:             {rates(len(times), draw)}")
    print(f"  drawn and encoded: {rates(len(times), draw_and_encode)}")
    print(f"  {path.stat().st_size / len(times) / 1e3:.1f} kB a frame", flush=True)


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        for record in records(sys.argv[1:]):
            measure(record, Path(name))


if __name__ == "__main__":
    main()
