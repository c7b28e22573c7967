"""Speed beside the peers: the corridor without controller, with one, and a jam."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence

from benchmarks.environments import Environment
from benchmarks.measuring import Job, Store, cell, ratio, runner, table

SUBJECT = "speed"
MOST = 1000
"""Steps until the robots are taken back to the start."""

CONTESTS = {
    "drive": ("no controller, commands from outside", "drive", (
        ("navground", "Dummy", "navground, discs"),
        ("irsim", "contact", "IR-SIM, rectangles with contact"),
        ("vmas", "contact", "VMAS, rectangles with contact"),
    )),
    "controller": ("each with its controller", "free", (
        ("navground", "HL", "navground HL, discs"),
        ("navground", "ORCA", "navground ORCA, discs"),
        ("irsim", "rvo", "IR-SIM RVO, discs"),
        ("pyrvo", "ORCA", "pyrvo, ORCA alone"),
    )),
    "jam": ("all driven into a dead end, packed", "jam", (
        ("navground", "Dummy", "navground, discs"),
        ("irsim", "contact", "IR-SIM, rectangles with contact"),
        ("vmas", "contact", "VMAS, rectangles with contact"),
    )),
}  # fmt: skip
"""What is compared: in words, physim's kind, and who does it how."""


def groups(peers: Mapping[str, Environment], quick: bool) -> list[list[Job]]:
    """Measurements, those that belong together in a list each."""
    found = []
    for contest, (_, kind, rivals) in CONTESTS.items():
        for robots in sizes(contest, quick):
            asked = {
                "what": "speed", "robots": robots, "seconds": 0.1 if quick else 0.35,
                "most": 200 if contest == "jam" else MOST, "jam": contest == "jam",
            }  # fmt: skip
            what = f"{contest}-{robots}"
            group = [runner(SUBJECT, "physim", what, sys.executable, "run_physim.py", kind=kind,
                            **asked)]  # fmt: skip
            for name, how, _ in rivals:
                if name in peers and not peers[name].failed:
                    python = peers[name].python
                    group.append(runner(SUBJECT, f"{name}-{how}", what, python, f"run_{name}.py",
                                        60.0, kind=how, **asked))  # fmt: skip
            found.append(group)
    return found


def sizes(contest: str, quick: bool) -> Sequence[int]:
    """Numbers of robots."""
    if quick:
        return (10, 100)
    return (10, 100) if contest == "jam" else (1, 10, 100, 1000)


def text(store: Store, peers: Mapping[str, Environment]) -> str:
    """The tables."""
    found = ["## Speed\n\n", INTRODUCTION]
    for contest, (words, _, rivals) in CONTESTS.items():
        columns = [
            n for n in (1, 10, 100, 1000) if store.results(SUBJECT, "physim", f"{contest}-{n}")
        ]
        rows = [["physim, rectangles with contact"]]
        rows[0] += [cell(store, SUBJECT, "physim", f"{contest}-{n}") for n in columns]
        behind = []
        for name, how, label in rivals:
            if name not in peers:
                continue
            who, failed = f"{name}-{how}", peers[name].failed
            rates = [failed or cell(store, SUBJECT, who, f"{contest}-{n}") for n in columns]
            ratios = [_ratio(store, who, f"{contest}-{n}") for n in columns]
            rows += [[label, *rates], [f"physim : {label}", *map(_shown, ratios)]]
            slower = [
                str(n) for n, r in zip(columns, ratios, strict=True) if r is not None and r < 1.0
            ]
            behind += [f"{label} at N = {', '.join(slower)}"] if slower else []
        found += [f"### {words[0].upper()}{words[1:]}\n\n"]
        found += [table(["", *(f"N = {n}" for n in columns)], rows), "\n"]
        found += [f"Faster than physim: {'; '.join(behind) or 'none of them'}.\n\n"]
    return "".join(found)


INTRODUCTION = """\
Robot-steps per second of processor time, steps of 0.05 s, corridor 10 m wide, robots in eight
lanes, nothing drawn; the median over fresh processes and their range, physim and peers in turn.
Robots of physim are rectangles of 0.5 × 0.3 m that touch and push each other and 200 wall segments;
discs have a radius of 0.29 m. Controllers decide every 0.1 s and, of the peers, see 5 m far
(navground, pyrvo), physim's 10 m. Peers have two walls, as they like them best. The rates of
one kind of rule and another are no measure of what the rules are worth.

"""


def _ratio(store: Store, who: str, what: str) -> float | None:
    return ratio(store.values(SUBJECT, "physim", what), store.values(SUBJECT, who, what))


def _shown(value: float | None) -> str:
    if value is None:
        return "–"
    return f"**{value:.2g}**" if value < 0.1 else f"**{value:.3g}**"
