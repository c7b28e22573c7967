"""Entrants in worlds: who drives where, on which seeds, and what is kept of it in a folder.

A league is a campaign whose cells are a world and an entrant: a controller with settings, by a
name, that takes the place of the world's own. A world may refuse an entrant; that is told, too. The
folder keeps what ran, so that further entrants are placed among those that are there.
"""

from __future__ import annotations

import functools
import os
import platform
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from physim.campaigns.folder import CAMPAIGN, LEAGUE, read_tree
from physim.campaigns.grid import Grid, check_start
from physim.campaigns.rows import FINISHED, Row, told
from physim.campaigns.sources import Part, Source, files_named, modules_of, own_parts
from physim.campaigns.spec import Label, RunSpec, spec_of
from physim.errors import PhysimError, WorldError, nearest
from physim.files import write_text
from physim.json_text import json_text, plain
from physim.parts.registry import CONTROLLER, make_part
from physim.world.faults import faults_of
from physim.world.file import read_document, read_world
from physim.world.file.files import file_text, shipped_folder
from physim.world.kinds import MOST_SEED
from physim.world.layout.scene_builder import may_vary

FORMAT, VERSION = "physim-league", 1
STUCK = 10.0
"""[s] without an advance of any robot after which a run that did not finish is a deadlock"""
NAMED = CONTROLLER._replace(option="--controllers")
OUTCOMES = ("arrived", "contact", "deadlock", "timeout", "error")
"""What comes of a run: exactly one of these"""
FURTHER = "further worlds"
"""Group of worlds that the programme does not name"""
Text = Annotated[str, Field(min_length=1, max_length=200)]
Told = Literal["always", "formation", "never", ""]


class Entrant(BaseModel):
    """A controller with settings, by a name."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)
    name: Text = Field(description="what the entrant is called in tables")
    controller: Text = Field(description="registered name, or module:Class")
    settings: dict[str, Any] = Field(default={}, description="settings of the controller")
    about: str = Field(default="", description="where its settings are from, in a few words")
    told: Told = Field(
        default="",
        description="when it uses what robots tell one another, stations and commands: always, "
        "formation (only in one), never; empty where the controller does not say",
    )

    @property
    def is_own(self) -> bool:
        """Whether it is code that is run only when it is named."""
        return ":" in self.controller

    @property
    def values(self) -> str:
        """Its settings as the rows of its runs have them."""
        return "; ".join(f"controller.{key}={_flow(one)}" for key, one in self.settings.items())

    def label(self, world: str) -> Label:
        """Its cell in a world."""
        return world, self.values, self.controller


class Group(BaseModel):
    """Worlds that are told of together."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)
    name: Text = Field(description="what the worlds have in common")
    worlds: list[Text] = Field(description="files, or names of shipped worlds")


class Refusal(BaseModel):
    """A world that an entrant cannot drive in, and why."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)
    world: str
    entrant: str
    reason: str


class League(BaseModel):
    """A programme, as its file says it, and what is known of its runs, as a folder keeps it."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)
    entrants: list[Entrant] = Field(description="who takes part")
    groups: list[Group] = Field(description="where they drive")
    seeds: Annotated[list[Annotated[int, Field(ge=0, le=MOST_SEED)]],
                     Field(min_length=2, max_length=2)] = Field(
        description="the first seed, and the end, which is not run")  # fmt: skip
    reference: Text = Field(description="name of the entrant that all others are held against")
    null: str = Field(default="", description="name of the entrant that avoids nothing")
    budget: str = Field(default="", description="how settings were tuned, and at what cost")
    refused: list[Refusal] = []
    machines: list[str] = []

    @property
    def worlds(self) -> list[str]:
        """All worlds, in the order of groups."""
        return list(dict.fromkeys(world for group in self.groups for world in group.worlds))

    def entrant(self, name: str) -> Entrant | None:
        """The entrant of a name."""
        return next((one for one in self.entrants if one.name == name), None)


def outcome_of(row: Row) -> str:
    """What came of a run, one of `OUTCOMES`; a contact counts whether it arrived or not."""
    if row.failed:
        return "error"
    if not row.contact_free:
        return "contact"
    if row.ended == FINISHED:
        return "arrived"
    return "deadlock" if (row.standstill or 0.0) >= STUCK else "timeout"


def read_programme(file: Path | None) -> League:
    """The programme of a file, or the one that is shipped. Raises WorldError with every fault."""
    path = shipped_folder() / "league" / "league.yaml" if file is None else file
    document = read_document(file_text(path), str(path))
    try:
        if not isinstance(document.values, dict):
            raise PhysimError(f"{path}: needs the keys entrants, groups, seeds and reference")
        found = League(**document.values)
    except ValidationError as error:
        raise document.error(faults_of(error, League)) from None
    names = [one.name for one in found.entrants]
    if twice := next((name for name in names if names.count(name) > 1), ""):
        raise PhysimError(f"{path}: two entrants are called {twice}")
    if not found.seeds[0] < found.seeds[1]:
        raise PhysimError(f"{path}: seeds: the end must be above the first; given: {found.seeds}")
    for key, name in (("reference", found.reference), ("null", found.null)):
        if name and name not in names:
            raise PhysimError(
                f"{path}: {key}: no entrant is called {name}; allowed: {', '.join(names)}"
                f"{nearest(name, names)}"
            )
    return found


def read_league(folder: Path) -> League | None:
    """What a folder keeps of a league; None where there is none.

    Raises PhysimError for what cannot be read, and for a campaign that is no league.
    """
    try:
        tree = read_tree(folder / LEAGUE, FORMAT, VERSION)
    except NotADirectoryError:
        raise PhysimError(f"{folder}: is a file; a league is a folder") from None
    if tree is None:
        if (folder / CAMPAIGN).exists():
            raise PhysimError(
                f"{folder}: holds a campaign that is no league; give another folder (physim report "
                f"{folder} reports it)"
            )
        return None
    del tree["format"], tree["version"]
    try:
        return League(**tree)
    except (ValidationError, TypeError) as error:
        why = told(error) if isinstance(error, ValidationError) else str(error)
        raise PhysimError(f"{folder / LEAGUE}: cannot be read ({why})") from None


def write_league(folder: Path, league: League) -> None:
    """Keep a league in a folder, which is made. Raises PhysimError where that fails."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise PhysimError(f"{folder}: cannot be written: {error.strerror}") from None
    tree = {"format": FORMAT, "version": VERSION, **league.model_dump()}
    write_text(folder / LEAGUE, json_text(plain(tree)))


def chosen(league: League, names: Sequence[str]) -> list[Entrant]:
    """Entrants by their names, or controllers by theirs; without names all but code of one's own.

    Each says when it is told of others. Raises PhysimError where one cannot be had, with its name.
    """
    found = []
    for name in dict.fromkeys(names):
        by_code = (one for one in league.entrants if ":" in name and one.controller == name)
        found.append(league.entrant(name) or next(by_code, Entrant(name=name, controller=name)))
    found = found or [one for one in league.entrants if not one.is_own]
    made = []
    for one in found:
        known = [each.name for each in league.entrants]
        if one.is_own and one.controller not in names:
            raise PhysimError(
                f"entrant {one.name}: {one.controller} is code of one's own, which runs only where "
                f"the command line names it: --controllers {one.controller}"
            )
        try:
            part = make_part(NAMED, one.controller, one.settings, trusted=True)
        except WorldError as error:
            raise PhysimError(f"entrant {one.name}: {error}") from None
        except PhysimError as error:
            of = f"; entrants: {', '.join(known)}" if one.name not in known else ""
            raise PhysimError(f"--controllers {one.name}: {error}{of}") from None
        when = getattr(part, "told", "")
        if when not in ("always", "formation", "never", ""):
            raise PhysimError(
                f"entrant {one.name}: {one.controller}.told is {when!r}; allowed: always, "
                "formation, never"
            )
        made.append(one.model_copy(update={"told": when}))
    return made


class Cells(NamedTuple):
    """Who drives where."""

    grid: Grid
    refused: list[Refusal]


def cells_of(entrants: Sequence[Entrant], worlds: Iterable[str], seeds: range) -> Cells:
    """Runs of entrants in worlds, and the worlds that refuse some.

    Raises WorldError for a world that cannot be run at all, PhysimError for entrants that are the
    same, and where nobody can drive anywhere.
    """
    cells: dict[str, RunSpec] = {}
    fixed: set[int] = set()
    refused: list[Refusal] = []
    sources: dict[tuple[Part, ...], tuple[Source, ...]] = {}
    for given in worlds:
        itself, document = read_world(given)
        check_start(itself, document, seeds, ())
        for one in entrants:
            choice = _flow({"type": one.controller, **one.settings})
            try:
                world, _ = read_world(
                    given, overrides=[f"controller={choice}"], controller=one.controller
                )
            except WorldError as error:
                why = error.faults[0].message.partition("; ")[0]  # without what to do about it
                refused.append(Refusal(world=given, entrant=one.name, reason=why))
                continue
            own = own_parts(world)
            if own not in sources:
                sources[own] = modules_of(own)
            if not may_vary(world):
                fixed.add(len(cells))
            cell = spec_of(
                world, seeds[0] if may_vary(world) else world.seed, name=given,
                settings=one.values, sources=sources[own] + files_named(world),
            )  # fmt: skip
            if cells.setdefault(cell.key, cell) is not cell:
                raise PhysimError(f"entrant {one.name}: another has its controller and settings")
    if not cells:
        why = f": {refused[0].reason}" if refused else ""
        raise PhysimError(f"nothing to run: no world takes any of the entrants{why}")
    return Cells(Grid(tuple(cells.values()), seeds, frozenset(fixed)), refused)


def joined(before: League | None, now: League, refused: Sequence[Refusal]) -> League:
    """A league with what ran before and what is to run now, ``now`` with entrants and worlds.

    Raises PhysimError where an entrant of before has the name of another one now.
    """
    entrants = {one.name: one for one in (before.entrants if before else ())}
    for one in now.entrants:
        there = entrants.setdefault(one.name, one)
        if (there.controller, there.settings) != (one.controller, one.settings):
            raise PhysimError(
                f"entrant {one.name}: has another controller or other settings in the folder; give "
                "it another name, or another folder"
            )
        entrants[one.name] = one
    groups: dict[str, list[str]] = {}
    for group in (*(before.groups if before else ()), *now.groups):
        known = [world for worlds in groups.values() for world in worlds]
        new = [world for world in group.worlds if world not in known]
        groups.setdefault(group.name, []).extend(new)
    answered = {(one.world, one.entrant) for one in refused}
    kept = [one for one in (before.refused if before else ())
            if (one.world, one.entrant) not in answered]  # fmt: skip
    return now.model_copy(update={
        "entrants": list(entrants.values()),
        "groups": [Group(name=name, worlds=worlds) for name, worlds in groups.items() if worlds],
        "refused": [*kept, *refused],
        "machines": list(dict.fromkeys((*(before.machines if before else ()), machine()))),
    })  # fmt: skip


def placed(league: League, worlds: Sequence[str]) -> League:
    """The league in these worlds alone, each in its group; all of its own where none is given."""
    if not worlds:
        return league
    known = {world: group.name for group in league.groups for world in group.worlds}
    groups: dict[str, list[str]] = {}
    for world in dict.fromkeys(worlds):
        groups.setdefault(known.get(world, FURTHER), []).append(world)
    made = [Group(name=name, worlds=those) for name, those in groups.items()]
    return league.model_copy(update={"groups": made})


@functools.cache
def machine() -> str:
    """This machine, as far as it tells of times: processor, number of cores, Python."""
    name = platform.machine()
    try:
        with open("/proc/cpuinfo", encoding="utf-8", errors="replace") as lines:
            models = (line.partition(":")[2].strip() for line in lines if "model name" in line)
            name = next(models, name)
    except OSError:
        pass
    return f"{name}, {os.cpu_count()} cores, Python {platform.python_version()}"


def _flow(value: Any) -> str:
    """A value as YAML on one line."""
    text = yaml.safe_dump(value, default_flow_style=True, sort_keys=False, width=1 << 20)
    return text.strip().removesuffix("...").strip()
