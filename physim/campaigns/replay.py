"""A run of a campaign again, from its row: the same record, bit for bit."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from physim.campaigns.folder import Folder
from physim.campaigns.one_run import simulation_of
from physim.campaigns.sources import sources_of
from physim.campaigns.spec import RunSpec
from physim.errors import PhysimError
from physim.parts.registry import CONTROLLER, shipped_parts
from physim.record import Record
from physim.simulation.run import record_run


def record_of(folder: Path, row: dict[str, Any]) -> Record:
    """Record of a row. Raises PhysimError where its run cannot be made again."""
    if not re.fullmatch(r"[0-9a-f]+", row["world_hash"] or ""):
        raise PhysimError(f"{folder}: run {row['run']}: its row names no world")
    file = Folder(folder).world_file(row["world_hash"])
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise PhysimError(f"{file}: cannot be read ({error})") from None
    own = row["controller"] not in shipped_parts(CONTROLLER)
    sources = sources_of(row["controller"]) if own else ()
    spec = RunSpec(text, row["seed"], row["world"], row["settings"], row["controller"], sources)
    if spec.key != row["run"]:
        raise PhysimError(
            f"{folder}: run {row['run']}: physim, the engine or its controller has changed since"
        )
    return record_run(simulation_of(spec))
