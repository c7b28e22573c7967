"""What happened in a recorded run: samples, and tables of decisions, commands and contacts."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from physim.errors import PhysimError, RecordError, nearest
from physim.escaping import escaped
from physim.geometry.shapes import FloatArray, IntArray
from physim.record import layout
from physim.record.considered import considered_rows
from physim.record.course import followed
from physim.record.row_checks import Source
from physim.record.rows import frozen
from physim.record.scene import RecordedScene

POSE_BLOCK = 1 << 14
"""Poses read at once where single samples are asked for"""
POSE_BLOCKS = 32
"""of such blocks, how many are kept: 12 MB"""


class RecordedHistory(RecordedScene):
    """What happened in a run of N robots with K samples; arrays are read-only."""

    dt: float
    """[s] physics step"""

    # Samples

    @cached_property
    def steps(self) -> IntArray:
        """(K,) physics step of each sample, increasing from 0."""
        return self.read("/steps/step")

    @cached_property
    def time(self) -> FloatArray:
        """(K,) [s]."""
        return frozen(self.steps * self.dt)

    @cached_property
    def pose(self) -> FloatArray:
        """(K, N, 3) x, y [m], heading [rad], unwrapped."""
        return self.read("/steps/pose")

    @cached_property
    def clearance(self) -> FloatArray:
        """(K, N) [m] to the nearest other robot, negative = depth; inf for a robot alone.

        With ``record_every`` > 1 the least since the sample before; so too ``boundary_clearance``.
        """
        return self.read("/steps/clearance")

    @cached_property
    def boundary_clearance(self) -> FloatArray:
        """(K, N) [m] to the nearest boundary or obstacle, negative = depth; inf without any."""
        return self.read("/steps/boundary_clearance")

    def pose_at(self, step: int) -> FloatArray:
        """(N, 3) poses at a recorded step. Raises RecordError for a step that is not recorded."""
        row = int(np.searchsorted(self.steps, step))
        if row == self.samples or self.steps[row] != step:
            closest = self.steps[np.argmin(np.abs(self.steps - step))] if self.samples else "none"
            raise RecordError(f"{self.where}: step {step} is not recorded; nearest: {closest}")
        block, place = divmod(row, self._block_rows)
        pose: FloatArray = self._pose_block(block)[place]
        return pose

    @property
    def _block_rows(self) -> int:
        return max(1, POSE_BLOCK // self.robots)

    @cached_property
    def _pose_block(self) -> Callable[[int], FloatArray]:
        """Reads a block of the poses by its number; the last few are kept."""
        rows = self._block_rows
        return lru_cache(POSE_BLOCKS)(lambda k: self.read("/steps/pose", k * rows, (k + 1) * rows))

    @cached_property
    def course(self) -> FloatArray:
        """(K, N, 3) [m] at each sample: station on the own path, deviation from it (left positive),
        station on s*. Worked out from the poses, so that it does not depend on who decided when."""
        return frozen(followed(self))

    # Tables

    @cached_property
    def updates(self) -> NDArray[np.void]:
        """Decisions, rows of `layout.update_type` in the order of steps."""
        return self.read("/updates")

    def column(self, name: str, *, absent: float | None = None) -> FloatArray:
        """(M,) values of a column of the decisions.

        ``absent`` stands in each place where the controller declares none such; where it is not
        given either, that raises RecordError.
        """
        names = self.updates.dtype.names or ()
        if name not in names:
            if absent is not None:
                return frozen(np.full(len(self.updates), absent))
            raise RecordError(
                f'{self.where}: no column "{escaped(name)}"; allowed: {", ".join(names)}'
                f"{nearest(name, [*names])}"
            )
        return np.asarray(self.updates[name], dtype=np.float64)

    @cached_property
    def commands(self) -> NDArray[np.void]:
        """Commands that differ between stages, rows of `layout.COMMAND` in the order of steps."""
        return self.read("/commands")

    def commands_over(
        self, stage: Literal["nominal", "filtered", "applied"], first: int, last: int
    ) -> FloatArray:
        """(last - first, N, 2) command of each robot over steps ``first`` to ``last - 1``.

        [m/s, rad/s]; a robot's command is 0 before its first decision, and that of its last one
        after the run, however far. Raises PhysimError for another stage.
        """
        stages = list(layout.COMMAND_STAGES)
        if stage not in stages:
            raise PhysimError(
                f"commands_over: stage is {stage!r}; allowed: {', '.join(stages)}"
                f"{nearest(str(stage), stages)}"
            )
        steps = max(0, last - first)
        held = np.zeros((steps, self.robots, 2))
        if not steps:
            return held
        updates = self.updates
        nominal = np.stack((updates["nominal_v"], updates["nominal_omega"]), axis=1)
        at = np.zeros((steps, self.robots), dtype=np.int64)  # row + 1 of the decision that holds
        begin = int(np.searchsorted(updates["step"], first, side="right"))
        end = int(np.searchsorted(updates["step"], last))
        robot, from_end = np.unique(updates["robot"][:begin][::-1], return_index=True)
        at[0, robot] = begin - from_end
        rows = np.arange(begin, end)
        at[updates["step"][rows] - first, updates["robot"][rows]] = rows + 1
        np.maximum.accumulate(at, axis=0, out=at)
        held[at > 0] = nominal[at[at > 0] - 1]
        table = self.commands
        mine = table[slice(*np.searchsorted(table["step"], (first, last)))]
        place = mine["step"] - first, mine["robot"]
        held[place] = np.stack((mine[f"{stage}_v"], mine[f"{stage}_omega"]), axis=1)
        return held

    @cached_property
    def considered(self) -> NDArray[np.void]:
        """Robots considered in decisions, rows of `layout.CONSIDERED` in the order of steps."""
        source, others = Source(self.where, layout.OTHERS), self.read(layout.OTHERS)
        return frozen(considered_rows(source, self.considering, others, self.robots))

    @cached_property
    def considering(self) -> NDArray[np.void]:
        """How many robots each decision considered, rows of `layout.CONSIDERING`."""
        return self.read("/considered")

    @cached_property
    def contacts(self) -> NDArray[np.void]:
        """Contacts, rows of `physim.contacts.CONTACT_ROW` in the order of steps.

        Those at samples and, of kind *swept*, those between two samples.
        """
        return self.read("/contacts")

    def contacts_over(self, first: int, last: int) -> NDArray[np.void]:
        """Those rows of `contacts` of steps ``first`` to ``last - 1``."""
        return self.contacts[slice(*np.searchsorted(self._contact_steps, (first, last)))]

    @cached_property
    def _contact_steps(self) -> IntArray:
        return np.ascontiguousarray(self.contacts["step"])

    @cached_property
    def false_contacts(self) -> NDArray[np.void]:
        """Rejected contacts of the engine, rows of `physim.contacts.FALSE_CONTACT_ROW` by steps."""
        return self.read("/false_contacts")

    @cached_property
    def extremes(self) -> NDArray[np.void]:
        """(N,) rows of `layout.EXTREME`: shortest distances over all physics steps."""
        return self.read(layout.EXTREMES)

    @cached_property
    def farthest(self) -> NDArray[np.void]:
        """() one `layout.FARTHEST`: farthest [m], step, a, b over all physics steps."""
        return self.read(layout.EXTREMES_FARTHEST)

    @cached_property
    def arrived(self) -> IntArray:
        """(N,) step from which on each robot has arrived, to the end; -1 where it has not."""
        return self.read(layout.ARRIVED)
