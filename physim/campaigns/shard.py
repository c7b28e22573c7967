"""One shard of rows: read in bulk by Arrow, and line by line where that finds anything amiss.

It may come from a stranger. Both ways take the same shards; the slow one says what is wrong where.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from physim.campaigns import contradictions
from physim.campaigns.columns import COLUMNS, DERIVED, OLD, RENAMED, Row, are_rows, row_of, schema
from physim.errors import PhysimError
from physim.json_text import parse_json

if TYPE_CHECKING:
    import pyarrow as pa

DEEPEST = 100
"""Brackets in a line that Arrow is given; a row has two."""
AT_ONCE = 1 << 24
"""[bytes] about, of a shard that are read at a time: memory does not grow with its size"""

LONGEST_ROW = 1_000_000
"""Bytes of a line; a row has a thousandth of them"""


class Part(NamedTuple):
    """Rows that stand one behind another in a file of JSON lines."""

    table: pa.Table
    lines: list[bytes]
    """of each row its line, without the end of it"""
    cut: int = 0
    """number in the file of the last line, from 1, where that is cut off and no row; else 0"""


def read_shard(file: Path) -> Iterator[Part]:
    """Read a shard part by part, each row of it checked; an empty one has none.

    Raises FileNotFoundError; PhysimError with file, line and column for what is no row.
    """
    before = 0
    try:
        with open(file, "rb") as stream:
            while data := stream.read(AT_ONCE) + stream.readline(LONGEST_ROW):
                part = _part(file, data, before)
                before += len(part.lines)
                yield part
    except FileNotFoundError:
        raise
    except OSError as error:
        raise PhysimError(f"{file}: cannot be read: {error.strerror}") from None


def _part(file: Path, data: bytes, before: int) -> Part:
    """The rows of some lines of a file, which has so many ``before`` them."""
    lines = data.split(b"\n")
    for number, line in enumerate(lines, before + 1):
        if len(line) >= LONGEST_ROW:
            raise PhysimError(f"{file}:{number}: is no row: has {LONGEST_ROW} bytes or more")
    ends = not lines[-1]
    if ends:
        lines.pop()
    table = _in_bulk(data, lines) if ends else None
    part = Part(table, lines) if table is not None else _one_by_one(file, lines, ends, before)
    if found := contradictions.of_itself(part.table):
        row, what = found
        raise PhysimError(f"{file}:{before + row + 1}: contradicts itself: {what}")
    return part


def _in_bulk(data: bytes, lines: list[bytes]) -> pa.Table | None:
    """The rows of whole lines; None where they are not all as they should be."""
    import pyarrow as pa
    from pyarrow import compute, json

    if not _are_plain(data, lines):  # at the nested Arrow would break the whole process off
        return None
    if any(f'"{name}"'.encode() in data for name in (OLD, DERIVED, *RENAMED)):
        return None
    options = json.ParseOptions(explicit_schema=schema(), unexpected_field_behavior="ignore")
    try:
        data.decode()  # what is no text Arrow would hand on
        found = json.read_json(pa.BufferReader(data), parse_options=options).select(list(COLUMNS))
    except (pa.ArrowInvalid, UnicodeDecodeError):
        return None
    if found.num_rows != len(lines) or not are_rows(found):  # it takes two rows on a line
        return None
    texts = [k for k, one in enumerate(found.schema) if one.type == pa.string()]
    for k in texts:  # columns that an earlier version did not have
        found = found.set_column(k, found.schema[k], compute.fill_null(found[k], ""))
    return found


def _are_plain(data: bytes, lines: list[bytes]) -> bool:
    """Whether each line is one object or several, none that goes on in the next, none nested deep.

    A text that holds the end of a line is refused by Arrow.
    """
    if data[:1] != b"{" or data[-2:] != b"}\n" or data.count(b"}\n{") != len(lines) - 1:
        return False
    if data.count(b"[") + data.count(b"{") <= len(lines) + DEEPEST:
        return True
    return all(line.count(b"[") + line.count(b"{") <= DEEPEST for line in lines)


def _one_by_one(file: Path, lines: list[bytes], ends: bool, before: int) -> Part:
    """The rows of lines, of which the last may be cut off unless it ``ends``."""
    rows: list[Row] = []
    for number, line in enumerate(lines, before + 1):
        try:
            try:
                tree = parse_json(line, once=True)
            except ValueError as error:
                if ends or line is not lines[-1]:
                    raise ValueError(f"is no row: {error}") from None
                return Part(_table(rows), lines[:-1], number)
            rows.append(row_of(tree))
        except ValueError as error:
            raise PhysimError(f"{file}:{number}: {error}") from None
    return Part(_table(rows), lines)


def _table(rows: list[Row]) -> pa.Table:
    """Rows as a table; what is no text in them becomes a question mark."""
    import pyarrow as pa

    def clean(value: object) -> object:
        return value.encode("utf-8", "replace").decode("utf-8") if isinstance(value, str) else value

    columns = {name: [clean(getattr(row, name)) for row in rows] for name in COLUMNS}
    return pa.table(columns, schema=schema())


__all__ = ["Part", "read_shard"]
