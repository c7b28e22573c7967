"""``physim summary``."""

from __future__ import annotations

import argparse
import json
import sys
import textwrap
from collections.abc import Mapping

from physim.errors import PhysimError
from physim.metrics import DEFINITIONS, Definition, own_metrics
from physim.record import Record
from physim.summary import summarise, table

LINE = 96
"""Characters a line of the definitions."""


def summary(options: argparse.Namespace) -> int:
    """Print the summary of a record, or what its metrics are; returns the exit code."""
    if options.definitions:
        if options.record is not None:
            raise PhysimError("--definitions: goes without a record: it tells what the metrics are")
        own, faults = own_metrics(DEFINITIONS)
        known = {**DEFINITIONS, **own}
        print(_definitions_json(known) if options.json else _definitions(known), end="")
        for fault in faults:
            print(fault, file=sys.stderr)
        return 0
    if options.record is None:
        raise PhysimError("physim summary: RECORD is missing; or give --definitions")
    with Record.load(options.record) as record:
        found = summarise(record)
    print(found.to_json() if options.json else table(found), end="")
    return 0


def _definitions(known: Mapping[str, Definition]) -> str:
    width = max(len(name) for name in known)
    units = max(len(one.unit) for one in known.values())
    lines = []
    for name, one in known.items():
        source = "" if one.source == "-" else f" [{one.source}]"
        head = f"{name:<{width}}  {one.unit:<{units}}  "
        lines += textwrap.wrap(
            one.meaning + source, LINE, initial_indent=head, subsequent_indent=" " * len(head)
        )
    return "\n".join(lines) + "\n"


def _definitions_json(known: Mapping[str, Definition]) -> str:
    told = {
        name: {"unit": one.unit, "meaning": one.meaning, "source": one.source}
        for name, one in known.items()
    }
    return json.dumps(told, indent=2, ensure_ascii=False) + "\n"
