"""Values given on the command line: ``--set a.b.0.c=YAML``, put into the tree of the file."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from physim.errors import Fault, Location, Position, WorldError, dotted
from physim.parts.registry import STAGES
from physim.world import World
from physim.world.faults import describe, field_at
from physim.world.file.nodes import Document, Member, Node, OverridePosition
from physim.world.file.reading import MOST_DEPTH, read_document

NULL = ("null", "Null", "NULL")
"""Values that leave a key out (not ~, which shells replace). A file leaves the key itself out."""

PARTS = tuple(kind.key for kind in STAGES)
"""Where a world lists parts."""

_KEY = re.compile(r"[^.\[\]=]+(?:\.[^.\[\]=]+|\[[0-9]+\])*")


def apply_overrides(document: Document, overrides: Sequence[str]) -> Document:
    """Return the document with values replaced, in the order given; the given one is unchanged.

    Each override is ``key=YAML``, the key written ``robots.0.pose`` or ``robots[0].pose``. Keys
    that do not exist are made, so that the check of the model finds them as unknown keys, at
    ``--set key``. ``key=null`` leaves a key out that may be left out, as though the file did not
    have it. Raises `WorldError` for an override that cannot be read or placed.
    """
    for override in overrides:
        document = _applied(document, override)
    return document


def _applied(document: Document, override: str) -> Document:
    key, equals, text = override.partition("=")
    key = key.strip()
    place = OverridePosition(document.source, 1, 1, describe(key)[1:-1])
    if not equals or not _KEY.fullmatch(key):
        message = (
            f"{describe(override)} is not KEY=VALUE, as time.step=0.02 or robots.0.pose=[1, 2, 0]"
        )
        raise WorldError([Fault((), message)], [place])
    location = _location(key)
    if len(location) > MOST_DEPTH:
        message = f"{len(location)} keys within each other; a world has at most {MOST_DEPTH}"
        raise WorldError([Fault((), message)], [place])
    if not text.strip():
        message = "no value after the =; null leaves a key out"
        raise WorldError([Fault(location, message)], [place])
    if text.strip() in NULL:
        return _left_out(document, location, place)
    try:
        value = read_document(text, document.source)
    except WorldError as error:
        raise WorldError([Fault((), fault.message) for fault in error.faults], [place]) from None
    _mark(value.root, key)
    root = _placed(document.root, location, 0, value.root, place)
    return _without(document, location, replace(value, root=root), place)


def _left_out(document: Document, location: Location, place: OverridePosition) -> Document:
    """Take a key out; one that no world has is made, for the check of the model to find it."""
    field = field_at(World, location)
    if isinstance(location[-1], int):
        raise WorldError(
            [Fault(location, "null leaves a key out, not an entry of a list")], [place]
        )
    if field is not None and field.is_required():
        message = f"null leaves optional keys out; this one is needed: {field.description}"
        raise WorldError([Fault(location, message)], [place])
    root = _cut(document.root, location)
    if root is document.root and field is None:
        root = _placed(root, location, 0, Node(1, 1, override=place.key), place)
    changed = Document(document.source, root)
    return _without(document, location, changed, place)


def _cut(node: Node, location: Location) -> Node:
    """Copy of a tree without the key at ``location``; the tree itself where there is none."""
    part, rest = location[0], location[1:]
    if node.members is not None and str(part) in node.members:
        members = dict(node.members)
        if not rest:
            del members[str(part)]
            return replace(node, members=members)
        old = members[str(part)]
        child = _cut(old.node, rest)
        members[str(part)] = replace(old, node=child)
        return node if child is old.node else replace(node, members=members)
    if node.items is not None and isinstance(part, int) and part < len(node.items) and rest:
        child = _cut(node.items[part], rest)
        items = [*node.items[:part], child, *node.items[part + 1 :]]
        return node if child is node.items[part] else replace(node, items=items)
    return node


def _location(key: str) -> Location:
    parts = re.findall(r"[^.\[\]]+", key)
    return tuple(int(part) if re.fullmatch("[0-9]{1,9}", part) else part for part in parts)


def _mark(node: Node, key: str) -> None:
    """Say of every value in a tree which override it came from."""
    node.override = key
    members = [member.node for member in (node.members or {}).values()]
    for child in [*(node.items or []), *members]:
        if child.override is None:
            _mark(child, key)


def _placed(
    node: Node | None, location: Location, depth: int, value: Node, place: Position
) -> Node:
    """Copy of a tree with ``value`` at ``location``; only the way there is copied."""
    if depth == len(location):
        return value
    part = location[depth]
    if node is None and location[:depth] in PARTS and isinstance(part, int):
        key = dotted(location[:depth])
        message = f"the world has no {key}; give it some, as {key}=[{{type: NAME, KEY: VALUE}}]"
        raise WorldError([Fault(location[:depth], message)], [place])
    if node is None:
        node = replace(value, value=None, items=None, members={})
    if node.members is not None:
        key = str(part)
        old = node.members.get(key)
        child = _placed(old.node if old else None, location, depth + 1, value, place)
        line, column = (old.line, old.column) if old else (node.line, node.column)
        return replace(node, members={**node.members, key: Member(line, column, child)})
    if node.items is not None and isinstance(part, int) and part < len(node.items):
        child = _placed(node.items[part], location, depth + 1, value, place)
        return replace(node, items=[*node.items[:part], child, *node.items[part + 1 :]])
    if node.items is not None:
        there = f"has entries 0 to {len(node.items) - 1}" if node.items else "is an empty list"
        message = f"there is no entry {describe(part)}; this list {there}"
    else:
        message = (
            f"there is no {describe(part)} in it; it is the single value {describe(node.value)}"
        )
    raise WorldError([Fault(location[:depth], message)], [place])


def _without(
    document: Document, location: Location, changed: Document, place: Position
) -> Document:
    """Put the faults of the old text that still stand and those of the new value together."""
    depth = len(location)
    kept = [pair for pair in document.faults if pair[0].location[:depth] != location]
    new = [
        (replace(fault, location=(*location, *fault.location)), place)
        for fault, _ in changed.faults
    ]
    unreadable = {where for where in document.unreadable if where[:depth] != location}
    unreadable |= {(*location, *where) for where in changed.unreadable}
    warnings = [fault for fault in document.warnings if fault.location[:depth] != location]
    return replace(
        document, root=changed.root, faults=(*kept, *new), unreadable=frozenset(unreadable),
        warnings=tuple(warnings),
    )  # fmt: skip
