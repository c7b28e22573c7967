"""All that a record says of decisions, commands and its end, computed anew from its poses.

Decisions are made again by the world's own controller, from what it saw according to the record.
Poses and held commands are those of the record, stations follow from them, and the controller's
memory is carried along; so each decision is made again as it was made, whatever moved the robots.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.analysis.validation.columns import (
    Considered,
    Meaning,
    StandardColumns,
    check_considered,
    check_priority,
)
from physim.analysis.validation.consistency import (
    ArrivalCheck,
    check_commands,
    check_counts,
    check_ending,
    check_schedule,
)
from physim.analysis.validation.decisions import DecisionTable, SampleBlock, sample_blocks
from physim.analysis.validation.mismatch import (
    SLACK,
    SLACKS,
    Mismatch,
    Mismatches,
    Value,
    differs,
    plain,
)
from physim.analysis.validation.origin import Inside
from physim.analysis.validation.responsibility import has_priority
from physim.errors import ControllerError
from physim.geometry.shapes import FloatArray, IntArray, read_only
from physim.parts.controller import (
    LONGEST_HOLD,
    BatchCapable,
    Controller,
    Decisions,
    Sensed,
    Snapshot,
)
from physim.parts.declarations import NO_NUMBER, Declared
from physim.parts.registry import CONTROLLER, DISTURBANCE, FILTER, SENSING, shipped_parts
from physim.parts.stages import everybody, shared
from physim.record import Record
from physim.simulation.decisions import PerRobotAdapter
from physim.tolerances import SHARE
from physim.world.scene import Scene

Rows = NDArray[np.void]


class Replay:
    """A controller that decides again, step by step."""

    def __init__(
        self, record: Record, scene: Scene, controller: Controller, considered: Considered
    ) -> None:
        self.record, self.scene, self.considered = record, scene, considered
        self.declared = Declared.of(controller)
        self.by = f"decided again by {scene.world.controller.type}"
        self.batch = (
            controller.batch(scene)
            if isinstance(controller, BatchCapable)
            else PerRobotAdapter(controller, scene, self.declared)
        )
        self.memory = self.batch.memory()
        self.shared = shared(scene.robots)
        self.broken: str | None = None
        """what the controller said where it could not decide; nothing is checked from there on"""
        self.decided = 0

    def take(self, block: SampleBlock, found: Mismatches) -> None:
        """Make the decisions of a stretch again and hold the record against them."""
        rows = block.rows
        if not len(rows) or self.broken is not None:
            return
        order = np.lexsort((rows["robot"], rows["step"]))
        edges = np.flatnonzero(np.diff(rows["step"][order], prepend=-1))
        decisions = []
        for low, high in zip(edges, [*edges[1:], len(order)], strict=True):
            some = order[low:high]
            due = rows["robot"][some].astype(np.int64)
            k = int(rows["step"][some[0]]) - block.first
            try:
                decisions.append(self.batch.decide_due(self._sensed(block, k), due, self.memory))
            except ControllerError as error:
                self.broken = str(error).splitlines()[0]
                order = order[:low]
                break
        if decisions:
            self.decided += len(order)
            self._hold(rows[order], block.row + order, decisions, found)

    def _sensed(self, block: SampleBlock, k: int) -> Sensed:
        """What everybody knows at sample ``k`` of a block."""
        # Laid out as in the loop: for arrays of another kind kernels are compiled anew.
        course = read_only(np.ascontiguousarray(block.course[k].T))
        truth = Snapshot(block.first + k, block.pose[k], block.held[k], *course)
        return everybody(truth, self.shared)

    def _hold(
        self, rows: Rows, number: IntArray, decisions: list[Decisions], found: Mismatches
    ) -> None:
        """Hold rows (M,) of the update table against the same decisions made again."""
        command = np.concatenate([d.command for d in decisions])
        hold = np.concatenate([d.hold for d in decisions])
        exact: dict[str, NDArray[Any]] = {
            "nominal_v": command[:, 0],
            "nominal_omega": command[:, 1],
            "mode": np.concatenate([d.mode for d in decisions]),
            "rule": np.concatenate([d.rule for d in decisions]),
            "next_step": rows["step"] + whole_steps(hold, self.scene.dt),
        }
        report = np.concatenate([d.report for d in decisions])
        for c, one in enumerate(self.declared.columns):
            exact[one.name] = report[:, c]
        for column, values in exact.items():
            wrong = np.flatnonzero(differs(rows[column], values, SLACKS.get(column, SLACK)))
            words = self._words(column)
            for k in wrong.tolist():
                found.add(
                    "/updates", column, words(rows[column][k]), words(values[k]), self.by,
                    row=int(number[k]), robot=int(rows["robot"][k]), step=int(rows["step"][k]),
                )  # fmt: skip
        self._hold_considered(rows, number, decisions, found)

    def _hold_considered(
        self, rows: Rows, number: IntArray, decisions: list[Decisions], found: Mismatches
    ) -> None:
        again = np.concatenate([d.considered for d in decisions])
        count = np.concatenate([np.diff(d.considered_start) for d in decisions])
        first, last = self.considered.start[number], self.considered.end[number]
        ends = np.cumsum(count)
        alike = count == last - first
        sure = np.repeat(alike, count)
        place = np.arange(len(again)) + np.repeat(first - (ends - count), count)
        order = np.lexsort((again, np.repeat(np.arange(len(rows)), count)))
        unlike = again[order][sure] != self.considered.other[place[sure]]
        wrong = ~alike
        wrong[np.repeat(np.arange(len(rows)), count)[sure][unlike]] = True
        names = self.record.names
        for k in np.flatnonzero(wrong).tolist():
            theirs = self.considered.other[first[k] : last[k]]
            ours = np.sort(again[ends[k] - count[k] : ends[k]])
            recorded, exact = (
                ", ".join(names[j] for j in some) or "nobody" for some in (theirs, ours)
            )
            found.add(
                "/considered", "other", recorded, exact, self.by,
                robot=int(rows["robot"][k]), step=int(rows["step"][k]),
            )  # fmt: skip

    def _words(self, column: str) -> Callable[[Any], Value]:
        """How values of a column are printed: modes and rules by name."""
        names = {
            "mode": [mode.name for mode in self.record.modes],
            "rule": [rule.name for rule in self.record.declared.rules],
        }.get(column)
        if names is None:
            return plain
        return lambda number: "none" if number == NO_NUMBER else names[int(number)]


def whole_steps(hold: FloatArray, dt: float) -> IntArray:
    """Steps that decisions hold: rounded down, one at least (14)."""
    steps = np.clip(np.floor(hold / dt + SHARE), 1.0, LONGEST_HOLD)
    return np.asarray(steps, dtype=np.int64)


@dataclass(frozen=True)
class Recomputed:
    """What was computed anew, and what does not agree."""

    decisions: int
    replayed: int
    """of these, how many were made again by the world's own controller"""
    columns: tuple[str, ...]
    """standard columns of decisions that were computed from the geometry"""
    left_out: tuple[str, ...]
    """what could not be computed, and why"""
    mismatches: tuple[Mismatch, ...]


def recompute(record: Record, inside: Inside, table: DecisionTable) -> Recomputed:
    """Hold everything that follows from poses, commands and the world inside against the record."""
    found, scene = Mismatches(record), inside.scene
    considered = Considered(record)
    replay, columns, left_out = _checkers(record, inside, considered)
    by_rule = replay is not None and scene is not None and has_priority(record)
    arrivals = None if scene is None else ArrivalCheck(scene)
    check_schedule(record, table, found)
    check_considered(record, considered, found)
    check_commands(record, table, scene, inside.stages, found)
    check_counts(record, found)
    for block in sample_blocks(record):
        _stations(record, block, found)
        if arrivals is not None:
            arrivals.take(block)
        if columns is not None:
            columns.take(block, found)
        if by_rule and scene is not None:
            check_priority(record, block, scene.sensing_range, considered, found)
        if replay is not None:
            replay.take(block, found)
    if arrivals is not None and scene is not None:
        check_ending(record, scene, arrivals, found)
    if replay is not None and replay.broken is not None:
        left_out.append(f"decisions from there on: {replay.broken}")
    for word in (FILTER.word, DISTURBANCE.word):
        if word in (inside.stages or ()):
            left_out.append(f"what each {word} made of commands: only --rerun runs it again")
    return Recomputed(
        len(record.updates), 0 if replay is None else replay.decided,
        () if columns is None else tuple(columns.columns), tuple(left_out), found.found,
    )  # fmt: skip


def _checkers(
    record: Record, inside: Inside, considered: Considered
) -> tuple[Replay | None, StandardColumns | None, list[str]]:
    """What makes decisions again, what works out their columns, and what cannot be done."""
    scene, own = inside.scene, inside.controller
    if not len(record.updates):
        return None, None, ["decisions: there are none"]
    if scene is None:
        return None, None, [
            "commands within limits, arrival, modes, rules, targets, considered robots, distances "
            f"and collision times of decisions: {inside.why_not}"
        ]  # fmt: skip
    if SENSING.word in (inside.stages or ()):
        return None, None, [
            "modes, rules, commands, targets, considered robots, distances and collision times of "
            "decisions: what robots sensed is not in the record"
        ]  # fmt: skip
    kind = scene.world.controller.type
    is_ours = kind in shipped_parts(CONTROLLER)  # a horizon of others may be that of a plan
    settings = getattr(own, "settings", None) if is_ours else None
    columns = StandardColumns(record, scene, Meaning.of(record, settings), considered)
    why = inside.why_not
    if own is not None and not is_ours:
        why = f"{kind} is not shipped with physim, and need not decide alike twice"
    elif own is not None and record.declared != Declared.of(own):
        why = "the record declares others"
    if why or own is None:
        what = "modes, rules, commands and targets of decisions, and which robots they considered"
        return None, columns, [f"{what}: {why}"]
    return Replay(record, scene, own, considered), columns, []


def _stations(record: Record, block: SampleBlock, found: Mismatches) -> None:
    """Stations and formation errors of decisions against the poses."""
    rows, lead = block.rows, record.lead
    station, deviation, reference = block.course[block.at, rows["robot"]].T
    mean = block.reference_station[block.at].mean(axis=1)
    error = (mean - reference) - (lead.mean() - lead[rows["robot"]])
    exact = {"station": station, "deviation": deviation, "reference_station": reference}
    found.add_columns("/updates", rows, block.row, exact, "by its pose")
    found.add_columns(
        "/updates", rows, block.row, {"formation_error": np.asarray(error)}, "by all poses"
    )
