"""Validate a record: the ledgers, their comparison, the contacts, and the verdict."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from physim.errors import RecordError
from physim.metrics import Deep, deep_contacts
from physim.record import Record
from physim.scene import Body
from physim.validation.comparison import Comparison, Confusion, compare
from physim.validation.contact_report import (
    ContactReport,
    GrazeReport,
    contact_reports,
    graze_reports,
)
from physim.validation.decisions import DecisionTable
from physim.validation.ledger import Ledger, work_out
from physim.validation.motion import Motion, check_motion
from physim.validation.near_misses import NearMisses, near_misses
from physim.validation.origin import Origin, check_origin
from physim.validation.prediction import DISAGREES, Predictor
from physim.validation.recorded import exact_distances

FREE, CONTACTS, DISAGREE = 0, 1, 3
"""Exit codes of the verdict."""


@dataclass(frozen=True)
class Run:
    """What was validated."""

    name: str
    source: str
    """file of the record, or what was run"""
    seed: int
    controller: str
    bodies: tuple[Body, ...]
    robots: int
    dt: float
    """[s]"""
    samples: int
    seconds: float
    """[s] simulated"""
    planned: float
    """[s]"""
    ended: str
    versions: dict[str, str]
    given: tuple[tuple[str, str], ...]
    """parts that came from Python in place of or beside what the world names: kind and name"""


@dataclass(frozen=True)
class Validation:
    """Everything that `validate` finds out about one run."""

    run: Run
    comparison: Comparison
    contacts: tuple[ContactReport, ...]
    """at samples, where the engine sees them"""
    grazes: tuple[GrazeReport, ...]
    """between two samples"""
    near_misses: NearMisses
    motion: Motion
    """whether robots that touch nothing moved as commanded"""
    origin: Origin
    """whether the record is that of the world inside it"""
    deep: tuple[Deep, ...]
    """contacts deeper than `physim.tolerances.DEEP`: what follows them is not physical"""
    resimulated: bool = False
    """the record was coarse: the run was simulated again, and its samples agreed"""

    @property
    def mispredicted(self) -> tuple[ContactReport, ...]:
        """Contacts that came in another step than the last decision before them foretold."""
        return tuple(one for one in self.contacts if one.prediction.verdict == DISAGREES)

    @property
    def unexplained(self) -> int:
        """Disagreements of the checks without a cause."""
        return self.comparison.unexplained + len(self.mispredicted)

    @property
    def verdict(self) -> str:
        """``contact-free``, ``contacts: N of P pairs`` or ``checks disagree: ...``.

        Contacts between samples are counted apart: ``contacts: N of P pairs at samples, M between
        samples``. The checks disagree by ``N unexplained``, by ``poses do not follow the commands,
        N times``, and by what is not as in the world inside the record.
        """
        found = [f"{self.unexplained} unexplained"] if self.unexplained else []
        if count := len(self.motion.strays):
            times = "once" if count == 1 else f"{count} times"
            found.append(f"poses do not follow the commands, {times}")
        found += self.origin.differences[:1]
        if found:
            return f"checks disagree: {'; '.join(found)}"
        contacts = f"contacts: {len(self.contacts)}"
        if self.contacts:
            contacts += f" of {self.pairs} pair{'s' if self.pairs != 1 else ''}"
        if self.grazes:
            return f"{contacts} at samples, {len(self.grazes)} between samples"
        return contacts if self.contacts else "contact-free"

    @property
    def pairs(self) -> int:
        """Number of pairs of bodies that touched at samples."""
        return len({(one.a, one.b) for one in self.contacts})

    @property
    def code(self) -> int:
        """Exit code: 0 contact-free, 1 contacts, 3 checks disagree."""
        if self.unexplained or self.motion.strays or self.origin.differences:
            return DISAGREE
        return CONTACTS if self.contacts or self.grazes else FREE


def validate(record: Record, *, source: str | None = None, resimulated: bool = False) -> Validation:
    """Validate a record that holds the poses of every step.

    ``source`` says in the report where it came from: its file, when absent.

    Raises RecordError for a coarser one, or one that breaks off or is damaged. A run that was
    interrupted or killed is judged as far as it is recorded.
    """
    check_complete(record)
    origin = check_origin(record)
    ledger: Ledger = work_out(record)
    table = DecisionTable(record)
    exact = exact_distances(record)
    comparison = compare(record, ledger, exact)
    contacts = contact_reports(record, ledger, table, Predictor(record, table))
    return Validation(
        _run(record, source), comparison, contacts, graze_reports(record, table),
        near_misses(record, ledger, table, exact), check_motion(record, table), origin,
        deep_contacts(record), resimulated,
    )  # fmt: skip


def confusions(validation: Validation) -> list[tuple[str, Confusion]]:
    """Rows of the confusion table with their labels; kinds of pairs that do not exist left out."""
    comparison = validation.comparison
    rows = []
    for kind, label in (("robots", "robot and robot"), ("boundaries", "robot and boundary")):
        for when, tables in (
            ("at samples", comparison.at_samples), ("between, swept", comparison.over_steps)
        ):  # fmt: skip
            if sum(tables[kind]):
                rows.append((f"{label}, {when}", tables[kind]))
    return rows


def is_coarse(record: Record) -> bool:
    """Whether a record leaves steps out, so that its run has to be simulated again."""
    return record.record_every > 1 and record.steps_run > 0


def check_complete(record: Record) -> None:
    """Raise RecordError unless the poses of every step up to the end of the run are there."""
    where = record.path or "record in memory"
    if is_coarse(record):
        raise RecordError(
            f"{where}: poses of every {record.record_every}. step only; every step is needed "
            "(physim validate simulates such a run again)"
        )
    steps = record.steps
    if not len(steps):
        raise RecordError(f"{where}: truncated: no samples; make the record again")
    gap = np.flatnonzero(np.diff(steps) != 1)
    if len(gap):
        raise RecordError(
            f"{where}: step {steps[gap[0]] + 1} has no sample, the record has those of steps "
            f"{steps[gap[0]]} and {steps[gap[0] + 1]}; make the record again"
        )
    if len(steps) != record.steps_run + 1 or steps[0] != 0 or steps[-1] != record.steps_run:
        raise RecordError(
            f"{where}: truncated: {len(steps)} samples for {record.steps_run} steps; "
            f"{record.steps_run + 1} are needed; make the record again"
        )


def _run(record: Record, source: str | None) -> Run:
    return Run(
        record.name, source or str(record.path or "in memory"), record.seed, _controller(record),
        record.bodies, record.robots, record.dt, record.samples, record.steps_run * record.dt,
        record.steps_planned * record.dt, record.ended, record.versions, record.given,
    )  # fmt: skip


def _controller(record: Record) -> str:
    """Name of the controller: what decided, or that of the world's text."""
    if record.controller:
        return record.controller
    return record.world.controller.type if record.world_text.strip() else "not named in the record"
