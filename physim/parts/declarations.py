"""What a controller declares of itself: its modes, the rules it decides by, what it reports.

Everything that shows a run (record, summary, pictures) takes names, colours and units from here,
so a controller of one's own is shown like the shipped one. No mode says whether a run succeeds:
arrival is judged from the motion alone.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from physim.errors import ControllerError
from physim.parts.user_code import naming

NO_NUMBER = -1
"""In tables, the mode or rule of a decision that gave none."""
MOST_MODES = 100
"""Modes, rules or columns of one controller."""


@dataclass(frozen=True)
class Mode:
    """A mode of a controller. ``name`` is a word; ``colour`` is ``#rrggbb``."""

    name: str
    colour: str
    words: str = ""
    """as people read it; the name where it is empty"""
    danger: bool = False
    """whether the robot keeps clear of something: such decisions make the share of danger mode"""

    def __str__(self) -> str:
        """Words that people read."""
        return self.words or self.name


@dataclass(frozen=True)
class Rule:
    """A rule by which decisions are made, e.g. an equation."""

    name: str
    words: str = ""

    def __str__(self) -> str:
        """Words that people read."""
        return self.words or self.name


@dataclass(frozen=True)
class Column:
    """A number that a controller reports with its decisions; NaN where a decision leaves it out."""

    name: str
    unit: str = "-"
    words: str = ""


SAFE = Mode("safe", "#0072b2", "safe")
BY_DISTANCE = Mode("danger_distance", "#e69f00", "danger, by distance", danger=True)
BY_TIME = Mode("danger_time", "#882255", "danger, by collision time", danger=True)
AT_STOP = Mode("arrived", "#009e73", "arrived")
PAPER_MODES = (SAFE, BY_DISTANCE, BY_TIME, AT_STOP)
"""Modes of the paper's controller, in the colours of Okabe and Ito (2008)."""

STANDARD_COLUMNS = (
    Column("target_x", "m", "point steered to"),
    Column("target_y", "m", "point steered to"),
    Column("distance", "m", "smallest distance to a considered robot; inf without any"),
    Column("boundary_distance", "m", "smallest distance to a boundary or obstacle in range"),
    Column(
        "collision_time",
        "s",
        "smallest collision time under the new command with considered robots and boundaries; "
        "inf when there is none within the controller's horizon",
    ),
    Column("evaluations", "-", "collision times worked out"),
)
"""Columns whose meaning is fixed: whoever declares one must mean this, and it is checked."""

_NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")
_COLOUR = re.compile(r"#[0-9a-fA-F]{6}")


@dataclass(frozen=True)
class Declared:
    """All that a controller declares, checked; numbers in tables count in these tuples."""

    modes: tuple[Mode, ...] = ()
    rules: tuple[Rule, ...] = ()
    columns: tuple[Column, ...] = ()

    @classmethod
    def of(cls, controller: object) -> Declared:
        """Declarations of a controller: its attributes ``modes``, ``rules`` and ``columns``.

        Raises ControllerError for what is no such thing, for names given twice, and for a standard
        column with another unit, with the line of the class; for what raises as it is read, too.
        """
        name = type(controller).__name__
        with naming(f"controller {name}", type(controller)):
            return cls._of(controller)

    @classmethod
    def _of(cls, controller: object) -> Declared:
        declared = cls(
            *(
                _declared(controller, key, kind)
                for key, kind in (("modes", Mode), ("rules", Rule), ("columns", Column))
            )
        )
        for mode in declared.modes:
            if not _COLOUR.fullmatch(mode.colour):
                raise ControllerError(
                    f'modes: colour of "{mode.name}" is {mode.colour!r}; it must be #rrggbb'
                )
        standard = {column.name: column for column in STANDARD_COLUMNS}
        for column in declared.columns:
            if column.name in RESERVED:
                raise ControllerError(
                    f'columns: "{column.name}" is written for every decision anyway'
                )
            meant = standard.get(column.name)
            if meant is not None and meant.unit != column.unit:
                raise ControllerError(
                    f'columns: "{column.name}" has the unit {column.unit!r}; the standard '
                    f"column has {meant.unit!r}: use it, or another name"
                )
        return declared


RESERVED = frozenset(
    (
        "step", "robot", "mode", "rule", "nominal_v", "nominal_omega", "applied_v",
        "applied_omega", "station", "reference_station", "formation_error", "deviation",
        "considered", "next_step",
    )
)  # fmt: skip
"""Columns that the record writes itself."""


def _declared(controller: object, key: str, kind: type) -> tuple:  # type: ignore[type-arg]
    given = getattr(controller, key, ())
    if not isinstance(given, tuple | list) or not all(isinstance(one, kind) for one in given):
        raise ControllerError(f"{key} must be a tuple of {kind.__name__}(...)")
    if len(given) > MOST_MODES:
        raise ControllerError(f"{key} has {len(given)} entries; at most {MOST_MODES} are allowed")
    names = [one.name for one in given]
    for name in names:
        if not isinstance(name, str) or not _NAME.fullmatch(name):
            raise ControllerError(
                f"{key}: name {name!r}; allowed: 1 to 40 lower-case letters, digits and _, a "
                "letter first"
            )
        if names.count(name) > 1:
            raise ControllerError(f'{key}: "{name}" is declared {names.count(name)} times')
    for one in given:
        words = getattr(one, "words", "") + getattr(one, "unit", "")
        if not isinstance(words, str) or not words.isprintable() or len(words) > 300:
            raise ControllerError(f'{key}: words of "{one.name}" must be one line of plain text')
    return tuple(given)


def agreement_of(controller: object) -> float:
    """How far `decide` and `decide_all` may differ in commands, holds and reported numbers.

    A controller declares it as ``agreement = 1e-9``; without that 0: bit for bit. Raises
    ControllerError for what is no such number.
    """
    given = getattr(controller, "agreement", 0.0)
    if isinstance(given, bool) or not isinstance(given, int | float) or not 0.0 <= given < 1.0:
        raise ControllerError(
            f"agreement of the controller is {given!r}; it must be a number from 0 to below 1"
        )
    return float(given)


def kept_from_walls(controller: object) -> tuple[str, float]:
    """Setting by which a controller turns away from walls, and how near [m]; no name without one.

    A controller tells it by a method ``kept_from_walls()``. `physim check` names the setting where
    a robot stands before a place that leaves it less. Raises ControllerError where that fails.
    """
    if (say := getattr(controller, "kept_from_walls", None)) is None:
        return "", 0.0
    with naming(f"{type(controller).__name__}.kept_from_walls", say):
        name, distance = say()
        return str(name), float(distance)


def kept_distance(controller: object) -> float:
    """L [m] that a controller keeps from boundaries: its setting ``safe_distance``; 0 without.

    Pictures show the safe area by it.
    """
    return float(getattr(getattr(controller, "settings", None), "safe_distance", 0.0))
