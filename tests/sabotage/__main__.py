"""``python -m tests.sabotage``: breaks each rule on purpose and looks whether a test notices.

Exit codes: 0 every edit was noticed by a test of its room, 1 one was not, 2 an edit has no place
or more than one, the tests of a room fail as they are, or the arguments are wrong, 130 interrupted.
"""

from __future__ import annotations

import argparse
import json
import signal
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from types import FrameType

from tests.sabotage import table
from tests.sabotage.anchors import BadAnchorError, Sources
from tests.sabotage.edit import ROOMS, Edit
from tests.sabotage.edits import EDITS
from tests.sabotage.runner import Outcome, RunError, sabotage

ROOT = Path(__file__).parents[2]


def main(given: Sequence[str] | None = None) -> int:
    """Run the program; returns the exit code."""
    options = _arguments(given)
    if options.table:
        (ROOT / table.PAGE).write_text(table.page(EDITS), encoding="utf-8")
        return 0
    rooms = list(ROOMS) if options.all else options.room
    edits = [edit for edit in EDITS if edit.room in rooms]
    if options.function:
        edits = [edit for edit in edits if edit.function in options.function]
    if not edits:
        _tell("no edit is meant by these arguments")
        return 2
    signal.signal(signal.SIGTERM, _interrupt)
    try:
        sources = Sources(ROOT)
        for edit in edits:
            sources.place_of(edit)
        outcomes = _run(edits, options.jobs)
    except (BadAnchorError, RunError) as error:
        _tell(str(error))
        return 2
    except KeyboardInterrupt:
        _tell("interrupted")
        return 130
    survivors = [one for one in outcomes if one.noticed is None]
    if options.json:
        print(json.dumps(_plain(outcomes), indent=2, ensure_ascii=False))
    else:
        print(f"{len(outcomes)} edits, {len(survivors)} not noticed")
        for one in survivors:
            print(f"NOT NOTICED  {one.edit.room}: {one.edit.function}: {one.edit.breaks}")
    return 1 if survivors else 0


def _arguments(given: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.sabotage", description=__doc__)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--room", action="append", choices=list(ROOMS), help="may be repeated")
    what.add_argument("--all", action="store_true", help="all rooms")
    what.add_argument("--table", action="store_true", help=f"write {table.PAGE}")
    parser.add_argument("--function", action="append", help="only edits of this function")
    parser.add_argument("--jobs", type=int, default=1, help="edits at a time (1)")
    parser.add_argument("--json", action="store_true", help="print what was found as JSON")
    options = parser.parse_args(given)
    if options.jobs < 1:
        parser.error("--jobs: at least 1")
    return options


def _run(edits: Sequence[Edit], jobs: int) -> list[Outcome]:
    """Outcomes of all edits, in their order; a line on stderr for each as it comes."""
    begun = time.monotonic()
    outcomes: dict[Edit, Outcome] = {}

    with sabotage(ROOT, jobs) as work:
        for room, tests, seconds in work.unedited(dict.fromkeys(edit.room for edit in edits)):
            _tell(f"{room}: {tests.ran} tests pass unedited ({seconds:.0f} s)")
        for one in work.edits(edits):
            outcomes[one.edit] = one
            place = f"[{len(outcomes)}/{len(edits)}] {one.edit.room}: {one.edit.function}"
            by = "NOT NOTICED" if one.noticed is None else table.short(one.noticed)
            _tell(f"{place}: {one.edit.breaks}: {by} ({one.seconds:.0f} s)")
            if one.noticed is not None and not one.noticed.startswith(one.edit.notices):
                _tell(f"    listed, but blind to it: {table.short(one.edit.notices)}")
    _tell(f"{time.monotonic() - begun:.0f} s in all")
    return [outcomes[edit] for edit in edits]


def _plain(outcomes: Sequence[Outcome]) -> list[dict[str, object]]:
    return [
        {**one.edit._asdict(), "noticed": one.noticed, "seconds": round(one.seconds, 1)}
        for one in outcomes
    ]


def _tell(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt


if __name__ == "__main__":
    sys.exit(main())
