"""Touching pairs of bodies and their history: began, stays, ended.

A pair of bodies a < b is one integer, its *key* a * B + b with B bodies, so that a set of pairs is
a sorted array. Which pairs touch is decided elsewhere.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.contacts import CONTACT_ROW, Kind, Phase
from physim.geometry.bodies import (
    describe_contact,
    point_gap,
    relative_frame,
    wall_gap,
)
from physim.geometry.convex import frame_at, part_witness
from physim.geometry.neighbours import put_in_order
from physim.geometry.shapes import ContactRows, FloatArray, IntArray, IntRows2, Part, Rows3, Shapes
from physim.geometry.walls import NearestWalls, WallTree, parts_near
from physim.tolerances import CONTACT
from physim.world.ground.solids import Solids

BEGAN, STAYS, ENDED, PHYSICAL = map(int, (*Phase, Kind.PHYSICAL))


class Pairs(NamedTuple):
    """A set of touching pairs, each with what it exchanged."""

    key: IntArray
    """(K,) increasing, without repetition"""
    impulse: FloatArray
    """(K,) [N s]"""
    size: int
    """K"""


class Among(NamedTuple):
    """Robots among walls, and among the solids that these make up, in one numbering each."""

    shapes: Shapes
    """of robots and walls"""
    joined: Shapes
    """of robots and solids"""
    owner: IntArray
    """(P,) robot or solid of each part of ``joined``"""
    solids: Solids
    wall_tree: WallTree
    known: NearestWalls
    """of nobody"""
    robots: int
    bodies: int
    """robots and walls"""


@compiled
def put_solid_keys(
    key: IntArray, pairs: int, bodies: int, solid: IntArray, solids: int, out: IntArray
) -> int:
    """Write the keys of so many ``pairs`` of ``bodies`` in the numbering of robots and ``solids``.

    ``solid`` (B,) is that of each body. Increasing, each once; returns how many.
    """
    for m in range(pairs):
        out[m] = solid[key[m] // bodies] * solids + solid[key[m] % bodies]
    put_in_order(out, pairs)
    count = 0
    for m in range(pairs):
        if count == 0 or out[count - 1] != out[m]:
            out[count] = out[m]
            count += 1
    return count


def split(key: IntArray, bodies: int) -> IntArray:
    """Return body ids (K, 2), the smaller first, of pairs."""
    return np.stack(np.divmod(key, bodies), axis=1)


def pairs_of(part: IntRows2, impulse: FloatArray, among: Among, pose: Rows3) -> Pairs:
    """Pairs of robots and walls that touch, by contacts of parts (M, 2) of robots and solids.

    ``pose`` (B, 3) has all robots first. What a robot exchanges with a solid of several walls it
    does with the one of those it touches that the contact's point on the solid lies on. The others
    that it touches have a contact without impulse.
    """
    room = most_pairs(part, len(part), among)
    key, total = np.empty(room, np.int64), np.zeros(room)
    count = put_pairs_of(part, impulse, len(part), among, pose, room, key, total)
    return Pairs(key[:count], total[:count], count)


@compiled
def most_pairs(part: IntRows2, many: int, among: Among) -> int:
    """How many pairs so ``many`` contacts may be of."""
    most, start = many, among.solids.start
    for m in range(many):
        s = max(among.owner[part[m, 0]], among.owner[part[m, 1]]) - among.robots
        if s >= 0:
            most += start[s + 1] - start[s]
    return int(most)


@compiled
def put_pairs_of(
    part: IntRows2,
    impulse: FloatArray,
    many: int,
    among: Among,
    pose: Rows3,
    room: int,
    key: IntArray,
    total: FloatArray,
) -> int:
    """Write `pairs_of` so ``many`` contacts into ``key`` and ``total`` (room,); how many."""
    shapes, solids, owner, robots = among.shapes, among.solids, among.owner, among.robots
    body, given = np.empty((room, 2), np.int64), np.zeros(room)
    count = 0
    for m in range(many):
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
        body[first, 1] = robots + solids.wall[solids.start[s]]
        if solids.start[s + 1] - solids.start[s] == 1:
            continue
        x, y = on_solid(among.joined, p, pose[a], q)
        nearest, w, n, walls = np.inf, 0, 0, among.wall_tree.walls
        reach = shapes.radius[a] + CONTACT
        found = parts_near(among.wall_tree, pose[a, 0], pose[a, 1], reach, among.known)
        f = frame_at(np.cos(pose[a, 2]), np.sin(pose[a, 2]), pose[a, 0], pose[a, 1])
        while n < found.size:  # the parts of one wall after the other
            while walls.body_start[w + 1] <= found.number[n]:
                w += 1
            is_met = False
            while n < found.size and found.number[n] < walls.body_start[w + 1]:
                k = found.number[n]
                wall = Part(walls.vertices, walls.part_start[k], walls.part_start[k + 1])
                if not is_met and wall_gap(wall, shapes, a, f, np.inf) <= CONTACT:
                    is_met = True
                n += 1
            if solids.of[w] != s or not is_met:
                continue
            body[count, 0], body[count, 1] = a, robots + w
            count += 1
            gap = gap_to(shapes, robots + w, x, y)
            if gap < nearest:
                nearest, body[first, 1] = gap, robots + w
        if nearest == np.inf:  # it touches the outline alone
            for n in range(solids.start[s], solids.start[s + 1]):
                gap = gap_to(shapes, robots + solids.wall[n], x, y)
                if gap < nearest:
                    nearest, body[first, 1] = gap, robots + solids.wall[n]
    return gather(body, given, count, among.bodies, key, total)


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
    x, y = found.bx, found.by
    return pose[0] + cp * x - sp * y, pose[1] + sp * x + cp * y


@compiled
def gather(
    body: IntRows2, impulse: FloatArray, count: int, bodies: int, key: IntArray, total: FloatArray
) -> int:
    """Gather ``count`` contacts of ``body`` (M, 2), in any order, into `Pairs`; how many.

    Their impulses (M,) are added.
    """
    # One number for pair and place: those of a pair stay in their order, in which they are added.
    places = np.empty(count, np.int64)
    for m in range(count):
        a, b = body[m, 0], body[m, 1]
        places[m] = (min(a, b) * bodies + max(a, b)) * count + m
    put_in_order(places, count)
    pairs = 0
    for m in range(count):
        place = places[m]
        if pairs == 0 or key[pairs - 1] != place // count:
            key[pairs], total[pairs] = place // count, 0.0
            pairs += 1
        total[pairs - 1] += impulse[place % count]
    return pairs


def contact_rows(
    step: int, before: IntArray, now: Pairs, pushes: Pairs, among: Among, pose: Rows3
) -> ContactRows:
    """Return the contact rows of a sample, sorted by pair.

    ``before`` are the keys of the pairs that touched at the sample before, ``now`` those that
    touch, with their impacts, ``pushes`` those that touched on the way. ``shapes`` are those of
    all bodies, at ``pose`` (B, 3), ``faces`` those of `Solids`. Of a pair that has ended the depth
    is minus the distance; a pair that touches, by its tolerance, has no depth below 0.
    """
    rows = np.empty(len(before) + now.size, CONTACT_ROW)
    count = put_contact_rows(step, before, len(before), now, pushes, among, pose, rows)
    return rows[:count].copy()


@compiled
def put_contact_rows(
    step: int,
    before: IntArray,
    earlier: int,
    now: Pairs,
    pushes: Pairs,
    among: Among,
    pose: Rows3,
    rows: ContactRows,
) -> int:
    """Write `contact_rows` into ``rows``, the first of ``before`` being ``earlier``; how many."""
    bodies, found = among.bodies, np.empty(5)
    i, j, k, count = 0, 0, 0, 0
    while i < earlier or j < now.size:
        if j == now.size or (i < earlier and before[i] < now.key[j]):
            key = before[i]
        else:
            key = now.key[j]
        touched = i < earlier and before[i] == key
        touches = j < now.size and now.key[j] == key
        while k < pushes.size and pushes.key[k] < key:
            k += 1
        impulse = pushes.impulse[k] if k < pushes.size and pushes.key[k] == key else 0.0
        if touches:
            impulse += now.impulse[j]
        a, b = key // bodies, key % bodies
        describe_contact(
            among.shapes, among.solids.faces, a, pose[a], b, pose[b], b - among.robots, found
        )
        rows[count]["step"], rows[count]["a"], rows[count]["b"] = step, a, b
        rows[count]["kind"] = PHYSICAL
        rows[count]["x"], rows[count]["y"] = found[0], found[1]
        rows[count]["nx"], rows[count]["ny"], rows[count]["impulse"] = found[2], found[3], impulse
        rows[count]["phase"] = (STAYS if touched else BEGAN) if touches else ENDED
        rows[count]["depth"] = -found[4] if found[4] < 0.0 or not touches else 0.0  # and not -0.0
        i, j, count = i + touched, j + touches, count + 1
    return count


@compiled
def hold_back(
    key: IntArray, pairs: int, bodies: int, allowed: Rows3, robots: int, wanted: Rows3
) -> None:
    """Give every robot of so many ``pairs`` its velocity of ``allowed`` (N, 3) as the wanted one.

    Bodies from N on are walls.
    """
    for m in range(pairs):
        for end in range(2):
            i = key[m] % bodies if end else key[m] // bodies
            if i < robots:
                for k in range(3):
                    wanted[i, k] = allowed[i, k]
