"""``physim list``."""

from __future__ import annotations

import argparse
import json

from physim.metrics import DEFINITIONS
from physim.metrics.own import taken_name
from physim.plots import NAMES
from physim.registry import KINDS, METRIC, PLOT, part_names
from physim.world_file.shipped import shipped_worlds

LISTED = (*KINDS, METRIC, PLOT)


def listing(options: argparse.Namespace) -> int:
    """Print the shipped worlds and the registered parts of every kind, a line each."""
    found = {"worlds": shipped_worlds()}
    found |= {f"{kind.word}s": part_names(kind) for kind in LISTED}
    for kind, own in ((METRIC, DEFINITIONS), (PLOT, NAMES)):
        entries = found[f"{kind.word}s"]
        entries |= {name: taken_name(kind, name) for name in entries if name in own}
    if options.json:
        keys = ["worlds", *(kind.group.removeprefix("physim.") for kind in LISTED)]
        print(json.dumps(dict(zip(keys, found.values(), strict=True)), indent=2))
        return 0
    width = max(len(name) for entries in found.values() for name in entries)
    for title, entries in found.items():
        if entries:
            print(title)
        for name, line in entries.items():
            print(f"  {name:<{width}}  {line}")
    if none := [title for title, entries in found.items() if not entries]:
        print(f"none of your own: {', '.join(none)} (docs/EXTENDING.md)")
    return 0
