"""Bookkeeping of contacts with sets and whole columns: the oracle of `simulation.engine.pairs`."""

from __future__ import annotations

import numpy as np

from physim.contacts import CONTACT_ROW, Kind, Phase
from tests.helpers import inside

describe_pairs = inside("physim.geometry", "describe_pairs")
Pairs, split = inside("physim.simulation.engine", "Pairs", "split")


def gather(body, impulse, bodies):
    """Contacts of parts, ``body`` (M, 2) in any order, as pairs: impulses are added."""
    key = body.min(axis=1) * bodies + body.max(axis=1)
    unique, place = np.unique(key, return_inverse=True)
    total = np.zeros(len(unique))
    np.add.at(total, place, impulse)
    return Pairs(unique, total)


def phases(key, before, now):
    """`Phase` of each pair, given the sets that touched before and touch now."""
    touched, touches = np.isin(key, before), np.isin(key, now)
    return np.where(touches, np.where(touched, Phase.STAYS, Phase.BEGAN), Phase.ENDED).astype("i1")


def impulse_of(key, *exchanged):
    """Impulse [N s] of each pair, added over several sets; 0 where none has it."""
    total = np.zeros(len(key))
    for pairs in exchanged:
        known = np.isin(pairs.key, key)
        total[np.searchsorted(key, pairs.key[known])] += pairs.impulse[known]
    return total


def contact_rows(step, before, now, pushes, shapes, pose):
    """Contact rows of a sample; ``pose`` (B, 3) of all bodies."""
    key = np.union1d(before, now.key)
    pairs, phase = split(key, len(pose)), phases(key, before, now.key)
    found = describe_pairs(shapes, pose, pairs)
    rows = np.zeros(len(pairs), CONTACT_ROW)
    rows["step"], rows["phase"], rows["kind"] = step, phase, Kind.PHYSICAL
    rows["a"], rows["b"] = pairs.T
    rows["x"], rows["y"], rows["nx"], rows["ny"] = found[:, :4].T
    rows["depth"] = np.where(phase == Phase.ENDED, -found[:, 4], np.maximum(-found[:, 4], 0.0))
    rows["impulse"] = impulse_of(key, pushes, now)
    return rows
