"""Decisions made again by the world's own controller, from what it saw according to the record.

Poses and held commands are those of the record, stations follow from them, and the controller's
memory is carried along; so each decision is made again as it was made, whatever moved the robots.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.control import LONGEST_HOLD, Batched, Controller, Decisions, Sensed, Snapshot
from physim.control_loop import PlainBatch
from physim.declared import NO_NUMBER, Declared
from physim.errors import ControllerError
from physim.geometry.shapes import FloatArray, IntArray
from physim.record import Record
from physim.scene import Scene
from physim.stages import everybody, shared
from physim.tolerances import SHARE
from physim.validation.columns import Considered
from physim.validation.mismatch import SLACK, SLACKS, Mismatches, Value, differs, plain
from physim.validation.walk import SampleBlock

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
            if isinstance(controller, Batched)
            else PlainBatch(controller, scene, self.declared)
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
        told = []
        for low, high in zip(edges, [*edges[1:], len(order)], strict=True):
            some = order[low:high]
            due = rows["robot"][some].astype(np.int64)
            k = int(rows["step"][some[0]]) - block.first
            try:
                told.append(self.batch.decide_due(self._sensed(block, k), due, self.memory))
            except ControllerError as error:
                self.broken = str(error).splitlines()[0]
                order = order[:low]
                break
        if told:
            self.decided += len(order)
            self._hold(rows[order], block.row + order, told, found)

    def _sensed(self, block: SampleBlock, k: int) -> Sensed:
        """What everybody knows at sample ``k`` of a block."""
        truth = Snapshot(block.first + k, block.pose[k], block.held[k], *block.course[k].T)
        return everybody(truth, self.shared)

    def _hold(self, rows: Rows, number: IntArray, told: list[Decisions], found: Mismatches) -> None:
        """Hold rows (M,) of the update table against the same decisions made again."""
        command = np.concatenate([d.command for d in told])
        hold = np.concatenate([d.hold for d in told])
        exact: dict[str, NDArray[Any]] = {
            "nominal_v": command[:, 0],
            "nominal_omega": command[:, 1],
            "mode": np.concatenate([d.mode for d in told]),
            "rule": np.concatenate([d.rule for d in told]),
            "next_step": rows["step"] + whole_steps(hold, self.scene.dt),
        }
        report = np.concatenate([d.report for d in told])
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
        self._hold_considered(rows, number, told, found)

    def _hold_considered(
        self, rows: Rows, number: IntArray, told: list[Decisions], found: Mismatches
    ) -> None:
        again = np.concatenate([d.considered for d in told])
        count = np.concatenate([np.diff(d.considered_start) for d in told])
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
            told_names, our_names = (
                ", ".join(names[j] for j in some) or "nobody" for some in (theirs, ours)
            )
            found.add(
                "/considered", "other", told_names, our_names, self.by,
                robot=int(rows["robot"][k]), step=int(rows["step"][k]),
            )  # fmt: skip

    def _words(self, column: str) -> Callable[[Any], Value]:
        """How values of a column are told: modes and rules by name."""
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
