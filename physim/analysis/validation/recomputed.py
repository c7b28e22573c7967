"""Commands and decisions of a record, held against its tables, its poses and its own controller.

Where the run cannot be simulated again to the bit, decisions are made again by the world's own
controller, from what it saw according to the record. Poses and held commands are those of the
record, stations follow from them, and the controller's memory is carried along; so each decision
is made again as it was made, whatever moved the robots.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.analysis.validation.consistency import check_commands, check_counts
from physim.analysis.validation.decisions import DecisionTable, SampleBlock, sample_blocks
from physim.analysis.validation.mismatch import (
    SLACK,
    SLACKS,
    Mismatch,
    Mismatches,
    differs,
    words,
)
from physim.analysis.validation.origin import Inside
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
from physim.parts.declarations import Declared
from physim.parts.registry import CONTROLLER, SENSING, shipped_parts
from physim.parts.stages import everybody, shared
from physim.record import Record
from physim.simulation.decisions import PerRobotAdapter
from physim.tolerances import SHARE
from physim.world.scene import Scene

Rows = NDArray[np.void]


class Considered:
    """The table of considered robots, by decision."""

    def __init__(self, record: Record) -> None:
        table = record.considered
        key, decided = (
            rows["step"] * record.robots + rows["robot"] for rows in (table, record.updates)
        )
        order = np.lexsort((table["other"], key))
        self.other = table["other"][order].astype(np.int64)
        self.start = np.searchsorted(key[order], decided).astype(np.int64)
        """(M,) first of each decision in ``other``, and one past its last:"""
        self.end = np.searchsorted(key[order], decided, side="right").astype(np.int64)


class Replay:
    """A controller that decides again, step by step."""

    def __init__(self, record: Record, scene: Scene, controller: Controller) -> None:
        self.record, self.scene, self.considered = record, scene, Considered(record)
        self.declared = Declared.of(controller)
        self.by = f"decided again by {scene.world.controller.type}"
        self.batch = (
            controller.batch(scene)
            if isinstance(controller, BatchCapable)
            else PerRobotAdapter(controller, scene, self.declared)
        )
        self.memory = self.batch.memory()
        self.shared = shared(scene.robots)
        self.broken = ""
        """what the controller said where it could not decide; nothing is checked from there on"""
        self.decided = 0

    def take(self, block: SampleBlock, found: Mismatches) -> None:
        """Make the decisions of a stretch again and hold the record against them."""
        rows = block.rows
        if not len(rows) or self.broken:
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
            for k in wrong.tolist():
                told, due = (words(self.record, column, some[k]) for some in (rows[column], values))
                found.add(
                    "/updates", column, told, due, self.by,
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
    left_out: tuple[str, ...]
    """what could not be computed, and why"""
    mismatches: tuple[Mismatch, ...]


def recompute(record: Record, inside: Inside, table: DecisionTable, again: bool) -> Recomputed:
    """Hold commands and counts against tables and the world inside.

    Where the run was not simulated ``again`` to the bit, its decisions are made again.
    """
    found, left_out, replayed = Mismatches(record), [], 0
    check_commands(record, table, inside, found)
    check_counts(record, found)
    if not again:
        replay, why_not = _replay(record, inside)
        for block in sample_blocks(record):
            _stations(record, block, found)
            if replay is not None:
                replay.take(block, found)
        if replay is not None:
            replayed, why_not = replay.decided, replay.broken
        if why_not:
            left_out.append(f"decisions made again: {why_not}")
    return Recomputed(len(record.updates), replayed, tuple(left_out), found.found)


def _replay(record: Record, inside: Inside) -> tuple[Replay | None, str]:
    """What makes decisions again, or why nothing does."""
    own, scene, why = inside.controller, inside.scene, inside.why_not
    if SENSING.word in (inside.stages or ()):
        why = "what robots sensed is not in the record"
    elif own is not None and scene is not None:
        kind = scene.world.controller.type
        if kind not in shipped_parts(CONTROLLER):
            why = f"{kind} is not shipped with physim, and need not decide alike twice"
        elif record.declared != Declared.of(own):
            why = "the record declares others"
        else:
            return Replay(record, scene, own), ""
    return None, why


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
