"""Try every item again: ``python -m tests.edges [--only NUMBER ...] [--list]``.

A line an item, and below it a line for each trial that fails; exit code 1 where any does.
``--only`` takes numbers or names of items.
"""

from __future__ import annotations

import argparse
import sys
import traceback

from tests.edges.item import Item, all_items


def main() -> int:
    """Run what is asked for."""
    parser = argparse.ArgumentParser(prog="python -m tests.edges", description=__doc__)
    parser.add_argument("--only", nargs="+", default=[], metavar="ITEM", help="numbers or names")
    parser.add_argument("--list", action="store_true", help="list the items, try nothing")
    given = parser.parse_args()
    items = all_items()
    known = {item.number for item in items} | {item.name for item in items}
    if unknown := set(given.only) - known:
        parser.error(f"no such item: {', '.join(sorted(unknown))}")
    chosen = [i for i in items if not given.only or {i.number, i.name} & set(given.only)]
    if given.list:
        for item in chosen:
            print(f"{item.number:>4}  {item.line} ({', '.join(item.trials)})")
        return 0
    return 1 if sum([_failures(item) for item in chosen]) else 0


def _failures(item: Item) -> int:
    """Try an item and tell how it went; returns how many trials failed."""
    failed = []
    for name in item.trials:
        try:
            item.run(name)
        except Exception as error:  # whatever it is, the next is tried
            place = traceback.extract_tb(error.__traceback__)[-1]
            said = str(error).strip() or place.line
            failed.append(f"      {name}: {type(error).__name__}: {said}")
    result = f"FAILED {len(failed)} of {len(item.trials)}" if failed else f"ok ({len(item.trials)})"
    print(f"{item.number:>4}  {item.line}: {result}", *failed, sep="\n", flush=True)
    return len(failed)


if __name__ == "__main__":
    sys.exit(main())
