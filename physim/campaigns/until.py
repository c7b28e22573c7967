"""Campaigns that stop when a goal is decided: ``physim sweep --until``, and that it was so."""

from __future__ import annotations

import json
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path

from physim.campaigns.rows import FINISHED, Row, write_whole
from physim.errors import PhysimError
from physim.statistics.goal import Goal, Watch, read_goal

UNTIL = "until.json"
"""File in a campaign's folder that tells its goal: reports need to know that it was looked at."""
FORMAT = "physim-until"

Label = tuple[str, str, str]
"""World, settings and controller of a cell"""


@dataclass(frozen=True)
class Until:
    """The goal of a campaign, and the seed from which on its runs count, one after the other."""

    goal: Goal
    first: int


class Decided:
    """Whether the goal is decided in every cell: of the rows of a sweep so far, in its order.

    Within a cell the rows are in the order of seeds, so the answer depends on their outcomes alone,
    not on which was done first. Writes `UNTIL` when it is first asked.
    """

    def __init__(self, folder: Path, until: Until, cells: Collection[Label]) -> None:
        self.folder, self.until = folder, until
        self.watches = {label: Watch(until.goal) for label in cells}
        self.seen = 0

    def __call__(self, rows: Sequence[Row]) -> bool:
        """Take notice of the rows that are new."""
        if not self.seen:
            write_until(self.folder, self.until)
        for row in rows[self.seen :]:
            self.watches[row.world, row.settings, row.controller].add(
                succeeded(row, self.until.goal.rate)
            )
        self.seen = len(rows)
        return all(watch.decided for watch in self.watches.values())


def succeeded(row: Row, rate: str) -> bool:
    """Whether a run counts as a success for a rate of `physim.statistics.goal.RATES`."""
    if rate == "rate":
        return row.safe
    return row.contact_free if rate == "contact_free" else row.ended == FINISHED


def write_until(folder: Path, until: Until) -> None:
    """Say in a campaign's folder what its goal is; runs count from the least first seed on.

    Raises PhysimError where that cannot be written.
    """
    before = read_until(folder)
    first = until.first if before is None else min(until.first, before.first)
    tree = {"format": FORMAT, "version": 1, "goal": str(until.goal), "first_seed": first}
    write_whole(folder / UNTIL, json.dumps(tree, indent=1).encode())


def read_until(folder: Path) -> Until | None:
    """Goal of a campaign; None where it had none. Raises PhysimError for a file of another kind."""
    path = folder / UNTIL
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        if found["format"] != FORMAT or not isinstance(found["first_seed"], int):
            raise ValueError("another format")
        return Until(read_goal(str(found["goal"])), found["first_seed"])
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise PhysimError(f"{path}: cannot be read ({error})") from None
