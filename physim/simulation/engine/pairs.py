"""Touching pairs of bodies and their history: began, stays, ended.

A pair of bodies a < b is one integer, its *key* a * B + b with B bodies, so that a set of pairs is
a sorted array. Which pairs touch is decided elsewhere.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.compiled import compiled
from physim.contacts import CONTACT_ROW, FALSE_CONTACT_ROW, Kind, Phase
from physim.geometry.separation import describe_pair
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.tolerances import CONTACT

BEGAN, STAYS, ENDED, PHYSICAL = map(int, (*Phase, Kind.PHYSICAL))


class Pairs(NamedTuple):
    """A set of touching pairs, each with what it exchanged."""

    key: IntArray
    """(K,) increasing, without repetition"""
    impulse: FloatArray
    """(K,) [N s]"""


def no_pairs() -> Pairs:
    """Return the empty set of pairs."""
    return Pairs(np.zeros(0, dtype=np.int64), np.zeros(0))


def no_contacts() -> NDArray[np.void]:
    """Return an empty array of contact rows."""
    return np.zeros(0, CONTACT_ROW)


def no_false_contacts() -> NDArray[np.void]:
    """Return an empty array of false contacts."""
    return np.zeros(0, FALSE_CONTACT_ROW)


def false_rows(step: int, pairs: IntArray, distance: FloatArray) -> NDArray[np.void]:
    """Return the rows of pairs (K, 2) reported at a sample that are apart; ``distance`` (K,) [m].

    A pair of which other parts do touch is no false contact.
    """
    apart = distance > CONTACT
    rows = np.zeros(int(apart.sum()), FALSE_CONTACT_ROW)
    rows["step"] = step
    rows["a"], rows["b"] = pairs[apart].T
    rows["distance"] = distance[apart]
    return rows


def split(key: IntArray, bodies: int) -> IntArray:
    """Return body ids (K, 2), the smaller first, of pairs."""
    return np.stack(np.divmod(key, bodies), axis=1)


@compiled
def gather(
    part: IntArray, impulse: FloatArray, body_of_part: IntArray, bodies: int
) -> tuple[IntArray, FloatArray]:
    """Gather contacts of parts (M, 2), in any order, into `Pairs`: impulses (M,) are added."""
    count = len(part)
    # One number for pair and place: those of a pair stay in their order, in which they are added.
    places = np.empty(count, np.int64)
    for m in range(count):
        a, b = body_of_part[part[m, 0]], body_of_part[part[m, 1]]
        places[m] = (min(a, b) * bodies + max(a, b)) * count + m
    places.sort()
    key, total = np.empty(count, np.int64), np.empty(count)
    pairs = 0
    for place in places:
        if pairs == 0 or key[pairs - 1] != place // count:
            key[pairs], total[pairs] = place // count, 0.0
            pairs += 1
        total[pairs - 1] += impulse[place % count]
    return key[:pairs], total[:pairs]


@compiled
def contact_rows(
    step: int,
    before: IntArray,
    now: IntArray,
    impact: FloatArray,
    pushed: IntArray,
    push: FloatArray,
    shapes: Shapes,
    pose: FloatArray,
    rows: NDArray[np.void],
) -> int:
    """Write the contact rows of a sample into ``rows``, sorted by pair; returns how many.

    The keys of the pairs that touched ``before`` and touch ``now`` are sorted, and so are those
    that were ``pushed`` on the way; ``impact`` and ``push`` [N s] belong to the latter two.
    ``shapes`` are those of all bodies, at ``pose`` (B, 3). Of a pair that has ended the depth is
    minus the distance; a pair that touches, by its tolerance, has no depth below 0.
    """
    bodies = len(pose)
    found = np.empty(5)
    i, j, k, count = 0, 0, 0, 0
    while i < len(before) or j < len(now):
        if j == len(now) or (i < len(before) and before[i] < now[j]):
            key = before[i]
        else:
            key = now[j]
        touched, touches = i < len(before) and before[i] == key, j < len(now) and now[j] == key
        while k < len(pushed) and pushed[k] < key:
            k += 1
        impulse = push[k] if k < len(pushed) and pushed[k] == key else 0.0
        if touches:
            impulse += impact[j]
        a, b = key // bodies, key % bodies
        describe_pair(shapes, a, pose[a], shapes, b, pose[b], found)
        row = rows[count]
        row["step"], row["a"], row["b"], row["kind"] = step, a, b, PHYSICAL
        row["x"], row["y"], row["nx"], row["ny"] = found[0], found[1], found[2], found[3]
        row["phase"] = (STAYS if touched else BEGAN) if touches else ENDED
        row["depth"] = -found[4] if found[4] < 0.0 or not touches else 0.0  # and not -0.0
        row["impulse"] = impulse
        i, j, count = i + touched, j + touches, count + 1
    return count


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
