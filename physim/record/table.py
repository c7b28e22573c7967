"""How a dataset of a record is told of: its columns, its sizes, and what reads it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, NamedTuple, Self, TypeVar, overload

import numpy as np

T = TypeVar("T")
Bound = float | str | None
"""Least or greatest value of a column: a number, or the highest number of ``robots``, ``moving``,
``bodies``, ``modes``, ``rules`` or ``steps`` that there are; as the least also another column,
which it is above. None: any value, NaN too."""


class Column(NamedTuple):
    """A column of a table."""

    name: str
    kind: str
    unit: str
    words: str
    least: Bound = None
    most: Bound = None


class Property(Generic[T]):
    """A property of a `Record`, made when it is first asked for."""

    name = ""

    def __set_name__(self, owner: type, name: str) -> None:
        """Take the name of the property."""
        self.name = name

    @overload
    def __get__(self, record: None, owner: type) -> Self: ...
    @overload
    def __get__(self, record: object, owner: type) -> T: ...
    def __get__(self, record: Any, owner: type) -> Self | T:
        """What a record holds; of the class, the property itself."""
        if record is None:
            return self
        made: T = vars(record).setdefault(self.name, self.of(record))
        return made

    def of(self, record: Any) -> Any:
        """Make it from a record, which can ``read`` a dataset."""
        raise NotImplementedError


class Dataset(Property[T]):
    """A dataset of the file, all of its rows.

    ``row`` are the columns of its rows, or their type; of a plain type ``least`` and ``most``
    bound the values. ``shape`` names its sizes: N robots, B bodies that move, W boundaries and
    obstacles that stand, K samples, M rows; others are free. ``starts`` is the path of packed items
    whose runs begin where it says, each of ``fewest`` items or more. One that is not ``needed`` is
    in some records only: those of some worlds, or of runs that were asked for it.
    """

    def __init__(
        self,
        path: str,
        shape: str,
        row: str | tuple[Column, ...],
        words: str,
        unit: str = "",
        least: Bound = None,
        most: Bound = None,
        *,
        starts: str = "",
        fewest: int = 1,
        needed: bool = True,
    ) -> None:
        self.path, self.shape, self.words, self.unit = path, tuple(shape.split()), words, unit
        self.fields = row if isinstance(row, tuple) else (Column("", row, unit, "", least, most),)
        self.starts, self.fewest, self.needed = starts, fewest, needed
        self.__doc__ = f"({', '.join(self.shape)}) {f'[{unit}] ' if unit else ''}{words}"

    @property
    def field(self) -> str:
        """Last part of the path."""
        return self.path.rpartition("/")[2]

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of a value, or of a row of columns; of decisions without the declared columns."""
        if not self.fields[0].name:
            return np.dtype(self.fields[0].kind)
        return np.dtype([(field.name, field.kind) for field in self.fields])

    def of(self, record: Any) -> Any:
        """All its rows."""
        return record.read(self.path)


class Packed(Property[T]):
    """What is ``put`` together from several datasets."""

    def __init__(self, put: Callable[..., T], words: str, *datasets: Dataset[Any]) -> None:
        self.put, self.datasets, self.__doc__ = put, datasets, words

    def __set_name__(self, owner: type, name: str) -> None:
        """Take the name of the property, for its datasets too."""
        super().__set_name__(owner, name)
        for one in self.datasets:
            one.name = name

    def of(self, record: Any) -> Any:
        """What its datasets make."""
        return self.put(*(record.read(one.path) for one in self.datasets))
