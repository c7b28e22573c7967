"""In what two cells of different campaigns differ, whatever they are called.

Cells are matched by names. The worlds called alike may have been changed between the campaigns, and
so may the source of a controller: what is found is then no effect of what is compared.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from typing import NamedTuple

from physim.campaigns.compare import Comparison
from physim.campaigns.folder import Folder, label_of
from physim.campaigns.outcomes import Cell
from physim.campaigns.sources import own_parts
from physim.drawing.labels import shortened
from physim.errors import plain_key
from physim.parts.registry import CONTROLLER, STAGES, shipped_parts
from physim.world.differences import differences
from physim.world.file.files import file_text
from physim.world.file.loading import parse_world
from physim.world.model import World

MOST_NAMED = 3
"""values of worlds that are named; of the others there is a count"""

MOST_SHOWN = 40
"""characters of such a value"""
WORDS = ("name", "description", "expect")
"""Keys of a world by which no run moves otherwise."""


class _Side(NamedTuple):
    """What one campaign says of its cell."""

    cell: Cell
    described: dict[str, str]
    world: Callable[[str], World]
    """an effective world of its campaign, by its hash"""


def with_unlike(comparisons: list[Comparison], a: Folder, b: Folder) -> list[Comparison]:
    """Comparisons of two campaigns, each with all in which its cells differ beside their names.

    Raises PhysimError where a world's file cannot be read or is no world.
    """
    read_a, read_b = _reader(a), _reader(b)
    found = []
    for one in comparisons:
        sides = read_a(one.a.cell), read_b(one.b.cell)
        found.append(replace(one, unlike=tuple(_unlike(*sides))))
    return found


def _reader(folder: Folder) -> Callable[[Cell], _Side]:
    """What a campaign says of its cells; each of its worlds is read once."""
    described = {label_of(one): one for one in folder.cells()}

    @cache
    def world(world_hash: str) -> World:
        file = folder.world_file(world_hash)
        return parse_world(file_text(file), str(file), check_controller=False)

    return lambda cell: _Side(cell, described[cell.names], world)


def _unlike(a: _Side, b: _Side) -> Iterator[str]:
    """What differs and is not in the names of the cells, a text each."""
    if a.cell.world == b.cell.world:
        yield from _worlds(a, b)
    if a.described["source_hash"] != b.described["source_hash"]:
        yield from _sources(a, b)
    for what in ("physim", "engine"):
        one, other = a.described[what], b.described[what]
        if one != other:
            name = "" if what == "engine" else "physim "
            yield f"A was run by {name}{one}, B by {name}{other}"


def _sources(a: _Side, b: _Side) -> Iterator[str]:
    """What of one's own was changed, where the hashes of all sources of a run differ.

    Of what one side has alone nothing is said: that is what is compared.
    """
    one, other = _own(a), _own(b)
    both = " or ".join(sorted(one & other))
    settings = (set(side.cell.settings.split("; ")) for side in (a, b))
    varied = {key.split(".")[0] for key in map(plain_key, set.symmetric_difference(*settings))}
    if both and one == other and not varied & {"controller", *(kind.key[0] for kind in STAGES)}:
        yield f"the source of {both} was changed between them, or a file that its settings name"
    elif both:
        yield f"whether the source of {both} is the same in both is not known"


def _own(side: _Side) -> set[str]:
    """Controller and stages that came not with physim."""
    world = side.world(side.described["world_hash"])
    stages = {name for kind, name in own_parts(world) if kind in STAGES}
    return stages | {side.cell.controller} - set(shipped_parts(CONTROLLER))


def _worlds(a: _Side, b: _Side) -> Iterator[str]:
    """In which values two worlds of one name differ, but those that the settings give."""
    hashes = a.described["world_hash"], b.described["world_hash"]
    if hashes[0] == hashes[1]:
        return
    settings = [one for side in (a, b) for one in side.cell.settings.split("; ") if one]
    given = {*WORDS, *map(plain_key, settings)}
    if a.cell.controller != b.cell.controller:
        given.add("controller")
    found = {
        key: pair
        for key, pair in differences(a.world(hashes[0]), b.world(hashes[1])).items()
        if not any(key == one or key.startswith(f"{one}.") for one in given)
    }
    if not found:
        return
    told = [
        f"{key} {shortened(one, MOST_SHOWN)} in A, {shortened(other, MOST_SHOWN)} in B"
        for key, (one, other) in found.items()
    ]
    rest = len(told) - MOST_NAMED
    more = f"; and {rest} more" if rest > 0 else ""
    yield f"their worlds are not the same: {'; '.join(told[:MOST_NAMED])}{more}"


__all__ = ["with_unlike"]
