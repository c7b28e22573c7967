"""A mapping that cannot change, so that a model that holds free settings stays hashable."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any


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
