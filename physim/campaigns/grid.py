"""Worlds x settings x controllers x seeds: the runs of a sweep, every fault of them told first."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from itertools import product
from typing import NamedTuple

from physim.campaigns.rows import installed
from physim.campaigns.sources import Part, Source, files_named, modules_of, own_parts
from physim.campaigns.spec import Label, RunSpec, key_of, spec_of
from physim.errors import ControllerError, PhysimError, WorldError, plain_key
from physim.escaping import escaped
from physim.parts.registry import CONTROLLER, find_part, settings_model
from physim.world import World
from physim.world.file import Document, read_world
from physim.world.file.files import stem_of
from physim.world.layout.scene_builder import build_scene, may_vary, seeds_note

MOST_RUNS = 1_000_000
"""Runs that are begun without being asked twice"""
MOST_EVER = 10_000_000
"""Runs of one folder: reports hold its rows in memory. Measured with 10,000 and 100,000: 1.1 kB
each, so that this many take 11 GB."""
MOST_CELLS = 10_000
ROW_BYTES, RUNS_A_SECOND = 820, 100
"""[bytes] of a row on disk, and the rate of a large machine, for estimates"""
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
    """All runs, seed by seed; a cell in which nothing is random is run once.

    No run is made before it is asked for: a grid takes the memory of its cells, whatever its seeds.
    """

    cells: tuple[RunSpec, ...]
    """one spec for each world, settings and controller"""
    seeds: range | None
    """None: each world with its own"""
    fixed: frozenset[int] = frozenset()
    """numbers of the cells in which nothing is random"""
    shard: Shard = WHOLE
    warnings: tuple[str, ...] = field(default=(), compare=False)
    """what is to be noted about the worlds, and metrics that cannot be used, a line each"""

    @property
    def asked(self) -> dict[Label, range]:
        """Seeds of each cell, of all shards; without those of which some are left out."""
        found = {cell.label: self._seeds(k) for k, cell in enumerate(self.cells)}
        return {label: seeds for label, seeds in found.items() if seeds.step == 1}

    def __len__(self) -> int:
        """Number of runs of this shard."""
        return sum(len(self._mine(k)) for k in range(len(self.cells)))

    def __iter__(self) -> Iterator[RunSpec]:
        """The runs of this shard."""
        drawn = [k for k in range(len(self.cells)) if k not in self.fixed]
        groups = [sorted(self.fixed)]
        groups += (drawn[k : k + TOGETHER] for k in range(0, len(drawn), TOGETHER))
        for group in filter(None, groups):
            mine = {k: self._mine(k) for k in group}
            for turn in range(len(self._seeds(group[0]))):
                for k in group:
                    if turn in mine[k]:
                        yield replace(self.cells[k], seed=self._seeds(k)[turn])

    def __contains__(self, spec: object) -> bool:
        """Whether a run is one of them."""
        return isinstance(spec, RunSpec) and self.has(spec.label, spec.seed, spec.key)

    def has(self, label: Label, seed: int, key: str) -> bool:
        """Whether the run of a cell and a seed is one of this shard, and is known by ``key``."""
        k = self._numbers.get(label)
        if k is None or seed not in (seeds := self._seeds(k)):
            return False
        return seeds.index(seed) in self._mine(k) and key_of(self._identities[k], seed) == key

    @cached_property
    def _numbers(self) -> dict[Label, int]:
        return {cell.label: k for k, cell in enumerate(self.cells)}

    @cached_property
    def _identities(self) -> list[str]:
        return [cell.identity for cell in self.cells]

    def _seeds(self, k: int) -> range:
        """Seeds of a cell, of all shards."""
        own = self.cells[k].seed
        return range(own, own + 1) if self.seeds is None or k in self.fixed else self.seeds

    def _mine(self, k: int) -> range:
        """Which of the seeds of a cell are of this shard."""
        number, of = self.shard
        return range((number - 1 + k) % of, len(self._seeds(k)), of)


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
    values = [settings_of(axis) for axis in axes]
    keys = [plain_key(axis) for axis in axes]
    if seeds is not None and "seed" in keys:
        raise PhysimError("--set seed: --seeds says which seeds are run; give one of them")
    if twice := next((key for key in keys if keys.count(key) > 1), None):
        raise PhysimError(f"--set {twice}: given twice; write --set {twice}=V1,V2")
    chosen: list[str | None] = [*dict.fromkeys(controllers)] or [None]
    count = len(names) * math.prod(map(len, values)) * len(chosen)
    _check_count(count, 1 if seeds is None else len(seeds), most)
    warnings: dict[str, None] = dict.fromkeys(installed().faults)
    combinations = list(product(names.items(), product(*values), chosen))
    if any(key.startswith("controller.") and key != "controller.type" for key in keys):
        combinations, note = _given_to_those_that_have(combinations)
        warnings |= note
    cells: dict[str, RunSpec] = {}
    fixed: set[int] = set()
    sources: dict[tuple[Part, ...], tuple[Source, ...]] = {}
    for (name, given), overrides, controller in combinations:
        try:
            world, document = read_world(given, overrides=overrides, controller=controller)
        except WorldError as error:
            one_of_several = (name if len(names) > 1 else "", controller if chosen[1:] else "")
            raise _of_cell(error, *one_of_several) from None
        warnings |= dict.fromkeys(document.lines(document.warnings))
        check_start(world, document, seeds, overrides)
        own = own_parts(world)
        if own not in sources:
            sources[own] = modules_of(own)
        seed = world.seed if seeds is None or not may_vary(world) else seeds[0]
        if not may_vary(world):
            fixed.add(len(cells))
        elif seeds is not None and (note_ := seeds_note(world)):
            warnings[f"{name}: {note_}"] = None
        cell = spec_of(
            world, seed, name=name, settings="; ".join(overrides),
            sources=sources[own] + files_named(world), limit=limit,
        )  # fmt: skip
        if (same := cells.setdefault(cell.key, cell)) is not cell:
            one, other = (", ".join(filter(None, each.label)) for each in (same, cell))
            raise PhysimError(
                f"{one} and {other} are the same world and controller, so that their runs would be "
                "the same; leave one of them out"
            )
    return Grid(tuple(cells.values()), seeds, frozenset(fixed), shard, tuple(warnings))


Combination = tuple[tuple[str, str], tuple[str, ...], str | None]
"""Name and file of a world, settings, controller"""


def _given_to_those_that_have(
    combinations: Sequence[Combination],
) -> tuple[list[Combination], dict[str, None]]:
    """Combinations without the settings that their controllers have not, and a note of these.

    A setting that no controller has stays with all: reading the worlds refuses it.
    """

    @cache
    def settings(given: str, name: str | None) -> tuple[str, frozenset[str] | None]:
        name = name or read_world(given)[0].controller.type
        try:
            model = settings_model(find_part(CONTROLLER, name, trusted=True))
        except ControllerError:
            return name, None  # which reading the world refuses
        return name, frozenset(() if model is None else model.model_fields)

    def lacks(combination: Combination, one: str) -> str:
        """The controller that has not what a setting sets; empty where it has, or it is no such."""
        (_, given), overrides, controller = combination
        first, *key = plain_key(one).split(".")
        if first != "controller" or key[:1] in ([], ["type"]):
            return ""
        types = (one.partition("=")[2] for one in overrides if plain_key(one) == "controller.type")
        name, known = settings(given, controller or next(types, None))
        return "" if known is None or key[0] in known else name

    pairs = [(each, one) for each in combinations for one in each[1]]
    having = {plain_key(one) for each, one in pairs if not lacks(each, one)}
    lacking: dict[str, set[str]] = {}
    for each, one in pairs:
        if plain_key(one) in having and (name := lacks(each, one)):
            lacking.setdefault(plain_key(one), set()).add(name)
    found: dict[Combination, None] = {}
    for each in combinations:
        left = (one for one in each[1] if plain_key(one) not in having or not lacks(each, one))
        found[each[0], tuple(left), each[2]] = None
    return list(found), {
        f"--set {path}: not given to {', '.join(sorted(those))}, which has no such setting": None
        for path, those in lacking.items()
    }


def _check_count(cells: int, seeds: int, most: int | None) -> None:
    """Raise PhysimError where there are no runs, or more than may be, before any is made."""
    count = cells * seeds
    if not count:
        raise PhysimError("nothing to run: no worlds, seeds or values")
    if count > MOST_EVER:
        days, size = count / RUNS_A_SECOND / 86400, count * ROW_BYTES / 1e9
        raise PhysimError(
            f"{count:,} runs: at {RUNS_A_SECOND} a second they would take {days:,.3g} days, and "
            f"their rows {size:,.0f} GB; allowed: at most {MOST_EVER:,} in a folder"
        )
    if cells > MOST_CELLS:
        raise PhysimError(
            f"{cells:,} combinations of worlds, values and controllers; allowed: at most "
            f"{MOST_CELLS:,} in a folder"
        )
    if most is not None and count > most:
        raise PhysimError(f"{count:,} runs; --yes runs more than {most:,}")


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
    """What is given of each world by what it is called: the stem of its file, where one has it.

    What no line of text can hold is written out: line ends, bytes that are not UTF-8. Raises
    PhysimError for two that are then called alike.
    """
    given = list(dict.fromkeys(worlds))
    stems = [stem_of(one) for one in given]
    found: dict[str, str] = {}
    for stem, one in zip(stems, given, strict=True):
        name = stem if stems.count(stem) == 1 else escaped(one)
        if name in found:
            raise PhysimError(f"{name}: two worlds are called so; rename one of their files")
        found[name] = one
    return found


def _of_cell(error: WorldError, world: str, controller: str | None) -> WorldError:
    """The faults of a cell; those of ``--set`` with its world and controller, where given.

    A line of a file says by itself which world it is of.
    """
    words = [f"in {world}"] if world else []
    words += [f"with {controller}"] if controller else []
    if not words or not error.positions:  # a file that is not there has no places
        return error
    of = f" ({' '.join(words)})"
    return WorldError(
        [
            replace(fault, message=fault.message + of) if str(place).startswith("--set ") else fault
            for fault, place in zip(error.faults, error.positions, strict=True)
        ],
        list(error.positions),
    )


def check_start(
    world: World, document: Document, seeds: range | None, overrides: Sequence[str]
) -> None:
    """Raise WorldError where a world cannot be run, whatever the seed; with what makes it so."""
    tried = [world.seed] if seeds is None or not may_vary(world) else seeds[:TRIES]
    for k, seed in enumerate(tried):
        try:
            build_scene(world, seed)
            return
        except WorldError as error:
            if k == len(tried) - 1:
                one_of = [*overrides, *([] if seeds is None else [f"seed {seed}"])]
                of = f" (with {', '.join(one_of)})" if one_of else ""
                faults = [replace(one, message=one.message + of) for one in error.faults]
                raise document.error(faults) from None
