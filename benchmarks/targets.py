"""What physim is to reach by itself: measured, target, met or short."""

from __future__ import annotations

import statistics
import sys
from collections.abc import Iterator, Sequence

from benchmarks.first import SUBJECT as FIRST
from benchmarks.measuring import Job, Store, cell, ratio, runner, spread, table
from benchmarks.speed import CONTESTS
from benchmarks.speed import SUBJECT as SPEED
from benchmarks.trial import own

SUBJECT = "targets"
RECORDED = {10: 1200, 100: 1200, 1000: 300, 5000: 60}
"""Steps with a record on disk."""
SIZES = (10, 100, 1000)
RECORDS = {
    "rate": "with a record on disk : without",
    "lasting": "the same but for beginning and ending the record",
}
LEAST_WITH_RECORD, MOST_BY_DISTANCE, MOST_BY_WALLS = 0.6, 1.3, 1.3
PLAIN = {10: 60e3, 100: 40e3, 1000: 40e3}
"""Robot-steps/s of a plain controller, on the day and machine of the targets."""
PACKED = 250e3
"""The same of a packed jam of 1,000."""
WORLD = (1000, 2000)
"""Robots and wall segments of a world that is read, checked and built."""
FAR = (10, 10_000)
"""Segments out of sight."""
LEAST, MOST = "≥", "≤"


def groups(quick: bool) -> list[list[Job]]:
    """What belongs together in a list each."""
    seconds = 0.1 if quick else 0.35
    sizes = SIZES[:2] if quick else SIZES

    def one(what: str, robots: int, kind: str, **walls: int) -> Job:
        return own(SUBJECT, what, robots, kind, seconds, **walls)

    found = [[one(kind, n, kind) for kind in ("default", "short")] for n in sizes]
    found += [[one(kind, n, kind) for kind in ("long", "free")] for n in sizes]
    found += [[one("plain", n, "plain")] for n in sizes]
    return [*found, [one(f"far_{far}", 100, "free", far=far) for far in FAR]]


def long_ones(quick: bool) -> list[Job]:
    """What takes long, and is done more than once within its process."""
    sizes = SIZES[:2] if quick else RECORDED
    found = [] if quick else [own(SUBJECT, "jam", 1000, "jam", 0.35)]
    for robots in sizes:
        steps = RECORDED[robots] // (4 if quick else 1)
        found.append(_physim(f"record-{robots}", what="record", robots=robots, steps=steps))
    found.append(_physim("world", what="world", robots=WORLD[0], segments=WORLD[1]))
    found.append(_physim("run", what="run", world="ten_robots"))
    return found


def _physim(name: str, **task: object) -> Job:
    return runner(SUBJECT, "physim", name, sys.executable, "run_physim.py", 300.0, **task)


def text(store: Store) -> str:
    """The table."""
    rows = [
        *_ratios(store), *_rates(store), *_seconds(store), *_videos(store), *_ahead(store),
    ]  # fmt: skip
    head = ["", "N", "measured", "target", ""]
    return f"## Targets\n\n{INTRODUCTION}{table(head, rows)}\n"


INTRODUCTION = """\
Ratios hold on any machine; the other targets are of another day and machine. Seconds and frames are
of processor time.

"""
Row = list[str]


def _row(words: str, robots: int, shown: str, found: float | None, sign: str, aim: float,
         unit: str = "") -> Row:  # fmt: skip
    """One row; ``found`` is held against ``aim``."""
    if found is None:
        verdict = "not measured"
    else:
        verdict = "met" if (found >= aim if sign == LEAST else found <= aim) else "short"
    number = f"{aim / 1e3:g} k" if aim >= 1e3 else f"{aim:.3g}"
    return [words, f"{robots:,}", shown, f"{sign} {number}{unit}", verdict]


def _ratios(store: Store) -> Iterator[Row]:
    """What is held against physim itself."""
    for n in RECORDED:
        if store.results(SUBJECT, "physim", f"record-{n}"):
            for key, words in RECORDS.items():
                pair = [store.values(SUBJECT, "physim", f"record-{n}", one)
                        for one in (key, "without")]  # fmt: skip
                yield _beside(words, n, pair, LEAST_WITH_RECORD, store, f"record-{n}")
    distances = (
        ("default", "short", "default settings, L 1 m : 0.3 m"),
        ("long", "free", "thresholds of the free flow, L 1 m : 0.3 m"),
    )
    for one, other, words in distances:
        for n in SIZES:
            if store.results(SUBJECT, "physim", f"{one}-{n}"):
                pair = [store.values(SUBJECT, "physim", f"{kind}-{n}") for kind in (one, other)]
                yield _beside(f"{words}{_danger(store, one, other, n)}", n, pair,
                              1.0 / MOST_BY_DISTANCE, store, f"{one}-{n}")  # fmt: skip
    if store.results(SUBJECT, "physim", f"far_{FAR[1]}-100"):
        pair = [store.values(SUBJECT, "physim", f"far_{far}-100") for far in FAR[::-1]]
        yield _beside("free flow, 10,000 segments out of range : 10", 100, pair,
                      1.0 / MOST_BY_WALLS, store, f"far_{FAR[1]}-100")  # fmt: skip


def _beside(words: str, robots: int, pair: Sequence[list[float]], target: float, store: Store,
            what: str) -> Row:  # fmt: skip
    found = ratio(*pair)
    shown = store.why_not(SUBJECT, "physim", what) or "–"
    if found is not None:
        shown = f"**{found:.2f}**: {spread(pair[0])} : {spread(pair[1])}"
    return _row(words, robots, shown, found, LEAST, target)


def _danger(store: Store, one: str, other: str, robots: int) -> str:
    """Shares of decisions in danger mode with the one and with the other."""
    shares = [store.values(SUBJECT, "physim", f"{kind}-{robots}", "danger")
              for kind in (one, other)]  # fmt: skip
    if not all(shares):
        return ""
    first, second = (100.0 * statistics.median(each) for each in shares)
    return f" ({first:.0f} and {second:.0f} % of the decisions in danger mode)"


def _rates(store: Store) -> Iterator[Row]:
    """Rates that were set as such."""
    aims = [("plain", "a controller of one's own, robot-steps/s", n, aim)
            for n, aim in PLAIN.items()]  # fmt: skip
    for what, words, n, aim in [*aims, ("jam", "jam, packed, robot-steps/s", 1000, PACKED)]:
        name = f"{what}-{n}"
        if store.results(SUBJECT, "physim", name):
            shown = cell(store, SUBJECT, "physim", name)
            found = _middle(store.values(SUBJECT, "physim", name))
            yield _row(words, n, shown, found, LEAST, aim)


def _seconds(store: Store) -> Iterator[Row]:
    """Seconds at most."""
    limits = (
        (SUBJECT, "world", "built", "world of 2,000 segments read and built", WORLD[0], 2.0),
        (SUBJECT, "world", "checked", "the same read and checked", WORLD[0], 2.0),
        (SUBJECT, "run", "cpu", "`ten_robots` simulated, with record", 10, 0.7),
        (FIRST, "command-1", "cpu", "the same, whole command", 10, 2.0),
        (FIRST, "validate", "cpu", "`validate` of it, whole command", 10, 1.55),
    )
    for subject, what, key, words, robots, limit in limits:
        if store.results(subject, "physim", what):
            values = store.values(subject, "physim", what, key)
            found = _middle(values)
            shown = store.why_not(subject, "physim", what) or "–"
            if values:
                shown = f"{found:.2f} s ({min(values):.2f}–{max(values):.2f})"
            yield _row(words, robots, shown, found, MOST, limit, " s")


def _videos(store: Store) -> Iterator[Row]:
    for what, robots, aim in (("video", 10, 250.0), ("video-1000", 1000, 60.0)):
        if store.results(FIRST, "physim", what):
            found = _middle(store.values(FIRST, "physim", what))
            shown = "–" if found is None else f"{found:.0f}"
            shown = store.why_not(FIRST, "physim", what) or shown
            yield _row("video at 1280 × 720, frames/s", robots, shown, found, LEAST, aim)


def _ahead(store: Store) -> Iterator[Row]:
    """Ahead of which peers: navground's controllers from 100 robots on, IR-SIM everywhere."""
    for contest, (words, _, rivals) in CONTESTS.items():
        for name, how, label in rivals:
            for n in (1, *SIZES):
                if name == "irsim" or (how in ("HL", "ORCA") and name == "navground" and n >= 100):
                    what = f"{contest}-{n}"
                    theirs = store.values(SPEED, f"{name}-{how}", what)
                    found = ratio(store.values(SPEED, "physim", what), theirs)
                    if found is not None:
                        yield _row(f"physim : {label}; {words}", n, f"**{found:.2f}**", found,
                                   LEAST, 1.0)  # fmt: skip


def _middle(values: Sequence[float]) -> float | None:
    return statistics.median(values) if values else None
