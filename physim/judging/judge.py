"""Judge a log: a record of poses, and of what follows from them by geometry alone.

Footprints, walls, paths and formation are the world's; where robots are, the log says. From one
step to the next position and angle go linearly, as everywhere in physim: a contact between two
steps is as exact as that.
"""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from physim.analysis.validation.analytic_contacts import Room, near_rows
from physim.contacts import CONTACT_ROW, Kind, Phase
from physim.geometry.bodies import describe_contacts
from physim.geometry.clearance import ClearanceFinder
from physim.geometry.path import Tracking
from physim.geometry.shapes import FloatArray, IntArray, joined_shapes
from physim.judging.log import read_log
from physim.judging.steps import motion_of
from physim.record import Record, RecordWriter
from physim.record.layout import Judged
from physim.simulation.arrival import Arrivals, later_since
from physim.simulation.recorder import BLOCK_POSES, check_room
from physim.simulation.swept_contacts import SweptContactFinder
from physim.tolerances import CONTACT
from physim.world import World
from physim.world.ground.solids import solids_of
from physim.world.layout.scene_builder import build_scene
from physim.world.scene import Scene


def judge(
    log: str | os.PathLike[str],
    world: World,
    *,
    seed: int | None = None,
    every: float | None = None,
    gaps: float | None = None,
    jumps: bool = False,
    degrees: bool = False,
) -> Record:
    """Judge poses of the robots of a world that no run of physim made, as a record.

    ``log`` is a CSV file with a row for each sample of a robot and the columns ``time`` [s],
    ``robot`` (its name in the world, or its number from 0), ``x``, ``y`` [m], ``heading`` [rad, or
    with ``degrees`` such]. ``seed`` is that of the world, where it draws something. The step of the
    record is the log's own, or ``every`` [s]; gaps of up to ``gaps`` [s] are bridged, by default
    five usual spacings; with ``jumps`` robots may go farther than their limits allow.

    The record holds poses, contacts, distances and arrivals; commands, decisions, modes and
    impulses are not known, which its ``judged`` says. It is in memory, `Record.save` writes it.
    Raises PhysimError, one line with file, line and column, for a log that cannot be judged, and
    WorldError for a faulty world.
    """
    scene = build_scene(world, seed)
    robots, moving = scene.robots, scene.moving
    found = read_log(Path(log), [body.name for body in scene.bodies[:moving]])
    limits = np.full((moving, 2), np.inf)
    limits[:robots, 0] = np.hypot(scene.limits[:, 0], scene.limits[:, 2:].sum(axis=1))
    limits[:robots, 1] = scene.limits[:, 1]
    motion = motion_of(found, limits, every, gaps, jumps, degrees)
    start, steps = motion.pose[0, :robots], len(motion.pose) - 1
    scene = replace(scene, dt=motion.dt, steps=steps, start=start)
    check_room(scene, 1, None)
    writer = RecordWriter(
        None, scene, scene.world.to_yaml(), accessible=scene.area.accessible_rings, record_every=1,
        tables=("contacts",),
        judged=Judged(found.path.name, found.sha256, motion.begun, motion.notes),
    )  # fmt: skip
    writer.append("contacts", contacts_of_poses(scene, motion.pose))
    _write_samples(writer, scene, motion.pose)
    writer.close("duration", steps_run=scene.steps, rejected=0, wall_clock={})
    return writer.record()


def contacts_of_poses(scene: Scene, pose: FloatArray) -> NDArray[np.void]:
    """Rows of `CONTACT_ROW` of poses (K, B, 3) of all that moves, by step; no impulse is known, it
    is 0."""
    grazes, finder = [np.zeros(0, CONTACT_ROW)], SweptContactFinder(scene)
    touching, room = [np.zeros((0, 3), dtype=np.int64)], Room()
    size, moving = max(2, BLOCK_POSES // scene.moving), scene.moving
    is_mover = np.append(np.isinf(scene.mass), True)  # and so are walls: nothing holds them up
    for first in range(0, len(pose) - 1, size):
        block = np.ascontiguousarray(pose[first : first + size + 1])
        near = near_rows(block, first, scene.shapes, scene.walls, CONTACT, scene.dt, room)
        free = is_mover[near["a"]] & is_mover[np.minimum(near["b"], moving)]
        near = near[(near["distance"] <= CONTACT) & ~free]
        touching.append(np.stack([near[name] for name in ("step", "a", "b")], axis=1))
        steps = enumerate(zip(block[:-1], block[1:], strict=True), first + 1)
        grazes += [finder.follow(step, old, now)[1] for step, (old, now) in steps]
    rows = np.concatenate((_lasting(scene, pose, np.concatenate(touching)), *grazes))
    return rows[np.lexsort((rows["b"], rows["a"], rows["step"]))]


def _lasting(scene: Scene, pose: FloatArray, touching: IntArray) -> NDArray[np.void]:
    """Rows of pairs that touch at steps, (M, 3) of step, a and b, and where they part."""
    bodies = len(scene.bodies)
    key = (touching[:, 0] * bodies + touching[:, 1]) * bodies + touching[:, 2]
    after = key + bodies * bodies
    parted = after[(touching[:, 0] < len(pose) - 1) & ~np.isin(after, key)]
    every = np.sort(np.concatenate((key, parted)))
    step, pairs = every // (bodies * bodies), np.stack((every // bodies, every), 1) % bodies
    rows = np.zeros(len(every), CONTACT_ROW)
    rows["step"], rows["kind"] = step, Kind.PHYSICAL
    rows["a"], rows["b"] = pairs.T
    rows["phase"] = np.where(np.isin(every, after), Phase.STAYS, Phase.BEGAN)
    rows["phase"][np.isin(every, parted)] = Phase.ENDED
    shapes, faces = joined_shapes(scene.shapes, scene.walls), solids_of(scene.walls).faces
    place, found = np.zeros((len(shapes.radius), 3)), np.empty((len(every), 5))
    edges = np.flatnonzero(np.diff(step, prepend=-1, append=-1))
    for low, high in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        place[: scene.moving], some = pose[step[low]], found[low:high]
        describe_contacts(shapes, faces, scene.moving, place, pairs[low:high], high - low, some)
    rows["x"], rows["y"], rows["nx"], rows["ny"] = found[:, :4].T
    depth = -found[:, 4]
    rows["depth"] = np.where(rows["phase"] == Phase.ENDED, depth, np.maximum(depth, 0.0))
    return rows


def _write_samples(writer: RecordWriter, scene: Scene, pose: FloatArray) -> None:
    """Write poses (K, B, 3) with the clearances of robots, and who has arrived since when."""
    robots, radius = scene.robots, scene.shapes.radius[: scene.robots]
    tracking = Tracking(scene.paths, scene.reference, radius, scene.start)
    arrivals = Arrivals(scene, tracking)
    near = ClearanceFinder(scene.shapes, scene.wall_tree, robots)
    since, size = np.full(robots, -1, dtype=np.int64), max(1, BLOCK_POSES // scene.moving)
    for first in range(0, len(pose), size):
        block = pose[first : first + size]
        steps, arrived = (
            np.arange(first, first + len(block)),
            np.zeros((len(block), robots), np.bool_),
        )
        for step in steps[steps > 0].tolist():
            arrivals.follow(tracking, step, np.ascontiguousarray(pose[step, :robots]))
            arrived[step - first] = arrivals.arrived
        since = later_since(since, first, arrived)
        writer.note_arrived(since)
        found = near.find(block)
        writer.note_extremes(steps, found)
        writer.append_steps(steps, block, found.clearance, found.boundary_clearance)
