"""Worlds x settings x controllers x seeds: the runs of a sweep, every fault of them told first."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from pathlib import Path
from typing import NamedTuple

from physim.campaigns.sources import Source, sources_of
from physim.campaigns.spec import RunSpec, spec_of
from physim.errors import PhysimError, WorldError
from physim.parts.registry import CONTROLLER, shipped_parts
from physim.world import World
from physim.world.file import Document, located, read_world, warning_lines
from physim.world.layout.scene_builder import build_scene, is_random

MOST_RUNS = 1_000_000
"""Runs that are begun without being asked twice"""
TOGETHER = 16
"""Cells that are gone through side by side, seed by seed: workers have so many worlds ready"""
TRIES = 3
"""Seeds with which robots are placed before a world is refused"""


class Shard(NamedTuple):
    """Part of a grid for one of several machines."""

    number: int
    """from 1"""
    of: int


WHOLE = Shard(1, 1)


@dataclass(frozen=True)
class Grid(Collection[RunSpec]):
    """All runs, seed by seed; a cell in which nothing is random is run once."""

    cells: tuple[RunSpec, ...]
    """one spec for each world, settings and controller"""
    seeds: range | None
    """None: each world with its own"""
    fixed: frozenset[int] = frozenset()
    """numbers of the cells in which nothing is random"""
    shard: Shard = WHOLE
    warnings: tuple[str, ...] = field(default=(), compare=False)
    """what is to be noted about the worlds, a line each"""

    @property
    def total(self) -> int:
        """Number of runs of all shards."""
        drawn = 1 if self.seeds is None else len(self.seeds)
        return len(self.fixed) + drawn * (len(self.cells) - len(self.fixed))

    def __len__(self) -> int:
        """Number of runs of this shard."""
        return len(range(self.shard.number - 1, self.total, self.shard.of))

    def __iter__(self) -> Iterator[RunSpec]:
        """The runs of this shard."""
        for k, spec in enumerate(self._all()):
            if k % self.shard.of == self.shard.number - 1:
                yield spec

    def __contains__(self, spec: object) -> bool:
        """Whether a run is one of them."""
        return any(spec == one for one in self)

    def _all(self) -> Iterator[RunSpec]:
        yield from (self.cells[k] for k in sorted(self.fixed))
        drawn = [cell for k, cell in enumerate(self.cells) if k not in self.fixed]
        if self.seeds is None:
            yield from drawn
            return
        for first in range(0, len(drawn), TOGETHER):
            group = drawn[first : first + TOGETHER]
            for seed in self.seeds:
                yield from (replace(cell, seed=seed) for cell in group)


def make_grid(
    worlds: Sequence[str],
    seeds: range | None,
    axes: Sequence[str] = (),
    controllers: Sequence[str] = (),
    limit: float | None = None,
    shard: Shard = WHOLE,
    most: int | None = MOST_RUNS,
) -> Grid:
    """Runs of worlds, given as files or shipped names.

    ``axes`` are ``KEY=V1,V2,…`` each; ``controllers`` names or ``module:Class``, those of the
    worlds where empty; ``limit`` [s] of each run. Raises WorldError with all faults of a world,
    ControllerError, and PhysimError where there are more than ``most`` runs or none.
    """
    names = _named(worlds)
    changes = list(product(*(settings_of(axis) for axis in axes)))
    keys = [axis.partition("=")[0].strip() for axis in axes]
    if twice := next((key for key in keys if keys.count(key) > 1), None):
        raise PhysimError(f"--set {twice}: given twice; write --set {twice}=V1,V2")
    chosen: list[str | None] = [*dict.fromkeys(controllers)] or [None]
    count = len(names) * len(changes) * len(chosen) * (1 if seeds is None else len(seeds))
    if not count:
        raise PhysimError("nothing to run: no worlds, seeds or values")
    if most is not None and count > most:
        raise PhysimError(f"{count:,} runs; --yes runs more than {most:,}")
    cells: list[RunSpec] = []
    fixed: set[int] = set()
    warnings: dict[str, None] = {}
    sources: dict[str, tuple[Source, ...]] = {}
    for (name, given), overrides, controller in product(names.items(), changes, chosen):
        world, document = read_world(given, overrides=overrides, controller=controller)
        warnings |= dict.fromkeys(warning_lines(document))
        _check(world, document, seeds)
        choice = world.controller.type
        if choice not in sources:
            shipped = choice in shipped_parts(CONTROLLER)
            sources[choice] = () if shipped else sources_of(choice)
        seed = world.seed if seeds is None or not is_random(world) else seeds[0]
        if not is_random(world):
            fixed.add(len(cells))
        cells.append(
            spec_of(
                world,
                seed,
                name=name,
                settings="; ".join(overrides),
                sources=sources[choice],
                limit=limit,
            )
        )
    return Grid(tuple(cells), seeds, frozenset(fixed), shard, tuple(warnings))


def settings_of(axis: str) -> list[str]:
    """``KEY=VALUE`` for each value of ``KEY=V1,V2,…``; commas within brackets part nothing."""
    key, equals, text = axis.partition("=")
    if not equals:
        return [axis]  # which reading the world refuses
    values, depth, quote, begin = [], 0, "", 0
    for k, sign in enumerate(text):
        if quote:
            quote = "" if sign == quote else quote
        elif sign in "\"'":
            quote = sign
        elif sign in "[{(":
            depth += 1
        elif sign in "]})":
            depth -= 1
        elif sign == "," and not depth:
            values.append(text[begin:k])
            begin = k + 1
    values.append(text[begin:])
    return list(dict.fromkeys(f"{key.strip()}={value.strip()}" for value in values))


def _named(worlds: Sequence[str]) -> dict[str, str]:
    """What is given of each world by what it is called: the stem of its file, where one has it."""
    given = list(dict.fromkeys(worlds))
    stems = [Path(one).stem for one in given]
    return {
        stem if stems.count(stem) == 1 else one: one for stem, one in zip(stems, given, strict=True)
    }


def _check(world: World, document: Document, seeds: range | None) -> None:
    """Raise WorldError where a world cannot be run, whatever the seed."""
    tried = [world.seed] if seeds is None or not is_random(world) else seeds[:TRIES]
    for k, seed in enumerate(tried):
        try:
            build_scene(world, seed)
            return
        except WorldError as error:
            if k == len(tried) - 1:
                raise located(error.faults, document) from None


__all__ = ["MOST_RUNS", "Grid", "Shard", "make_grid", "settings_of"]
