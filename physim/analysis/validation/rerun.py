"""Simulated again: does the world inside a record give this very run?

On the versions that made the record everything must be the same to the bit. On others values must
agree within `SLACK` up to the first contact: from there on two runs may part by a rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from physim.analysis.validation.mismatch import SLACK, Mismatch, words
from physim.analysis.validation.origin import controller_name
from physim.analysis.validation.sums import BLOCK, BY, bounds, sums, unlike
from physim.errors import PhysimError, RecordError, WorldError
from physim.record import Record
from physim.record.layout import (
    ATTRIBUTES,
    FIXED,
    OTHERS,
    STEPS,
    TABLES,
)

if TYPE_CHECKING:
    from physim.parts.controller import Controller
    from physim.parts.stages import Disturbance, Filter, SensingStage
    from physim.simulation.loop import Simulation

LAST = ("safe_distance", "ended", "steps_run", "rejected_contacts")
"""Attributes that are compared last: how the run went, and what is drawn."""
NOT_COMPARED = ("record_every", "tables", "given", "version")
"""Attributes that do not say what happened: what was recorded, and how parts were named."""


@dataclass(frozen=True)
class Rerun:
    """A run held against the same run simulated again."""

    exact: bool
    """to the bit; otherwise within `SLACK`, since other versions made the record"""
    until: float
    """[s] up to which it was compared"""
    whole: bool
    """that is all of it"""
    digest: str
    """of the record"""
    same_digest: bool
    """the run simulated again has the very digest"""
    difference: Mismatch | None
    """the first one in time"""


class AgainError(PhysimError):
    """A run cannot be simulated again; ``why`` says why not."""

    def __init__(self, record: Record, why: str) -> None:
        self.why = why
        super().__init__(f"{record.where}: cannot be simulated again: {why}")


def simulation_again(
    record: Record,
    *,
    controller: Controller | None = None,
    sensing: Sequence[SensingStage] = (),
    filters: Sequence[Filter] = (),
    disturbances: Sequence[Disturbance] = (),
) -> Simulation:
    """Set up the run of a record anew, at sample 0, from the world inside.

    No code is run because a record names it: parts that were given from Python, and a controller
    ``module:Class``, have to be given again. Raises AgainError where one is missing, and where the
    run made no step.
    """
    from physim.simulation.loop import Simulation

    if not record.world_text.strip():
        raise AgainError(record, "it holds no text of its world")
    if not record.noted_until:
        raise AgainError(record, "it made no step")
    try:
        world, name = record.world, controller_name(record)
    except WorldError as error:
        raise AgainError(record, str(error).splitlines()[0]) from error
    if controller is None and (record.controller or ":" in name):
        raise AgainError(
            record,
            f"its controller is the class {name}; no code is run because a record names it: if you "
            f"trust the class, give --controller {name}",
        )
    given = {"sensing stage": sensing, "filter": filters, "disturbance": disturbances}
    for kind, parts in given.items():
        names = [name for word, name in record.given if word == kind]
        if len(names) != len(parts):
            raise AgainError(
                record,
                f"its {kind} {', '.join(names) or 'none'} came from Python; give it again there: "
                "rerun(record, sensing=..., filters=..., disturbances=...) of "
                "physim.analysis.validation.rerun",
            )
    try:
        return Simulation(
            world, controller=controller, sensing=sensing, filters=filters,
            disturbances=disturbances,
        )  # fmt: skip
    except PhysimError as error:
        raise AgainError(record, str(error).splitlines()[0]) from error


def run_again(
    record: Record,
    simulation: Simulation,
    *,
    stop: Callable[[], bool] = lambda: False,
    progress: Callable[[Simulation, float], None] | None = None,
) -> Record:
    """Run a simulation, in memory and with every sample, as far as the record goes.

    Runs that were interrupted, killed or broke off end where `Record.noted_until` says. Raises
    AgainError where memory does not hold it.
    """
    from physim.simulation.recorder import SaveAt
    from physim.simulation.run import record_run

    cut, last = record.ended in ("interrupted", "running", "error"), record.noted_until
    if record.ended == "running":  # it had decided what to do from there on
        last += any((rows["step"] == last).any() for rows in (record.updates, record.commands))
    try:
        return record_run(
            simulation,
            save=SaveAt(every=1),
            progress=progress,
            stop=lambda: stop() or (cut and simulation.step_number >= last),
        )
    except RecordError as error:
        raise AgainError(record, str(error)) from error


def rerun(record: Record, **parts: Any) -> Rerun:
    """Simulate the run of a record again and compare; ``parts`` are those of `simulation_again`."""
    with run_again(record, simulation_again(record, **parts)) as again:
        return compare_runs(record, again)


def simulated_again(record: Record) -> Record | str:
    """The run of a record simulated again, or why it is not."""
    try:
        return run_again(record, simulation_again(record))
    except AgainError as error:
        return error.why


def compare_runs(record: Record, again: Record) -> Rerun:
    """Hold a record against the same run simulated again, which has every sample and table."""
    digest = record.digest()
    same = digest == again.digest()
    exact = record.versions == again.versions
    until, whole, difference = record.steps_run, True, None
    if not exact:
        touched = [int(one.contacts["step"][0]) for one in (record, again) if len(one.contacts)]
        whole = not touched
        until = min([until, *(step - 1 for step in touched)])
        difference = _first_contact(record, again)
    if not same and difference is None:
        difference = _first(record, again, until, exact, whole)
    return Rerun(exact, until * record.dt, whole, digest, same, difference)


def _first_contact(record: Record, again: Record) -> Mismatch | None:
    """A first contact that one run has and the other has not, or later, and that is none to touch
    or miss by a rounding: up to it both agree within `SLACK`."""
    claimed, repeated = (one.contacts for one in (record, again))
    late = min(record.steps_run, again.steps_run) + 1  # contacts later than that are not compared
    steps = [int(rows["step"][0]) if len(rows) else late for rows in (claimed, repeated)]
    step = min(steps)
    if step >= late or steps[0] == steps[1]:
        return None
    row = (claimed if steps[0] < steps[1] else repeated)[0]
    who, column = int(row["a"]), "clearance" if row["b"] < record.robots else "boundary_clearance"
    near = float(again.read(f"/steps/{column}", step, step + 1)[0, who])
    if abs(near) <= SLACK:
        return None
    words, at = (("there", "not"), 0) if steps[0] < steps[1] else (("not there", "there"), None)
    return Mismatch.of(record, "/contacts", None, *words, BY, row=at, robot=who, step=step)


def _first(record: Record, again: Record, until: int, exact: bool, whole: bool) -> Mismatch | None:
    """First difference: what is known before the run, then by time, then what sums it up."""
    for found in _attributes(record, again, [k for k in ATTRIBUTES if k not in LAST]):
        return found
    found_at = [
        *(
            _table(record, again, path, _last(record, again, path, until, whole), exact)
            for path in TABLES
        ),
        _others(record, again, _last(record, again, "/considered", until, whole)),
        *(_samples(record, again, path, until, exact) for path in STEPS[1:]),
    ]
    if exact:
        for found in _fixed(record, again):
            return found
    timed = [one for one in found_at if one is not None]
    if timed:
        return min(timed, key=lambda one: -1 if one.step is None else one.step)
    killed = record.ended == "running"
    broken = record.ended == "error" and again.ended != "finished"
    last = [] if killed else [key for key in LAST if key != "ended" or not broken]
    for found in (
        (*_attributes(record, again, last), *sums(record, again, exact))
        if whole else bounds(record, again, until)
    ):  # fmt: skip
        return found
    return None


def _attributes(record: Record, again: Record, names: Sequence[str]) -> Iterator[Mismatch]:
    for name in names:
        key = "world_text" if name == "world" else name
        if name in NOT_COMPARED or not hasattr(record, key):
            continue
        recorded, repeated = getattr(record, key), getattr(again, key)
        if recorded != repeated:
            if name == "world":
                recorded, repeated = _first_line(recorded, repeated)
            yield Mismatch.of(record, "attribute", name, recorded, repeated, BY)


def _fixed(record: Record, again: Record) -> Iterator[Mismatch]:
    """What stands still, to the bit; how well it must agree otherwise is held elsewhere."""
    for path in FIXED:
        rows, others = record.read(path), again.read(path)
        if rows.shape != others.shape:
            yield Mismatch.of(record, path, None, f"{len(rows)} rows", f"{len(others)} rows", BY)
        elif (wrong := rows != others).any():
            at = tuple(np.argwhere(wrong)[0])
            yield Mismatch.of(record, path, None, rows[at], others[at], BY, row=int(at[0]))


def _first_line(recorded: str, repeated: str) -> tuple[str, str]:
    """First line of two texts that differs."""
    lines, others = recorded.splitlines(), repeated.splitlines()
    for line, other in zip(lines, others, strict=False):
        if line != other:
            return line.strip(), other.strip()
    return f"{len(lines)} lines", f"{len(others)} lines"


def _last(record: Record, again: Record, path: str, until: int, whole: bool) -> int:
    """Last step of a table that is compared: what was decided at the last one may follow from
    poses that are not compared any more, or a run was killed before all of it was written."""
    if path.endswith("contacts"):
        return until
    if record.ended == "running":
        there, wanted = (int((one.read(path)["step"] == until).sum()) for one in (record, again))
        return until if there >= wanted else until - 1
    return until if whole else until - 1


def _table(record: Record, again: Record, path: str, last: int, exact: bool) -> Mismatch | None:
    """First row of a table that differs, among those up to a step."""
    if path[1:] not in record.tables and path != "/commands":
        return None
    rows, others = (one.read(path) for one in (record, again))
    rows, others = rows[rows["step"] <= last], others[others["step"] <= last]
    common = min(len(rows), len(others))
    for column in rows.dtype.names or ():
        if column not in (others.dtype.names or ()):
            return Mismatch.of(record, path, column, "there", "not", BY)
    wrong = np.zeros(common, dtype=np.bool_)
    found = {}
    for column in rows.dtype.names or ():
        found[column] = unlike(rows[column][:common], others[column][:common], exact, column)
        wrong |= found[column]
    if wrong.any():
        k = int(np.argmax(wrong))
        column = next(name for name, values in found.items() if values[k])
        return _row(record, path, column, k, rows, rows[column][k], others[column][k])
    if len(rows) != len(others):
        some = rows if len(rows) > common else others
        words = ("there", "not") if some is rows else ("not there", "there")
        return _row(record, path, None, common, some, *words)
    return None


def _others(record: Record, again: Record, last: int) -> Mismatch | None:
    """First decision whose considered robots are others; how many they are is in a table."""
    if "considered" not in record.tables:
        return None
    counts = record.read("/considered")
    counts = counts[counts["step"] <= last]
    ends = np.cumsum(counts["count"])
    count = int(ends[-1]) if len(ends) else 0
    rows, others = (one.read(OTHERS)[:count] for one in (record, again))
    if len(rows) != len(others) or not (wrong := rows != others).any():
        return None  # where the counts differ that is found
    at = int(np.argmax(wrong))
    k = int(np.searchsorted(ends, at, side="right"))
    return _row(record, OTHERS, None, k, counts, rows[at], others[at])


def _row(
    record: Record, path: str, column: str | None, k: int, rows: NDArray[np.void],
    recorded: Any, repeated: Any,
) -> Mismatch:  # fmt: skip
    step = int(rows["step"][k])
    who = next((name for name in ("robot", "a") if name in (rows.dtype.names or ())), None)
    robot = None if who is None else int(rows[who][k])
    told, true = (words(record, column, value) for value in (recorded, repeated))
    return Mismatch.of(record, path, column, told, true, BY, row=k, robot=robot, step=step)


def _samples(record: Record, again: Record, path: str, until: int, exact: bool) -> Mismatch | None:
    """First sample that differs; clearances of a coarse record are the least since the last one."""
    steps = record.steps
    count = int(np.searchsorted(steps, until, side="right"))
    for low in range(0, count, BLOCK):
        high = min(low + BLOCK, count)
        first = int(steps[low - 1]) + 1 if low else 0
        repeated = again.read(path, first, int(steps[high - 1]) + 1)
        if len(repeated) <= steps[high - 1] - first:
            step = first + len(repeated)
            return Mismatch.of(record, path, None, "there", "at its end", BY, step=step)
        if path == "/steps/pose":
            repeated = repeated[steps[low:high] - first]
        else:
            begins = np.concatenate(([0], steps[low : high - 1] + 1 - first))
            repeated = np.minimum.reduceat(repeated, begins, axis=0)
        recorded = record.read(path, low, high)
        wrong = unlike(recorded, repeated, exact, path)
        if wrong.any():
            k, robot, *rest = (int(v) for v in np.argwhere(wrong)[0])
            step = int(steps[low + k])
            column = ("x", "y", "heading")[rest[0]] if rest else None
            at = (k, robot, *rest)
            return Mismatch.of(
                record, path, column, recorded[at], repeated[at], BY, row=low + k, robot=robot,
                step=step,
            )  # fmt: skip
    return None
