"""Where processor time goes: what stands behind the targets of RESULTS.md that are short.

Every few milliseconds of processor time the running Python function is noted; compiled code counts
for the function that calls it. A sample costs next to nothing; a profiler that counts calls makes
small functions look dear::

    python -m benchmarks.hotspots drive 10        # kinds of runners/physim_corridor.py, robots
    python -m benchmarks.hotspots record 10
    python -m benchmarks.hotspots video 10
    python -m benchmarks.hotspots physim validate RECORD    # a whole command, imports and all
"""

from __future__ import annotations

import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "benchmarks" / "runners")]

EVERY = 0.001
"""[s] of processor time between two samples, where the kernel's clock is as fine"""
LONG = 4.0
"""[s] of processor time that are sampled at least, but of a command"""
SHOWN = 24
"""Functions listed"""

Samples = Counter[tuple[str, str]]


@contextmanager
def sampled(samples: Samples) -> Iterator[None]:
    """Count (file, function) at every `EVERY` of processor time in the block."""

    def note(_signal: int, frame: FrameType | None) -> None:
        if frame is not None:
            samples[place(frame.f_code)] += 1

    before = signal.signal(signal.SIGPROF, note)
    signal.setitimer(signal.ITIMER_PROF, EVERY, EVERY)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def place(code: CodeType) -> tuple[str, str]:
    """File, below the project or its package, and function."""
    file = code.co_filename
    for start in (f"{ROOT}/", "/site-packages/", "/lib/python"):
        if start in file:
            file = file.rsplit(start, 1)[1]
    return file, code.co_qualname


def steps(kind: str, robots: int) -> tuple[Callable[[], Any], int]:
    """What to sample, and the steps in it: the corridor under a kind of controller."""
    import numpy as np
    from common import SPEED
    from physim_corridor import FORWARD, simulation

    running = simulation(kind, robots)
    forward = np.tile([SPEED, 0.0], (robots, 1)) if kind in FORWARD else None
    start, count = running.state, max(100, 40_000 // robots)

    def go() -> None:
        for k in range(count):
            if k % 1000 == 0:
                running.restore(start)
            running.step(forward)

    return go, count


def recorded(robots: int) -> tuple[Callable[[], Any], int]:
    """What to sample, and the steps in it: a run with its record on disk."""
    from common import STEP
    from physim_corridor import PAPER, corridor

    from physim import Simulation
    from physim.simulation.run import record_run

    count = max(400, 20_000 // robots)
    running = Simulation(corridor(robots, PAPER["free"], duration=count * STEP))
    start = running.state

    def go() -> None:
        running.restore(start)
        with tempfile.TemporaryDirectory() as folder:
            record_run(running, path=Path(folder) / "record.h5")

    return go, count


def filmed(robots: int) -> tuple[Callable[[], Any], int]:
    """What to sample, and the frames in it: the video of a corridor."""
    from physim_corridor import PAPER, corridor

    from physim import simulate
    from physim.drawing.video import render

    record = simulate(corridor(robots, PAPER["free"], duration=20.0))

    def go() -> None:
        with tempfile.TemporaryDirectory() as folder:
            render(record, Path(folder) / "video.mp4", speed=1.0)

    return go, 538


def command(arguments: list[str]) -> tuple[Callable[[], Any], int]:
    """What to sample, once: a command of physim in this process, nothing of it imported yet."""

    def go() -> None:
        from physim.cli import main

        main(arguments)

    return go, 1


def text(samples: Samples, spent: float, main: float, count: int) -> str:
    """The samples as a list: microseconds of processor time a step, frame or command."""
    total = max(samples.total(), 1)
    lines = [f"{1e6 * spent / count:,.1f} µs each, {1e6 * main / count:,.1f} of them in the main "
             f"thread; {total:,} samples"]  # fmt: skip
    for (file, function), hits in samples.most_common(SHOWN):
        lines.append(f"{1e6 * spent / count * hits / total:12,.1f} µs {hits / total:6.1%}  "
                     f"{file} {function}")  # fmt: skip
    return "\n".join(lines)


def main() -> None:
    """Sample what is asked for, once it is warm; a command is sampled cold."""
    kind, *rest = sys.argv[1:]
    if kind == "physim":
        go, count = command(rest)
    else:
        sorts = {"record": recorded, "video": filmed}
        robots = int(rest[0])
        go, count = sorts[kind](robots) if kind in sorts else steps(kind, robots)
        go()
    samples: Samples = Counter()
    cpu, thread = time.process_time(), time.thread_time()
    times = 0
    with sampled(samples):
        while not times or (kind != "physim" and time.process_time() - cpu < LONG):
            go()
            times += 1
    cpu, thread = time.process_time() - cpu, time.thread_time() - thread
    print(text(samples, cpu, thread, count * times), file=sys.stderr)


if __name__ == "__main__":
    main()
