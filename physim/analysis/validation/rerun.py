"""Simulated again: does the world inside a record give this very run?

On the versions that made the record everything must be the same to the bit. On others values must
agree within `SLACK` up to the first contact: from there on two runs may part by a rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from physim.analysis.validation.analytic_contacts import pair_distance
from physim.analysis.validation.finding import (
    SLACK,
    Finding,
    first_difference,
    unlike,
    unlike_attributes,
    unlike_scene,
)
from physim.analysis.validation.origin import PATHS
from physim.contacts import CONTACT_ROW, FALSE_CONTACT_ROW
from physim.errors import RecordError
from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.record.digest import KNOWN
from physim.record.layout import (
    ARRIVED,
    EXTREMES,
    EXTREMES_FARTHEST,
    OTHERS,
    SENSED,
    STEPS,
    TABLES,
)
from physim.simulation.again import AgainError, simulation_again

if TYPE_CHECKING:
    from physim.simulation.loop import Simulation
    from physim.world.scene import Scene

BY = "simulated again"
BEFORE = ("name", "world", "seed", "dt", "steps_planned", "begun_at")
AFTER = ("safe_distance", "ended", "steps_run", "rejected_contacts")
"""Attributes that are compared: what was to be run, and last of all how it went"""
BLOCK = 4096
"""Samples that are compared at a time"""


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
    difference: Finding | None
    """the first one in time"""


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
            save=SaveAt(every=1, sensed=SENSED in record.tables),
            progress=progress,
            stop=lambda: stop() or (cut and simulation.step_number >= last),
        )
    except RecordError as error:
        raise AgainError(record, str(error)) from error


def rerun(record: Record, **parts: Any) -> Rerun:
    """Simulate the run of a record again and compare; ``parts`` are those of `simulation_again`."""
    with run_again(record, simulation_again(record, **parts)) as again:
        return compare_runs(record, again)


class _Led:
    """Stands in for the engine: robots go where a record says."""

    def __init__(self, record: Record) -> None:
        self.record, self.at = record, 0
        self.contacts = np.zeros(0, CONTACT_ROW)
        self.false_contacts = np.zeros(0, FALSE_CONTACT_ROW)

    @property
    def pose(self) -> FloatArray:
        """(B, 3) at the present sample."""
        return self.record.pose_at(self.at)

    def step(self, _: FloatArray) -> None:
        """Go to the next sample, whatever the commands."""
        self.at += 1
        self.contacts = self.contacts[:0]


def run_led(record: Record, scene: Scene) -> Record:
    """Run led through the poses of every step of a record: its controllers decide anew.

    Raises ControllerError where a controller cannot decide.
    """
    from physim.simulation.loop import Simulation
    from physim.simulation.recorder import SaveAt
    from physim.simulation.run import record_run

    simulation = Simulation(scene)
    simulation.physics = cast(Any, _Led(record))
    ended = record.steps_run
    return record_run(
        simulation, save=SaveAt(every=1), stop=lambda: simulation.step_number >= ended
    )


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


def _first_contact(record: Record, again: Record) -> Finding | None:
    """A first contact that one run has and the other has not, or later, and that is none to touch
    or miss by a rounding: up to it both agree within `SLACK`."""
    tables = record.contacts, again.contacts
    late = min(record.steps_run, again.steps_run) + 1  # contacts later than that are not compared
    steps = [int(rows["step"][0]) if len(rows) else late for rows in tables]
    step, which = min(steps), int(np.argmin(steps))
    if step >= late or steps[0] == steps[1]:
        return None
    a, b = (int(tables[which][key][0]) for key in "ab")
    if abs(pair_distance(again, again.pose_at(step), a, b)) <= SLACK:
        return None
    words, row = (("there", "not"), 0) if which == 0 else (("not there", "there"), None)
    return unlike(record, "/contacts", None, *words, BY, row=row, robot=a, step=step)


def _first(record: Record, again: Record, until: int, exact: bool, whole: bool) -> Finding | None:
    """First difference: what is known before the run, then by time, then what sums it up."""
    before = chain(
        unlike_attributes(record, again, BEFORE, BY),
        unlike_scene(record, again, KNOWN if exact else PATHS, BY, exact),
    )
    if found := next(before, None):
        return found
    timed = [_table(record, again, path, until, exact, whole) for path in (*TABLES, OTHERS)]
    timed += [_samples(record, again, path, until, exact) for path in STEPS[1:]]
    if differences := [one for one in timed if one is not None]:
        return min(differences, key=lambda one: -1 if one.step is None else one.step)
    return next(_after(record, again, until, exact, whole), None)


def _table(
    record: Record, again: Record, path: str, until: int, exact: bool, whole: bool
) -> Finding | None:
    """First row of a table that differs, as far as it is compared: what was decided at the last
    step may follow from poses that are not, or a run was killed before all of it was written."""
    name = "considered" if path == OTHERS else path[1:]
    if name not in record.tables and path != "/commands":
        return None
    tables = [one.considered if path == OTHERS else one.read(path) for one in (record, again)]
    there, wanted = (int((rows["step"] == until).sum()) for rows in tables)
    is_cut = not whole or (record.ended == "running" and there < wanted)
    until -= is_cut and not path.endswith("contacts")
    rows, others = (rows[rows["step"] <= until] for rows in tables)
    return first_difference(record, path, rows, others, BY, exact)


def _samples(record: Record, again: Record, path: str, until: int, exact: bool) -> Finding | None:
    """First sample that differs; clearances of a coarse record are the least since the last one."""
    count = int(np.searchsorted(record.steps, until, side="right"))
    for low in range(0, count, BLOCK):
        steps = record.steps[low : min(low + BLOCK, count)]
        first = int(record.steps[low - 1]) + 1 if low else record.begun_at
        begun = record.begun_at
        every = again.read(path, first - begun, int(steps[-1]) + 1 - begun)
        ends = steps[steps < first + len(every)] - first
        thinned = every[ends]
        if path != "/steps/pose" and record.record_every > 1 and len(ends):
            begins = np.append(0, ends[:-1] + 1)
            thinned = np.minimum.reduceat(every[: ends[-1] + 1], begins, axis=0)
        recorded = record.read(path, low, low + len(steps))
        if found := first_difference(record, path, recorded, thinned, BY, exact, steps):
            return found
    return None


def _after(
    record: Record, again: Record, until: int, exact: bool, whole: bool
) -> Iterator[Finding]:
    """What sums up a run, where that can be compared; how well extremes must agree otherwise is
    held elsewhere. A killed run may have noted some of after its last sample."""
    killed = record.ended == "running"
    if whole and not killed:
        broken = record.ended == "error" and again.ended != "finished"
        names = (name for name in AFTER if name != "ended" or not broken)
        yield from unlike_attributes(record, again, names, BY)
    for path in (EXTREMES, EXTREMES_FARTHEST) if exact and not killed else ():
        rows, others = (np.atleast_1d(one.read(path)) for one in (record, again))
        if found := first_difference(record, path, rows, others, BY, exact=True):
            yield found
    told, true = record.arrived, again.arrived
    wrong = told != true
    if not whole:
        wrong &= (told >= 0) & (told <= until) & (true <= until)
    elif killed:
        wrong &= (told >= 0) | (true < record.steps_run)
    for k in np.flatnonzero(wrong).tolist():
        yield unlike(record, ARRIVED, None, told[k], true[k], BY, row=k, robot=k)
