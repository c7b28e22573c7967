"""Commands and decisions of a record, held against its tables, its poses and its own controller.

A row of ``/commands`` stands where the stages of a command differ, or where the nominal one is not
that of the last decision; where there is none, the nominal command of the last decision was
applied. So each row must say something, and what stages there were must explain it.

Where the run cannot be simulated again to the bit, decisions are made again by the world's own
controller, in a run that is led through the poses of the record: so each is made as it was made,
whatever moved the robots.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from physim.analysis.metrics.progress import blocks
from physim.analysis.validation.decisions import DecisionTable
from physim.analysis.validation.finding import Finding, first_difference, unlike, unlike_rows
from physim.analysis.validation.origin import Inside
from physim.analysis.validation.rerun import run_led
from physim.errors import ControllerError
from physim.parts.declarations import Declared
from physim.parts.registry import CONTROLLER, DISTURBANCE, FILTER, SENSING, shipped_parts
from physim.record import Record
from physim.record.layout import COMMAND_STAGES, OPTIONAL, OTHERS, PARTS
from physim.simulation.driving import applied_of, followed
from physim.tolerances import SHARE
from physim.units import joined


@dataclass(frozen=True)
class Recomputed:
    """What was computed anew, and what does not agree."""

    decisions: int
    replayed: int
    """of these, how many were made again by the world's own controller"""
    left_out: tuple[str, ...]
    """what could not be computed, and why"""
    mismatches: tuple[Finding, ...]


def recompute(
    record: Record, whole: Record, inside: Inside, table: DecisionTable, again: bool
) -> Recomputed:
    """Hold counts of a record against its tables, commands of its ``whole`` run against each other.

    Where the run was not simulated ``again`` to the bit, its decisions are made again.
    """
    found = [*_check_commands(whole, table, inside), *_check_counts(record)]
    replayed, why_not = 0, ""
    if not again:
        wrong, replayed, why_not = _check_decisions(whole, inside)
        found += wrong
    left_out = (f"decisions made again: {why_not}",) if why_not else ()
    found.sort(key=lambda one: -1 if one.step is None else one.step)
    return Recomputed(len(whole.updates), replayed, left_out, tuple(found))


def _check_commands(record: Record, table: DecisionTable, inside: Inside) -> Iterator[Finding]:
    """Hold both tables of commands against each other, the limits and the stages there were."""
    rows, commands, stages = record.updates, record.commands, inside.stages
    key, listed_key = (some["step"] * record.robots + some["robot"] for some in (rows, commands))
    _, at_decision, listed = np.intersect1d(key, listed_key, return_indices=True)
    last = table.last_rows(commands["robot"], commands["step"])
    inherited = (last < 0) & (record.begun_at > 0)  # held from before the record began
    alike = ~inherited
    driven = inside.scene.drives if inside.fits(record) else ()
    for part in PARTS[: record.columns]:
        exact = rows[f"nominal_{part}"].copy()
        decided = np.append(exact, 0.0)[last]  # row -1: 0 before the first decision
        decided[inherited] = commands[f"nominal_{part}"][inherited]
        exact[at_decision] = commands[f"applied_{part}"][listed]
        column, by = f"applied_{part}", "by the table /commands and the nominal command"
        wrong = rows[column] != exact
        yield from unlike_rows(record, "/updates", column, rows, exact, by, wrong)
        values = [decided, *(commands[f"{stage}_{part}"] for stage in COMMAND_STAGES)]
        for k, (stage, due, by) in enumerate((
            ("nominal", len(rows) > 0, "by the last decision of that robot"),
            ("filtered", FILTER.word not in stages,
             "by the nominal command: there is no filter"),
            ("applied", DISTURBANCE.word not in stages and not driven,
             "by the filtered command: there is no disturbance"),
        )):  # fmt: skip
            wrong, column = values[k + 1] != values[k], f"{stage}_{part}"
            alike &= ~wrong
            if due:
                yield from unlike_rows(record, "/commands", column, commands, values[k], by, wrong)
    by = "as all stages are the command last decided"
    yield from unlike_rows(record, "/commands", None, commands, "not", by, alike)
    by = "at most either way, by the limits of that robot in the world inside"
    for name, some, held in (
        ("/updates", rows, ("nominal",)), ("/commands", commands, ("nominal", "filtered"))
    ):  # fmt: skip
        for k, part in enumerate(PARTS[: record.columns] if inside.fits(record) else ()):
            limit = inside.scene.limits[some["robot"], k]
            for column in (f"{stage}_{part}" for stage in held):
                wrong = ~(np.abs(some[column]) <= limit * (1.0 + SHARE))
                yield from unlike_rows(record, name, column, some, limit, by, wrong)
    if driven and record.begun_at == 0:
        yield from _check_drives(record, inside, DISTURBANCE.word in stages)


def _check_drives(record: Record, inside: Inside, is_disturbed: bool) -> Iterator[Finding]:
    """Hold applied commands and steering against what the drives make of the filtered commands.

    Disturbances stand behind the drives: of a run that had some the steering alone is told.
    """
    scene, begin = inside.scene, 0
    state = np.zeros((record.robots, 4))
    for begin, end in blocks(record):
        over = (record.commands_over(stage, begin, end) for stage in ("filtered", "applied"))
        for step, (filtered, applied) in enumerate(zip(*over, strict=True), start=begin):
            state = followed(scene, filtered, state, step * record.dt)
            found = (
                [] if is_disturbed else [("applied command", applied_of(state, filtered), applied)]
            )
            row = int(np.searchsorted(record.steps, step + 1))
            if scene.steers and row < record.samples and record.steps[row] == step + 1:
                found.append(("steering", state[:, 3:], record.steering[row][:, None]))
            for what, due, told in found:
                for i in np.flatnonzero((due != told).any(axis=1))[:1].tolist():
                    text = (
                        f"its {what} is {told[i].tolist()} in the record, {due[i].tolist()} by its "
                        "drive from the filtered commands"
                    )
                    yield Finding(text, (i,), step, step * record.dt)
                    return


def _check_counts(record: Record) -> Iterator[Finding]:
    """Hold counts and lists in attributes against the tables."""
    if "false_contacts" in record.tables:
        killed = record.ended == "running"  # it would have counted them in the end
        count = 0 if killed else len(record.false_contacts)
        if (told := record.rejected_contacts) != count:
            by = "by the table /false_contacts"
            yield unlike(record, "attribute", "rejected_contacts", told, count, by)
    for table in OPTIONAL:
        if table not in record.tables and (rows := len(record.read(f"/{table}"))):
            by = f"by that table, which has {rows} rows"
            both = f"without {table}", f"with {table}"
            yield unlike(record, "attribute", "tables", *both, by)
    apart = np.diff(record.steps[:-1])  # the last sample may be nearer
    apart = apart[record.begun_at % record.record_every > 0 :]  # and the first, of a later begin
    for wrong in apart[apart != record.record_every][:1].tolist():
        told, by = record.record_every, "by the recorded steps"
        yield unlike(record, "attribute", "record_every", told, wrong, by)


def _check_decisions(record: Record, inside: Inside) -> tuple[list[Finding], int, str]:
    """Stations against poses, and decisions made again: how many, and why others are not."""
    rows, lead, own, why_not = record.updates, record.lead, inside.controller, inside.why_not
    samples = rows["step"] - record.begun_at
    station, deviation, reference = record.course[samples, rows["robot"]].T
    mean = record.course[samples, :, 2].mean(axis=1)
    due = {
        "station": station, "deviation": deviation, "reference_station": reference,
        "formation_error": (mean - reference) - (lead.mean() - lead[rows["robot"]]),
    }  # fmt: skip
    found = [
        one
        for name, exact in due.items()
        for one in unlike_rows(record, "/updates", name, rows, exact, "by the poses")
    ]
    kind = record.setup.controller_names
    types = {one.type for one in inside.scene.world.drivers()}
    own_ones = joined(sorted(types.difference(shipped_parts(CONTROLLER))) or [""])
    if not len(rows):
        why_not = "the run made no decision"
    elif SENSING.word in inside.stages:
        why_not = "what robots sensed is not in the record"
    elif own is not None and own_ones:
        why_not = f"{own_ones} is not shipped with physim, and need not decide alike twice"
    elif own is not None and record.declared != Declared.of(own):
        why_not = "the record declares others"
    elif record.begun_at:
        why_not = "the run went on from the state of another"
    if why_not or own is None:
        return found, 0, why_not
    try:
        again = run_led(record, inside.scene)
    except ControllerError as error:
        return found, 0, str(error).splitlines()[0]
    killed = record.ended == "running"  # not all that was decided at its last step may be there
    until = min(int(some.updates["step"][-1]) for some in (record, again)) - killed
    held_elsewhere = ("applied_v", "applied_omega", *due)
    names = [name for name in rows.dtype.names or () if name not in held_elsewhere]
    for path, some, others in (
        ("/updates", rows[names], again.updates[names]),
        (OTHERS, record.considered, again.considered),
    ):
        some, others = (one[one["step"] <= until] for one in (some, others))
        by = f"decided again by {kind}"
        one = first_difference(record, path, some, others, by, exact=False)
        found += [] if one is None else [one]
    return found, int((rows["step"] <= until).sum()), ""
