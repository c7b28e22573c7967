"""What avoidance does: every shipped world as it is, and beside it with avoidance switched off.

python -m benchmarks.avoidance [WORLD ...] [--seeds A:B] [--jobs N] [--check | --write]

Prints a table: contact-free and finished with avoidance and without, the share of decisions by (12)
and (13), distances, and what contacts there are. ``--write`` puts it into docs/reference/worlds.md;
``--check`` compares it with the one that stands there, and holds the worlds that claim to show
avoidance to their claim: contacts without it in at least half of their seeds, none with it in at
least 95 %. Exit codes: 0 fine, 1 a claim or the table does not hold, 2 bad input, 130 interrupted.
"""

from __future__ import annotations

import argparse
import math
import os
import re
import statistics
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

import physim
from physim.analysis import metrics
from physim.campaigns.pool import Job, do_all
from physim.cli.options import seed_range
from physim.contacts import Phase
from physim.errors import PhysimError
from physim.record import Record
from physim.reproduction.measures import figures
from physim.reproduction.model import Arm
from physim.reproduction.run import run
from physim.reproduction.study import rule_shares
from physim.world.file.files import shipped_worlds
from physim.world.layout.scene_builder import is_random

SHOWS_AVOIDANCE = ("ten_robots", "crowded_start", "three_robots", "nonconvex", "random_road")
"""Worlds whose descriptions claim that avoidance is at work in them."""
WITHOUT = "controller.avoidance=none"
CONTACTS_WITHOUT, FREE_WITH = 0.5, 0.95
"""[-] What such a world must reach: shares of its seeds"""
README = Path(__file__).parents[1] / "docs/reference/worlds.md"
BEGIN, END = "<!-- avoidance -->\n", "<!-- end of avoidance -->"
HEADER = (
    "| world | seeds | contact-free, with and without | finished, with and without "
    "| decisions by (12), (13) | shortest distance with | without avoidance: deepest contact, "
    "time in contact |\n|---|---|---|---|---|---|---|\n"
)

Figures = Mapping[str, float]


def measure(record: Record) -> Figures:
    """Outcome of one run, from its record alone."""
    rows, found = record.contacts, metrics.Figures(record)
    touching = np.unique(rows["step"][rows["phase"] != Phase.ENDED])
    return {
        "contacts": float(len(found.episodes) + len(found.grazes)),
        "finished": float(record.ended == "finished"),
        **rule_shares(record),
        "depth": float(rows["depth"].max()) if len(rows) else 0.0,
        "in_contact": len(touching) * record.dt,
        **figures(record, "shortest_distance"),
    }


def table(names: Sequence[str], seeds: tuple[int, int], jobs: int) -> dict[str, str]:
    """Rows by world. Raises PhysimError for a world that cannot be run."""
    work = {}
    for name in names:
        world = physim.load_world(name)
        drawn = range(*seeds) if is_random(world) else [world.seed]
        for arm in (Arm("with", name), Arm("without", name, (WITHOUT,))):
            for seed in drawn:
                given = (arm, seed, (measure,))
                work[name, arm.label, seed] = Job(f"{name} seed {seed}", run, given)
    found = do_all(work.items(), jobs, lambda: False, progress)
    rows = {}
    for name in names:
        arms = [
            [found[key].measures[measure.__name__] for key in work if key[:2] == (name, label)]
            for label in ("with", "without")
        ]
        rows[name] = row(name, *arms)
        print(rows[name], flush=True)
    return rows


def row(name: str, shown: Sequence[Figures], bare: Sequence[Figures]) -> str:
    """One line of the table."""
    seeds = "nothing random" if len(shown) == 1 else str(len(shown))

    def count(runs: Sequence[Figures], fine: str) -> int:
        return sum(r["contacts"] == 0.0 if fine == "free" else r["finished"] > 0.0 for r in runs)

    by = [100.0 * statistics.mean(r[key] for r in shown) for key in ("by_distance", "by_time")]
    touched = [r for r in bare if r["contacts"]]
    without = "none"
    if touched:
        deepest = max(1e3 * r["depth"] for r in touched)
        lasts = statistics.median(r["in_contact"] for r in touched)
        without = f"{deepest:.1f} mm, {lasts:.1f} s"
    cells = (
        f"`{name}`",
        seeds,
        f"{count(shown, 'free')}, {count(bare, 'free')}",
        f"{count(shown, 'finished')}, {count(bare, 'finished')}",
        f"{by[0]:.2f} %, {by[1]:.1f} %",
        spread([r["shortest_distance"] for r in shown]),
        without,
    )
    return "| " + " | ".join(cells) + " |"


def spread(values: Sequence[float]) -> str:
    """Median and least of the runs' shortest distances."""
    known = [value for value in values if math.isfinite(value)]
    if not known:
        return "none"
    return f"{statistics.median(known):.2f} m ({min(known):.2f} m)"


def broken_claims(rows: Mapping[str, str]) -> list[str]:
    """What worlds claim and do not hold, one line each."""
    lines = []
    for name in SHOWS_AVOIDANCE:
        if name not in rows:
            continue
        seeds, free, bare = (int(n) for n in _counts(rows[name]))
        if free < FREE_WITH * seeds:
            lines.append(f"{name}: {free} of {seeds} contact-free; {FREE_WITH:.0%} are claimed")
        if seeds - bare < CONTACTS_WITHOUT * seeds:
            lines.append(f"{name}: without avoidance {bare} of {seeds} are contact-free, too")
    return lines


def _counts(line: str) -> tuple[str, str, str]:
    found = re.match(r"\| `\w+` \| (\d+) \| (\d+), (\d+) \|", line)
    if found is None:
        raise PhysimError(f"no seeds and counts in: {line}")
    return found.group(1), found.group(2), found.group(3)


def written(text: str) -> dict[str, str]:
    """Rows by world of the table in docs/reference/worlds.md."""
    lines = text.split(BEGIN)[1].split(END)[0].splitlines()
    return {line.split("`")[1]: line for line in lines if line.startswith("| `")}


def progress(done: int, of: int, note: str) -> None:
    """One line on the terminal; nothing in a pipe."""
    if sys.stderr.isatty():
        print(f"\r{done} of {of}, {note:40.40}", end="", file=sys.stderr)


def main() -> int:
    """Run the program; returns the exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.avoidance", description=__doc__.splitlines()[0]
    )
    parser.add_argument("worlds", nargs="*", metavar="WORLD", help="shipped worlds (all)")
    parser.add_argument("--seeds", type=seed_range, default=(0, 100), metavar="A:B")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--check", action="store_true", help="against docs/reference/worlds.md")
    what.add_argument("--write", action="store_true", help="into docs/reference/worlds.md")
    options = parser.parse_args()
    names = options.worlds or list(shipped_worlds())
    text = README.read_text(encoding="utf-8")
    try:
        rows = table(names, options.seeds, options.jobs)
    except PhysimError as error:
        print(error, file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    wrong = broken_claims(rows)
    if options.write:
        rows = {**written(text), **rows}
        lines = "".join(f"{rows[name]}\n" for name in shipped_worlds() if name in rows)
        before, after = text.split(BEGIN)[0], text.split(END)[1]
        README.write_text(f"{before}{BEGIN}{HEADER}{lines}{END}{after}", encoding="utf-8")
    if options.check:
        known = written(text)
        wrong += [
            f"docs/reference/worlds.md: {known.get(n)}\nmeasured: {r}"
            for n, r in rows.items()
            if known.get(n) != r
        ]
    for line in wrong:
        print(line, file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
