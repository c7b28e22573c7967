"""What one run is: all that decides its outcome, as a value that can be sent to a worker."""

from __future__ import annotations

import functools
import hashlib
from dataclasses import dataclass
from importlib.metadata import version
from math import inf

import numpy as np

from physim._version import __version__
from physim.campaigns.sources import Source, source_hash, sources_of
from physim.errors import PhysimError
from physim.world import World
from physim.world.kinds import MOST_SEED
from physim.world.layout.scene_builder import seeds_draw

LEAST_LIMIT = 120.0
"""[s] that every run may take"""
STEP_LIMIT = 1e-3
"""[s] that a run may take beside for each robot and physics step: some hundred times as long as the
shipped controllers"""
MOST_LIMIT = 1e7
"""[s] that a run may be limited to: some months"""
KEY_DIGITS = 20
HASH_DIGITS = 12

Label = tuple[str, str, str]
"""World, settings and controller of a cell, as its rows have them"""


@dataclass(frozen=True)
class RunSpec:
    """One run: an effective world, a seed, and the source of parts of one's own."""

    text: str
    """the effective world as YAML, controller and settings included, with the seed 0"""
    seed: int
    world: str
    """what the world is called in results"""
    settings: str = ""
    """ "key=value; key=value" that make it another world than the one called so"""
    controller: str = ""
    """registered name, or ``module:Class``"""
    sources: tuple[Source, ...] = ()
    limit: float | None = None
    """[s] after which the run is given up, inf never; no part of what the run is"""
    draws: str = ""
    """what the seed draws, in words; no part of what the run is"""

    def __post_init__(self) -> None:
        """Refuse what no row could hold; a whole number of numpy is one of Python's then."""
        seed, limit = self.seed, self.limit
        whole = isinstance(seed, int | np.integer) and not isinstance(seed, bool)
        if not whole or not 0 <= seed <= MOST_SEED:
            raise PhysimError(f"seed {seed!r}: must be a whole number from 0 to {MOST_SEED:.0e}")
        object.__setattr__(self, "seed", int(seed))
        for key in ("text", "world", "settings", "controller"):
            text = getattr(self, key)
            if not isinstance(text, str) or text.encode(errors="replace").decode() != text:
                raise PhysimError(f"{key} {text!r}: must be text that can be written")
        number = isinstance(limit, float | int | np.integer | np.floating)
        if limit is not None and (
            not number
            or isinstance(limit, bool | np.timedelta64)
            or not (0.0 < limit <= MOST_LIMIT or limit == inf)
        ):
            raise PhysimError(
                f"limit {limit!r}: must be a number of seconds above 0, at most {MOST_LIMIT:.0e}, "
                "or inf for none"
            )

    @property
    def timer(self) -> float | None:
        """[s] after which a worker gives it up; None for none."""
        return None if self.limit is None or self.limit == inf else float(self.limit)

    @property
    def world_hash(self) -> str:
        """Short hash of the effective world without its seed."""
        return short_hash(self.text)

    @property
    def source_hash(self) -> str:
        """Short hash of the source of controller and stages; empty where all come with physim."""
        return source_hash(self.sources)

    @property
    def code(self) -> str:
        """Whose code it runs beside that of physim; empty where all comes with physim."""
        return f"{self.controller} {self.source_hash}" if self.sources else ""

    @property
    def key(self) -> str:
        """20 hex digits by which the run is known: of world, seed, controller and versions."""
        return key_of(self.identity, self.seed)

    @property
    def identity(self) -> str:
        """Hash of all that its key is made of but the seed."""
        return identity_of(self.text, self.controller, self.source_hash, __version__, engine())

    @property
    def label(self) -> Label:
        """World, settings and controller: the cell that it belongs to."""
        return self.world, self.settings, self.controller

    @property
    def note(self) -> str:
        """A few words for people."""
        changed = f" with {self.settings}" if self.settings else ""
        return f"{self.world}{changed}, {self.controller}, seed {self.seed}"


def key_of(identity: str, seed: int) -> str:
    """Key of the run of an identity with a seed."""
    return hashlib.sha256(f"{identity}\0{seed}".encode()).hexdigest()[:KEY_DIGITS]


def spec_of(
    world: World,
    seed: int,
    *,
    name: str | None = None,
    settings: str = "",
    sources: tuple[Source, ...] | None = None,
    limit: float | None = None,
) -> RunSpec:
    """Run of a world, whose controller may be ``module:Class``; ``sources`` where they are known.

    Raises ControllerError where the source of its controller or of a stage cannot be had, and
    PhysimError for a seed, name, settings or limit that are none.
    """
    controller = world.controller.type
    if sources is None:
        sources = sources_of(world)
    return RunSpec(
        world.changed(seed=0).to_yaml(), seed, world.stem if name is None else name, settings,
        controller, sources, usual_limit(world) if limit is None else limit, seeds_draw(world),
    )  # fmt: skip


def usual_limit(world: World) -> float:
    """[s] that a run of a world may take, where nothing else is said."""
    return LEAST_LIMIT + STEP_LIMIT * world.robot_count * world.time.steps


@functools.cache
def engine() -> str:
    """The engine and its version."""
    return f"pymunk {version('pymunk')}"


@functools.lru_cache(maxsize=64)
def short_hash(text: str) -> str:
    """Hash of an effective world, by which its file is called."""
    return hashlib.sha256(text.encode()).hexdigest()[:HASH_DIGITS]


@functools.lru_cache(maxsize=64)
def identity_of(*parts: str) -> str:
    """Hash of an effective world, a controller's name and source, and both versions."""
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()
