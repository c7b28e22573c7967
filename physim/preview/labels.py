"""Labels on a map that never overlap: each takes the best free place round its anchor, or none."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from physim.geometry.shapes import FloatArray

ANGLES = np.radians([90, 270, 45, 135, 0, 180, 315, 225, 67, 112, 22, 157, 247, 292, 202, 337])
"""Directions, the preferred first."""
GAPS = (2.0, 6.0, 12.0, 20.0)
"""[pt] between what is labelled and its label"""
NEAR = 4.0
"""[pt] A label farther off than this has a line to what it belongs to."""
PRICES = (0.0, 1.0, 2.5, 4.0)
"""What these gaps cost; a direction costs up to 1."""
STEP = 3.0
"""[pt] Lines that labels should not cover are looked at in points this far apart."""
ASTRAY = 50.0
"""What it costs to be nearer to another robot than to the own: more than all lines together"""


class Label(NamedTuple):
    """A text to place, all in points."""

    at: tuple[float, float]
    reach: float
    """radius to keep free round ``at``"""
    size: tuple[float, float]


def placed(
    labels: list[Label], taken: FloatArray, lines: FloatArray, anchors: FloatArray, room: FloatArray
) -> list[FloatArray | None]:
    """Middle (2,) of every label, or None for those that find no place; the first go first.

    ``taken`` (M, 4) are boxes left, bottom, right, top that no label may cover, ``lines`` (P, 3)
    points x, y of lines and what it costs to cover each, ``anchors`` (A, 2) the places of all
    robots, and ``room`` (4,) the box that all must lie in. Labels do not cover each other.
    """
    middles: list[FloatArray | None] = []
    boxes = np.asarray(taken, dtype=np.float64).reshape(-1, 4)
    for label in labels:
        box = _best(label, boxes, lines, anchors, room)
        middles.append(None if box is None else (box[:2] + box[2:]) / 2.0)
        if box is not None:
            boxes = np.concatenate((boxes, box[None]))
    return middles


def leader(label: Label, middle: FloatArray) -> FloatArray | None:
    """Line (2, 2) [pt] from what is labelled to a label that stands off; None for one beside it."""
    way = middle - label.at
    half = np.array(label.size) / 2.0
    distance = float(np.hypot(*way))
    way = way / distance
    room = distance - float(np.min(half / np.maximum(np.abs(way), 1e-9)))
    if room - label.reach <= NEAR:
        return None
    return np.array([label.at + 0.6 * label.reach * way, label.at + room * way])


def along(lines: list[FloatArray], price: float) -> FloatArray:
    """Points (P, 3) at most STEP apart on lines (n, 2) [pt], each with its price."""
    found = [np.zeros((0, 2))]
    for line in lines:
        start, way = line[:-1], np.diff(line, axis=0)
        count = np.ceil(np.hypot(*way.T) / STEP).astype(int).clip(1, 2000)
        leg = np.repeat(np.arange(len(way)), count)
        share = (np.arange(len(leg)) - np.repeat(np.cumsum(count) - count, count)) / count[leg]
        found.append(start[leg] + share[:, None] * way[leg])
    points = np.concatenate(found)
    return np.column_stack((points, np.full(len(points), price)))


def _best(
    label: Label, taken: FloatArray, lines: FloatArray, anchors: FloatArray, room: FloatArray
) -> FloatArray | None:
    """Box of a label in the cheapest of its free places."""
    half = np.array(label.size) / 2.0
    way = np.column_stack((np.cos(ANGLES), np.sin(ANGLES)))
    out = np.min(half / np.maximum(np.abs(way), 1e-9), axis=1) + label.reach
    middles = np.concatenate([label.at + way * (out + gap)[:, None] for gap in GAPS])
    places = np.concatenate((middles - half, middles + half), axis=1)
    inside = ((places[:, :2] >= room[:2]) & (places[:, 2:] <= room[2:])).all(axis=1)
    near = places[:, :2].min(axis=0), places[:, 2:].max(axis=0)
    taken = taken[((taken[:, 2:] > near[0]) & (taken[:, :2] < near[1])).all(axis=1)]
    low, high = places[:, None, :2], places[:, None, 2:]
    lapped = np.asarray(((low < taken[:, 2:]) & (high > taken[:, :2])).all(axis=2))
    free = inside & ~lapped.any(axis=1)
    if not free.any():
        return None
    lines, price = lines[:, :2], lines[:, 2]
    seen = ((lines > near[0]) & (lines < near[1])).all(axis=1)
    lines, price = lines[seen], price[seen]
    covered = ((lines > low) & (lines < high)).all(axis=2) @ price
    cost = np.repeat(PRICES, len(ANGLES)) + np.tile(np.arange(len(ANGLES)), len(GAPS)) / len(ANGLES)
    cost = cost + covered
    anchors = anchors[(np.abs(anchors - label.at) < np.max(near[1] - near[0])).all(axis=1)]
    if len(anchors):
        other = np.hypot(*(anchors - middles[:, None]).transpose(2, 0, 1)).min(axis=1)
        own = np.hypot(*(middles - label.at).T)
        cost = cost + ASTRAY * (other < own - 1e-6)
    cost[~free] = np.inf
    return np.asarray(places[np.argmin(cost)])
