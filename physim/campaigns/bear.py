"""How much a world can bear: the strength at which the rate of good runs falls below a target.

A number of the world, the strength, is varied over a grid from ``least`` to ``most``. At each
strength that is tried, runs of seed after seed are held against the target by a confidence sequence
(`physim.statistics`), which may be looked at after every run. It ends at a strength as soon as the
interval of the rate lies above the target (the target is *met*) or below it (*missed*), and is
*open* where the seeds come to their end first. A bisection chooses the strengths, and goes on on
both sides of strengths that are open, until the ends of the bracket are neighbours in the grid or
next to an open strength.

**What is sure.** Of a grid of n strengths, each interval errs with at most ``(1 - confidence) /
n``, so that, with at least ``confidence``, the intervals of all strengths hold their true rates at
all looks at once (Bonferroni's bound over the grid, Ville's over the looks). It follows that the
rate is at least the target at ``lower`` and below it at ``upper``: in whatever order strengths were
chosen, though all have the same seeds, and whatever the shape of the curve. A bound over the
strengths that are tried alone would need fewer runs, but the seeds that choose the next strength
could not be used there again.

**What is assumed.** That seeds are independent of one another; and that the rate falls as the
strength grows, for the bracket to hold the only place where it crosses the target. Without that it
holds one such place, and there may be others below ``lower`` or above ``upper``. A rise that two
intervals show is told; a search that looks at a few strengths can miss one.

**The same seeds** at every strength make runs comparable: seed 7 goes well at 0.2 and fails at 0.3.
The answer depends on the outcomes in the order of seeds alone, never on the number of workers.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any, get_args

import yaml
from pydantic import BaseModel

from physim.campaigns.grid import settings_of
from physim.errors import PhysimError, WorldError, nearest, plain_key
from physim.parts.registry import STAGES, Kind, find_part, part_names, settings_model
from physim.statistics import Decision, Goal
from physim.world import World
from physim.world.file import read_world

UNIT = re.compile(r"\[[^\]]+\]")
CELLS = 32
"""Steps of the grid from the least to the greatest strength, where no precision is given"""
MOST_STRENGTHS = 200
"""Steps of a grid: each makes a world before the first run"""
DIGITS = 12
"""Significant digits of a strength: 0.3, not 0.30000000000000004"""


# The search


def next_strength(known: Mapping[int, Decision], last: int) -> int | None:
    """Number of the strength to try next, from 0 to ``last``, given what is known of others.

    First both ends; then the middle of the widest gap that the bracket leaves; None where there is
    none, or where an end says that there is nothing to search for.
    """
    if 0 not in known:
        return 0
    if known[0].holds is False:
        return None
    if last not in known:
        return last
    lower, upper = bracket(known)
    if known[last].holds or (lower is None and upper is None):
        return None
    ends = sorted(k for k in known if (lower or 0) <= k <= (last if upper is None else upper))
    gaps = [ends[:2]] * (lower is not None) + [ends[-2:]] * (upper is not None)
    wide, begin = max((end - begin, begin) for begin, end in gaps)
    return begin + wide // 2 if wide > 1 else None


def bracket(known: Mapping[int, Decision]) -> tuple[int | None, int | None]:
    """Greatest strength at which the target is met, and the least at which it is missed."""
    met = [k for k, one in known.items() if one.holds]
    missed = [k for k, one in known.items() if one.holds is False]
    return max(met, default=None), min(missed, default=None)


def each_confidence(confidence: float, strengths: int) -> float:
    """Confidence of one strength's interval, with which all of them hold with ``confidence``."""
    return 1.0 - (1.0 - confidence) / strengths


# The result


@dataclass(frozen=True)
class Borne:
    """How much of a strength a world bears."""

    world: str
    controller: str
    vary: str
    """what was varied, as it was given"""
    goal: Goal
    confidence: float
    strengths: tuple[float, ...]
    """the grid, from the least to the greatest"""
    known: Mapping[int, Decision]
    """by the numbers of the strengths that were tried; their intervals hold together"""
    interrupted: bool
    unit: str = ""
    """of the strength, as `unit_of` gives it"""

    @property
    def tried(self) -> list[tuple[float, Decision]]:
        """Strengths that were tried, in ascending order, and what came of the target there."""
        return [(self.strengths[k], one) for k, one in sorted(self.known.items())]

    @property
    def bracket(self) -> tuple[float | None, float | None]:
        """Greatest strength that meets the target, least that misses it; None where none does."""
        lower, upper = bracket(self.known)
        return (
            None if lower is None else self.strengths[lower],
            None if upper is None else self.strengths[upper],
        )

    @property
    def rises(self) -> list[tuple[float, float]]:
        """Pairs of strengths of which the stronger has the higher rate, as intervals show."""
        pairs = combinations(self.tried, 2)
        return [(weak, strong) for (weak, a), (strong, b) in pairs if b.low > a.high]


# What is varied


@dataclass(frozen=True)
class Varied:
    """A number of a world to be varied, and the values that it takes."""

    key: str
    """of the world, where the values are put"""
    values: tuple[str, ...]
    """as ``--set KEY=VALUE`` takes them, one for each strength"""
    strengths: tuple[float, ...]

    @property
    def axis(self) -> str:
        """``KEY=V1,V2,…``, as `physim.campaigns.grid.make_grid` takes it."""
        return f"{self.key}={','.join(self.values)}"


def varied(
    given: str, vary: str, least: float, most: float, precision: float | None,
    overrides: Sequence[str], controller: str | None,
) -> Varied:  # fmt: skip
    """Find what ``vary`` names in a world, and the grid of its strengths.

    It is a key of the world, or ``TYPE.SETTING`` of a registered stage: the one of that type in the
    world, or one that is added behind the others with that setting alone. Where the world takes
    whole numbers alone, all strengths are whole. Raises WorldError and ControllerError where the
    world refuses one of the ends, and PhysimError for what cannot be found or may be meant in
    several ways, and for a grid of no or too many strengths.
    """
    if most <= least:
        raise PhysimError(f"--most {most:g}: must be above --least, which is {least:g}")
    step = (most - least) / CELLS if precision is None else precision
    if (most - least) / step > MOST_STRENGTHS:
        raise PhysimError(
            f"--precision {step:g}: must be at least {(most - least) / MOST_STRENGTHS:g}, a "
            f"{MOST_STRENGTHS}th of what lies between --least and --most"
        )
    for one in overrides:
        if len(settings_of(one)) > 1:
            raise PhysimError(f"--set {plain_key(one)}: takes one value; --vary is what varies")
    _, document = read_world(given, overrides=overrides, controller=controller)
    key, before, path = _place(vary, document.values)
    if key in map(plain_key, overrides) or key == "seed":
        other = "--seeds gives the seeds" if key == "seed" else "it is also given by --set"
        raise PhysimError(f"--vary {vary}: {other}")

    def value(strength: float) -> str:
        found: Any = int(strength) if strength.is_integer() else strength
        if path:
            for name in reversed(path[1:]):
                found = {name: found}
            found = [*before, {"type": path[0], **found}]
        text: str = yaml.safe_dump(
            found, default_flow_style=True, sort_keys=False, allow_unicode=True, width=math.inf
        )
        return text.removesuffix("...\n").strip()

    def read(strength: float, option: str = "") -> None:
        with named(vary, key, f" ({option} {strength:g})"):
            override = f"{key}={value(strength)}"
            read_world(given, overrides=[*overrides, override], controller=controller)

    read(most, "--most")
    read(least, "--least")
    count = math.ceil((most - least) / step - 1e-9)
    if most.is_integer() and least.is_integer():
        try:
            read(least + (most - least) / math.pi)
        except WorldError:  # it takes whole numbers alone
            count = min(count, round(most - least))
            strengths = [float(round(least + (most - least) * k / count)) for k in range(count + 1)]
            return Varied(key, tuple(map(value, strengths)), tuple(strengths))
    strengths = [
        float(f"{least + (most - least) * k / count:.{DIGITS}g}") for k in range(count + 1)
    ]
    return Varied(key, tuple(map(value, strengths)), tuple(strengths))


def unit_of(vary: str) -> str:
    """``[m]``: what the description of a varied key or setting begins with; empty without one."""
    model: type[BaseModel] | None = World
    keys, said = plain_key(vary).split("."), ""
    if keys[0] not in World.model_fields:
        kind = next(kind for kind in STAGES if keys[0] in part_names(kind))
        model, keys = settings_model(find_part(kind, keys[0])), keys[1:]
    for key in (key for key in keys if not key.isdecimal()):
        if model is None or key not in model.model_fields:
            return ""
        field = model.model_fields[key]
        said, model = field.description or "", _model_in(field.annotation)
    found = UNIT.match(said)
    return found[0] if found else ""


def _model_in(kind: Any) -> type[BaseModel] | None:
    """The first model in the type of a key: that of the entries of a list."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return kind
    return next(filter(None, map(_model_in, get_args(kind))), None)


@contextmanager
def named(vary: str, key: str, value: str = "") -> Iterator[None]:
    """Faults of what is varied have ``--vary`` as their place, not the ``--set`` that it became."""
    try:
        yield
    except WorldError as error:
        places = [
            replace(at, option=f"--vary {vary}{value}") if at.option == f"--set {key}" else at
            for at in error.positions
        ]
        raise WorldError(list(error.faults), places) from None


def _place(vary: str, values: Mapping[str, Any]) -> tuple[str, list[Any], list[str]]:
    """Key of the world that is set; where a stage is added, those before it, its type and setting.

    A key of the world comes first where a stage has the name of one.
    """
    plain = plain_key(vary)
    head, *rest = plain.split(".")
    if head in World.model_fields:
        return plain, [], []
    names = {kind: part_names(kind) for kind in STAGES}
    kinds = [kind for kind in STAGES if head in names[kind]]
    if not kinds:
        known = [*World.model_fields, *(name for some in names.values() for name in some)]
        raise PhysimError(
            f"--vary {vary}: {head} is no key of a world and no registered stage"
            f"{nearest(head, known)}"
        )
    if not rest:
        model = settings_model(find_part(kinds[0], head))
        settings = ", ".join(
            f"{head}.{name}" for name in ({} if model is None else model.model_fields)
        )
        raise PhysimError(
            f"--vary {vary}: is a {kinds[0].word}; write one of its settings: {settings}"
        )
    found = [
        f"{'.'.join(map(str, kind.key))}.{k}"
        for kind in kinds
        for k, stage in enumerate(_listed(values, kind))
        if isinstance(stage, Mapping) and stage.get("type") == head
    ]
    if len(found) > 1:
        choices = " or ".join(".".join([one, *rest]) for one in found)
        raise PhysimError(f"--vary {vary}: the world has {len(found)} of {head}; write {choices}")
    if found:
        return ".".join([found[0], *rest]), [], []
    if len(kinds) > 1:
        words = " and a ".join(kind.word for kind in kinds)
        keys = " or ".join(".".join(map(str, kind.key)) for kind in kinds)
        raise PhysimError(
            f"--vary {vary}: {head} is a {words}; add the one that you mean to the world, in {keys}"
        )
    return ".".join(map(str, kinds[0].key)), _listed(values, kinds[0]), [head, *rest]


def _listed(values: Mapping[str, Any], kind: Kind) -> list[Any]:
    """Stages of a kind, as a world lists them."""
    found: Any = values
    for key in kind.key:
        found = found.get(key, {})
    return list(found)
