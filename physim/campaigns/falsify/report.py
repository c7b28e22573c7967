"""What a search found, in words and as values."""

from __future__ import annotations

import json
from typing import Any

from physim.campaigns.falsify.hunt import Hunt
from physim.campaigns.falsify.robustness import Judged
from physim.campaigns.falsify.shrink import Shrunk, size_of
from physim.campaigns.falsify.space import Space
from physim.campaigns.falsify.writing import headline


def found_text(found: Hunt) -> str:
    """What the search found, what it had to leave out, and what that means."""
    lines = []
    if found.stopped:
        lines.append(f"interrupted after {found.runs} of {found.budget} runs")
    if found.judged is not None and found.failed:
        times = f"; {found.failures} of {found.runs} runs failed" if found.failures > 1 else ""
        lines.append(f"failure in run {found.run}: {headline(found.judged)}{times}")
    elif found.judged is not None:
        pair = " and ".join(found.judged.pair)
        lines.append(
            f"no failure in {found.runs} runs; least clearance {found.judged.clearance:.4g} m "
            f"({pair} at {found.judged.time:.2f} s, run {found.run}), of the world itself "
            f"{found.first:.4g} m. This is no proof that there is none."
        )
    if found.repaired:
        lines.append(f"{found.repaired} of {found.runs} starts or settings were moved to where "
                     "they are allowed before they were run")  # fmt: skip
    if found.refused or found.broken:
        lines.append(f"{found.refused} worlds refused and {found.broken} runs broken off, which "
                     f"count as nothing; the first: {found.reason}")  # fmt: skip
    return "".join(f"{line}\n" for line in lines)


def shrunk_text(found: Hunt, shrunk: Shrunk) -> str:
    """How much smaller the world has become, and with how many runs."""
    if found.world is None:
        return ""
    before, after = size_of(found.world), size_of(shrunk.world)
    changed = [
        f"{key.replace('_', ' ')} {before[key]:g} to {after[key]:g}"
        for key in before
        if before[key] != after[key]
    ]
    least = "" if shrunk.is_least else "; not to the end, for want of runs"
    return f"shrunk with {shrunk.runs} runs: {', '.join(changed) or 'numbers only'}{least}"


def found_json(space: Space, found: Hunt, shrunk: Shrunk | None, told: str) -> str:
    """What was found, as values; lengths [m], times [s], angles [rad]."""
    tree: dict[str, Any] = {
        "format": "physim-falsify",
        "version": 1,
        "world": space.world.name,
        "seed": space.world.seed,
        "bounds": [one._asdict() for one in space.dimensions],
        "least_gap_at_start_m": float(space.starts.gap.min()),
        "budget": found.budget,
        "runs": found.runs,
        "failed": found.failed,
        "failures": found.failures,
        "repaired": found.repaired,
        "refused": found.refused,
        "broken_off": found.broken,
        "interrupted": found.stopped,
        "clearance_of_the_world_itself_m": found.first,
        "worst_by_run": found.history,
        "worst": None if found.judged is None else _values(found.judged),
        "worst_run": found.run,
        "shrunk": None,
        "story": told.strip(),
    }
    if shrunk is not None:
        tree["shrunk"] = {
            "runs": shrunk.runs,
            "taken": shrunk.taken,
            "to_the_end": shrunk.is_least,
            "worst": _values(shrunk.judged),
        }
    return json.dumps(tree, indent=2, ensure_ascii=False) + "\n"


def _values(judged: Judged) -> dict[str, Any]:
    """A judged run; distances [m], times [s]."""
    touched = judged.touched
    return {
        "clearance_m": judged.clearance,
        "pair": judged.pair,
        "time_s": judged.time,
        "touched": None
        if touched is None
        else {
            "kind": touched.kind,
            "pair": touched.pair,
            "time_s": touched.time,
            "modes": touched.modes,
        },
    }
