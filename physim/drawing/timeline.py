"""What a record says at given times: poses, last decisions, contacts. Nothing is interpolated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.analysis.metrics import Episode, Figures, Graze
from physim.contacts import Phase
from physim.drawing.crowd import NAMED
from physim.drawing.drivers import MOST_MODES, drivers_of, marks_of
from physim.drawing.palette import BAND, INK, Colour
from physim.drawing.scene_model import SceneModel
from physim.errors import RecordError
from physim.geometry.clearance import ClearanceFinder, Clearances
from physim.geometry.shapes import FloatArray, IntArray
from physim.geometry.walls import build_wall_tree
from physim.parts.declarations import NO_NUMBER
from physim.record import check_record

if TYPE_CHECKING:
    from physim.record import Record

NO_ROW = -1
"""Row of a robot that has not decided yet."""
COARSE = 0.1
"""[s] between two samples from which on a picture shows the sample before, and that sample's time:
the clock has so many seconds, and all of a picture is of one moment"""
MOST_POSES = 100_000
"""whose distances are worked out in one go"""


class Moment(NamedTuple):
    """A record at one time, N robots."""

    time: float
    """[s] of all that is shown"""
    sample: int
    """index of the sample"""
    pose: FloatArray
    """(N, 3)"""
    decisions: IntArray
    """(N,) rows of the last decisions, -1 for none"""
    modes: IntArray
    """(N,) numbers of their modes, -1 for none"""
    colours: NDArray[np.uint8]
    """of these modes; where no robot ever has one, the robots' own"""
    targets: FloatArray
    """(N, 2) [m], NaN where there is none"""
    moving_pose: FloatArray
    """(B, 3) of all that moves, robots first"""
    steering: FloatArray
    """(N,) [rad] angles of front wheels, left positive; 0 where none was recorded"""


class Curves(NamedTuple):
    """One figure over time, L lines: a line a robot, or the least distances of all."""

    title: str
    """what it is, with its unit"""
    name: str
    """of the figure, as a column of the decisions has it"""
    values: FloatArray
    """(K, L) [m] at the samples"""
    names: Sequence[str]
    """of the lines"""
    colours: Sequence[Colour]
    """of the lines"""


def coarse_spacing(times: FloatArray) -> float:
    """Greatest time [s] between two samples at times (K,) of a coarse record; 0 of others."""
    spacing = float(np.diff(times).max(initial=0.0))
    return spacing if spacing > COARSE + 1e-9 else 0.0


def samples_before(times: FloatArray, time: Any) -> Any:
    """Index of the last of samples at times (K,) [s] that is not after ``time``; 0 before all.

    Of each of an array of times, too.
    """
    after = np.searchsorted(times, np.asarray(time) + 1e-9, side="right")
    return np.maximum(after - 1, 0)


class Timeline:
    """Look-ups in a record at any time [s]; N robots.

    Raises `physim.errors.RecordError` for a record without samples or robots.
    """

    def __init__(self, record: Record) -> None:
        check_record(record)
        self.time: FloatArray = np.asarray(record.time, dtype=np.float64)
        if len(self.time) == 0 or len(record.names) == 0:
            raise RecordError(
                f"record {record.name!r}: no sample to show; at least one robot and one recorded "
                "step are needed"
            )
        self.record = record
        self.scene = SceneModel.of_record(record)
        self.robots, self.moving = len(record.names), record.moving
        self.drivers = drivers_of(record)
        """those of `drivers_of`"""
        self.marks = marks_of(self.drivers, self.robots)
        """those of `marks_of`"""
        self.begin, self.duration = float(self.time[0]), float(self.time[-1])
        """[s] of the first sample and of the last"""
        self.spacing = coarse_spacing(self.time)
        """[s] that of `coarse_spacing`"""
        robot = np.asarray(record.updates["robot"], dtype=np.int64)
        step = np.asarray(record.updates["step"], dtype=np.int64)
        self._clock = np.arange(int(step.max(initial=0)) + 1, dtype=np.float64) * record.dt
        # all decisions, robot by robot in the order of time: one search finds those of all robots
        order = np.lexsort((step, robot))
        self._keys = (robot * (len(self._clock) + 1) + step)[order]
        self._first = np.searchsorted(robot[order], np.arange(self.robots))
        # row -1, no decision, finds what is added at the ends
        self._rows = np.append(order, NO_ROW)
        self._mode = np.append(record.updates["mode"].astype(np.int64), NO_NUMBER)
        known = len(self.scene.modes)
        each = [self.scene.mode_colour(mode) for mode in (*range(known), NO_NUMBER)]
        self._colours = np.array(each, np.uint8)
        targets = [record.column(name, absent=np.nan) for name in ("target_x", "target_y")]
        self._targets = np.append(np.column_stack(targets), [[np.nan, np.nan]], axis=0)
        self.aims = bool(np.isfinite(self._targets).all(axis=1).any())
        """Whether any decision has a target."""
        self._arrived = np.where(record.arrived >= 0, record.arrived * record.dt, np.inf)
        self._steering = record.steering if record.holds("/steps/steering") else None
        self.contacts = episodes(record)
        is_told = len(self._rows) > 1 or record.judged is not None
        self.modeless = is_told and bool((self._mode == NO_NUMBER).all())
        """Whether there are decisions, and none gave a mode; of a log that was judged none can."""
        most = np.full(self.robots, NO_NUMBER)
        np.maximum.at(most, robot, record.updates["mode"])
        silent = (most == NO_NUMBER) & (np.bincount(robot, minlength=self.robots) > 0)
        self.partly_modeless = not self.modeless and bool(silent.any())
        """Whether some robots gave modes, and others decided and gave none."""

    def at(self, time: float) -> Moment:
        """Return all that is shown of one time [s]; of a coarse record, of the sample before."""
        sample = int(self.shown(time))
        if self.spacing:
            time = float(self.time[sample])
        rows = self.decisions(time)
        modes = self.modes(rows)
        colours = self._colours[modes]
        if self.modeless:
            alike = self.robots > NAMED
            each = [BAND] * self.robots if alike else self.scene.colours
            colours = np.array(each, np.uint8)
        every = np.asarray(self._moving_pose[sample], dtype=np.float64)
        pose, targets = every[: self.robots], self._targets[rows]
        steering = np.zeros(self.robots) if self._steering is None else self._steering[sample]
        return Moment(time, sample, pose, rows, modes, colours, targets, every, steering)

    @property
    def _moving_pose(self) -> FloatArray:
        is_alone = self.moving == self.robots
        return self.record.pose if is_alone else self.record.moving_pose

    def sample(self, time: Any) -> Any:
        """Return the index of the sample nearest to ``time`` (of two, the earlier)."""
        after = np.clip(np.searchsorted(self.time, time), 1, max(len(self.time) - 1, 1))
        if len(self.time) == 1:
            return np.zeros_like(after)
        return np.where(self.time[after] - time < time - self.time[after - 1], after, after - 1)

    def shown(self, time: Any) -> Any:
        """Return the index of the sample that is shown: the nearest; of coarse records the last."""
        return samples_before(self.time, time) if self.spacing else self.sample(time)

    def pose(self, time: Any) -> FloatArray:
        """Return the poses (N, 3), or (T, N, 3) for an array of times."""
        return np.asarray(self.record.pose[self.sample(time)], dtype=np.float64)

    def decisions(self, time: Any) -> IntArray:
        """Return the rows of all robots' last decisions at or before ``time``; -1 for none.

        (N,), or (T, N) for an array of times.
        """
        steps = np.searchsorted(self._clock, np.asarray(time) + 1e-9)
        robots = np.arange(self.robots) * (len(self._clock) + 1)
        after = np.searchsorted(self._keys, steps[..., None] + robots)
        return np.where(after > self._first, self._rows[after - 1], NO_ROW)

    def modes(self, rows: IntArray) -> IntArray:
        """Return the modes of decisions ``rows``; -1 where there is none."""
        return np.asarray(self._mode[rows])

    @cached_property
    def explained_modes(self) -> list[int]:
        """Numbers of the modes to explain: all that are declared, if any was ever given."""
        given = [mode for mode in np.unique(self._mode).tolist() if mode != NO_NUMBER]
        declared = len(self.scene.modes)
        return given[:MOST_MODES] if declared > MOST_MODES or not given else list(range(declared))

    def over(self, time: float) -> bool:
        """Return whether ``time`` [s] is that of the last sample, or later; of one, never."""
        return bool(time >= self.duration - 1e-9 > self.begin)

    def arrived(self, time: float) -> int:
        """Return how many robots have arrived at ``time``, judged by their motion."""
        return int((self._arrived <= time + 1e-9).sum())

    @cached_property
    def curves(self) -> Curves:
        """What to show over time: formation errors, in a run without formation deviations."""
        errors = Figures(self.record).formation_errors
        lines = self.record.names, self.scene.colours
        if errors is not None:
            return Curves("formation error [m]", "formation_error", errors, *lines)
        title = "deviation left of the path [m]"
        return Curves(title, "deviation", self.record.course[:, :, 1], *lines)

    def distances_at(self, samples: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return the distances (M, N) [m] to what moves and to walls at M samples, by index.

        Negative: depth. A record of every step has them. Those of one with fewer samples are the
        least since the sample before, which is another moment: they are worked out from the poses.
        """
        record = self.record
        if record.record_every == 1:
            return record.clearance[samples], record.boundary_clearance[samples]
        found = self._found(samples)
        return (
            np.concatenate([one.clearance for one in found]),
            np.concatenate([one.boundary_clearance for one in found]),
        )

    def closest_at(self, samples: IntArray) -> IntArray:
        """Return the closest two bodies (M, 2) at M samples, a robot first, given by index."""
        found = self._found(samples)
        clearance = np.concatenate([one.clearance for one in found])
        other = np.concatenate([one.other for one in found])
        robot = clearance.argmin(axis=1)
        return np.column_stack((robot, other[np.arange(len(robot)), robot]))

    def _found(self, samples: IntArray) -> list[Clearances]:
        """Clearances at samples, block by block."""
        block, pose = max(1, MOST_POSES // self.moving), self._moving_pose
        return [
            self._finder.find(pose[samples[first : first + block]])
            for first in range(0, len(samples), block)
        ]

    @cached_property
    def _finder(self) -> ClearanceFinder:
        walls = build_wall_tree(self.record.walls)
        return ClearanceFinder(self.record.shapes, walls, self.robots)

    @cached_property
    def distances(self) -> Curves:
        """The least distances of all robots to what moves, and to walls, where there are any."""
        record, is_alone = self.record, self.moving == self.robots
        least = {
            "robots" if is_alone else "others": (record.clearance.min(axis=1), INK),
            "walls": (record.boundary_clearance.min(axis=1), BAND),
        }
        names = [name for name, (line, _) in least.items() if np.isfinite(line).any()]
        values = np.array([least[name][0] for name in names]).reshape(len(names), len(self.time)).T
        colours = [least[name][1] for name in names]
        return Curves("least distance [m]", "distance", values, names, colours)


@dataclass(frozen=True)
class Episodes:
    """One row a contact episode or swept contact, by the time it began; C of them."""

    began: FloatArray
    """(C,) [s]"""
    moment: FloatArray
    """(C,) [s] the same; of a swept contact when the two are closest"""
    ended: FloatArray
    """(C,) [s] first sample apart; after the record's end for a contact that lasts to the end"""
    apart: FloatArray
    """(C,) [s] how long the two were apart before; inf for their first contact"""
    bodies: IntArray
    """(C, 2) body ids"""
    swept: NDArray[np.bool_]
    """(C,) a swept contact: the two touch between two samples only"""
    deep: FloatArray
    """(C,) [s] from when on it is too deep to be physical; inf for one that never is"""
    first: IntArray
    """(C,) where an episode begins in ``places``"""
    last: IntArray
    """(C,) and where it ends"""
    times: FloatArray
    """(R,) [s] of ``places``"""
    places: FloatArray
    """(R, 2) [m] deepest points, episode by episode"""

    def count(self, time: float) -> int:
        """Return how many began at or before ``time`` [s], swept contacts included."""
        return int(np.searchsorted(self.began, time + 1e-9, side="right"))

    def swept_count(self, time: float) -> int:
        """Return how many of them are swept contacts."""
        return int(self.swept[: self.count(time)].sum())

    def deep_count(self, time: float) -> int:
        """Return how many were too deep to be physical at or before ``time`` [s]."""
        return int((self.deep <= time + 1e-9).sum())

    def recent(self, time: float, lasts: float) -> IntArray:
        """Return the episodes that began at most ``lasts`` seconds before ``time``, old first."""
        first = int(np.searchsorted(self.began, time - lasts, side="right"))
        return np.arange(first, self.count(time))

    def latest(self, rows: IntArray) -> IntArray:
        """Return of ``rows``, old first, the last of each pair of bodies: pairs may rattle."""
        _, back = np.unique(self.bodies[rows][::-1], axis=0, return_index=True)
        return np.sort(rows[::-1][back])

    def present(self, time: float) -> IntArray:
        """Return the episodes in which bodies touch at ``time`` [s], old first."""
        return np.flatnonzero(self.ended[: self.count(time)] > time + 1e-9)

    def place_at(self, episode: int, time: float) -> FloatArray:
        """Return the deepest point (2,) [m] at ``time``; before and after, the nearest one."""
        first, last = int(self.first[episode]), int(self.last[episode])
        after = np.searchsorted(self.times[first + 1 : last + 1], time + 1e-9, side="right")
        return np.asarray(self.places[first + int(after)])

    def touching(self, time: float, bodies: int) -> NDArray[np.bool_]:
        """Return for each of the first ``bodies`` whether it touches anything at ``time``."""
        now = self.bodies[self.present(time)]
        result = np.zeros(bodies, dtype=bool)
        result[now[now < bodies]] = True
        return result


def episodes(record: Record) -> Episodes:
    """Contact episodes and swept contacts of a record, with the places of their contacts."""
    run = Figures(record)
    found: list[Episode | Graze] = [*run.episodes, *run.grazes]
    found.sort(key=lambda one: (one.step, one.a, one.b))
    swept = [isinstance(one, Graze) for one in found]
    columns = [(e.a, e.b, e.step, 1 if isinstance(e, Graze) else e.samples) for e in found]
    a, b, step, samples = np.array(columns, dtype=np.int64).reshape(-1, 4).T
    table = np.asarray(record.contacts)
    # pair by pair, each in order of time: an episode is then a run of rows
    table = table[table["phase"] != Phase.ENDED]
    table = table[np.lexsort((table["step"], table["b"], table["a"]))]
    row = {key: k for k, key in enumerate(table[["a", "b", "step"]].tolist())}
    first = np.array([row[key[:3]] for key in columns], dtype=np.int64)
    deep = np.full(len(columns), np.inf)
    for one in run.deep:
        for k in np.flatnonzero((a == one.a) & (b == one.b)).tolist():
            mine = table[first[k] : first[k] + samples[k]]
            beyond = mine["step"][mine["depth"] > one.allowed]
            deep[k] = beyond[0] * record.dt if len(beyond) else np.inf
    began = np.asarray(step * record.dt, dtype=np.float64)
    ended = np.asarray((step + samples) * record.dt, dtype=np.float64)
    order = np.lexsort((began, b, a))
    again = (a[order[1:]] == a[order[:-1]]) & (b[order[1:]] == b[order[:-1]])
    apart = np.full(len(found), np.inf)
    apart[order[1:]] = np.where(again, began[order[1:]] - ended[order[:-1]], np.inf)
    return Episodes(
        began=began,
        moment=np.array([one.time for one in found], dtype=np.float64),
        ended=ended,
        apart=apart,
        bodies=np.column_stack((a, b)),
        swept=np.array(swept, dtype=bool),
        deep=deep,
        first=first,
        last=first + samples - 1,
        times=np.asarray(table["step"] * record.dt, dtype=np.float64),
        places=np.column_stack((table["x"], table["y"])).astype(np.float64),
    )
