"""Standard columns of decisions, computed from poses and commands: nothing of a controller's.

Distance and collision time are those to the robots that the record says were considered, under the
decision's own command and the commands that the others held; boundaries are those within range of
sensing. Which robots the paper's controller has to consider is computed, too: those ahead along
s* within range, both along it and straight.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot

import numpy as np
from numpy.typing import NDArray

from physim.analysis.validation.decisions import SampleBlock
from physim.analysis.validation.mismatch import SLACKS, Mismatches, differs
from physim.compiled import compiled
from physim.geometry.collision import collision_time_pair, collision_time_walls
from physim.geometry.separation import body_distance, wall_distance
from physim.geometry.shapes import FloatArray, IntArray, Shapes, locked
from physim.geometry.wall_grid import WallGrid, parts_in_range, parts_near
from physim.record import Record
from physim.tolerances import LENGTH, TIME
from physim.world.scene import Scene

COLUMNS = ("distance", "boundary_distance", "collision_time")
"""Standard columns, in the order of `standard_columns`."""
LONGEST = 100.0
"""[s] Collision times beyond this are not looked for where a controller's horizon is not known."""
BY = "by its pose, the walls and the robots it considered"
BY_COMMANDS = "by poses, commands, the walls and the robots it considered"


@dataclass(frozen=True)
class Meaning:
    """What collision times of a run's decisions mean."""

    horizon: float
    """[s]"""
    motions: tuple[float, ...]
    """shares of omega that they may have been computed with: 1 arcs, 0 translation"""
    known: bool
    """whether the controller's settings say so"""

    @classmethod
    def of(cls, record: Record, settings: object) -> Meaning:
        """By a controller's settings; by the recorded times where these are not known.

        No time beyond its horizon is reported, so the largest finite one is within it.
        """
        horizon = getattr(settings, "horizon", None)
        if isinstance(horizon, float):
            motion = getattr(settings, "collision_motion", "arc")
            return cls(horizon, (0.0,) if motion == "translation" else (1.0,), True)
        times = record.column("collision_time", absent=np.nan)
        times = times[np.isfinite(times)]
        least = min(float(times.max(initial=0.0)), LONGEST)
        return cls(least + 2.0 * TIME, (1.0, 0.0), False)


class Considered:
    """The table of considered robots, by decision."""

    def __init__(self, record: Record) -> None:
        table = record.considered
        key, decided, counted = (
            rows["step"] * record.robots + rows["robot"]
            for rows in (table, record.updates, record.considering)
        )
        order = np.lexsort((table["other"], key))
        self.other = table["other"][order].astype(np.int64)
        self.start = np.searchsorted(key[order], decided).astype(np.int64)
        """(M,) first of each decision in ``other``, and one past its last:"""
        self.end = np.searchsorted(key[order], decided, side="right").astype(np.int64)
        self.orphans = np.flatnonzero(~np.isin(counted, decided))
        """rows of `Record.considering` that belong to no decision"""


class StandardColumns:
    """Holds the standard columns of decisions against what the geometry says."""

    def __init__(
        self, record: Record, scene: Scene, meaning: Meaning, considered: Considered
    ) -> None:
        self.scene, self.meaning, self.considered = scene, meaning, considered
        self.world = locked(scene.shapes), locked(scene.walls), locked(scene.wall_grid)
        names = record.updates.dtype.names or ()
        self.columns = [name for name in COLUMNS if name in names]
        self.unsigned = [
            name
            for name in self.columns
            if not meaning.known and not (record.updates[name] < 0.0).any()
        ]
        """those of a controller of one's own that are 0 where shapes overlap, as in (11)"""

    def take(self, block: SampleBlock, found: Mismatches) -> None:
        """Check the decisions of a block."""
        rows = block.rows
        if not len(rows) or not self.columns:
            return
        exact = self._exact(block, self.meaning.motions[0])
        for name in self.unsigned:
            exact[name] = np.maximum(exact[name], 0.0)
        for name in self.columns:
            wrong = differs(rows[name], exact[name], SLACKS.get(name, LENGTH))
            wrong &= ~np.isnan(rows[name])  # left out, which is the controller's own business
            if name == "collision_time" and wrong.any() and not self.meaning.known:
                wrong &= self._refuted(block, exact[name])
            by = BY_COMMANDS if name == "collision_time" else BY
            found.add_rows("/updates", name, rows, block.row, wrong, exact[name], by)

    def _refuted(self, block: SampleBlock, exact: FloatArray) -> NDArray[np.bool_]:
        """Collision times that neither motion gives, where the horizon is not known."""
        recorded = block.rows["collision_time"]
        other = self._exact(block, self.meaning.motions[1])["collision_time"]
        wrong = differs(recorded, exact, SLACKS["collision_time"])
        wrong &= differs(recorded, other, SLACKS["collision_time"])
        within = exact < self.meaning.horizon - 3.0 * TIME
        return np.asarray(wrong & (within | (recorded <= LONGEST)))

    def _exact(self, block: SampleBlock, keep: float) -> dict[str, FloatArray]:
        """Every standard column (M,) of the decisions; ``keep`` is the share of omega."""
        rows, out = block.rows, np.empty((len(block.rows), len(COLUMNS)))
        mine = slice(block.row, block.row + len(rows))
        command = np.stack((rows["nominal_v"], rows["nominal_omega"]), axis=1)
        scene = self.scene
        standard_columns(
            block.at, rows["robot"].astype(np.int64), command, self.considered.other,
            self.considered.start[mine], self.considered.end[mine], block.pose, block.held,
            *self.world, scene.sensing_range, self.meaning.horizon, keep, out,
        )  # fmt: skip
        return dict(zip(COLUMNS, out.T, strict=True))


@compiled
def standard_columns(
    at: IntArray,
    robot: IntArray,
    command: FloatArray,
    other: IntArray,
    start: IntArray,
    end: IntArray,
    pose: FloatArray,
    held: FloatArray,
    shapes: Shapes,
    walls: Shapes,
    wall_grid: WallGrid,
    reach: float,
    horizon: float,
    keep: float,
    out: FloatArray,
) -> None:
    """Distance [m], boundary distance [m] and collision time [s] of M decisions into ``out``.

    Decision k is that of ``robot[k]`` at sample ``at[k]`` of ``pose`` (B, N, 3); it considered
    ``other[start[k]:end[k]]``, took ``command[k]``, and the others held ``held[at[k]]``. ``keep``
    is 1, or 0 where collision times leave turning out.
    """
    for k in range(len(at)):
        i, here, theirs = robot[k], pose[at[k]], held[at[k]]
        x, y = here[i, 0], here[i, 1]
        mine = (command[k, 0], keep * command[k, 1])
        distance, time = np.inf, np.inf
        for m in range(start[k], end[k]):
            j = other[m]
            if j == i:
                continue
            distance = min(distance, body_distance(shapes, i, here[i], shapes, j, here[j]))
            room = hypot(here[j, 0] - x, here[j, 1] - y) - shapes.radius[i] - shapes.radius[j]
            if room > (abs(mine[0]) + abs(theirs[j, 0])) * min(time, horizon) and room > 0.0:
                continue  # head-on at full speed their discs meet later
            twist = (theirs[j, 0], keep * theirs[j, 1])
            xi = collision_time_pair(shapes, i, here[i], mine, j, here[j], twist, horizon)
            time = min(time, float(xi))
        seen = parts_in_range(walls, parts_near(wall_grid, x, y), x, y, reach)
        out[k, 0] = distance
        out[k, 1] = wall_distance(shapes, i, here[i], walls, seen)
        xi = collision_time_walls(shapes, i, here[i], mine, walls, seen, horizon)
        out[k, 2] = min(time, float(xi))


def check_considered(record: Record, considered: Considered, found: Mismatches) -> None:
    """Hold the column ``considered`` against the table of that name."""
    rows, table = record.updates, record.considering
    count = considered.end - considered.start
    wrong = rows["considered"] != count
    found.add_rows("/updates", "considered", rows, 0, wrong, count, "by the table /considered")
    for k in considered.orphans.tolist():
        found.add(
            "/considered", "robot", int(table["robot"][k]), "no robot that decides then",
            "by the decisions", row=k, robot=int(table["robot"][k]), step=int(table["step"][k]),
        )  # fmt: skip
    listed = record.considered
    for row in listed[listed["other"] == listed["robot"]]:
        robot, step = int(row["robot"]), int(row["step"])
        why, name = "as nobody considers itself", record.names[robot]
        found.add("/considered", "other", name, "another robot", why, robot=robot, step=step)


def check_priority(
    record: Record, block: SampleBlock, reach: float, considered: Considered, found: Mismatches
) -> None:
    """Hold the considered robots against the paper's rule; robots that stand at their stop have
    none to consider and are left out."""
    rows = block.rows
    rules = [rule.name for rule in record.declared.rules]
    moving = np.flatnonzero(rows["rule"] != (rules.index("stop") if "stop" in rules else -2))
    mine = block.row + moving
    wrong = wrongly_considered(
        block.at[moving], rows["robot"][moving].astype(np.int64), considered.other,
        considered.start[mine], considered.end[mine], block.pose,
        np.ascontiguousarray(block.reference_station), reach,
    )  # fmt: skip
    for k in np.flatnonzero(wrong >= 0).tolist():
        row, j = rows[moving[k]], int(wrong[k])
        listed = considered.other[considered.start[mine[k]] : considered.end[mine[k]]]
        words = ("not among those considered", "among those considered")
        recorded, exact = words if j not in listed else words[::-1]
        who = record.names[j]
        found.add(
            "/considered", "other", f"{who} {recorded}", f"{who} {exact}", "by priority and range",
            robot=int(row["robot"]), step=int(row["step"]),
        )  # fmt: skip


@compiled
def wrongly_considered(
    at: IntArray,
    robot: IntArray,
    other: IntArray,
    start: IntArray,
    end: IntArray,
    pose: FloatArray,
    station: FloatArray,
    reach: float,
) -> IntArray:
    """(M,) for each decision a robot that is considered wrongly or left out wrongly; -1: none.

    ``station`` (B, N) [m] along s*. What lies within 1e-9 m of equal stations or of the range may
    count as either.
    """
    wrong = np.full(len(at), -1, dtype=np.int64)
    robots = pose.shape[1]
    listed = np.zeros(robots, dtype=np.bool_)
    for k in range(len(at)):
        i, here, s = robot[k], pose[at[k]], station[at[k]]
        for m in range(start[k], end[k]):
            listed[other[m]] = True
        for j in range(robots):
            ahead = s[j] - s[i]
            far = max(ahead, hypot(here[j, 0] - here[i, 0], here[j, 1] - here[i, 1]))
            has_to = j != i and far <= reach and (ahead > 0.0 or (ahead == 0.0 and j < i))
            close_call = abs(far - reach) <= 1e-9 or (ahead != 0.0 and abs(ahead) <= 1e-9)
            if has_to != listed[j] and not (close_call and j != i):
                wrong[k] = j
        for m in range(start[k], end[k]):
            listed[other[m]] = False
    return wrong
