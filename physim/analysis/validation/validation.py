"""Validate a record: both kinds of contacts, their comparison, the reports, and the verdict.

Units of the JSON: m, s, m/s, rad/s, N s; bodies by id, named in run.bodies.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from physim.analysis.expectations import Held, expectations
from physim.analysis.metrics import Deep, Figures
from physim.analysis.validation.analytic_contacts import analytic_contacts
from physim.analysis.validation.comparison import (
    Comparison,
    check_extremes,
    compare,
    exact_distances,
)
from physim.analysis.validation.contact import Contact, contacts_of, swept_contacts
from physim.analysis.validation.decisions import DecisionTable
from physim.analysis.validation.finding import UNEXPLAINED, Finding
from physim.analysis.validation.motion import Motion, check_motion
from physim.analysis.validation.near_misses import NearMisses, near_misses
from physim.analysis.validation.origin import (
    compare_with_world,
    world_inside,
)
from physim.analysis.validation.prediction import DISAGREES, Prediction, Predictor
from physim.analysis.validation.recomputed import Recomputed, recompute
from physim.analysis.validation.rerun import (
    Rerun,
    compare_runs,
    run_again,
)
from physim.analysis.validation.told import sentences
from physim.analysis.validation.undisturbed import (
    Undisturbed,
    disturbing,
    undisturbed,
)
from physim.errors import RecordError, plural
from physim.json_text import json_text, plain
from physim.parts.declarations import Mode, Rule
from physim.record import Record, check_record
from physim.record.layout import OPTIONAL, moving
from physim.record.setup import Setup
from physim.simulation.again import AgainError, simulation_again
from physim.world.faults import describe
from physim.world.scene import Body

NOT_ASKED = "not asked for"
NO_COMMANDS = (
    "whether robots moved as commanded, their decisions, and the run simulated again: no run made "
    "these poses, and a log tells no commands"
)

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
    begun: float
    """[s] time of its first sample"""
    seconds: float
    """[s] simulated from there"""
    planned: float
    """[s] from there"""
    ended: str
    versions: dict[str, str]
    given: tuple[tuple[str, str], ...]
    """parts that came from Python in place of or beside what the world names: kind and name"""
    setup: Setup
    """controller and stages with their settings"""

    @property
    def moving(self) -> int:
        """How many bodies move: robots, movers and obstacles that can be pushed."""
        return moving(self.bodies)

    @property
    def considered(self) -> str:
        """What robots consider, in a word: robots, or others, where something else moves."""
        return "robot" if self.moving == self.robots else "other"


@dataclass(frozen=True, repr=False)
class Validation:
    """Everything that `validate` finds out about one run."""

    run: Run
    comparison: Comparison
    contacts: tuple[Contact, ...]
    """at samples, where the engine sees them"""
    grazes: tuple[Contact, ...]
    """between two samples"""
    near_misses: NearMisses
    motion: Motion
    """whether robots that touch nothing moved as commanded"""
    origin: tuple[Finding, ...]
    """what the record has otherwise than the world inside it gives"""
    recomputed: Recomputed
    """commands and counts held against the tables, and decisions made again"""
    expectations: tuple[Held, ...]
    """what the world inside expects of a run, and whether this one shows it"""
    deep: tuple[Deep, ...]
    """contacts deeper than `physim.contacts.allowed_depth`: what follows them is not physical"""
    rerun: Rerun | None = None
    """the run simulated again, where it was"""
    undisturbed: Undisturbed | None = None
    """the run without its disturbances, where it had such and contacts"""

    def __repr__(self) -> str:
        """Whose, and the verdict; `report` says all of it."""
        return f"<Validation of {describe(self.run.name)} seed {self.run.seed}: {self.verdict}>"

    def is_of(self, record: Record) -> bool:
        """Whether it is of this record, wherever that lies: the same run, with as many contacts."""
        same = replace(_run(record, record, self.run.source), versions=self.run.versions)
        return same == self.run and len(Figures(record).episodes) == len(self.contacts)

    @property
    def names(self) -> list[str]:
        """Name of every body by id."""
        return [body.name for body in self.run.bodies]

    @property
    def mispredicted(self) -> tuple[Prediction, ...]:
        """Of contacts that came in another step than the last decision before them foretold."""
        every = (one.prediction for one in self.contacts)
        return tuple(one for one in every if one is not None and one.verdict == DISAGREES)

    @property
    def findings(self) -> list[tuple[Finding, ...]]:
        """Every disagreement, sort by sort, as report and page list it."""
        again, pairs = self.rerun, self.comparison.disagreements
        first = []
        if again is not None and (one := again.difference) is not None:
            first = [replace(one, what=f"the first difference of the run: {one.what}")]
        foretold = (
            Finding(
                f"first touch at {one.touched:.6f} s, but contact predicted at {one.made:.2f} s: "
                f"{one.due_text(4)}", (one.a, one.b), one.step, one.found,
            )
            for one in self.mispredicted
        )  # fmt: skip
        return [
            self.origin, self.recomputed.mismatches, tuple(first), self.motion.strays,
            tuple(sorted(pairs, key=lambda one: one.cause != UNEXPLAINED)), tuple(foretold),
        ]  # fmt: skip

    @property
    def unexplained(self) -> int:
        """Disagreements of the checks without a cause."""
        return self.comparison.unexplained + len(self.mispredicted)

    @property
    def verdict(self) -> str:
        """``contact-free``, ``contacts: N of P pairs`` or ``checks disagree: ...``.

        Contacts between samples are counted apart: ``contacts: N of P pairs at samples, M between
        samples``. What the world expects and did not get stands behind: ``; not as expected:
        finished``. Of a run that broke off: ``broke off with an error at 2.50 s; no contact until
        then``.
        """
        if found := self._disagreeing():
            return f"checks disagree: {'; '.join(found)}"
        missed = ", ".join(one.key for one in self.missed if one.key != "contacts")
        told = self._touching()
        if self._is_broken:
            at, touched = self.run.begun + self.run.seconds, self.contacts or self.grazes
            told = f"{told if touched else 'no contact'} until then"
            told = f"broke off with an error at {at:.2f} s; {told}"
        return told + (f"; not as expected: {missed}" if missed else "")

    @property
    def _is_broken(self) -> bool:
        return self.run.ended == "error"

    def _disagreeing(self) -> list[str]:
        """By what the checks disagree, with the first place where it is one of many."""
        found = [f"{self.unexplained} unexplained"] if self.unexplained else []
        if count := len(self.motion.strays):
            times = "once" if count == 1 else f"{count} times"
            found.append(f"poses do not follow the commands, {times}")
        found += [one.line(self.names) for one in self.origin[:1]]
        if wrong := self.recomputed.mismatches:
            found.append(f"{plural(len(wrong), 'wrong value')}, {wrong[0].line(self.names)}")
        if self.rerun is not None and self.rerun.difference is not None:
            difference = self.rerun.difference.line(self.names)
            found.append(f"simulated again it is another run, {difference}")
        return found

    def _touching(self) -> str:
        contacts = f"contacts: {len(self.contacts)}"
        if self.contacts:
            contacts += f" of {self.pairs} pair{'s' if self.pairs != 1 else ''}"
        if self.grazes:
            return f"{contacts} at samples, {len(self.grazes)} between samples"
        return contacts if self.contacts else "contact-free"

    @property
    def missed(self) -> tuple[Held, ...]:
        """What the world expects of a run and did not get."""
        return tuple(one for one in self.expectations if not one.held)

    @property
    def pairs(self) -> int:
        """Number of pairs of bodies that touched at samples."""
        return len({(one.a, one.b) for one in self.contacts})

    @property
    def code(self) -> int:
        """Exit code: 0 contact-free and as expected, 1 contacts, not as expected or broken off
        with an error, 3 checks disagree."""
        if self._disagreeing():
            return DISAGREE
        failed = self.contacts or self.grazes or self.missed or self._is_broken
        return CONTACTS if failed else FREE


def validate(record: Record, *, rerun: bool = True, source: str | None = None) -> Validation:
    """Validate a record that holds the poses of every step, and all tables.

    The run is simulated again and held against the record, unless ``rerun`` is False or parts of
    it came from Python, which `judge` takes simulated again. ``source`` says in the report where
    the record came from: its file, when absent.

    Raises RecordError for a coarser one, or one that breaks off or is damaged. A run that was
    interrupted or killed is validated as far as it is recorded.
    """
    check_record(record)
    check_complete(record)
    if not rerun:
        return judge(record, None, NOT_ASKED, source=source)
    without = undisturbed(record)
    try:
        again = run_again(record, simulation_again(record))
    except AgainError as error:
        return judge(record, None, error.why, source=source, without=without)
    with again:
        return judge(record, again, source=source, without=without)


def judge(
    record: Record,
    again: Record | None,
    why_not: str = "",
    *,
    source: str | None = None,
    without: Undisturbed | None = None,
) -> Validation:
    """Validate a record, with the same run simulated ``again``, or with the reason why it is not.

    ``without``: the run without its disturbances, where that was made.
    What the record lacks is taken from the run simulated again; what it has is held against that.
    Raises RecordError as `validate` does.
    """
    check_record(record)
    whole = again if again is not None and missing(record) else record
    check_complete(whole)
    inside = world_inside(record)
    analytic, (exact, distances) = analytic_contacts(whole), exact_distances(whole)
    table = DecisionTable(whole)
    rerun = None if again is None else compare_runs(record, again)
    if without is None and len(whole.contacts) and (names := disturbing(whole)):
        without = Undisturbed(names, why_not=why_not or NOT_ASKED)
    is_again = whole is again or (rerun is not None and rerun.exact)
    if record.judged is None:
        recomputed = recompute(record, whole, inside, table, is_again)
        motion = check_motion(whole, table, inside.scene if inside.fits(whole) else None)
    else:
        recomputed, motion, why_not = Recomputed(0, 0, (NO_COMMANDS,), ()), Motion(0, 0, (), ()), ""
    parted = whole is again and rerun is not None and not rerun.whole
    if not parted:
        distances += check_extremes(record, whole, analytic, exact)
    if why_not:
        left_out = (*recomputed.left_out, f"the run simulated again: {why_not}")
        recomputed = replace(recomputed, left_out=left_out)
    return Validation(
        _run(record, whole, source or str(record.path or "in memory")),
        compare(whole, analytic, distances),
        contacts_of(whole, analytic, table, Predictor(whole, table)),
        swept_contacts(whole, table), near_misses(whole, analytic, table),
        motion,
        compare_with_world(record, inside), recomputed, tuple(expectations(whole)),
        Figures(whole).deep, rerun, without,
    )  # fmt: skip


def missing(record: Record) -> str:
    """What a record lacks, so that its run has to be simulated again; empty where it has all."""
    if record.record_every > 1 and record.steps_made > 0:
        return f"poses of one step in {record.record_every} only"
    if record.noted_until > record.steps_run:
        return "no samples of the last steps of which it tells"
    needed = OPTIONAL if record.judged is None else ("contacts",)
    tables = [table for table in needed if table not in record.tables]
    return f"no table {', '.join(tables)}" if tables else ""


def check_complete(record: Record) -> None:
    """Raise RecordError unless all tables and the poses of every step of the run are there."""
    if lacking := missing(record):
        raise RecordError(
            f"{record.where}: {lacking}; every step and all tables are needed (physim validate "
            "simulates such a run again)"
        )
    for step in np.setdiff1d(np.arange(record.begun_at, record.steps_run + 1), record.steps)[
        :1
    ].tolist():
        raise RecordError(f"{record.where}: step {step} has no sample; make the record again")


def _run(record: Record, whole: Record, source: str) -> Run:
    """What was run, as the record says; how long, as that says which has every sample."""
    controller = record.controller_name or "not named in the record"
    if len(record.setup.controllers) > 1 or record.judged is not None:
        controller = record.setup.controller_names
    return Run(
        record.name, source, record.seed, controller, record.bodies, record.robots, record.dt,
        whole.samples, record.begun, whole.steps_made * record.dt,
        (record.steps_planned - record.begun_at) * record.dt, record.ended, record.versions,
        record.given, record.setup,
    )  # fmt: skip


UNITS = "m, s, rad, m/s, rad/s, N s; world frame"


def json_of_validation(validation: Validation) -> str:
    """JSON of one run. Infinite values are the text "inf"; what was not looked at is null."""
    values = plain(validation, infinite=True, named=(Mode, Rule))
    for key in ("contacts", "grazes"):
        for one, said in zip(getattr(validation, key), values[key], strict=True):
            said["sentences"] = sentences(one, validation.names, validation.run.considered)
    found = {
        "format": "physim-validation",
        "version": 3,
        "units": UNITS,
        "verdict": validation.verdict,
        "exit_code": validation.code,
        "unexplained": validation.unexplained,
        "pairs_in_contact": validation.pairs,
        **values,
    }
    return json_text(found)
