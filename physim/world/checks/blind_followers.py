"""Robots that run into others ahead of them, which they do not see by the rule of priority.

Where stations along the reference path settle who looks out for whom, a robot does not see one
ahead of it whose station is smaller, or, of equal stations, whose number is higher: on a way
against the reference path, across it, beyond its ends, and on the outside of its corners.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from physim.errors import place_text, plural
from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray, IntArray
from physim.world.checks.findings import Diagnostics
from physim.world.checks.measured import Drive
from physim.world.checks.spacing import name_of
from physim.world.checks.standing import Stop, leads
from physim.world.scene import Layout

MOST_PLACES = 2_000_000
"""Places of all robots at which it is known where they are along the reference path"""
MOST_PAIRS = 10_000
"""Pairs of robots that are driven, about: of each those that start nearest to it"""
MOST_STEPS = 20_000
"""of a drive, which ends with the run that is checked, too"""
STEP = 0.2
"""[m] that the fastest robot drives in a step"""
SLOWEST = 1e-6
"""[m/s] of a robot that is driven"""
SAME_WAY = 0.7
"""[-] cosine between the headings of two that drive the same way"""


class Reach(NamedTuple):
    """How far the footprints of N robots reach to the front, back and side, (N,) [m] each."""

    front: FloatArray
    back: FloatArray
    side: FloatArray

    @classmethod
    def of(cls, outlines: list[FloatArray]) -> Reach:
        """Of outlines (n, 2) in the frames of their robots."""
        ends = np.array([[one[:, 0].max(), -one[:, 0].min()] for one in outlines])
        side = np.array([np.abs(one[:, 1]).max() for one in outlines])
        return cls(ends[:, 0], ends[:, 1], side)


class Keeping(NamedTuple):
    """What robots keep: the distance [m] and the collision time [s] to those that they see.

    And their usual ``speed`` [m/s]; by (7) in a formation: ``gain`` [1/s], 0 without one, between
    ``low`` and ``high`` [m/s], wanted leads (N,) [m] over the first. ``duration`` [s] of the run.
    """

    clear: float
    time: float
    speed: float
    gain: float
    low: float
    high: float
    lead: FloatArray
    duration: float


def check_blind_followers(
    laid: Layout, at: list[Stop], speed: float, clear: float, time: float, found: Diagnostics
) -> None:
    """Warn of robots that would run into others which they do not see.

    ``speed`` [m/s] is that of all robots whose limits are not below it. ``clear`` [m] and ``time``
    [s] are the distance and the collision time that one keeps to those that it sees.
    """
    world, count = laid.world, len(at)
    if count < 2:
        return
    outlines = [laid.footprints[i] for i in range(count)]
    radius = np.array([circumscribed_radius(one) for one in outlines])
    paths = [laid.paths[i] for i in range(count)]
    stops = np.array([stop.station for stop in at])
    drive = Drive.of(paths, laid.reference, laid.start, radius, stops, MOST_PLACES)
    if drive is None:
        return
    plan, lead = world.formation, leads(laid)
    gain, low, high = 0.0, 0.0, np.inf
    if plan is not None:
        gain, (low, high) = plan.gain, plan.limits
        speed = min(max(plan.speed, low), high)  # (7)
    if lead is None:
        return
    own = np.array([np.inf if one.limits.v is None else one.limits.v for one in world.robots])
    rule = Keeping(clear, time, speed, gain, low, high, lead, world.time.duration)
    hits = run_into(drive, laid.start, np.maximum(own, SLOWEST), Reach.of(outlines), rule)
    if not hits:
        return
    (i, j), (x, y) = hits[0]
    more = f", and {plural(len(hits) - 1, 'more pair')} like that" if len(hits) > 1 else ""
    found.warn(
        laid.path_key(i),
        f"{name_of(laid, i)} may run into {name_of(laid, j)} ahead of it, near "
        f"{place_text(float(x), float(y), 4)}{more}: by its station along the reference path it "
        "has priority there, against that path, across it, beyond its ends or outside a corner of "
        "it, so it does not see the other; lead the reference path along the way of both, or give "
        "them one speed",
    )


def run_into(
    drive: Drive, start: FloatArray, limit: FloatArray, reach: Reach, keep: Keeping
) -> list[tuple[tuple[int, int], FloatArray]]:
    """Pairs (i, j) of robots of which i runs into j ahead, unseen, and where, (2,) [m].

    Each pair of N robots drives alone, at ``limit`` (N,) [m/s] at most, from its ``start`` (N, 3);
    i stays behind j wherever it sees it, as far as it is to ``keep``.
    """
    poses, station = (np.concatenate(some) for some in zip(*drive.blocks(), strict=True))
    places = np.concatenate([start[None, :, :2], poses[:, :, :2]])
    station = np.concatenate([station[:1], station])
    i, j = _pairs(places, np.hypot(np.maximum(reach.front, reach.back), reach.side))
    speed = np.maximum(np.minimum(limit, keep.speed), SLOWEST)
    comes_nearer = (speed[i] > speed[j]) | (keep.gain > 0.0)  # by (7) it may
    i, j = i[comes_nearer], j[comes_nearer]
    if not len(i):
        return []
    way, step = drive.end - drive.begin, STEP / float(speed.max())
    pace = np.divide(len(poses), way, out=np.zeros(len(way)), where=way > 0.0)  # [1/m]
    lasting = min(float((way / speed).max()), keep.duration)
    steps = min(int(np.ceil(lasting / step)) + 1, MOST_STEPS)
    two = _Two(
        i, j,
        limit=(limit[i], limit[j]),
        pace=(pace[i] * step, pace[j] * step),
        lead=keep.lead[j] - keep.lead[i],
        touch=reach.front[i] + reach.back[j],
        side=reach.side[i] + reach.side[j],
        clear=keep.clear + np.maximum(speed[i] - speed[j], 0.0) * keep.time,
    )  # fmt: skip
    hit, where = _driven(places, station, two, keep, steps)
    first: dict[tuple[int, int], int] = {}  # of two that drive through each other
    for n in np.argsort(hit, kind="stable")[: np.count_nonzero(hit < steps)].tolist():
        first.setdefault((min(i[n], j[n]), max(i[n], j[n])), n)
    return [((int(i[n]), int(j[n])), where[n]) for n in first.values()]


class _Two(NamedTuple):
    """Pairs (P,) of robots i and j, the one behind and the one ahead."""

    i: IntArray
    j: IntArray
    limit: tuple[FloatArray, FloatArray]
    """[m/s] of i and j"""
    pace: tuple[FloatArray, FloatArray]
    """[s/m] places that they drive in a step, at 1 m/s"""
    lead: FloatArray
    """[m] that j is to lead i by in a formation"""
    touch: FloatArray
    """[m] between their reference points, one behind the other, where they touch"""
    side: FloatArray
    """[m] beside each other"""
    clear: FloatArray
    """[m] that i keeps to j where it sees it"""


def _driven(
    places: FloatArray, station: FloatArray, two: _Two, keep: Keeping, steps: int
) -> tuple[IntArray, FloatArray]:
    """In which step (P,) each i runs into j, unseen, else ``steps``; and where, (P, 2) [m].

    From places (K, N, 2) [m] of N robots on their ways and their stations (K, N) [m] on s* there.
    """
    i, j, last = two.i, two.j, len(places) - 1
    ahead = np.diff(places, axis=0)
    length = np.hypot(ahead[..., 0], ahead[..., 1])
    along = ahead / np.maximum(length, np.finfo(np.float64).tiny)[..., None]
    at_i, at_j, was_behind = np.zeros(len(i)), np.zeros(len(i)), np.zeros(len(i), dtype=bool)
    hit, where = np.full(len(i), steps), np.zeros((len(i), 2))
    for now in range(steps):
        k, m = np.minimum(at_i.astype(int), last), np.minimum(at_j.astype(int), last)
        here, heading = places[k, i], along[np.minimum(k, last - 1), i]
        x, y = (places[m, j] - here).T
        gap = heading[:, 0] * x + heading[:, 1] * y - two.touch
        beside = np.abs(heading[:, 0] * y - heading[:, 1] * x)
        same = (heading * along[np.minimum(m, last - 1), j]).sum(axis=1) > SAME_WAY
        follows = same & (beside < two.side) & (gap > -two.touch)
        mine, its = station[k, i], station[m, j]
        sees = (its > mine) | ((its == mine) & (j < i))  # `has_priority` of the controller
        new = was_behind & follows & ~sees & (gap <= 0.0) & (hit == steps)
        hit[new], where[new] = now, here[new]
        was_behind |= follows & (gap > 0.0)
        change = keep.gain * (its - mine - two.lead)  # (7), of these two alone
        v_i = np.minimum(np.clip(keep.speed + change, keep.low, keep.high), two.limit[0])
        v_j = np.minimum(np.clip(keep.speed - change, keep.low, keep.high), two.limit[1])
        at_i += np.where(follows & sees & (gap < two.clear), 0.0, v_i * two.pace[0])
        at_j += v_j * two.pace[1]
    return hit, where


def _pairs(places: FloatArray, radius: FloatArray) -> tuple[IntArray, IntArray]:
    """Numbers i and j of the pairs that may meet, of each robot those that start nearest to it.

    From places (K, N, 2) [m] and circumscribed radii (N,) [m].
    """
    count = len(radius)
    near = min(max(MOST_PAIRS // count, 1) + 1, count)
    _, others = cKDTree(places[0]).query(places[0], near)
    i, j = np.repeat(np.arange(count), near), others.ravel()
    pair = np.unique(np.concatenate([i * count + j, j * count + i])[np.tile(i != j, 2)])
    i, j = np.divmod(pair, count)
    low, high = places.min(axis=0) - radius[:, None], places.max(axis=0) + radius[:, None]
    is_near = ((low[i] <= high[j]) & (low[j] <= high[i])).all(axis=1)
    return i[is_near], j[is_near]
