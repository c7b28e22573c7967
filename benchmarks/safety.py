"""How safe every shipped world is with every shipped controller: rates from campaigns, as a page.

python -m benchmarks.safety DIR [DIR ...] [--write]

Reads folders of `physim sweep` and prints docs/explanation/safety.md, or writes it with
``--write``; the commands that fill the folders stand at the head of the page. Exit codes:
0 fine, 2 bad input.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import physim
from physim.campaigns.folder import read
from physim.campaigns.outcomes import Cell, Outcomes
from physim.campaigns.report.contents import report_of
from physim.errors import PhysimError
from physim.statistics import clopper_pearson
from physim.units import interval
from physim.world.file.files import find_world
from physim.world.layout.scene_builder import is_random

PAGE = Path(__file__).parents[1] / "docs/explanation/safety.md"
MANY = "hundred_robots", "thousand_robots"
"""Worlds that get few seeds."""
SEEDS, FEW = "0:23", "0:2"
CONTROLLERS = "mode_switching,path_following,constant"

TEXT = """\
# How safe the shipped worlds are

Rates of {runs:,} runs: every shipped world with every shipped controller, its own settings
otherwise, the starts drawn by the seed. A run is contact-free when no robot touched another or a
wall, neither at a sample nor [between two](contacts.md#contacts-between-samples);
[intervals](intervals.md) are exact, for the number of runs fixed beforehand. In worlds without
anything random there is one run, and no rate.

- `mode_switching` is the controller of [the paper](paper.md).
- `path_following` is its first part alone, without formation control and avoidance.
- `constant` gives one command for ever, here none: the robots stand, so nothing touches, and
  nothing finishes.

Starts are drawn as each world says; [look for worse ones](../how-to/worst-case.md). {most} runs
without a contact show a rate within {bound}, no more. `jam` is in contact on purpose.

{table}
`least` is the least distance of two robots, or of a robot and a wall, in any run [m], below 0 in a
contact. `in contact` counts runs in which robots touched each other, and walls, and in which bodies
touched between two samples.

Made with {versions}, from these campaigns:

<!-- not run: takes hours -->
```sh
{commands}
physim report safety --no-pictures
```
"""
HEADER = """\
| world | controller | runs | contact-free | 95 % interval | finished | least | in contact |
|---|---|---|---|---|---|---|---|
"""


def commands(worlds: Sequence[str]) -> str:
    """What fills the folders."""
    some = " ".join(world for world in worlds if world not in MANY)
    few = " ".join(world for world in worlds if world in MANY)
    return (
        f"physim sweep {some} \\\n  --seeds {SEEDS} --controller {CONTROLLERS} -o safety\n"
        f"physim sweep {few} \\\n  --seeds {FEW} --controller {CONTROLLERS} -o safety-many"
    )


def page(folders: Sequence[Path]) -> str:
    """The whole page, from folders of campaigns."""
    lines, versions, runs, most = {}, {}, 0, 0
    for folder in folders:
        report = report_of(Outcomes(read(folder)), str(folder))
        runs += len(report.outcomes)
        versions |= dict.fromkeys(report.versions())
        for cell in report.cells:
            free, finished = cell.rates[1:]
            at, least = cell.cell, cell.spreads["least_distance"].least
            most = max(most, at.count)
            drawn = is_random(physim.load_world(find_world(at.world)))
            sure = interval(free.low, free.high) if drawn else "nothing is random"
            lines[at.world, at.controller] = (
                f"| `{at.world}` | {at.controller} | {at.count} | {free.good} | {sure} "
                f"| {finished.good} | {least:.3f} m "
                f"| {touching(report.outcomes, at)} |\n"
            )
    worlds = sorted({world for world, _ in lines})
    order = {name: k for k, name in enumerate(CONTROLLERS.split(","))}
    table = "".join(lines[key] for key in sorted(lines, key=lambda key: (key[0], order[key[1]])))
    return TEXT.format(
        runs=runs, commands=commands(worlds), table=HEADER + table, versions=", ".join(versions),
        most=most, bound=interval(*map(float, clopper_pearson(most, most))),
    )  # fmt: skip


def touching(outcomes: Outcomes, cell: Cell) -> str:
    """In how many runs robots touched each other, and walls, and how many failed."""
    columns = {
        name: outcomes.column(name)[cell.rows]
        for name in ("contacts_between_robots", "contacts_with_boundaries", "grazes")
    }
    counts = {
        "robots": np.count_nonzero(columns["contacts_between_robots"] > 0),
        "walls": np.count_nonzero(columns["contacts_with_boundaries"] > 0),
        "between samples": np.count_nonzero(columns["grazes"] > 0),
        "failed": np.count_nonzero(outcomes.failed[cell.rows]),
    }
    return ", ".join(f"{what} {count}" for what, count in counts.items() if count) or "-"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", type=Path, metavar="DIR")
    parser.add_argument("--write", action="store_true", help=f"write docs/{PAGE.name}")
    options = parser.parse_args()
    try:
        text = page(options.folders)
    except PhysimError as error:
        print(f"safety: {error}", file=sys.stderr)
        return 2
    if options.write:
        PAGE.write_text(text, encoding="utf-8")
    else:
        print(text, end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
