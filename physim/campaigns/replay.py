"""A run of a campaign again, from its row: the same record, bit for bit."""

from __future__ import annotations

from physim.campaigns.folder import Folder
from physim.campaigns.rows import Row
from physim.campaigns.sources import sources_of
from physim.campaigns.spec import RunSpec
from physim.errors import PhysimError
from physim.parts.registry import CONTROLLER, shipped_parts


def spec_of_row(folder: Folder, row: Row, controller: str | None = None) -> RunSpec:
    """The spec of a row. Raises PhysimError where the same run cannot be made here."""
    if ":" in row.controller and controller != row.controller:
        raise PhysimError(
            f"run {row.run}: its controller {row.controller} is code of your own; give it again by "
            f"--controller {row.controller}"
        )
    file = folder.world_file(row.world_hash)
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise PhysimError(f"{file}: cannot be read ({error})") from None
    shipped = row.controller in shipped_parts(CONTROLLER)
    sources = () if shipped else sources_of(row.controller)
    spec = RunSpec(text, row.seed, row.world, row.settings, row.controller, sources)
    if spec.key != row.run:
        raise PhysimError(f"run {row.run} would not be the same again")
    return spec
