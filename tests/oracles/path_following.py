"""Path following (5): every plan of speed pairs, and how near to the target it ends."""

from __future__ import annotations

import itertools

import numpy as np

from tests.oracles.motion import arc


def pairs(speeds, nu, omegas):
    """All speed pairs (C, 2), in the order of the sets."""
    return np.array([(multiple * nu, omega) for multiple in speeds for omega in omegas])


def judging_time(judge_ahead, left, nu):
    """How far ahead a plan is judged: no further than to the last waypoint at speed nu."""
    return min(judge_ahead, left / nu) if nu > 0.0 else judge_ahead


def plans(candidates, dwell):
    """All sequences (C^m, m, 2) of the speed pairs (C, 2), one pair for each dwell time."""
    return np.array(list(itertools.product(candidates, repeat=len(dwell))))


def judgements(pose, sequences, dwell, ahead, target):
    """For each plan: distance from the target at the end, heading error there, first |omega|.

    The last pair goes on until ``ahead``, where that is later than the end of the plan.
    """
    end = np.broadcast_to(pose, (len(sequences), 3))
    times = [*dwell[:-1], max(dwell[-1], ahead - sum(dwell[:-1]))]
    for k, time in enumerate(times):
        end = arc(end, sequences[:, k], time)
    way = np.asarray(target) - end[:, :2]
    error = np.arctan2(way[:, 1], way[:, 0]) - end[:, 2]
    error = np.abs((error + np.pi) % (2.0 * np.pi) - np.pi)
    return np.hypot(*way.T), error, np.abs(sequences[:, 0, 1])
