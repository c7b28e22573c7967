"""What a record says at given times: poses, last decisions, contacts. Nothing is interpolated."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from physim.declared import NO_NUMBER
from physim.errors import RecordError
from physim.geometry.shapes import FloatArray, IntArray
from physim.metrics import has_formation
from physim.palette import Colour
from physim.scene_model import SceneModel
from physim.video.contacts import episodes

if TYPE_CHECKING:
    from physim.record import Record

SPEEDS = (1, 2, 4, 5, 8)
"""Playback speeds of the first decade; the others are these times a power of ten."""

LONGEST = 80.0
"""[s] length of a video, without the hold, above which the next playback speed is taken"""

HOLD = 1.5
"""[s of video] that the last picture stays, so that the end can be read"""


MOST_MODES = 8
"""Modes that are explained; of more, those that the run has."""


def playback_speed(duration: float) -> float:
    """Return simulated seconds per second of video: 1, 2, 4, 5, 8, 10, 20 …"""
    decade = 1.0
    while True:
        for speed in SPEEDS:
            if duration <= LONGEST * speed * decade * (1.0 + 1e-9):
                return speed * decade
        decade *= 10.0


def frame_times(start: float, end: float, fps: float, speed: float) -> FloatArray:
    """Return the simulated times of all frames (F,) [s].

    From ``start`` to ``end`` [s] inclusive; then the end again for `HOLD` seconds of video.
    """
    last = int(np.ceil((end - start) * fps / speed - 1e-6))
    shown = last + 1 + round(HOLD * fps)
    times: FloatArray = np.minimum(start + np.arange(shown) * (speed / fps), end)
    return times


class Curves(NamedTuple):
    """One figure a robot over time: its name with the unit, and its values (n,) of decisions."""

    title: str
    values: Callable[[IntArray], FloatArray]


class Story:
    """Look-ups in a record at any time [s]; N robots."""

    def __init__(self, record: Record) -> None:
        self.time: FloatArray = np.asarray(record.time, dtype=np.float64)
        if len(self.time) == 0 or len(record.names) == 0:
            raise RecordError(
                f"record {record.name!r}: no sample to show; at least one robot and one recorded "
                "step are needed"
            )
        self.record = record
        self.scene = SceneModel.of_record(record)
        self.robots = len(record.names)
        self.duration = float(self.time[-1])
        updates = record.updates
        decided = np.asarray(updates["step"], dtype=np.float64) * record.dt
        robot = np.asarray(updates["robot"])
        self._rows: list[IntArray] = [np.flatnonzero(robot == i) for i in range(self.robots)]
        self._decided = [decided[rows] for rows in self._rows]
        self._mode: IntArray = np.asarray(updates["mode"], dtype=np.int64)
        self._target = np.column_stack((record.column("target_x"), record.column("target_y")))
        self._error = np.asarray(updates["formation_error"], dtype=np.float64)
        self._deviation = np.asarray(updates["deviation"], dtype=np.float64)
        self._arrived = np.where(record.arrived >= 0, record.arrived * record.dt, np.inf)
        self.contacts = episodes(record)

    def sample(self, time: Any) -> Any:
        """Return the index of the sample nearest to ``time`` (of two, the earlier)."""
        after = np.clip(np.searchsorted(self.time, time), 1, max(len(self.time) - 1, 1))
        if len(self.time) == 1:
            return np.zeros_like(after)
        return np.where(self.time[after] - time < time - self.time[after - 1], after, after - 1)

    def pose(self, time: Any) -> FloatArray:
        """Return the poses (N, 3), or (T, N, 3) for an array of times."""
        return np.asarray(self.record.pose[self.sample(time)], dtype=np.float64)

    def decision(self, robot: int, time: Any) -> Any:
        """Return the row of ``robot``'s last decision at or before ``time``, -1 for none."""
        count = np.searchsorted(self._decided[robot], np.asarray(time) + 1e-9)
        rows = np.concatenate(([-1], self._rows[robot]))
        return rows[count]

    def decisions(self, time: float) -> IntArray:
        """Return the rows (N,) of all robots' last decisions at or before ``time``; -1 none."""
        return np.array([self.decision(i, time) for i in range(self.robots)], dtype=np.int64)

    @property
    def shown_modes(self) -> list[int]:
        """Numbers of the modes to explain: all that are declared, if any was ever given."""
        given = [mode for mode in np.unique(self._mode).tolist() if mode != NO_NUMBER]
        declared = len(self.scene.modes)
        return given[:MOST_MODES] if declared > MOST_MODES or not given else list(range(declared))

    def modes(self, rows: IntArray) -> IntArray:
        """Return the modes of decisions ``rows``; -1 where there is none."""
        found: IntArray = self._of(self._mode, rows, NO_NUMBER)
        return found

    def colours(self, rows: IntArray) -> list[Colour]:
        """Return the colours of the modes of decisions ``rows``."""
        return [self.scene.mode_colour(mode) for mode in self.modes(rows).tolist()]

    def arrived(self, time: float) -> int:
        """Return how many robots have arrived at ``time``, judged by their motion."""
        return int((self._arrived <= time + 1e-9).sum())

    def targets(self, rows: IntArray) -> FloatArray:
        """Return the targets (n, 2) [m] of decisions ``rows``; NaN where there is none."""
        found: FloatArray = self._of(self._target, rows, np.nan)
        return found

    def errors(self, rows: IntArray) -> FloatArray:
        """Return the formation errors [m] of decisions ``rows``; NaN where there is none."""
        found: FloatArray = self._of(self._error, rows, np.nan)
        return found

    def deviations(self, rows: IntArray) -> FloatArray:
        """Return the deviations [m] from the own path, left positive; NaN where there is none."""
        found: FloatArray = self._of(self._deviation, rows, np.nan)
        return found

    @property
    def has_targets(self) -> bool:
        """Whether any decision has a target to show."""
        return bool(np.isfinite(self._target).all(axis=1).any())

    @property
    def curves(self) -> Curves | None:
        """What to show over time: formation errors, else deviations; None where there are none."""
        if self.robots > 1 and np.isfinite(self._error).any() and has_formation(self.record):
            return Curves("formation error [m]", self.errors)
        if np.isfinite(self._deviation).any():
            return Curves("deviation from the path, left positive [m]", self.deviations)
        return None

    @staticmethod
    def _of(values: Any, rows: IntArray, missing: float) -> Any:
        result = np.full((len(rows), *values.shape[1:]), missing, dtype=values.dtype)
        known = rows >= 0
        result[known] = values[rows[known]]
        return result
