"""A world file as text: plain values, and on demand the place of each of them in the file.

PyYAML composes the nodes without giving any of them a meaning, so nothing in a file is executed.
What YAML readers take differently is refused: tags, keys given twice, and scalars (`scalar`).
"""

from __future__ import annotations

import gc
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import yaml

from physim.errors import Fault, Location, Position, WorldError
from physim.world import World
from physim.world.faults import describe, field_at
from physim.world.file.scalars import RefusedScalarError, scalar
from physim.world.file.syntax import syntax_fault

MOST_BYTES = 5_000_000
MOST_DEPTH = 50
MOST_VALUES = 500_000
MOST_KEYS = 1_000
"""Keys of one mapping"""
MOST_KEY = 100
"""Characters of a key"""
MOST_FAULTS = 500
"""Faults of keys and single values, after which no more are looked for"""

_CONTROL = re.compile("[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_TAB = re.compile(r"^ *(\t)[ \t]*(?=[^ \t\r\n#])", re.MULTILINE)
_OVERRIDE = re.compile(r"[^.\[\]=]+(?:\.[^.\[\]=]+|\[[0-9]+\])*")


class _Loader(getattr(yaml, "CBaseLoader", yaml.BaseLoader)):  # type: ignore[misc]
    """Composes nodes; the tag of one is "" unless its author wrote one."""

    def resolve(self, _kind: object, _value: object, _implicit: object) -> str:
        return ""


@dataclass(frozen=True)
class Document:
    """Values of a world file, and where they stand."""

    source: str
    values: Any
    """dicts, lists, numbers and texts"""
    root: Any
    """yaml.Node of the file"""
    options: dict[Location, str] = field(default_factory=dict)
    """locations of values that the command line gives, and the option that gives them"""
    warnings: tuple[Fault, ...] = ()
    from_python: tuple[tuple[str, str], ...] = ()
    """kind and name of the parts that the run of a record had from Python"""

    def position(self, location: Location, of_key: bool = False) -> Position:
        """Place of the value, or of its key, at a location.

        Where there is nothing, that of the nearest thing that would hold it: its key, where it has
        one.
        """
        for end in range(len(location), -1, -1):
            if (option := self.options.get(location[:end])) is not None:
                return Position(self.source, 1, 1, option)
        node = at = self.root
        for end, part in enumerate(location, start=1):
            if (found := _child(node, part)) is None:
                made = (o for at, o in self.options.items() if at[: len(location)] == location)
                if option := next(made, ""):
                    return Position(self.source, 1, 1, option)
                break
            key, node = found
            at = key if of_key or end < len(location) else node
        return _place(self.source, at)

    def error(self, faults: Iterable[Fault]) -> WorldError:
        """Error of these faults in the order of the file, each once and at its place."""
        return _placed((one, self.position(one.location, one.of_key)) for one in faults)

    def lines(self, faults: Iterable[Fault]) -> list[str]:
        """Faults in the order of the file, a line each, with their places."""
        return str(self.error(faults)).splitlines()


def _placed(pairs: Iterable[tuple[Fault, Position]]) -> WorldError:
    found = sorted(dict.fromkeys(pairs), key=lambda pair: (pair[1].line, pair[1].column))
    return WorldError([fault for fault, _ in found], [position for _, position in found])


def _place(source: str, node: Any) -> Position:
    return Position(source, node.start_mark.line + 1, node.start_mark.column + 1)


def _child(node: Any, part: str | int) -> tuple[Any, Any] | None:
    """Nodes of key and value at a part of a location; both the entry, in a list."""
    if isinstance(node, yaml.MappingNode):
        return next((pair for pair in node.value if pair[0].value == part), None)
    if isinstance(node, yaml.SequenceNode) and isinstance(part, int) and part < len(node.value):
        return node.value[part], node.value[part]
    return None


def refused(at: Position, message: str, location: Location = ()) -> WorldError:
    """Error of one fault, at a place of a text or of the command line."""
    return WorldError([Fault(location, message)], [at])


def read_document(text: str, source: str = "<text>") -> Document:
    """Values of a text.

    Raises `WorldError` where it is not YAML, is empty or exceeds a limit, and for what readers
    take differently, with every fault at its place.
    """
    text = text.removeprefix("\ufeff")
    if len(text) > MOST_BYTES:
        raise refused(Position(source, 1, 1), f"the text is longer than {MOST_BYTES // 10**6} MB")
    if found := _CONTROL.search(text):
        message = f"character U+{ord(found[0]):04X} is not allowed in YAML"
        raise refused(_position(source, text, found.start()), message)
    if found := _TAB.search(text):
        message = "a tab in the indentation; indent with spaces"
        raise refused(_position(source, text, found.start(1)), message)
    collects = gc.isenabled()
    gc.disable()  # a quarter of the time of a long text, which makes no cycles
    try:
        roots = list(yaml.compose_all(text, Loader=_Loader))
        if not roots or roots[0].value in ("", "~", "null"):
            message = "the file is empty; a world needs name, time, corridor and robots"
            raise refused(Position(source, 1, 1), message)
        if len(roots) > 1:
            message = "a second document begins here; a world file holds one"
            raise refused(_place(source, roots[1]), message)
        reader = _Reader(source)
        values = reader.value(roots[0], ())
    except yaml.YAMLError as error:
        line, column, message = syntax_fault(error, text)
        raise refused(Position(source, line, column), message) from None
    finally:
        if collects:
            gc.enable()
    if reader.faults:
        raise _placed(reader.faults)
    return Document(source, values, roots[0])


def _position(source: str, text: str, index: int) -> Position:
    line, column = text.count("\n", 0, index) + 1, index - text.rfind("\n", 0, index)
    return Position(source, line, column)


class _Reader:
    """Plain values of nodes; aliases are written out."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.faults: list[tuple[Fault, Position]] = []
        self.count = 0

    def value(self, node: Any, location: Location) -> Any:
        self.count += 1
        if self.count > MOST_VALUES:
            raise refused(
                _place(self.source, node), f"more than {MOST_VALUES} values, aliases written out"
            )
        if len(location) > MOST_DEPTH:
            raise refused(_place(self.source, node), f"nested deeper than {MOST_DEPTH} levels")
        if node.tag:
            tag = describe(node.tag.replace("tag:yaml.org,2002:", "!!"))
            return self._fault(location, f"tag {tag} is not allowed; write the bare value", node)
        if isinstance(node, yaml.MappingNode):
            return self._mapping(node, location)
        if isinstance(node, yaml.SequenceNode):
            return [self.value(item, (*location, k)) for k, item in enumerate(node.value)]
        try:
            return node.value if node.style else scalar(node.value)
        except RefusedScalarError as error:
            return self._fault(location, str(error), node)

    def _mapping(self, node: Any, location: Location) -> dict[str, Any]:
        values: dict[str, Any] = {}
        lines: dict[str, int] = {}
        is_told = False
        for key, item in node.value:
            if not isinstance(key, yaml.ScalarNode):
                raise refused(_place(self.source, key), "a list or mapping cannot be a key")
            name = key.value
            if len(values) >= MOST_KEYS:
                raise refused(
                    _place(self.source, key), f"more than {MOST_KEYS} keys in one mapping"
                )
            if key.tag or not name.isprintable() or not 0 < len(name) <= MOST_KEY:
                self._fault(
                    location, f"{describe(name)} cannot be a key; keys are short plain words", key
                )
            elif name == "<<":
                self._fault(location, "merge keys (<<) are not supported; write the keys out", key)
            elif name in values:
                if is_told:  # as the keys before it
                    continue
                is_told = True
                entry = location and isinstance(location[-1], int)
                dash = ', or begin the next entry of the list with a dash, "- "' if entry else ""
                message = f"key given twice, first on line {lines[name]}; keep one{dash}"
                self._fault((*location, name), message, key)
            else:
                values[name] = self.value(item, (*location, name))
                lines[name] = key.start_mark.line + 1
        return values

    def _fault(self, location: Location, message: str, node: Any) -> None:
        self.faults.append((Fault(location, message), _place(self.source, node)))
        if len(self.faults) > MOST_FAULTS:
            raise _placed(self.faults)


def apply_overrides(document: Document, overrides: Sequence[str]) -> Document:
    """The document with ``KEY=YAML`` values put in, in order; the given one is unchanged.

    A key is written ``robots.0.pose`` or ``robots[0].pose``. One that does not exist is made, for
    the check of the model to find it, at ``--set KEY``. ``KEY=null`` leaves a key out. Raises
    `WorldError` for an override that cannot be read or placed.
    """
    for override in [overrides] if isinstance(overrides, str) else overrides:
        key, equals, text = override.partition("=")
        key = key.strip()
        option = f"--set {describe(key)[1:-1]}"
        at = Position(option, 1, 1, option)
        if not equals or not _OVERRIDE.fullmatch(key):
            raise refused(at, f"{describe(override)} is not KEY=VALUE, for example time.step=0.02")
        parts = re.findall(r"[^.\[\]]+", key)
        location: Location = tuple(int(p) if re.fullmatch("[0-9]{1,9}", p) else p for p in parts)
        if len(location) > MOST_DEPTH:
            message = f"{len(location)} keys within each other; a world has at most {MOST_DEPTH}"
            raise refused(at, message)
        if not text.strip():
            raise refused(at, "no value after the =; null leaves a key out", location)
        value = None
        if text.strip() not in ("null", "Null", "NULL"):  # not ~, which shells replace
            try:
                value = read_document(text).values
            except WorldError as error:
                faults = [replace(one, location=location + one.location) for one in error.faults]
                raise WorldError(faults, [at] * len(faults)) from None
        document = put(document, location, value, option)
    return document


def put(document: Document, location: Location, value: Any, option: str) -> Document:
    """The document with a value that an option of the command line gives; None leaves a key out.

    Raises `WorldError` where there is no such place.
    """
    at = Position(option, 1, 1, option)
    values = holder = document.values.copy()
    for end, part in enumerate(location[:-1]):
        if isinstance(holder, dict):
            part = str(part)
            inner = holder.get(part, {})
        else:
            inner = _entry(holder, part, location[:end], at)
        holder[part] = inner.copy() if isinstance(inner, dict | list) else inner
        holder = holder[part]
    last = location[-1]
    if isinstance(holder, dict):
        if value is not None or (last not in holder and field_at(World, location) is None):
            holder[str(last)] = value  # also an unknown key to be left out: the model refuses it
        else:
            holder.pop(str(last), None)
    else:
        _entry(holder, last, location[:-1], at)
        if value is None:
            raise refused(at, "null leaves a key out, not an entry of a list", location)
        holder[last] = value
    options = {k: v for k, v in document.options.items() if k[: len(location)] != location}
    return replace(document, values=values, options={**options, location: option})


def _entry(holder: Any, part: str | int, location: Location, at: Position) -> Any:
    """Entry of a list."""
    if not isinstance(holder, list):
        message = f"there is no {describe(part)} in it; it is the single value {describe(holder)}"
        raise refused(at, message, location)
    if not isinstance(part, int) or part >= len(holder):
        there = f"has entries 0 to {len(holder) - 1}" if holder else "is an empty list"
        raise refused(at, f"there is no entry {describe(part)}; this list {there}", location)
    return holder[part]
