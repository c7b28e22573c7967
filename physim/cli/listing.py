"""``physim list``."""

from __future__ import annotations

import json

from physim.cli.parser import Options, command, flag


@command("list", "worlds, controllers and other parts there are")
@flag("--json", "print JSON instead of a table")
def listing(options: Options) -> int:
    """List the shipped worlds and, a line each, what is registered: controllers, sensing stages,
    filters, disturbances, observers; of metrics and plots those of other packages.

    exit codes:
      0    listed
      2    bad input

    examples:
      physim list
      physim run NAME                            NAME as listed under worlds
      physim run three_robots --controller NAME  NAME as listed under controllers
      physim run three_robots --observer NAME    NAME as listed under observers
    """
    from physim.metrics import DEFINITIONS
    from physim.metrics.own import taken_name
    from physim.plots import NAMES
    from physim.registry import KINDS, METRIC, PLOT, part_names
    from physim.world_file.shipped import shipped_worlds

    kinds = (*KINDS, METRIC, PLOT)
    found = {"worlds": shipped_worlds()}
    found |= {f"{kind.word}s": part_names(kind) for kind in kinds}
    for kind, own in ((METRIC, DEFINITIONS), (PLOT, NAMES)):
        entries = found[f"{kind.word}s"]
        entries |= {name: taken_name(kind, name) for name in entries if name in own}
    if options.json:
        keys = ["worlds", *(kind.group.removeprefix("physim.") for kind in kinds)]
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
