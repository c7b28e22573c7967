"""In what two cells of different campaigns differ, whatever they are called.

Cells are matched by names. The worlds called alike may have been changed between the campaigns, and
so may the source of a controller: what is found is then no effect of what is compared.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache

from physim.campaigns.compare import Comparison
from physim.campaigns.folder import Described, Folder
from physim.drawing.labels import shortened
from physim.errors import plain_key
from physim.world.differences import differences
from physim.world.file.files import file_text
from physim.world.file.loading import parse_world
from physim.world.model import World

MOST_NAMED, MOST_SHOWN = 3, 40
"""Values of worlds that are named, of the others there is a count; characters of such a value"""
WORDS = ("name", "description", "expect")
"""Keys of a world by which no run moves otherwise."""


def with_unlike(comparisons: list[Comparison], a: Folder, b: Folder) -> list[Comparison]:
    """Comparisons of two campaigns, each with all in which its cells differ beside their names.

    Raises PhysimError where a world's file cannot be read or is no world.
    """

    @cache
    def world(folder: Folder, world_hash: str) -> World:
        file = folder.world_file(world_hash)
        return parse_world(file_text(file), str(file), check_controller=False)

    cells = [{one.label: one for one in folder.cells()} for folder in (a, b)]
    found = []
    for one in comparisons:
        of_a, of_b = cells[0][one.a.cell.names], cells[1][one.b.cell.names]
        told = [*_versions(of_a, of_b)]
        if of_a.world == of_b.world and of_a.world_hash != of_b.world_hash:
            worlds = world(a, of_a.world_hash), world(b, of_b.world_hash)
            told = [*_worlds(of_a, of_b, *worlds), *told]
        found.append(replace(one, unlike=tuple(told)))
    return found


def _versions(a: Described, b: Described) -> Iterator[str]:
    """Sources of one name and versions that are not the same."""
    if a.label[1:] == b.label[1:] and a.source_hash != b.source_hash:
        yield (
            f"the source of {a.controller} or of a stage, or a file that they name, was changed "
            "between them"
        )
    if a.physim != b.physim:
        yield f"A was run by physim {a.physim}, B by physim {b.physim}"
    if a.engine != b.engine:
        yield f"A was run by {a.engine}, B by {b.engine}"


def _worlds(a: Described, b: Described, in_a: World, in_b: World) -> Iterator[str]:
    """In which values two worlds of one name differ, but those that the settings give."""
    settings = [one for side in (a, b) for one in side.settings.split("; ") if one]
    given = {*WORDS, *map(plain_key, settings)}
    if a.controller != b.controller:
        given.add("controller")
    told = [
        f"{key} {shortened(one, MOST_SHOWN)} in A, {shortened(other, MOST_SHOWN)} in B"
        for key, (one, other) in differences(in_a, in_b).items()
        if not any(key == one or key.startswith(f"{one}.") for one in given)
    ]
    if told:
        rest = len(told) - MOST_NAMED
        more = f"; and {rest} more" if rest > 0 else ""
        yield f"their worlds are not the same: {'; '.join(told[:MOST_NAMED])}{more}"
