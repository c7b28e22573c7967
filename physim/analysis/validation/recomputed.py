"""Commands and decisions of a record, held against its tables, its poses and its own controller.

A row of ``/commands`` stands where the stages of a command differ, or where the nominal one is not
that of the last decision; where there is none, the nominal command of the last decision was
applied. So each row must say something, and what stages there were must explain it.

Where the run cannot be simulated again to the bit, decisions are made again by the world's own
controller, from what it saw according to the record. Poses and held commands are those of the
record, stations follow from them, and the controller's memory is carried along; so each decision
is made again as it was made, whatever moved the robots.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.analysis.validation.analytic_contacts import pose_blocks
from physim.analysis.validation.decisions import DecisionTable
from physim.analysis.validation.mismatch import Mismatch, Mismatches
from physim.analysis.validation.origin import Inside
from physim.errors import ControllerError
from physim.geometry.shapes import FloatArray, IntArray, read_only
from physim.geometry.tracking import Tracking
from physim.parts.controller import (
    LONGEST_HOLD,
    BatchCapable,
    Controller,
    Decisions,
    Sensed,
    Snapshot,
)
from physim.parts.declarations import Declared
from physim.parts.registry import CONTROLLER, DISTURBANCE, FILTER, SENSING, shipped_parts
from physim.parts.stages import everybody, shared
from physim.record import Record
from physim.record.layout import COMMAND_STAGES, OPTIONAL
from physim.simulation.decisions import PerRobotAdapter
from physim.tolerances import SHARE
from physim.world.scene import Scene

PARTS = ("v", "omega")


@dataclass(frozen=True)
class Recomputed:
    """What was computed anew, and what does not agree."""

    decisions: int
    replayed: int
    """of these, how many were made again by the world's own controller"""
    left_out: tuple[str, ...]
    """what could not be computed, and why"""
    mismatches: tuple[Mismatch, ...]


def recompute(
    record: Record, whole: Record, inside: Inside, table: DecisionTable, again: bool
) -> Recomputed:
    """Hold counts of a record against its tables, commands of its ``whole`` run against each other.

    Where the run was not simulated ``again`` to the bit, its decisions are made again.
    """
    found, replayed, why_not = Mismatches(record), 0, ""
    _check_commands(whole, table, inside, found)
    _check_counts(record, found)
    if not again:
        replayed, why_not = _check_decisions(whole, inside, found)
    left_out = (f"decisions made again: {why_not}",) if why_not else ()
    return Recomputed(len(whole.updates), replayed, left_out, found.found)


def _check_commands(
    record: Record, table: DecisionTable, inside: Inside, found: Mismatches
) -> None:
    """Hold both tables of commands against each other, the limits and the stages there were."""
    rows, commands, stages = record.updates, record.commands, inside.stages
    key, listed_key = (some["step"] * record.robots + some["robot"] for some in (rows, commands))
    _, at_decision, listed = np.intersect1d(key, listed_key, return_indices=True)
    last = table.last_rows(commands["robot"], commands["step"])
    alike = np.ones(len(commands), dtype=np.bool_)
    for part in PARTS:
        exact = rows[f"nominal_{part}"].copy()
        decided = np.append(exact, 0.0)[last]  # row -1: 0 before the first decision
        exact[at_decision] = commands[f"applied_{part}"][listed]
        column, by = f"applied_{part}", "by the table /commands and the nominal command"
        found.add_rows("/updates", column, rows, exact, by, rows[column] != exact)
        values = [decided, *(commands[f"{stage}_{part}"] for stage in COMMAND_STAGES)]
        for k, (stage, due, by) in enumerate((
            ("nominal", len(rows) > 0, "by the last decision of that robot"),
            ("filtered", FILTER.word not in stages,
             "by the nominal command: there is no filter"),
            ("applied", DISTURBANCE.word not in stages,
             "by the filtered command: there is no disturbance"),
        )):  # fmt: skip
            wrong = values[k + 1] != values[k]
            alike &= ~wrong
            if due:
                found.add_rows("/commands", f"{stage}_{part}", commands, values[k], by, wrong)
    for k in np.flatnonzero(alike).tolist():
        found.add(
            "/commands", None, "there", "not", "as all stages are the command last decided",
            row=k, robot=int(commands["robot"][k]), step=int(commands["step"][k]),
        )  # fmt: skip
    by = "at most either way, by the limits of that robot in the world inside"
    for name, some, held in (
        ("/updates", rows, ("nominal",)), ("/commands", commands, ("nominal", "filtered"))
    ):  # fmt: skip
        for k, part in enumerate(PARTS if inside.fits(record) else ()):
            limit = inside.scene.limits[some["robot"], k]
            for stage in held:
                column = f"{stage}_{part}"
                wrong = ~(np.abs(some[column]) <= limit * (1.0 + SHARE))
                found.add_rows(name, column, some, limit, by, wrong)


def _check_counts(record: Record, found: Mismatches) -> None:
    """Hold counts and lists in attributes against the tables."""
    if "false_contacts" in record.tables:
        killed = record.ended == "running"  # it would have counted them in the end
        count = 0 if killed else len(record.false_contacts)
        if record.rejected_contacts != count:
            found.add(
                "attribute", "rejected_contacts", record.rejected_contacts, count,
                "by the table /false_contacts",
            )  # fmt: skip
    for table in OPTIONAL:
        if table not in record.tables and (rows := len(record.read(f"/{table}"))):
            found.add(
                "attribute", "tables", f"without {table}", f"with {table}",
                f"by that table, which has {rows} rows",
            )  # fmt: skip
    apart = np.diff(record.steps[:-1])  # the last sample may be nearer
    for wrong in apart[apart != record.record_every][:1].tolist():
        found.add("attribute", "record_every", record.record_every, wrong, "by the recorded steps")


# Decided again


def _check_decisions(record: Record, inside: Inside, found: Mismatches) -> tuple[int, str]:
    """Stations against poses, and decisions made again: how many, and why others are not."""
    scene, own, why_not = inside.scene, inside.controller, inside.why_not
    kind, replay = scene.world.controller.type, None
    if SENSING.word in inside.stages:
        why_not = "what robots sensed is not in the record"
    elif own is not None and kind not in shipped_parts(CONTROLLER):
        why_not = f"{kind} is not shipped with physim, and need not decide alike twice"
    elif own is not None and record.declared != Declared.of(own):
        why_not = "the record declares others"
    elif own is not None:
        replay = _Replay(scene, own)
    rows, lead = record.updates, record.lead
    stations = np.zeros((4, len(rows)))
    for truth, due, at in _moments(record):
        station, deviation, reference = truth.station, truth.deviation, truth.reference_station
        error = (reference.mean() - reference[due]) - (lead.mean() - lead[due])
        stations[:, at] = station[due], deviation[due], reference[due], error
        if replay is not None:
            replay.decide(truth, due, at)
    names = ("station", "deviation", "reference_station", "formation_error")
    for name, exact in zip(names, stations, strict=True):
        found.add_rows("/updates", name, rows, exact, "by the poses")
    if replay is None or not replay.made:
        return 0, why_not
    replay.hold(record, found, f"decided again by {kind}")
    return sum(map(len, replay.rows)), replay.broken


def _moments(record: Record) -> Iterator[tuple[Snapshot, IntArray, IntArray]]:
    """Each step at which robots decided: what was so, who they were, their rows."""
    updates, tracking = record.updates, None
    for pose, first in pose_blocks(record):
        if tracking is None:
            tracking = Tracking(record.paths, record.reference, record.shapes.radius, pose[0])
        course = tracking.course(pose)  # its first sample is the last of the block before: it stays
        last = first + len(pose)
        end = last if last >= record.samples else last - 1
        held = read_only(record.commands_over("nominal", first - 1, last - 1))
        low, high = np.searchsorted(updates["step"], (first, end))
        rows = updates[low:high]
        order = np.lexsort((rows["robot"], rows["step"]))
        edges = np.flatnonzero(np.diff(rows["step"][order], prepend=-1))
        for at in np.split(order, edges[1:]) if len(rows) else ():
            k = int(rows["step"][at[0]]) - first
            # Laid out as in the loop: for arrays of another kind kernels are compiled anew.
            columns = read_only(np.ascontiguousarray(course[k].T))
            truth = Snapshot(first + k, pose[k], held[k], *columns)
            yield truth, rows["robot"][at].astype(np.int64), low + at


class _Replay:
    """A controller that decides again, step by step."""

    def __init__(self, scene: Scene, controller: Controller) -> None:
        self.scene, self.declared = scene, Declared.of(controller)
        self.batch = (
            controller.batch(scene)
            if isinstance(controller, BatchCapable)
            else PerRobotAdapter(controller, scene, self.declared)
        )
        self.memory, self.shared = self.batch.memory(), shared(scene.robots)
        self.made: list[Decisions] = []
        self.rows: list[IntArray] = []
        """numbers of their rows"""
        self.broken = ""
        """what the controller said where it could not decide; nothing is checked from there on"""

    def decide(self, truth: Snapshot, due: IntArray, rows: IntArray) -> None:
        """Make the decisions of a step again."""
        if self.broken:
            return
        sensed: Sensed = everybody(truth, self.shared)
        try:
            self.made.append(self.batch.decide_due(sensed, due, self.memory))
            self.rows.append(rows)
        except ControllerError as error:
            self.broken = str(error).splitlines()[0]

    def hold(self, record: Record, found: Mismatches, by: str) -> None:
        """Hold the update table, and who was considered, against the decisions made again."""
        number, rows = np.concatenate(self.rows), record.updates

        def column(values: Callable[[Decisions], NDArray[Any]]) -> NDArray[Any]:
            made = np.concatenate([values(one) for one in self.made])
            whole = np.zeros((len(rows), *made.shape[1:]), dtype=made.dtype)
            whole[number] = made
            return whole

        command, report = column(lambda d: d.command), column(lambda d: d.report)
        exact: dict[str, NDArray[Any]] = {
            "nominal_v": command[:, 0],
            "nominal_omega": command[:, 1],
            "mode": column(lambda d: d.mode),
            "rule": column(lambda d: d.rule),
            "next_step": rows["step"] + whole_steps(column(lambda d: d.hold), self.scene.dt),
            **{one.name: report[:, c] for c, one in enumerate(self.declared.columns)},
        }
        last = int(rows["step"][number].max())
        known = rows["step"] <= last
        for name, values in exact.items():
            found.add_rows("/updates", name, rows[known], values[known], by)
        self._hold_considered(record, record.considered, number, last, found, by)

    def _hold_considered(
        self,
        record: Record,
        table: NDArray[np.void],
        number: IntArray,
        last: int,
        found: Mismatches,
        by: str,
    ) -> None:
        n = record.robots
        rows = record.updates[number]
        count = np.concatenate([np.diff(d.considered_start) for d in self.made])
        decision = np.repeat(rows["step"] * n + rows["robot"], count)
        ours = decision * n + np.concatenate([d.considered for d in self.made])
        theirs = (table["step"] * n + table["robot"]) * n + table["other"]
        theirs = theirs[table["step"] <= last]
        for key in np.unique(np.setxor1d(ours, theirs) // n).tolist():
            told, due = (
                ", ".join(record.names[j] for j in np.sort(some[some // n == key] % n)) or "nobody"
                for some in (theirs, ours)
            )
            place = {"robot": key % n, "step": key // n}
            found.add("/considered", "other", told, due, by, **place)


def whole_steps(hold: FloatArray, dt: float) -> IntArray:
    """Steps that decisions hold: rounded down, one at least (14)."""
    steps = np.clip(np.floor(hold / dt + SHARE), 1.0, LONGEST_HOLD)
    return np.asarray(steps, dtype=np.int64)
