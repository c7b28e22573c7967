"""What a controller declares of itself: its modes, the rules it decides by, what it reports.

Everything that shows a run (record, summary, pictures) takes names, colours and units from here,
so a controller of one's own is shown like the shipped one. No mode says whether a run succeeds:
arrival is judged from the motion alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator, ConfigDict, Field, TypeAdapter

from physim.errors import ControllerError
from physim.parts.user_code import naming

NO_NUMBER = -1
"""In tables, the mode or rule of a decision that gave none."""
MOST_MODES = 100
"""Modes, rules or columns of one controller."""
RESERVED = frozenset(
    (
        "step", "robot", "mode", "rule", "nominal_v", "nominal_omega", "applied_v",
        "applied_omega", "station", "reference_station", "formation_error", "deviation",
        "considered", "next_step", "nominal_lateral", "applied_lateral",
    )
)  # fmt: skip
"""Columns that the record writes itself."""


def _plain(words: str) -> str:
    if words.isprintable():
        return words
    raise ValueError("it must be one line of plain text")


Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,39}$")]
Line = Annotated[str, AfterValidator(_plain)]
Words = Annotated[Line, Field(max_length=300)]
CHECKED = ConfigDict(revalidate_instances="always")


@dataclass(frozen=True)
class Mode:
    """A mode of a controller."""

    __pydantic_config__: ClassVar[ConfigDict] = CHECKED
    name: Name
    """a word of small letters, digits and _"""
    colour: Annotated[str, Field(pattern=r"^#[0-9a-fA-F]{6}$")]
    """``#rrggbb``"""
    words: Words = ""
    """text for people; if empty, the name"""
    danger: bool = False
    """whether the robot avoids something in this mode; the share of danger mode counts it"""

    def __str__(self) -> str:
        """Words that people read."""
        return self.words or self.name


@dataclass(frozen=True)
class Rule:
    """A rule by which decisions are made, e.g. an equation."""

    __pydantic_config__: ClassVar[ConfigDict] = CHECKED
    name: Name
    """a word of small letters, digits and _"""
    words: Words = ""
    """text for people; if empty, the name"""

    def __str__(self) -> str:
        """Words that people read."""
        return self.words or self.name


@dataclass(frozen=True)
class Column:
    """A number that a controller reports with its decisions; NaN where a decision leaves it out."""

    __pydantic_config__: ClassVar[ConfigDict] = CHECKED
    name: Name
    """a word of small letters, digits and _"""
    unit: Words = "-"
    """``-`` for shares and counts"""
    words: Words = ""
    """what it is"""


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


def _each_once(given: tuple[Any, ...]) -> tuple[Any, ...]:
    names = [one.name for one in given]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f'"{name}" is declared {names.count(name)} times')
    return given


def _as_meant(columns: tuple[Column, ...]) -> tuple[Column, ...]:
    standard = {column.name: column.unit for column in STANDARD_COLUMNS}
    for column in columns:
        if column.name in RESERVED:
            raise ValueError(f'"{column.name}" is written for every decision anyway')
        if column.unit != (unit := standard.get(column.name, column.unit)):
            raise ValueError(
                f'"{column.name}" has the unit {column.unit!r}; the standard column has {unit!r}: '
                "use it, or another name"
            )
    return columns


EachOnce = Field(max_length=MOST_MODES), AfterValidator(_each_once)


@dataclass(frozen=True)
class Declared:
    """All that a controller declares, checked; numbers in tables count in these tuples."""

    modes: Annotated[tuple[Mode, ...], *EachOnce] = ()
    rules: Annotated[tuple[Rule, ...], *EachOnce] = ()
    columns: Annotated[tuple[Column, ...], *EachOnce, AfterValidator(_as_meant)] = ()

    @classmethod
    def of(cls, controller: object) -> Declared:
        """Declarations of a controller: its attributes ``modes``, ``rules`` and ``columns``.

        Raises ControllerError for what is no such thing, for names given twice, and for a standard
        column with another unit, with the line of the class; for what raises as it is read, too.
        """
        with naming(f"controller {type(controller).__name__}", type(controller)):
            keys = ("modes", "rules", "columns")
            given = {key: getattr(controller, key, ()) for key in keys}
            return _checker().validate_python(given)


@cache
def _checker() -> TypeAdapter[Declared]:
    """What checks declarations; made once, which takes 5 ms."""
    return TypeAdapter(Declared)


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
