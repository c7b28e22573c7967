"""Are small faults in a room's sources noticed? ``python -m tests.mutation --room R``

The seed draws a sample of small changes of the sources, a mutant each. The room's tests that
execute the changed line are run until one is red. Kernels run as plain functions meanwhile; tests
that take long so, or fail, are left out and named. An edit of one function changes the mutants of
no other. Then every rule of the room in `tests.mutation.rules` is broken, one at a time. Exit code
0: all was noticed; 1: some survive, and are named.
"""

from __future__ import annotations

import argparse
import functools
import hashlib
import importlib
import importlib.util
import json
import math
import os
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.helpers import inside
from tests.mutation.children import first_red, first_red_with, forked, plain_kernels, watched
from tests.mutation.mutants import Mutant, drawn, mutants_of
from tests.mutation.rooms import EQUIVALENT, ROOMS, ROOT, sources_of, tests_of

CACHE = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"), "physim-mutation")
"""What is known of the tests of these very sources"""
SLACK = 5.0
"""s of CPU that a test may take beyond ten times what it took unmutated"""


def main(arguments: list[str] | None = None) -> int:
    """Run the program; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutation", description=__doc__)
    parser.add_argument("--room", choices=ROOMS, required=True)
    parser.add_argument("--sample", type=int, default=40, help="how many mutants (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="draws them (%(default)s)")
    parser.add_argument("--list", action="store_true", help="only name the mutants")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--slow", type=float, default=4.0, help="s of CPU that a test may take")
    options = parser.parse_args(arguments)
    room, began = ROOMS[options.room], time.monotonic()
    sources = sources_of(room)
    every = [one for file in sources for one in mutants_of(file, ROOT)]
    every = [one for one in every if (one.function, one.operator, one.change) not in EQUIVALENT]
    sample = drawn(every, options.seed, min(options.sample, len(every)))
    if options.list:
        print(*sample, sep="\n")
        return 0
    CACHE.mkdir(parents=True, exist_ok=True)
    log = CACHE / f"{options.room}.log"
    log.write_bytes(b"")
    in_forks = functools.partial(forked, jobs=options.jobs, log=log)
    tests = Known(sources, tests_of(room), options.slow, in_forks)
    survivors = judge(sample, tests, in_forks) + judge_rules(options.room, tests, in_forks)
    print(f"{time.monotonic() - began:.0f} s; {log} tells the rest")
    return 1 if survivors else 0


class Known:
    """The tests of a room: how long they take, and what they execute."""

    def __init__(
        self, sources: list[str], files: list[str], slow: float, in_forks: Callable[..., Any]
    ) -> None:
        """Run every file once, unmutated, or read how that went; say which tests are left out."""
        stamp = hashlib.sha256(repr((sources, slow)).encode())
        for folder in ("physim", "controllers", "worlds", "tests"):
            for path in sorted((ROOT / folder).rglob("*")):
                place = path.relative_to(ROOT)
                if path.suffix in (".py", ".yaml") and place.parts[:2] != ("tests", "mutation"):
                    stamp.update(f"{place}".encode() + path.read_bytes())
        kept = CACHE / stamp.hexdigest()[:16]
        kept.mkdir(exist_ok=True)
        known = {file: kept / f"{file.replace('/', '.')}.json" for file in files}
        run = functools.partial(watched, sources=sources, slow=slow)
        for file, found in in_forks([one for one in files if not known[one].exists()], run):
            known[file].write_text(json.dumps(found))
        self.seconds: dict[str, float] = {}
        self.left_out: dict[str, str] = {}
        self._by_line: defaultdict[tuple[str, int], set[str]] = defaultdict(set)
        for found in (json.loads(known[file].read_text()) for file in files):
            self.seconds |= found["seconds"]
            self.left_out |= found["not_passed"]
            for source, lines in found["lines"].items():
                for line, tests in lines.items():
                    self._by_line[source, int(line)].update(set(tests) & set(self.seconds))
        kinds, total = dict(Counter(self.left_out.values())), sum(self.seconds.values())
        print(f"{len(self.seconds)} tests, {total:.0f} s; left out: {kinds}", flush=True)
        for name, kind in self.left_out.items():
            if kind != "skipped":
                print(f"  {kind}: {name}")

    def reaching(self, mutant: Mutant) -> set[str]:
        """Tests that execute a mutant; all, where that happens at import."""
        if mutant.lines is None:
            return set(self.seconds)
        first, last = mutant.lines
        return set().union(*(self._by_line[mutant.file, k] for k in range(first, last + 1)))

    def in_order(self, tests: set[str]) -> dict[str, float]:
        """Tests, the quickest first, and s that each may take.

        After them come the others of their files: they may use what the first of them made and
        keeps, a fixture or a run. Tests of like duration are not torn from their files.
        """
        files = {name.partition("::")[0] for name in tests}

        def order(name: str) -> tuple[bool, int, str]:
            size = int(math.log2(max(self.seconds[name], 0.01)))
            return name not in tests, size, name.partition("::")[0]

        return {
            name: 10.0 * self.seconds[name] + SLACK
            for name in sorted(self.seconds, key=order)
            if name.partition("::")[0] in files and name not in self.left_out
        }


def judge(sample: list[Mutant], tests: Known, in_forks: Callable[..., Any]) -> int:
    """Run the tests of each mutant; returns how many survive."""
    reaching = {one: tests.reaching(one) for one in sample}
    left_out = set(tests.left_out)

    def run(mutant: Mutant) -> str:
        limits = tests.in_order(reaching[mutant])
        red = first_red_with(mutant.file, mutant.text(), limits)
        print(f"{mutant}: {red or 'SURVIVES'}")
        return red

    found = dict(in_forks([one for one in sample if reaching[one] - left_out], run))
    judged = [one for one in sample if one in found or not reaching[one]]
    survivors = [one for one in judged if not found.get(one)]
    for one in sample:
        if one not in judged:
            print(f"not judged, as only tests that are left out reach it: {one}")
        elif one in survivors:
            others = len(reaching[one] & left_out)
            note = f" ({others} tests that are left out reach it, too)" if others else ""
            print(f"survives: {one}{note if reaching[one] else ' (no test reaches it)'}")
    tell("mutants", len(judged), len(survivors))
    return len(survivors)


def judge_rules(room: str, tests: Known, in_forks: Callable[..., Any]) -> int:
    """Break each rule of the room that `tests.mutation.rules` names, where there is one."""
    if importlib.util.find_spec("tests.mutation.rules") is None:
        return 0
    names_of_room = (room, *ROOMS[room].tests)

    def rules() -> dict[str, Callable[[], Any]]:
        every = importlib.import_module("tests.mutation.rules").RULES
        return {name: breaks for place, name, breaks in every if place in names_of_room}

    def run(name: str) -> str:
        plain_kernels()
        rules()[name]()
        return first_red(tests.in_order(set(tests.seconds)))

    ((_, names),) = in_forks([None], lambda _: list(rules()))
    survivors = [name for name, red in in_forks(names, run) if not red]
    for name in survivors:
        print(f"survives: rule {name}")
    tell("rules", len(names), len(survivors))
    return len(survivors)


def tell(what: str, trials: int, survivors: int) -> None:
    """Say how many were noticed."""
    clopper_pearson = inside("physim.statistics", "clopper_pearson")

    noticed = trials - survivors
    low, high = clopper_pearson(noticed, trials)
    print(f"{noticed} of {trials} {what} noticed, {noticed / max(trials, 1):.0%}", end=" ")
    print(f"(95% interval {low:.0%} to {high:.0%})")


if __name__ == "__main__":
    sys.exit(main())
