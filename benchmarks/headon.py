"""A robot driven head-on into a thin wall: is it held, is it told of, and how late?"""

from __future__ import annotations

import statistics
import sys
from collections.abc import Mapping

from benchmarks.environments import Environment
from benchmarks.measuring import Job, Result, Store, runner, table

SUBJECT = "headon"
SPEEDS = (1.0, 6.0, 12.0)
"""[m/s]: 0.05, 0.3 and 0.6 m a step of 0.05 s"""
OFFSETS = tuple(0.6 * (0.6180339887 * k % 1.0) for k in range(20))
"""[m] more or less to go, so that the wall is met anywhere in a step"""
GAPS = {"physim": 2.0, "navground": 2.0, "irsim": 30.0}
"""[m] to go; robots of IR-SIM speed up as their grip allows"""
NAMES = {"physim": "physim", "navground": "navground, disc", "irsim": "IR-SIM, contact"}


def groups(peers: Mapping[str, Environment], quick: bool) -> list[list[Job]]:
    """One process for each."""
    asked = {"what": "head_on", "speeds": SPEEDS, "offsets": OFFSETS[:: 4 if quick else 1]}
    found = []
    for who, gap in GAPS.items():
        if who == "physim" or (who in peers and not peers[who].failed):
            python = sys.executable if who == "physim" else peers[who].python
            job = runner(SUBJECT, who, "wall", python, f"run_{who}.py", 300.0, gap=gap, **asked)
            found.append([job])
    return found


def text(store: Store, peers: Mapping[str, Environment]) -> str:
    """The table."""
    rows = []
    for who, name in NAMES.items():
        failed = store.why_not(SUBJECT, who, "wall") or (
            peers[who].failed if who in peers else "" if who == "physim" else "not asked for"
        )
        results = store.results(SUBJECT, who, "wall")
        if failed or not results:
            rows.append([name, failed or "not measured", "", "", "", ""])
            continue
        for speed in SPEEDS:
            rows.append([name, f"{speed:g} m/s", *_row(results[0], speed)])
    head = ["", "speed", "step", "passed through", "never told", "told late by: median, most"]
    return f"## Head-on into a thin wall\n\n{INTRODUCTION}{table(head, rows)}\n"


INTRODUCTION = """\
One robot, 20 start offsets (5 in a quick run), three speeds; the due time is the closed form, the
way to the wall over the speed. physim refuses a world whose robots could move more than a quarter
of their width in a step; there the step is what it allows. Robots of IR-SIM speed up as their grip
allows: what is due is then reckoned from the speed just before.

"""


def _row(found: Result, speed: float) -> list[str]:
    runs = [one for one in found["runs"] if one["speed"] == speed]
    late = [one["late"] * 1e3 for one in runs if one["late"] is not None]
    refused = found.get("refused", {}).get(f"{speed:g}") or found.get("refused", {}).get(str(speed))
    step = runs[0].get("step", found.get("step"))
    return [
        f"{step:g} s" + (" (0.05 s is refused)" if refused else ""),
        f"{sum(one['passed'] for one in runs)} of {len(runs)}",
        f"{len(runs) - len(late)} of {len(runs)}",
        f"{statistics.median(late):.1f} ms, {max(late):.1f} ms" if late else "–",
    ]
