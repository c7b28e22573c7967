"""Was a record made from a world? The world inside it and the one given are compared key by key."""

from __future__ import annotations

from pathlib import Path

import yaml

from physim.errors import RecordError
from physim.record import Record
from physim.world import World


def check_origin(record: Record, world: World, where: str | Path) -> None:
    """Raise RecordError unless a record was made from ``world``, whatever its seed and coarseness.

    Names the first key that differs.
    """
    try:
        theirs = yaml.safe_load(record.world_text)
    except yaml.YAMLError as error:
        said = " ".join(str(error).split())
        raise RecordError(f"{record.path}: the world inside cannot be read: {said}") from error
    ours = yaml.safe_load(world.to_yaml())
    for tree in (theirs, ours):
        if isinstance(tree, dict):
            tree.pop("seed", None)
            if isinstance(tree.get("time"), dict):
                tree["time"].pop("record_every", None)
    found = difference(theirs, ours, "")
    if found is not None:
        key, inside, given = found
        raise RecordError(
            f"{record.path}: not made from {where}: {key} is {_short(inside)} in the record, "
            f"{_short(given)} in the world (--set and --controller take the changes of a run)"
        )


def difference(a: object, b: object, key: str) -> tuple[str, object, object] | None:
    """First place at which two trees of plain values differ: key, value in a, value in b."""
    if isinstance(a, dict) and isinstance(b, dict):
        for name in [*a, *(n for n in b if n not in a)]:
            where = f"{key}.{name}" if key else str(name)
            found = difference(a.get(name), b.get(name), where)
            if found is not None:
                return found
        return None
    if isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        for k, (one, other) in enumerate(zip(a, b, strict=True)):
            found = difference(one, other, f"{key}[{k}]")
            if found is not None:
                return found
        return None
    return None if a == b else (key, a, b)


def _short(value: object) -> str:
    if isinstance(value, list):
        return f"a list of {len(value)}"
    text = "absent" if value is None else str(value)
    return text if len(text) <= 60 else text[:57] + "..."
