"""The columns of results, a row a run, and what may stand in them: rows may come from strangers."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, NamedTuple

from physim.campaigns.own_metrics import PATTERN
from physim.escaping import escaped

if TYPE_CHECKING:
    import pyarrow as pa

FINISHED, DURATION, ERROR, TIMEOUT, KILLED = "finished", "duration", "error", "timeout", "killed"
FAILED = (ERROR, TIMEOUT, KILLED)
"""How a run ended that says nothing about its controller's safety"""
ENDS = (FINISHED, DURATION, "interrupted", *FAILED)


class _Ended:
    """What follows from how a run ended and from what touched in it."""

    __slots__ = ()
    ended: str
    contacts: int | None
    grazes: int | None

    @property
    def failed(self) -> bool:
        """Whether it ended by an error, its limit or a kill."""
        return self.ended in FAILED

    @property
    def contact_free(self) -> bool:
        """Whether it came to its end and nothing touched."""
        return self.ended in (FINISHED, DURATION) and self.contacts == self.grazes == 0

    @property
    def safe(self) -> bool:
        """Whether it was contact-free and all robots arrived."""
        return self.contact_free and self.ended == FINISHED


@dataclass(frozen=True, kw_only=True, slots=True)
class Row(_Ended):
    """What came of one run; the fields are the columns. None: it has no meaning for this run."""

    run: str
    """key, 20 hex digits"""
    world: str
    seed: int
    settings: str = ""
    """ "key=value; key=value" """
    controller: str = ""
    physim: str
    engine: str
    ended: str
    """finished, duration, interrupted, error, timeout, killed"""
    reason: str = ""
    """one line"""
    seconds: float | None = None
    """[s] simulated"""
    robots: int | None = None
    contacts: int | None = None
    """episodes, with robots and with walls"""
    contacts_between_robots: int | None = None
    contacts_with_boundaries: int | None = None
    grazes: int | None = None
    """contacts between two samples"""
    first_contact: float | None = None
    """[s]"""
    first_contact_pair: str = ""
    """ "r1, r2" """
    deepest_contact: float | None = None
    """[m]"""
    closing_speed: float | None = None
    """[m/s] of the severest contact, as the next four"""
    energy_lost: float | None = None
    """[J]"""
    impulse: float | None = None
    """[N s]"""
    severest_contact_pair: str = ""
    severest_contact_time: float | None = None
    """[s]"""
    shortest_distance: float | None = None
    """[m] of two robots; negative: depth"""
    shortest_boundary_distance: float | None = None
    """[m] of a robot and a wall; negative: depth"""
    least_distance: float | None = None
    """[m] the less of the two"""
    least_distance_pair: str = ""
    least_distance_time: float | None = None
    """[s]"""
    shortest_collision_time: float | None = None
    """[s]"""
    shortest_collision_time_pair: str = ""
    shortest_collision_time_time: float | None = None
    """[s]"""
    shortest_pair_collision_time: float | None = None
    """[s] of any two robots under the commands applied at decisions; 10 where none is shorter"""
    formation_error_peak: float | None = None
    """[m] greatest size"""
    deviation_peak: float | None = None
    """[m] greatest size, from the path"""
    time_to_finish: float | None = None
    """[s]"""
    not_arrived: str = ""
    """ "r1, r3": robots that had not arrived at the end"""
    stood: str = ""
    """those of them that stood"""
    danger_share: float | None = None
    decisions: int | None = None
    messages: int | None = None
    cpu_seconds: float | None = None
    """[s] of the processor"""
    wall_seconds: float | None = None
    """[s] by the clock"""
    metrics: str = ""
    """ "name=value; name=value" of the metrics that packages registered"""
    record: str = ""
    """path of a record that was kept, within the folder"""
    world_hash: str = ""
    """of the effective world without its seed"""
    digest: str = ""
    """of a record that was kept"""


@dataclass(frozen=True, slots=True)
class Brief(_Ended):
    """As much of a row as a sweep needs to know; made in a tenth of the time of a `Row`."""

    run: str
    world: str
    seed: int
    settings: str
    controller: str
    ended: str
    contacts: int | None
    grazes: int | None


def briefs(table: pa.Table) -> Iterator[Brief]:
    """The rows of a table in short."""
    columns = (table[one.name].to_pylist() for one in fields(Brief))
    return map(Brief, *columns)


def rows_of(table: pa.Table) -> list[Row]:
    """The rows of a table."""
    return [Row(**one) for one in table.select(list(COLUMNS)).to_pylist()]


COLUMNS = tuple(field.name for field in fields(Row))
TIMES = ("cpu_seconds", "wall_seconds")
"""Columns that are not the same every time"""


def schema() -> pa.Schema:
    """The columns, as Arrow has them."""
    import pyarrow as pa

    types = {"str": pa.string(), "int": pa.int64(), "float": pa.float64()}
    return pa.schema(
        [pa.field(one.name, types[str(one.type).partition(" ")[0]]) for one in fields(Row)]
    )


class Allowed(NamedTuple):
    """What may stand in a column: a text that matches, or a finite number within bounds."""

    type: str
    """str, int or float"""
    words: str
    pattern: str = ""
    least: float = -math.inf
    most: float = math.inf
    needed: bool = False
    """whether every row has it"""


def _texts(words: str, pattern: str, needed: bool = False) -> Allowed:
    return Allowed("str", words, f"^(?:{pattern})$", needed=needed)


MOST = 1e12
"""[m], [s] that a length or a time may be: far beyond any run"""
_ENDED = _texts(f"one of {', '.join(ENDS)}", "|".join(ENDS), True)
_DISTANCE = Allowed("float", "a number from -1e12 to 1e12", least=-MOST, most=MOST)
_NUMBERS = {
    "seed": Allowed("int", "a whole number from 0", least=0, needed=True),
    "shortest_distance": _DISTANCE,
    "shortest_boundary_distance": _DISTANCE,
    "least_distance": _DISTANCE,
    "shortest_collision_time": Allowed("float", "a finite number from 0, or null", least=0.0),
    "shortest_pair_collision_time": Allowed("float", "a finite number from 0, or null", least=0.0),
    "danger_share": Allowed("float", "a number from 0 to 1", least=0.0, most=1.0),
}
_TEXTS = {
    "run": _texts("20 hex digits", "[0-9a-f]{20}", True),
    "world": Allowed("str", "a text", needed=True),
    "physim": Allowed("str", "a text", needed=True),
    "engine": Allowed("str", "a text", needed=True),
    "ended": _ENDED,
    "metrics": _texts("name=value; name=value, with numbers", PATTERN),
    "record": _texts("records/ and 20 hex digits and .h5", r"(records/[0-9a-f]{20}\.h5)?"),
    "world_hash": _texts("hex digits", "[0-9a-f]{0,64}"),
    "digest": _texts("hex digits", "[0-9a-f]{0,128}"),
}
_USUAL = {
    "str": Allowed("str", "a text"),
    "int": Allowed("int", "a whole number from 0, or null", least=0),
    "float": Allowed("float", "a number from 0 to 1e12, or null", least=0.0, most=MOST),
}
ALLOWED = {
    one.name: (_TEXTS | _NUMBERS).get(one.name, _USUAL[str(one.type).partition(" ")[0]])
    for one in fields(Row)
}
"""What may stand in each column; null too, but where every row has one."""
LARGEST = 2**63 - 1
SHOWN = 40
"""Characters of a value that an error repeats."""


OLD, DERIVED = "wall_contacts", "contact_free"
"""A column of earlier rows, whose ``contacts`` are of robots alone and whose ``shortest_distance``
is of robots and walls; and what follows from other columns, which a line may say all the same"""
RENAMED = {
    "deepest": "deepest_contact",
    "formation_error": "formation_error_peak",
    "deviation": "deviation_peak",
    "finish_time": "time_to_finish",
    "updates": "decisions",
}
"""Columns of earlier rows that have the names of their metrics now"""
_OLD_MEANING = {
    "contacts": "contacts_between_robots",
    OLD: "contacts_with_boundaries",
    "shortest_distance": "least_distance",
    "shortest_distance_pair": "least_distance_pair",
    "shortest_distance_time": "least_distance_time",
}


def row_of(tree: Any) -> Row:
    """Row of the values that a line holds; columns of a later version are left out.

    Columns that earlier versions called otherwise get their names of now: `RENAMED`, and those of
    a line with `OLD` that mean something else now.
    Raises ValueError with the column, what stands in it and what is allowed.
    """
    if not isinstance(tree, dict):
        raise ValueError("is no row: must be an object with columns")
    if OLD in tree:
        counts = tree.get("contacts"), tree[OLD]
        tree = {_OLD_MEANING.get(name, name): value for name, value in tree.items()}
        if all(type(count) is int for count in counts):
            tree["contacts"] = sum(counts)
    tree = {RENAMED.get(name, name): value for name, value in tree.items()}
    values: dict[str, Any] = {}
    for name, allowed in ALLOWED.items():
        value = tree.get(name)
        if value is None:
            if allowed.needed:
                raise ValueError(f"{name}: is missing; must be {allowed.words}")
            continue
        if not _fits(value, allowed):
            shown = escaped(repr(value)[: SHOWN + 1])
            shown = shown if len(shown) <= SHOWN else shown[:SHOWN] + "…"
            raise ValueError(f"{name}: must be {allowed.words}; given: {shown}")
        values[name] = float(value) if allowed.type == "float" else value
    row = Row(**values)
    if tree.get(DERIVED, row.contact_free) is not row.contact_free:
        raise ValueError(f"{DERIVED}: must be {row.contact_free} by the other columns")
    return row


def _fits(value: Any, allowed: Allowed) -> bool:
    """Whether a value of a column is what may stand there."""
    if allowed.type == "str":
        return isinstance(value, str) and (
            not allowed.pattern or re.fullmatch(allowed.pattern, value) is not None
        )
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    if isinstance(value, int):
        return abs(value) <= LARGEST and allowed.least <= value <= allowed.most
    return (
        allowed.type == "float" and math.isfinite(value) and allowed.least <= value <= allowed.most
    )


def are_rows(table: pa.Table) -> bool:
    """Whether all values of a table with the columns are what may stand there."""
    from pyarrow import compute

    for name, allowed in ALLOWED.items():
        column = table[name]
        if allowed.needed and column.null_count:
            return False
        if allowed.type == "str":
            if allowed.pattern:
                fine = compute.match_substring_regex(column, allowed.pattern)
                if compute.all(fine).as_py() is False:  # null where there is none at all
                    return False
            continue
        if allowed.type == "float" and compute.all(compute.is_finite(column)).as_py() is False:
            return False
        ends = compute.min_max(column).as_py()
        if ends["min"] is not None and (ends["min"] < allowed.least or ends["max"] > allowed.most):
            return False
    return True


__all__ = [
    "ALLOWED", "COLUMNS", "DERIVED", "FAILED", "OLD", "RENAMED", "TIMES", "Brief", "Row",
    "are_rows", "briefs", "row_of", "rows_of", "schema",
]  # fmt: skip
