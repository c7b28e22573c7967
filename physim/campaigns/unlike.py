"""In what two cells of different campaigns differ, whatever they are called.

Cells are matched by names. The worlds called alike may have been changed between the campaigns, and
so may the source of a controller: what is found is then no effect of what is compared.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

from physim.campaigns.compare import Comparison
from physim.campaigns.folder import Folder, label_of
from physim.campaigns.outcomes import Cell
from physim.errors import plain_key
from physim.world.differences import differing_values
from physim.world.file.files import file_text
from physim.world.file.reading import read_document

MOST_NAMED = 3
"""values of worlds that are named; of the others there is a count"""


class _Side(NamedTuple):
    """What one campaign says of its cell."""

    cell: Cell
    described: dict[str, str]
    values: Any
    """the effective world"""


def with_unlike(comparisons: list[Comparison], a: Folder, b: Folder) -> list[Comparison]:
    """Comparisons of two campaigns, each with all in which its cells differ beside their names.

    Raises PhysimError where a world's file cannot be read.
    """
    cells_a, cells_b = ({label_of(one): one for one in folder.cells()} for folder in (a, b))
    return [
        replace(
            one,
            unlike=tuple(
                _unlike(
                    _side(a, cells_a[one.a.cell.names], one.a.cell),
                    _side(b, cells_b[one.b.cell.names], one.b.cell),
                )
            ),
        )
        for one in comparisons
    ]


def _side(folder: Folder, described: dict[str, str], cell: Cell) -> _Side:
    file = folder.world_file(described["world_hash"])
    return _Side(cell, described, read_document(file_text(file), str(file)).values())


def _unlike(a: _Side, b: _Side) -> Iterator[str]:
    """What differs and is not in the names of the cells, a text each."""
    if a.cell.world == b.cell.world:
        yield from _worlds(a, b)
    if (
        a.cell.controller == b.cell.controller
        and a.described["source_hash"] != b.described["source_hash"]
    ):
        yield f"the source of {a.cell.controller} or of a stage was changed between them"
    for what in ("physim", "engine"):
        one, other = a.described[what], b.described[what]
        if one != other:
            name = "" if what == "engine" else "physim "
            yield f"A was run by {name}{one}, B by {name}{other}"


def _worlds(a: _Side, b: _Side) -> Iterator[str]:
    """In which values two worlds of one name differ, but those that the settings give."""
    given = {plain_key(one) for side in (a, b) for one in side.cell.settings.split("; ") if one}
    if a.cell.controller != b.cell.controller:
        given.add("controller")
    found = {
        key: pair
        for key, pair in differing_values(a.values, b.values).items()
        if not any(key == one or key.startswith(f"{one}.") for one in given)
    }
    if not found:
        return
    told = [f"{key} {one} in A, {other} in B" for key, (one, other) in found.items()]
    rest = len(told) - MOST_NAMED
    more = f"; and {rest} more" if rest > 0 else ""
    yield f"their worlds are not the same: {'; '.join(told[:MOST_NAMED])}{more}"


__all__ = ["with_unlike"]
