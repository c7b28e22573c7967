"""Pages: how large they are, how long they take to write, and how many frames a second they show.

    python -m benchmarks.page [WORLD ...]

Each world is run (a thousand robots for 60 s at most), its page is opened in Chromium, and frames
are counted in the page while it plays. One line a world.
"""

from __future__ import annotations

import statistics
import sys
import tempfile
import time
from pathlib import Path

from physim.drawing.page import write_page
from physim.simulation.run import simulate
from physim.world.file import load_world
from physim.world.file.files import find_world
from tests.drawing.browser.driver import Seen, chromium

WORLDS = {"ten_robots": 1.5, "thousand_robots": 6.0}
"""[MB] that a page may take"""
LONGEST = 60.0
"""[s] that more than a hundred robots are simulated for"""
WATCHED = 8.0
"""[s] of the reader's time over which frames are counted"""


def main(names: list[str]) -> None:
    """Measure the pages of some worlds."""
    with tempfile.TemporaryDirectory() as folder, chromium() as browser:
        for name in names or list(WORLDS):
            print(measure(name, Path(folder), browser), flush=True)


def measure(name: str, folder: Path, browser: object) -> str:
    """Run a world, write its page, and watch it; one line."""
    world = load_world(find_world(name))
    if world.robot_count > 100:
        duration = min(world.time.duration, LONGEST)
        world = world.changed(time=world.time.model_copy(update={"duration": duration}))
    record = simulate(world, path=folder / f"{name}.h5")
    began = time.perf_counter()
    file = write_page([record], folder / f"{name}.html")
    written = time.perf_counter() - began
    line = f"{name}: {record.robots} robots, {record.steps_run * record.dt:g} s"
    record.close()
    seen = Seen(browser, file)
    if file.stat().st_size > 1e6 * WORLDS.get(name, float("inf")):
        raise SystemExit(f"{file.name} is {file.stat().st_size / 1e6:.2f} MB")
    told = [f"{line}, {file.stat().st_size / 1e6:.2f} MB, written in {written:.1f} s"]
    for look in ("robots", "whole"):
        seen.ask(f"(physim.look('{look}'), physim.player.setSpeed(1), physim.player.seek(5))")
        seen.ask("(physim.player.frames.length = physim.player.work.length = 0)")
        seen.ask("physim.player.play()")
        seen.page.wait_for_timeout(WATCHED * 1e3)
        frames, work = seen.ask(
            "(physim.player.pause(), [physim.player.frames, physim.player.work])"
        )
        rate = 1e3 / statistics.fmean(frames)
        told.append(f"{look}: {rate:.0f} frames/s, {statistics.median(work):.1f} ms to draw one")
    seen.close()
    return "; ".join(told)


if __name__ == "__main__":
    main(sys.argv[1:])
