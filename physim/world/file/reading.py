"""Read a YAML text into a tree of nodes: one document, no tags, no surprises, nothing executed."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import yaml

from physim.errors import Fault, Location, Position, WorldError
from physim.world.faults import KeyFault, describe, field_at
from physim.world.file.nodes import UNREADABLE, Document, Member, Node, collector_paused
from physim.world.file.pitfalls import (
    EMPTY,
    RefusedScalarError,
    missing_colon,
    missing_space,
    missing_space_after_dash,
    scalar,
    syntax_hint,
)

MOST_BYTES = 5_000_000
MOST_DEPTH = 50
TOO_DEEP = f"nested deeper than {MOST_DEPTH} levels"
MOST_VALUES = 500_000
MOST_KEYS = 1_000
"""Keys of one mapping."""
MOST_FAULTS = 200
"""Faults after which reading stops."""
MOST_KEY = 100
"""Characters of a key."""

Loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

_CONTROL = re.compile("[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_UNSPACED_COMMENT = re.compile(r"\S#")
_TAB = re.compile(r"^ *\t[ \t]*(?=[^ \t\r\n#])", re.MULTILINE)


def read_document(text: str, source: str = "<text>") -> Document:
    """Read the text of a world file into a tree with positions.

    The mistakes that leave the tree whole (duplicate keys, ambiguous scalars, tags) are kept in
    ``Document.faults``, to be reported together with those of the model. Raises `WorldError` with
    one position where the text is not YAML, is empty, or exceeds a limit.
    """
    text = text.removeprefix("\ufeff")
    if len(text) > MOST_BYTES:
        raise refused(source, 1, 1, f"the text is longer than {MOST_BYTES // 10**6} MB")
    _check_characters(text, source)
    reader = _Reader(source)
    try:
        with collector_paused():
            reader.read(yaml.parse(text, Loader=Loader))
    except yaml.YAMLError as error:
        line, column, message = syntax_hint(error, text)
        if "nesting depth" in message:  # libyaml looks ahead, and has a limit of its own
            raise refused(source, line, column, TOO_DEEP) from None
        raise refused(source, line, column, f"not valid YAML: {message}") from None
    if reader.root is None:
        raise refused(
            source, 1, 1, "the file is empty; a world needs name, time, corridor and robots"
        )
    return Document(
        source,
        reader.root,
        tuple(reader.faults),
        frozenset(reader.unreadable),
        tuple(reader.warnings),
    )


def refused(source: str, line: int, column: int, message: str) -> WorldError:
    """One fault of the whole text, at a place of it (from 1)."""
    return WorldError([Fault((), message)], [Position(source, line, column)])


def _check_characters(text: str, source: str) -> None:
    """Refuse control characters and tabs in the indentation: parsers differ over both."""
    if found := _CONTROL.search(text):
        line, column = _line_column(text, found.start())
        code = ord(found[0])
        raise refused(source, line, column, f"character U+{code:04X} is not allowed in YAML")
    if found := _TAB.search(text):
        line, column = _line_column(text, text.index("\t", found.start()))
        raise refused(source, line, column, "a tab in the indentation; indent with spaces")


def _line_column(text: str, index: int) -> tuple[int, int]:
    return text.count("\n", 0, index) + 1, index - (text.rfind("\n", 0, index) + 1) + 1


@dataclass(slots=True)
class _Open:
    """A mapping or list whose end has not come yet."""

    node: Node
    anchor: str | None
    location: Location
    key: str | None = None
    key_place: tuple[int, int] = (0, 0)
    waits_for_value: bool = False
    is_usable: bool = True
    """whether the value that comes next has a place: not after a key that was refused"""
    is_block: bool = True
    """whether it is written in lines, not in brackets"""
    is_dash_advised: bool = False


@dataclass
class _Reader:
    """Builds the tree from the parser's events."""

    source: str
    root: Node | None = None
    faults: list[tuple[Fault, Position]] = field(default_factory=list)
    unreadable: set[Location] = field(default_factory=set)
    warnings: list[Fault] = field(default_factory=list)
    stack: list[_Open] = field(default_factory=list)
    anchors: dict[str, Node | None] = field(default_factory=dict)
    values: int = 0
    documents: int = 0

    def read(self, events: Iterator[Any]) -> None:
        take = {
            yaml.ScalarEvent: self._scalar,
            yaml.SequenceStartEvent: self._open,
            yaml.MappingStartEvent: self._open,
            yaml.SequenceEndEvent: self._close,
            yaml.MappingEndEvent: self._close,
            yaml.AliasEvent: self._alias,
            yaml.DocumentStartEvent: self._begin,
        }
        for event in events:
            if (taken := take.get(type(event))) is not None:
                mark = event.start_mark
                taken(event, mark.line + 1, mark.column + 1)

    def _begin(self, _event: Any, line: int, column: int) -> None:
        self.documents += 1
        if self.documents > 1:
            raise refused(self.source, line, column, "a second document; a world file holds one")

    def _fault(self, fault: Fault, line: int, column: int) -> None:
        self.faults.append((fault, Position(self.source, line, column)))
        if len(self.faults) >= MOST_FAULTS:
            faults, positions = zip(*self.faults, strict=True)
            raise WorldError(list(faults), list(positions))

    def _here(self) -> Location:
        """Location of the value that comes next."""
        if not self.stack:
            return ()
        top = self.stack[-1]
        if top.node.items is not None:
            return (*top.location, len(top.node.items))
        return (*top.location, top.key) if top.key is not None else top.location

    def _expects_key(self) -> bool:
        return bool(self.stack) and (
            self.stack[-1].node.members is not None and not self.stack[-1].waits_for_value
        )

    def _count(self, size: int, line: int, column: int) -> None:
        self.values += size
        if self.values > MOST_VALUES:
            raise refused(
                self.source, line, column, f"more than {MOST_VALUES} values, aliases written out"
            )

    def _check_tag(self, event: Any, line: int, column: int) -> None:
        if event.tag is not None:
            tag = describe(str(event.tag))
            self._fault(
                Fault(self._here(), f"tag {tag} is not allowed; write the bare value"), line, column
            )

    def _scalar(self, event: Any, line: int, column: int) -> None:
        self._count(1, line, column)
        if self._expects_key():
            self._check_tag(event, line, column)
            if event.anchor is not None:
                self.anchors[event.anchor] = Node(line, column, event.value)
            self._key(event.value, line, column, quoted=bool(event.style))
            return
        value: Any = UNREADABLE
        if event.tag is not None:
            self._check_tag(event, line, column)
        else:
            try:
                value = event.value if event.style else scalar(event.value)
            except RefusedScalarError as error:
                if event.value or not self.stack or self.stack[-1].is_usable:
                    text = self._empty() if str(error) == EMPTY else str(error)
                    self._fault(Fault(self._here(), text), line, column)
        if value is UNREADABLE:
            self.unreadable.add(self._here())
        elif not event.style and isinstance(value, str) and _UNSPACED_COMMENT.search(value):
            self._check_comment(value)
        node = Node(line, column, value)
        if event.anchor is not None:
            self.anchors[event.anchor] = node
        self._put(node)

    def _check_comment(self, text: str) -> None:
        """Warn of a comment that is none, for want of a blank: ``r1#first``."""
        here = self._here()
        if here[-1:] != ("description",) and len(self.warnings) < MOST_FAULTS:
            message = (
                f'{describe(text)}: the "#" belongs to the text; a comment needs a blank before '
                "it; put the text in quotes if it is meant so"
            )
            self.warnings.append(Fault(here, message))

    def _empty(self) -> str:
        """What to do about an empty value: a key that is needed cannot be left out."""
        from physim.world.model import World

        field = field_at(World, self._here())
        if field is not None and field.is_required():
            return f"empty value; needed: {field.description}"
        if meant := missing_colon((self.stack[-1].key if self.stack else None) or ""):
            return meant
        return f"empty value; give one, or leave the key out{self._comma_hint()}"

    def _comma_hint(self) -> str:
        """``{step: 0,5}`` is two entries, 0 and a key 5 without a value: a decimal comma."""
        top = self.stack[-1] if self.stack else None
        before = list((top.node.members or {}).items())[-1:] if top is not None else []
        if top is None or not before or top.key is None or not top.key.isdecimal():
            return ""
        key, value = before[0][0], before[0][1].node.value
        if type(value) is not int:
            return ""
        return f"; decimals take a point: {key}: {value}.{top.key}"

    def _dash_hint(self, top: _Open) -> str:
        """What may be missing where a key of an entry of a list comes again; said once an entry."""
        within = self.stack[-2] if len(self.stack) > 1 else None
        if within is None or within.node.items is None or not top.is_block or top.is_dash_advised:
            return "keep one"
        top.is_dash_advised = True
        return 'keep one, or put a dash before it ("- ") where the next entry of the list begins'

    def _key(self, text: str, line: int, column: int, quoted: bool = False) -> None:
        top = self.stack[-1]
        top.waits_for_value, top.is_usable, top.key = True, True, None
        given = top.node.members or {}
        if len(given) >= MOST_KEYS:
            raise refused(self.source, line, column, f"more than {MOST_KEYS} keys in one mapping")
        if not text.isprintable() or not 0 < len(text) <= MOST_KEY:
            message = f"{describe(text)} cannot be a key; keys are short words"
            self._fault(Fault(top.location, message), line, column)
            top.is_usable = False
        elif not quoted and (word := missing_space(text)) and word not in given:
            message = f'a space is missing after the colon; write "{word}: …"'
            self._fault(Fault((*top.location, word), message), line, column + len(word))
            self.unreadable.add((*top.location, word))
            given[word] = Member(line, column, Node(line, column, UNREADABLE))
            top.is_usable = False
        elif not quoted and (advice := missing_space_after_dash(text)):
            self._fault(Fault(top.location, advice), line, column + 1)
            top.is_usable = False
        elif text == "<<":
            self._fault(
                Fault(top.location, "merge keys (<<) are not supported; write the keys out"),
                line,
                column,
            )
            top.is_usable = False
        elif text in given and top.is_dash_advised:
            top.key, top.is_usable = text, False  # as the keys before it: told once
        elif text in given:
            first = given[text]
            self._fault(
                KeyFault(
                    (*top.location, text),
                    f"key given twice, first on line {first.line}; {self._dash_hint(top)}",
                ),
                line,
                column,
            )
            top.key, top.is_usable = text, False
        else:
            top.key = text
        top.key_place = (line, column)

    def _open(self, event: Any, line: int, column: int) -> None:
        self._count(1, line, column)
        if len(self.stack) >= MOST_DEPTH:
            raise refused(self.source, line, column, TOO_DEEP)
        if self._expects_key():
            raise refused(self.source, line, column, "a list or mapping cannot be a key")
        self._check_tag(event, line, column)
        if event.tag is not None:
            self.unreadable.add(self._here())  # what it would have been is not checked, too
        is_list = isinstance(event, yaml.SequenceStartEvent)
        node = Node(line, column, items=[] if is_list else None, members=None if is_list else {})
        if event.anchor is not None:
            self.anchors[event.anchor] = None
        is_block = not event.flow_style
        self.stack.append(_Open(node, event.anchor, self._here(), is_block=is_block))

    def _close(self, _event: Any, _line: int, _column: int) -> None:
        closed = self.stack.pop()
        if closed.anchor is not None:
            self.anchors[closed.anchor] = closed.node
        self._put(closed.node)

    def _alias(self, event: Any, line: int, column: int) -> None:
        anchor: str | None = event.anchor
        if anchor is None or anchor not in self.anchors:
            raise refused(self.source, line, column, f"no anchor &{anchor} before it"[:100])
        node = self.anchors[anchor]
        if node is None:
            raise refused(self.source, line, column, f"alias *{anchor[:40]} contains itself")
        if self._expects_key():
            if node.members is not None or node.items is not None:
                raise refused(self.source, line, column, "a list or mapping cannot be a key")
            self._count(1, line, column)
            self._key(str(node.value), line, column)
            return
        self._count(node.size, line, column)
        if len(self.stack) + node.height > MOST_DEPTH + 1:
            raise refused(self.source, line, column, TOO_DEEP)
        self._put(node)

    def _put(self, node: Node) -> None:
        """Give a finished value its place in what is open."""
        if not self.stack:
            self.root = node
            return
        top = self.stack[-1]
        top.node.size += node.size
        top.node.height = max(top.node.height, node.height + 1)
        if top.node.items is not None:
            top.node.items.append(node)
        elif top.node.members is not None:
            if top.is_usable and top.key is not None:
                top.node.members[top.key] = Member(*top.key_place, node)
            top.waits_for_value, top.key = False, None
