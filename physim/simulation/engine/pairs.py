"""Touching pairs of bodies and their history: began, stays, ended.

A pair of bodies a < b is one integer, its *key* a * B + b with B bodies, so that a set of pairs is
a sorted array. Which pairs touch is decided elsewhere.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.compiled import compiled
from physim.contacts import CONTACT_ROW, Kind, Phase
from physim.geometry.bodies import body_distance, describe_contact, point_gap, relative_frame
from physim.geometry.convex import part_witness
from physim.geometry.shapes import FloatArray, IntArray, Part, Shapes
from physim.geometry.walls import WallTree, parts_near
from physim.tolerances import CONTACT
from physim.world.ground.solids import Solids

BEGAN, STAYS, ENDED, PHYSICAL = map(int, (*Phase, Kind.PHYSICAL))


class Pairs(NamedTuple):
    """A set of touching pairs, each with what it exchanged."""

    key: IntArray
    """(K,) increasing, without repetition"""
    impulse: FloatArray
    """(K,) [N s]"""


class Bodies(NamedTuple):
    """Robots among walls, and among the solids that these make up, in one numbering each."""

    shapes: Shapes
    """of robots and walls"""
    joined: Shapes
    """of robots and solids"""
    owner: IntArray
    """(P,) robot or solid of each part of ``joined``"""
    solids: Solids
    wall_tree: WallTree


def split(key: IntArray, bodies: int) -> IntArray:
    """Return body ids (K, 2), the smaller first, of pairs."""
    return np.stack(np.divmod(key, bodies), axis=1)


@compiled
def pairs_of(part: IntArray, impulse: FloatArray, among: Bodies, pose: FloatArray) -> Pairs:
    """Pairs of robots and walls that touch, by contacts of parts (M, 2) of robots and solids.

    ``pose`` (B, 3) has all robots first. What a robot exchanges with a solid of several walls it
    does with the one of those it touches that the contact's point on the solid lies on. The others
    that it touches have a contact without impulse.
    """
    shapes, solids, owner = among.shapes, among.solids, among.owner
    robots = len(pose) - len(solids.of)
    room = 0
    for m in range(len(part)):
        s = max(owner[part[m, 0]], owner[part[m, 1]]) - robots
        room += 1 if s < 0 else 1 + solids.start[s + 1] - solids.start[s]
    body, given = np.empty((room, 2), np.int64), np.zeros(room)
    count = 0
    for m in range(len(part)):
        p, q = part[m, 0], part[m, 1]
        if owner[p] > owner[q]:
            p, q = q, p
        a, b = owner[p], owner[q]
        s = b - robots
        first = count
        body[first, 0], body[first, 1], given[first] = a, b, impulse[m]
        count += 1
        if s < 0:
            continue
        walls = solids.wall[solids.start[s] : solids.start[s + 1]]
        body[first, 1] = robots + walls[0]
        if len(walls) == 1:
            continue
        x, y = on_solid(among.joined, p, pose[a], q)
        nearest, last, w, tree = np.inf, -1, 0, among.wall_tree
        for k in parts_near(tree, pose[a, 0], pose[a, 1], shapes.radius[a] + CONTACT):
            while tree.walls.body_start[w + 1] <= k:
                w += 1
            if w == last or solids.of[w] != s:
                continue
            last = w
            d = body_distance(shapes, a, pose[a], shapes, robots + w, pose[robots + w])
            if d > CONTACT:
                continue
            body[count, 0], body[count, 1] = a, robots + w
            count += 1
            gap = gap_to(shapes, robots + w, x, y)
            if gap < nearest:
                nearest, body[first, 1] = gap, robots + w
        if nearest == np.inf:  # it touches the outline alone
            for w in walls:
                gap = gap_to(shapes, robots + w, x, y)
                if gap < nearest:
                    nearest, body[first, 1] = gap, robots + w
    return gather(body[:count], given[:count], len(pose))


@compiled
def gap_to(shapes: Shapes, body: int, x: float, y: float) -> float:
    """Lower bound [m] of the distance of a point from a wall."""
    gap = np.inf
    for k in range(shapes.body_start[body], shapes.body_start[body + 1]):
        wall = Part(shapes.vertices, shapes.part_start[k], shapes.part_start[k + 1])
        gap = min(gap, point_gap(wall, x, y))
    return gap


@compiled
def on_solid(joined: Shapes, p: int, pose: FloatArray, q: int) -> tuple[float, float]:
    """Point [m] of part q of a solid at which it touches part p of a robot."""
    v, start = joined.vertices, joined.part_start
    P, Q = Part(v, start[p], start[p + 1]), Part(v, start[q], start[q + 1])
    found = part_witness(P, Q, relative_frame(pose, np.zeros(3)))
    cp, sp = np.cos(pose[2]), np.sin(pose[2])
    x, y = found[5], found[6]
    return pose[0] + cp * x - sp * y, pose[1] + sp * x + cp * y


@compiled
def gather(body: IntArray, impulse: FloatArray, bodies: int) -> Pairs:
    """Gather contacts of bodies (M, 2), in any order, into `Pairs`: impulses (M,) are added."""
    count = len(body)
    # One number for pair and place: those of a pair stay in their order, in which they are added.
    places = np.empty(count, np.int64)
    for m in range(count):
        a, b = body[m, 0], body[m, 1]
        places[m] = (min(a, b) * bodies + max(a, b)) * count + m
    places.sort()
    key, total = np.empty(count, np.int64), np.empty(count)
    pairs = 0
    for place in places:
        if pairs == 0 or key[pairs - 1] != place // count:
            key[pairs], total[pairs] = place // count, 0.0
            pairs += 1
        total[pairs - 1] += impulse[place % count]
    return Pairs(key[:pairs], total[:pairs])


@compiled
def contact_rows(
    step: int,
    before: IntArray,
    now: Pairs,
    pushes: Pairs,
    shapes: Shapes,
    faces: Shapes,
    pose: FloatArray,
) -> NDArray[np.void]:
    """Return the contact rows of a sample, sorted by pair.

    ``before`` are the keys of the pairs that touched at the sample before, ``now`` those that
    touch, with their impacts, ``pushes`` those that touched on the way. ``shapes`` are those of
    all bodies, at ``pose`` (B, 3), ``faces`` those of `Solids`. Of a pair that has ended the depth
    is minus the distance; a pair that touches, by its tolerance, has no depth below 0.
    """
    bodies, found = len(pose), np.empty(5)
    rows = np.empty(len(before) + len(now.key), CONTACT_ROW)
    i, j, k, count = 0, 0, 0, 0
    while i < len(before) or j < len(now.key):
        if j == len(now.key) or (i < len(before) and before[i] < now.key[j]):
            key = before[i]
        else:
            key = now.key[j]
        touched = i < len(before) and before[i] == key
        touches = j < len(now.key) and now.key[j] == key
        while k < len(pushes.key) and pushes.key[k] < key:
            k += 1
        impulse = pushes.impulse[k] if k < len(pushes.key) and pushes.key[k] == key else 0.0
        if touches:
            impulse += now.impulse[j]
        a, b = key // bodies, key % bodies
        describe_contact(shapes, faces, a, pose[a], b, pose[b], found)
        row = rows[count]
        row["step"], row["a"], row["b"], row["kind"] = step, a, b, PHYSICAL
        row["x"], row["y"], row["nx"], row["ny"] = found[0], found[1], found[2], found[3]
        row["phase"] = (STAYS if touched else BEGAN) if touches else ENDED
        row["depth"] = -found[4] if found[4] < 0.0 or not touches else 0.0  # and not -0.0
        row["impulse"] = impulse
        i, j, count = i + touched, j + touches, count + 1
    return rows[:count].copy()


@compiled
def hold_back(key: IntArray, bodies: int, allowed: FloatArray, wanted: FloatArray) -> None:
    """Give every robot of the pairs ``key`` its velocity of ``allowed`` (N, 3) as the wanted one.

    Bodies from N on are walls.
    """
    for one in key:
        for i in (one // bodies, one % bodies):
            if i < len(wanted):
                for k in range(3):
                    wanted[i, k] = allowed[i, k]
