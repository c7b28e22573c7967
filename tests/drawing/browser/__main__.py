"""Look at a page as a reader would: ``python -m tests.drawing.browser PAGE --offline``.

It is opened from disk, played to its end, scrubbed, and asked why. Exit code 0: all of that works,
nothing was asked for outside of the page, and there is nothing on the console; 1: something is
wrong, told in a line each. With ``--offline`` the network is cut, too. Times of frames are printed.
"""

from __future__ import annotations

import argparse
import statistics
import sys
from collections.abc import Iterator
from pathlib import Path

from tests.drawing.browser.driver import Seen, chromium

SECONDS = 4.0
"""[s] that playing takes"""
SCRUBS = 7


def main() -> int:
    """Look at one page."""
    parser = argparse.ArgumentParser(prog="python -m tests.drawing.browser", description=__doc__)
    parser.add_argument("page", type=Path)
    parser.add_argument("--offline", action="store_true", help="cut the network")
    given = parser.parse_args()
    if not given.page.is_file():
        parser.error(f"{given.page}: no such file")
    with chromium() as browser:
        seen = Seen(browser, given.page, offline=given.offline)
        faults = list(look(seen)) or [f"console: {one}" for one in seen.faults]
        faults += [f"asked for {url}" for url in seen.outside()]
        seen.close()
    for fault in faults:
        print(fault)
    return 1 if faults else 0


def look(seen: Seen, seconds: float = SECONDS) -> Iterator[str]:
    """Play for so many seconds, scrub and ask; what is wrong, a line each."""
    if seen.ask("window.physim === undefined"):
        yield seen.text("#state")
        return
    duration = seen.ask("physim.duration")
    seen.ask(f"(physim.player.setSpeed({max(duration, 1e-3) / seconds}), physim.player.play())")
    seen.until("!physim.player.playing")
    if seen.ask("physim.player.time") != duration:
        yield "it does not play to the end"
    frames, work = seen.ask("[physim.player.frames, physim.player.work]")
    if frames:
        print(
            f"{len(frames)} frames, {statistics.median(frames):.1f} ms apart (median), "
            f"{statistics.median(work):.1f} ms to draw one"
        )
    for k in range(SCRUBS):
        time = duration * k / (SCRUBS - 1)
        drawn = seen.drawn_at(time)
        if abs(drawn["time"] - min(time, seen.ask("physim.view.run.duration"))) > 1e-6:
            yield f"scrubbed to {time} s it shows {drawn['time']} s"
        if not all(isinstance(value, int | float) for value in drawn["pose"]):
            yield f"at {time} s there are robots without a place"
    yield from _ask_why(seen, duration / 2)


def _ask_why(seen: Seen, time: float) -> Iterator[str]:
    """Click the first robot that is seen."""
    drawn = seen.drawn_at(time)
    lens, (wide, high) = drawn["lens"], drawn["size"]
    names = seen.ask("physim.view.run.names")
    poses = [drawn["pose"][k : k + 3] for k in range(0, len(drawn["pose"]), 3)]
    for x, y, _ in poses:
        at = x * lens["scale"] + lens["x"], lens["y"] - y * lens["scale"]
        if 20 < at[0] < wide - 20 and 20 < at[1] < high - 20:
            seen.page.locator(".view canvas").first.click(position={"x": at[0], "y": at[1]})
            seen.settle()
            told = seen.text("#why h2")
            if not any(name in told for name in names):
                yield f"a click on a robot tells {told!r}"
            return
    yield "no robot is in view"


if __name__ == "__main__":
    sys.exit(main())
