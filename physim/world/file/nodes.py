"""The tree of a YAML text, with the place of every value and key; no Python object is made of it.

It is built from the parser's events, so neither deep nesting nor loops of aliases can exhaust the
stack, and limits are checked while reading. Meanwhile the search for garbage is put off.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from physim.errors import Fault, Location, Position


@contextmanager
def collector_paused() -> Iterator[None]:
    """No search for garbage within: a quarter of the time of reading a long text, which holds none.

    Only cycles are left until afterwards; it may be nested.
    """
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


@dataclass(frozen=True)
class OverridePosition(Position):
    """Place of a value given on the command line."""

    key: str = ""

    def __str__(self) -> str:
        """``--set key``, or the option itself where it is another one."""
        return self.key if self.key.startswith("--") else f"--set {self.key}"


class Unreadable:
    """Stands for a value that could not be read; the fault that says why is already found."""


UNREADABLE = Unreadable()


def holds_unreadable(value: Any) -> bool:
    """Whether a plain value is `UNREADABLE`, or a list or mapping with it inside."""
    if isinstance(value, dict | list):
        return any(map(holds_unreadable, value.values() if isinstance(value, dict) else value))
    return value is UNREADABLE


@dataclass(slots=True)
class Node:
    """A value of the text: a scalar in ``value``, else ``items`` or ``members``."""

    line: int
    column: int
    value: Any = None
    items: list[Node] | None = None
    members: dict[str, Member] | None = None
    override: str | None = None
    """key of ``--set`` that this value came from"""
    size: int = 1
    """values in it, itself included, aliases written out"""
    height: int = 1
    """levels of nesting, aliases written out"""

    def plain(self) -> Any:
        """Return the value as dicts, lists, numbers and texts."""
        if self.members is not None:
            return {key: member.node.plain() for key, member in self.members.items()}
        if self.items is not None:
            return [item.plain() for item in self.items]
        return self.value


@dataclass(slots=True)
class Member:
    """One key of a mapping with its value; line and column are the key's."""

    line: int
    column: int
    node: Node


@dataclass(frozen=True)
class Document:
    """A world file as read: its tree, and what is already wrong with it.

    ``faults`` have their places. ``unreadable`` holds the locations of values that could not be
    read; they stand in the tree as `UNREADABLE`. ``warnings`` are about its text. ``from_python``
    are kind and name of the parts that the run of a record had from Python.
    """

    source: str
    root: Node
    faults: tuple[tuple[Fault, Position], ...] = ()
    unreadable: frozenset[Location] = frozenset()
    warnings: tuple[Fault, ...] = ()
    from_python: tuple[tuple[str, str], ...] = ()

    def values(self) -> Any:
        """Return the world as dicts, lists, numbers and texts."""
        return self.root.plain()

    def position(self, location: Location, key: bool = False) -> Position:
        """Place of the value (or of its ``key``) at a location.

        Where there is nothing, the place of the nearest thing that would hold it: its key, where
        it has one.
        """
        node = self.root
        place = self._place(node.line, node.column, node)
        for depth, part in enumerate(location):
            child, line, column = _child(node, part)
            if child is None:
                return place
            is_key_wanted = key or depth + 1 < len(location)
            if not is_key_wanted:
                line, column = child.line, child.column
            node = child
            place = self._place(line, column, node)
        return place

    def _place(self, line: int, column: int, node: Node) -> Position:
        if node.override is not None:
            return OverridePosition(self.source, line, column, node.override)
        return Position(self.source, line, column)


def _child(node: Node, part: str | int) -> tuple[Node | None, int, int]:
    if node.members is not None and isinstance(part, str) and part in node.members:
        member = node.members[part]
        return member.node, member.line, member.column
    if node.items is not None and isinstance(part, int) and 0 <= part < len(node.items):
        item = node.items[part]
        return item, item.line, item.column
    return None, 0, 0
