"""Kinds of values that a world is made of: numbers, points, polylines, words, labels, settings.

Numbers are strict: finite, whole numbers count as floats, true/false and text do not. Settings that
are free are held in a mapping that cannot change, so that a model that holds them stays hashable.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag
from pydantic_core import PydanticCustomError


class FrozenMapping(Mapping[str, Any]):
    """Read-only mapping with text keys; nested lists are tuples, nested mappings are frozen too."""

    __slots__ = ("_items",)

    def __init__(self, items: Mapping[str, Any] | None = None) -> None:
        """Hold a frozen copy of ``items``; keys become text."""
        self._items = {str(key): frozen(value) for key, value in (items or {}).items()}

    def __getitem__(self, key: str) -> Any:
        """Value of ``key``; KeyError when there is none."""
        return self._items[key]

    def __iter__(self) -> Iterator[str]:
        """Keys in the order they were written."""
        return iter(self._items)

    def __len__(self) -> int:
        """Number of keys."""
        return len(self._items)

    def __hash__(self) -> int:
        """Equal mappings have equal hashes, whatever their order."""
        return hash(frozenset(self._items.items()))

    def __repr__(self) -> str:
        """``FrozenMapping({...})``."""
        return f"FrozenMapping({self._items!r})"


def frozen(value: Any) -> Any:
    """Turn lists into tuples and mappings into `FrozenMapping`, at every depth."""
    if isinstance(value, Mapping):
        return value if isinstance(value, FrozenMapping) else FrozenMapping(value)
    if isinstance(value, list | tuple):
        return tuple(frozen(item) for item in value)
    return value


def thawed(value: Any) -> Any:
    """Turn tuples into lists and mappings into dicts, at every depth: what JSON can hold."""
    if isinstance(value, Mapping):
        return {key: thawed(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [thawed(item) for item in value]
    return value


LARGEST_COORDINATE = 1.0e6
"""[m] Beyond this a double resolves less than the contact tolerance allows."""
MOST_POINTS = 100_000
"""Points of one polyline."""
MOST_CORNERS = 2_000
"""Corners of one footprint or obstacle."""
MOST_NAME = 100
"""Characters of a name."""
MOST_ROBOTS = 20_000
MOST_WALLS = 10_000
"""Boundaries, and obstacles as many again."""
MOST_SEED = 10**15


def plain(value: Any) -> Any:
    """Return a numpy array or scalar as the list or number it stands for, all else unchanged."""
    tolist = getattr(value, "tolist", None)
    return tolist() if callable(tolist) else value


def _sequence(value: Any) -> Any:
    value = plain(value)
    if isinstance(value, list | tuple):
        return value
    raise PydanticCustomError("sequence", "must be a list")


def _points(value: Any) -> Any:
    value = plain(value)
    is_list = isinstance(value, list | tuple)
    if not is_list or (value and all(isinstance(one, int | float) for one in value)):
        raise PydanticCustomError("points", "must be a list of points [x, y]")
    return value


def _lines(value: Any) -> Any:
    value = _sequence(value)
    points = [plain(one) for one in value]
    if points and all(
        isinstance(one, list | tuple) and one and all(isinstance(x, int | float) for x in one)
        for one in points
    ):
        raise PydanticCustomError("lines", "must be a list of lists of points: [[[x, y], …], …]")
    return value


def _printable(text: str) -> str:
    if not text.isprintable():
        raise PydanticCustomError("label", "must not hold line breaks or control characters")
    if text != text.strip():
        raise PydanticCustomError("label", "must not begin or end with a space")
    return text


def _open_ring(corners: tuple[Point, ...]) -> tuple[Point, ...]:
    """Drop a last corner that repeats the first: the ring is closed anyway."""
    if len(corners) > 3 and corners[0] == corners[-1]:
        return corners[:-1]
    return corners


def either(first: str, other: str) -> Discriminator:
    """Choose ``first`` of two tags where a value is of that kind, else ``other``.

    Kinds are ``<word>``, ``<list>`` and ``<value>``, which is all else.
    """

    def tag(value: Any) -> str:
        kind = "<word>" if isinstance(value, str) else "<value>"
        if isinstance(plain(value), list | tuple):
            kind = "<list>"
        return first if kind == first else other

    return Discriminator(tag)


# Bounds stand before validators: so pydantic knows them, and writes them into the schema.
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Whole = Annotated[int, Field(strict=True)]
Length = Annotated[Number, Field(gt=0.0, le=1.0e6)]
Distance = Annotated[Number, Field(ge=0.0, le=1.0e6)]
Flag = Annotated[bool, Field(strict=True)]
Text = Annotated[str, Field(strict=True, max_length=10_000)]
Label = Annotated[
    str, Field(strict=True, min_length=1, max_length=MOST_NAME), AfterValidator(_printable)
]
Coordinate = Annotated[Number, Field(ge=-LARGEST_COORDINATE, le=LARGEST_COORDINATE)]
Angle = Annotated[Number, Field(ge=-1000.0, le=1000.0)]
Heading = Annotated[
    Annotated[Literal["random"], Tag("<word>")] | Annotated[Angle, Tag("<value>")],
    either("<word>", "<value>"),
]
Sequence = BeforeValidator(_sequence)
"""Put last on a tuple field: takes lists, tuples and arrays, and nothing else."""
Lines = BeforeValidator(_lines)
"""As `Sequence`, of lists of points: one list of points alone is told once, not at each point."""
Point = tuple[float, float]
Pose = Annotated[tuple[Coordinate, Coordinate, Heading], Sequence]
Polyline = Annotated[
    tuple[tuple[Coordinate, Coordinate], ...],
    Field(min_length=2, max_length=MOST_POINTS),
    BeforeValidator(_points),
]
Polygon = Annotated[
    tuple[tuple[Coordinate, Coordinate], ...],
    Field(min_length=3, max_length=MOST_CORNERS),
    BeforeValidator(_points),
    AfterValidator(_open_ring),
]
