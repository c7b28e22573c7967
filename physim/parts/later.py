"""Values whose fields are made when they are first asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import Any, Self, TypeVar, cast


class Later:
    """Gives a class some fields that are made when they are first asked for, and then kept.

    The class is a dataclass. An instance has all its fields from the constructor, or some of them
    and, by `partly`, a source of the rest, which is asked by name.
    """

    __slots__ = ("_source",)
    _source: Callable[[str], Any]

    @classmethod
    def partly(cls, values: Mapping[str, Any], source: Callable[[str], Any]) -> Self:
        """Return an instance with these fields already; the source has all others."""
        one = cls.__new__(cls)
        one.__dict__.update(values)
        object.__setattr__(one, "_source", source)
        return one

    def made(self) -> dict[str, Any]:
        """Every field, made by now, in the order of the class; and what else was put in."""
        names = (one.name for one in fields(cast(Any, self)))
        values = {**{name: getattr(self, name) for name in names}, **self.__dict__}
        if hasattr(self, "_source"):
            object.__delattr__(self, "_source")
        return values

    def __getstate__(self) -> dict[str, Any]:
        """Return what a copy is made of."""
        return self.made()


class MadeLater:
    """A field of `Later` as an attribute of its class, asked where an instance lacks the value."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __get__(self, one: Later | None, kind: type[Later]) -> Any:
        """Make the value and keep it in the instance, which is asked first from now on."""
        if one is None:
            return self
        value = one.__dict__[self.name] = one._source(self.name)
        return value


L = TypeVar("L", bound=Later)


def made_later(*names: str) -> Callable[[type[L]], type[L]]:
    """Let fields of a dataclass be made when they are asked for."""

    def with_them(kind: type[L]) -> type[L]:
        for name in names:
            setattr(kind, name, MadeLater(name))
        return kind

    return with_them
