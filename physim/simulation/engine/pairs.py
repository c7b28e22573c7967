"""Touching pairs of bodies and their history: began, stays, ended.

A pair of bodies a < b is one integer, its *key* a * B + b with B bodies, so that a set of pairs is
a sorted array. Which pairs touch is decided elsewhere.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.contacts import CONTACT_ROW, FALSE_CONTACT_ROW, Kind, Phase
from physim.geometry.shapes import FloatArray, IntArray
from physim.tolerances import CONTACT


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


def gather(body: IntArray, impulse: FloatArray, bodies: int) -> Pairs:
    """Gather contacts of parts, ``body`` (M, 2) in any order, into pairs: impulses are added."""
    key = body.min(axis=1) * bodies + body.max(axis=1)
    unique, place = np.unique(key, return_inverse=True)
    total = np.zeros(len(unique))
    np.add.at(total, place, impulse)
    return Pairs(unique, total)


def split(key: IntArray, bodies: int) -> IntArray:
    """Return body ids (K, 2), the smaller first, of pairs."""
    return np.stack(np.divmod(key, bodies), axis=1)


def phases(key: IntArray, before: IntArray, now: IntArray) -> NDArray[np.int8]:
    """Return the `Phase` of each pair, given the sets that touched before and touch now."""
    touched = np.isin(key, before)
    touches = np.isin(key, now)
    return np.where(touches, np.where(touched, Phase.STAYS, Phase.BEGAN), Phase.ENDED).astype("i1")


def contact_rows(
    step: int,
    pairs: IntArray,
    phase: NDArray[np.int8],
    found: FloatArray,
    impulse: FloatArray,
) -> NDArray[np.void]:
    """Return contact rows of a sample from columns: ``pairs`` (K, 2), ``found`` (K, 5).

    ``found`` holds x, y, nx, ny and signed distance [m]. Of a pair that has ended the depth is
    minus the distance; a pair that touches, by its tolerance, has no depth below 0.
    """
    rows = np.zeros(len(pairs), CONTACT_ROW)
    rows["step"] = step
    rows["a"], rows["b"] = pairs.T
    rows["phase"] = phase
    rows["kind"] = Kind.PHYSICAL
    rows["x"], rows["y"], rows["nx"], rows["ny"] = found[:, :4].T
    rows["depth"] = np.where(phase == Phase.ENDED, -found[:, 4], np.maximum(-found[:, 4], 0.0))
    rows["impulse"] = impulse
    return rows


def impulse_of(key: IntArray, *exchanged: Pairs) -> FloatArray:
    """Return the impulse [N s] of each pair, added over several sets; 0 where none has it."""
    total = np.zeros(len(key))
    for pairs in exchanged:
        known = np.isin(pairs.key, key)
        total[np.searchsorted(key, pairs.key[known])] += pairs.impulse[known]
    return total
