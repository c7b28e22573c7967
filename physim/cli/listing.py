"""``physim list``, what there is; ``physim summary``, the figures of a record."""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Mapping
from typing import TYPE_CHECKING

from physim.cli.options import JsonFlag, Out, RecordFile
from physim.errors import PhysimError
from physim.json_text import json_text

if TYPE_CHECKING:
    from physim.analysis.metrics import Definition


HOW = """python -c "help('physim.parts')\""""


def listing(
    *,
    json: JsonFlag = False,
    out: Out,
) -> int:  # fmt: skip
    """List the shipped worlds and the registered controllers, sensing stages, filters,
    disturbances, observers and drives, one line each; also metrics and plots of other packages.

    The worlds of the league and those for tuning stand below the others: run them as league/NAME.

    exit codes:
      0    listed
      2    bad input

    examples:
      physim list
      physim run NAME                            NAME as listed under worlds
      physim run three_robots --controller NAME  NAME as listed under controllers
      physim run three_robots --observer NAME    NAME as listed under observers
    """
    from physim.analysis.metrics import DEFINITIONS
    from physim.analysis.metrics.registered import taken_name
    from physim.drawing.plots import NAMES
    from physim.parts.registry import DRIVE, KINDS, METRIC, PLOT, part_names
    from physim.world.file.files import GROUPS, shipped_worlds

    kinds = (*KINDS, DRIVE, METRIC, PLOT)
    worlds = shipped_worlds()
    found = {"worlds": worlds}
    found |= {f"{kind.word}s": part_names(kind) for kind in kinds}
    for kind, own in ((METRIC, DEFINITIONS), (PLOT, NAMES)):
        entries = found[f"{kind.word}s"]
        entries |= {name: taken_name(kind, name) for name in entries if name in own}
    grouped = {group: shipped_worlds(group) for group in GROUPS}
    if json:
        keys = ["worlds", *(kind.group.removeprefix("physim.") for kind in kinds)]
        values = dict(zip(keys, found.values(), strict=True)) | grouped
        print(json_text(values), end="", file=out)
        return 0
    width = max(len(name) for entries in found.values() for name in entries)
    for title, entries in found.items():
        if entries:
            print(title)
        for name, line in entries.items():
            print(f"  {name:<{width}}  {line}")
        if entries is worlds:
            for group, names in grouped.items():
                inside = ", ".join(name.removeprefix(f"{group}/") for name in names)
                print(
                    textwrap.fill(
                        f"{group}/ {inside}", LINE, initial_indent="  ", subsequent_indent="    "
                    )
                )
    if none := [title for title, entries in found.items() if not entries]:
        print(f"none registered: {', '.join(none)} (how to add one: {HOW})")
    return 0


LINE = 96
"""Characters a line of the definitions."""


def summary(
    record: RecordFile | None = None, /, *,
    json: JsonFlag = False,
    definitions: bool = False,
    out: Out,
) -> int:  # fmt: skip
    """Print contacts, distances, collision times, formation errors and modes of a record, and
    whether the run met what its world expects.

    arguments:
      [RECORD]  a run: its folder or its record.h5

    options:
      --definitions  print instead what each metric means, with its unit and equation or figure

    exit codes:
      0    printed, whatever the result
      2    bad input: one message says what and where

    examples:
      physim summary runs/ten_robots-21
      physim summary out/record.h5 --json > figures.json
      physim summary --definitions
    """
    from physim.analysis.metrics import DEFINITIONS, own_metrics
    from physim.analysis.summary import summarise, table
    from physim.record import Record

    if definitions:
        if record is not None:
            raise PhysimError("--definitions: takes no record; it explains the metrics")
        own, faults = own_metrics(DEFINITIONS)
        known = {**DEFINITIONS, **own}
        if json:
            keys = ("unit", "meaning", "source")
            values = {name: {key: getattr(one, key) for key in keys} for name, one in known.items()}
            print(json_text(values), end="", file=out)
        else:
            _tell_definitions(known)
        for fault in faults:
            print(fault, file=sys.stderr)
        return 0
    if record is None:
        raise PhysimError("physim summary: RECORD is missing; or give --definitions")
    with Record.load(record) as opened:
        found = summarise(opened)
    print(found.to_json() if json else table(found), end="", file=out)
    return 0


def _tell_definitions(known: Mapping[str, Definition]) -> None:
    width = max(len(name) for name in known)
    units = max(len(one.unit) for one in known.values())
    for name, one in known.items():
        source = "" if one.source == "-" else f" [{one.source}]"
        head = f"{name:<{width}}  {one.unit:<{units}}  "
        lines = textwrap.wrap(
            one.meaning + source, LINE, initial_indent=head, subsequent_indent=" " * len(head)
        )
        print("\n".join(lines))
