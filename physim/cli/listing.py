"""``physim list``."""

from __future__ import annotations

import argparse
import json

from physim.registry import controller_names
from physim.world_file.shipped import shipped_worlds


def listing(options: argparse.Namespace) -> int:
    """Print the shipped worlds and the registered controllers, a line each."""
    worlds = shipped_worlds()
    controllers = controller_names()
    if options.json:
        print(json.dumps({"worlds": worlds, "controllers": controllers}, indent=2))
        return 0
    width = max(len(name) for name in (*worlds, *controllers))
    for title, entries in (("worlds", worlds), ("controllers", controllers)):
        print(title)
        for name, line in entries.items():
            print(f"  {name:<{width}}  {line}")
    return 0
