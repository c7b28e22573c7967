"""Small made-up records for tests: no simulation, no physics, only the writer."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import h5py
import numpy as np
import shapely
from numpy.typing import NDArray

from physim import PAPER_MODES, Rule
from physim.contacts import CONTACT_ROW, FALSE_CONTACT_ROW, Phase
from physim.record import Record, RecordWriter
from tests.helpers import inside

FloatArray, Polylines = inside("physim.geometry", "FloatArray", "Polylines")
pack_parts, pack_polylines = inside("physim.geometry", "pack_parts", "pack_polylines")
STANDARD_COLUMNS, Declared = inside("physim.parts", "STANDARD_COLUMNS", "Declared")
CONSIDERED, CONSIDERING = inside("physim.record", "CONSIDERED", "CONSIDERING")
OPTIONAL, SENSED, update_type = inside("physim.record", "OPTIONAL", "SENSED", "update_type")
Body = inside("physim.world", "Body")

CENTRELINE = np.array([[0.0, 0.0], [15.0, 0.0], [27.0, 9.0], [60.0, 9.0]])
WIDTH = 8.0
BOX = np.array([[-0.9, -0.5], [0.9, -0.5], [0.9, 0.5], [-0.9, 0.5]])
ELL = (
    np.array([[-0.9, -0.5], [0.9, -0.5], [0.9, 0.0], [-0.9, 0.0]]),
    np.array([[-0.9, 0.0], [-0.3, 0.0], [-0.3, 0.7], [-0.9, 0.7]]),
)
DECLARED = Declared(
    PAPER_MODES, (Rule("follow", "follows its path"), Rule("avoid", "avoids")), STANDARD_COLUMNS
)
UPDATE = update_type([column.name for column in STANDARD_COLUMNS])
WORLD = "name: made up\nseed: 3\nformation: {gain: 0.05}\nexpect: {contacts: 2, finished: false}\n"


def make_scene(robots: int = 3, seconds: float = 10.0, dt: float = 0.01) -> SimpleNamespace:
    """Arrays of a bent corridor with ``robots`` robots, every third of them L-shaped."""
    offsets = np.linspace(-2.0, 2.0, robots) if robots > 1 else np.zeros(1)
    paths = pack_polylines([_offset(CENTRELINE, offset) for offset in offsets])
    left, right = _offset(CENTRELINE, WIDTH / 2), _offset(CENTRELINE, -WIDTH / 2)
    walls = pack_parts([list(pairwise(line)) for line in (left, right)])
    names = [Body(i, "robot", f"r{i + 1}") for i in range(robots)]
    names += [Body(robots, "boundary", "left"), Body(robots + 1, "boundary", "right")]
    start = _along(paths, 3.0 + 2.5 * np.arange(robots)[::-1], np.arange(robots))
    ends = paths.station[paths.start[1:] - 1]
    return SimpleNamespace(
        seed=3,
        dt=dt,
        steps=round(seconds / dt),
        bodies=tuple(names),
        shapes=pack_parts([ELL if i % 3 == 2 else (BOX,) for i in range(robots)]),
        walls=walls,
        start=start,
        paths=paths,
        reference=pack_polylines([CENTRELINE]),
        stop_station=ends - 2.5 * np.arange(robots),
        formation=SimpleNamespace(lead=-2.5 * np.arange(float(robots))),
    )


def make_record(
    path: str | os.PathLike[str] | None = None,
    robots: int = 3,
    seconds: float = 10.0,
    *,
    dt: float = 0.01,
    contacts: bool = True,
    ended: str = "duration",
    world_text: str = WORLD,
    name: str = "made up",
    block: int = 64,
    wall_clock: dict[str, float] | None = None,
    sensed: bool = False,
) -> Record:
    """Robots drive in a row along a bent corridor, 2.5 m apart, at about 1 m/s.

    With ``contacts`` and at least two robots there are two episodes: robots 0 and 1 from 0.3 to
    0.32 of the time, and robot 1 with the left boundary from 0.6 to 0.61.
    """
    scene = make_scene(robots, seconds, dt)
    ring = _corridor_ring(WIDTH / 2)
    writer = RecordWriter(
        path, scene, world_text, name=name, accessible=[ring], safe=[_corridor_ring(3.0)],
        safe_distance=1.0, record_every=1, declared=DECLARED,
        tables=(*OPTIONAL, SENSED) if sensed else OPTIONAL,
    )  # fmt: skip
    pose = poses(scene)
    touching = contact_rows(scene) if contacts and robots > 1 else np.zeros(0, CONTACT_ROW)
    found = clearance_block(scene, pose, touching)
    decided = update_rows(scene, pose)
    others = considered_rows(decided)
    for first in range(0, len(pose), block):
        step = np.arange(first, min(first + block, len(pose)))
        part = SimpleNamespace(**{key: value[step] for key, value in vars(found).items()})
        writer.note_extremes(step, part)
        writer.append_steps(step, pose[step], part.clearance, part.boundary_clearance)
        tables = {"updates": decided, "considered": others, "contacts": touching}
        now = {
            table: rows[(rows["step"] >= step[0]) & (rows["step"] <= step[-1])]
            for table, rows in tables.items()
        }
        for table in ("updates", "contacts"):
            writer.append(table, now[table])
        writer.append_considered(considering_rows(now["updates"]), now["considered"]["other"])
    if sensed:
        writer.append(SENSED, np.zeros(robots, Record.sensed.dtype))
    if len(touching):
        reported = np.array([(5, 0, 1, 0.2)], dtype=FALSE_CONTACT_ROW)
        writer.append("false_contacts", reported)
    clock = {"seconds": 0.1, "factor": 10.0 * seconds} if wall_clock is None else wall_clock
    writer.close(ended, steps_run=scene.steps, rejected=int(len(touching) > 0), wall_clock=clock)
    return writer.record()


def told(attribute: str, group: str | None, row: int, **values: Any) -> Callable[[h5py.File], None]:
    """Change what a record says in an attribute of JSON, in a row of a list or of its ``group``."""

    def change(file: h5py.File) -> None:
        found = json.loads(file.attrs[attribute])
        (found if group is None else found[group])[row].update(values)
        file.attrs[attribute] = json.dumps(found)

    return change


def poses(scene: SimpleNamespace) -> FloatArray:
    """(K, N, 3): each robot on its path, robot i at speed 1 + 0.02 i sin t."""
    t = scene.dt * np.arange(scene.steps + 1)[:, None]
    robot = np.arange(len(scene.start))
    station = 3.0 + 2.5 * robot[::-1] + t + 0.02 * robot * (1 - np.cos(t))
    flat = _along(scene.paths, station.ravel(), np.broadcast_to(robot, station.shape).ravel())
    pose = flat.reshape(*station.shape, 3)
    pose[..., 2] = np.unwrap(pose[..., 2], axis=0)
    return pose


def contact_rows(scene: SimpleNamespace) -> NDArray[np.void]:
    """Rows of the two episodes that `make_record` tells of."""
    robots, rows = len(scene.start), []
    pose = poses(scene)
    for a, b, begin, end in ((0, 1, 0.3, 0.32), (1, robots, 0.6, 0.61)):
        first, last = round(begin * scene.steps), round(end * scene.steps)
        for step in range(first, last + 1):
            phase = Phase.BEGAN if step == first else Phase.ENDED if step == last else Phase.STAYS
            x, y = pose[step, a, :2]
            depth = -0.01 if phase == Phase.ENDED else 1e-3 * (step - first + 1)
            impulse = 0.0 if phase == Phase.ENDED else 5.0
            rows.append((step, a, b, phase, 0, x + 0.9, y, 1.0, 0.0, depth, impulse))
    rows.sort()
    return np.array(rows, dtype=CONTACT_ROW)


def update_rows(scene: SimpleNamespace, pose: FloatArray) -> NDArray[np.void]:
    """One decision per robot every 0.1 s; danger around the contact of robots 0 and 1."""
    hold = max(1, round(0.1 / scene.dt))
    steps = np.arange(0, scene.steps, hold)
    robots = len(scene.start)
    rows = np.zeros((len(steps), robots), dtype=UPDATE)
    rows["step"] = steps[:, None]
    rows["robot"] = np.arange(robots)
    share = (steps / max(1, scene.steps))[:, None]
    rows["mode"] = np.where((share > 0.25) & (share < 0.35) & (rows["robot"] < 2), 1, 0)
    rows["mode"][(share > 0.6) & (share < 0.65) & (rows["robot"] == 1)] = 2
    rows["rule"] = rows["mode"] > 0
    rows["nominal_v"] = rows["applied_v"] = 1.0
    heading = pose[steps, :, 2]
    rows["target_x"] = pose[steps, :, 0] + 2.0 * np.cos(heading)
    rows["target_y"] = pose[steps, :, 1] + 2.0 * np.sin(heading)
    rows["station"] = 3.0 + 2.5 * np.arange(robots)[::-1] + scene.dt * steps[:, None]
    rows["reference_station"] = rows["station"]
    rows["formation_error"] = np.sin(6 * share) * (1 - share) * (1 + np.arange(robots))
    rows["deviation"] = 0.1 * np.cos(9 * share)
    rows["distance"] = 1.0
    rows["boundary_distance"] = 1.5
    rows["collision_time"] = np.where(rows["mode"] == 0, np.inf, 0.5 + share)
    rows["considered"] = np.arange(robots)
    rows["evaluations"] = 15 * (rows["mode"] > 0)
    rows["next_step"] = rows["step"] + hold
    return rows.ravel()


def considering_rows(decided: NDArray[np.void]) -> NDArray[np.void]:
    """How many robots each decision considers."""
    rows = np.zeros(len(decided), dtype=CONSIDERING)
    for name, column in (("step", "step"), ("robot", "robot"), ("count", "considered")):
        rows[name] = decided[column]
    return rows


def considered_rows(decided: NDArray[np.void]) -> NDArray[np.void]:
    """Robot i considers all robots before it."""
    rows = [
        (row["step"], row["robot"], other) for row in decided for other in range(row["considered"])
    ]
    return np.array(rows, dtype=CONSIDERED)


def clearance_block(
    scene: SimpleNamespace, pose: FloatArray, touching: NDArray[np.void]
) -> SimpleNamespace:
    """Distances of the poses by shapely; where contacts say so, minus their depth."""
    shapes = np.stack([_placed(scene, i, pose[:, i]) for i in range(pose.shape[1])], axis=1)
    pairs = shapely.distance(shapes[:, :, None], shapes[:, None])
    robot = np.arange(pose.shape[1])
    far = np.where(robot[:, None] < robot, pairs, -np.inf).reshape(len(pose), -1)
    pairs[:, robot, robot] = np.inf
    lines = np.array([shapely.linestrings(_offset(CENTRELINE, s * WIDTH / 2)) for s in (1, -1)])
    walls = shapely.distance(shapes[:, :, None], lines)
    for row in touching[touching["phase"] != Phase.ENDED]:
        step, a, b, depth = row["step"], row["a"], row["b"], row["depth"]
        if b < len(robot):
            pairs[step, a, b] = pairs[step, b, a] = -depth
        else:
            walls[step, a, b - len(robot)] = -depth
    alone = len(robot) == 1
    farthest = far.argmax(axis=1)
    return SimpleNamespace(
        clearance=pairs.min(axis=2),
        other=np.full(pose.shape[:2], -1) if alone else pairs.argmin(axis=2),
        boundary_clearance=walls.min(axis=2),
        boundary_other=walls.argmin(axis=2) + len(robot),
        farthest=far.max(axis=1),
        farthest_a=np.full(len(pose), -1) if alone else farthest // len(robot),
        farthest_b=np.full(len(pose), -1) if alone else farthest % len(robot),
    )


def _placed(scene: SimpleNamespace, i: int, pose: FloatArray) -> NDArray[np.object_]:
    """Footprint of robot i at each pose, as shapely geometries (K,)."""
    first, last = scene.shapes.body_start[i : i + 2]
    parts = []
    for p in range(first, last):
        part = scene.shapes.vertices[scene.shapes.part_start[p] : scene.shapes.part_start[p + 1]]
        cos, sin = np.cos(pose[:, 2]), np.sin(pose[:, 2])
        turn = np.stack([np.stack([cos, sin], -1), np.stack([-sin, cos], -1)], axis=1)
        parts.append(shapely.polygons(part @ turn + pose[:, None, :2]))
    whole: NDArray[np.object_] = shapely.union_all(np.stack(parts, axis=-1), axis=-1)
    return whole


def _along(lines: Polylines, station: FloatArray, line: NDArray[np.int64]) -> FloatArray:
    """Poses (M, 3) at stations (M,) on polylines ``line`` (M,)."""
    pose = np.empty((len(station), 3))
    for k in np.unique(line):
        run = slice(lines.start[k], lines.start[k + 1])
        points, s = lines.points[run], lines.station[run]
        mine = line == k
        at = np.clip(np.searchsorted(s, station[mine], side="right") - 1, 0, len(s) - 2)
        along = np.diff(points, axis=0)[at]
        heading = np.arctan2(along[:, 1], along[:, 0])
        direction = np.stack([np.cos(heading), np.sin(heading)], axis=-1)
        pose[mine, :2] = points[at] + (station[mine] - s[at])[:, None] * direction
        pose[mine, 2] = heading
    return pose


def _offset(line: FloatArray, offset: float) -> FloatArray:
    """Parallel of a polyline at ``offset`` [m] to the left."""
    if offset == 0.0:
        return line.copy()
    return shapely.get_coordinates(
        shapely.offset_curve(shapely.linestrings(line), offset, join_style="mitre")
    )


def _corridor_ring(half: float) -> FloatArray:
    ring = shapely.buffer(shapely.linestrings(CENTRELINE), half, cap_style="flat", join_style=2)
    return shapely.get_coordinates(ring)


if __name__ == "__main__":
    make_record(Path("record.h5")).close()
