"""The rows of the contact table against the shapes and against each other.

Of each contact at a sample its point, its normal and, where it has ended, the gap are worked out
anew; its rows must make whole episodes: one that begins, one for every sample while it lasts, one
that ends.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.contacts import Kind, Phase
from physim.geometry.closeness import describe_pairs
from physim.geometry.shapes import FloatArray, joined_shapes
from physim.record import Record
from physim.validation.findings import DEPTH_SLACK, UNEXPLAINED, Disagreement
from physim.validation.ledger import blocks, robot_shapes


def contact_rows(record: Record) -> list[Disagreement]:
    """Contacts whose rows are not those of the shapes, or make no episode: one for each pair."""
    rows = record.contacts[record.contacts["kind"] == Kind.PHYSICAL]
    exact = _exact(record, rows)
    return [*_described(record, rows, exact), *_episodes(record, rows, exact[:, 4])]


def _exact(record: Record, rows: NDArray[np.void]) -> FloatArray:
    """Point [m], normal and signed distance [m] of each row (M, 5), by the shapes."""
    shapes = joined_shapes(robot_shapes(record), record.walls)
    found = np.zeros((len(rows), 5))
    pose = np.zeros((len(shapes.body_start) - 1, 3))
    step, pairs = rows["step"], np.stack((rows["a"], rows["b"]), axis=1).astype(np.int64)
    for poses, start in blocks(record):
        first, last = np.searchsorted(
            step, (start if start == 0 else start + 1, start + len(poses))
        )
        if first == last:
            continue
        edges = np.flatnonzero(np.diff(step[first:last], prepend=-1)) + first
        for low, high in zip(edges, [*edges[1:], last], strict=True):
            pose[: record.robots] = poses[step[low] - start]
            found[low:high] = describe_pairs(shapes, pose, pairs[low:high])
    return found


def _described(record: Record, rows: NDArray[np.void], exact: FloatArray) -> list[Disagreement]:
    told = np.stack([rows[key] for key in ("x", "y", "nx", "ny", "depth")], axis=1)
    true = exact.copy()
    true[:, 4] = -true[:, 4]
    wrong = np.abs(told - true) > DEPTH_SLACK
    wrong[:, 4] &= rows["phase"] == Phase.ENDED  # the depths of the others are held elsewhere
    found = []
    for columns, what, unit in (((0, 1), "contact point", " m"), ((2, 3), "normal", "")):
        for first, count in _by_pair(rows, np.any(wrong[:, columns], axis=1)):
            one, other = (
                f"({v[columns[0]]:.6g}, {v[columns[1]]:.6g}){unit}"
                for v in (told[first], true[first])
            )
            text = f"{what} {one} in the record, {other} by the shapes"
            found.append(_one(record, rows[first], count, exact[first, 4], text))
    for first, count in _by_pair(rows, wrong[:, 4]):
        text = (
            f"gap after a contact {-told[first, 4]:.6g} m in the record, "
            f"{exact[first, 4]:.6g} m by the shapes"
        )
        found.append(_one(record, rows[first], count, exact[first, 4], text))
    return found


def _episodes(record: Record, rows: NDArray[np.void], distance: FloatArray) -> list[Disagreement]:
    """Rows that do not follow on each other as those of an episode do."""
    n = len(record.bodies)
    place = (rows["a"].astype(np.int64) * n + rows["b"]) * (record.samples + 1) + rows["step"]
    ends = rows["phase"] == Phase.ENDED
    touching = place[~ends]
    before, after = np.isin(place - 1, touching), np.isin(place + 1, place)
    should = np.where(ends, Phase.ENDED, np.where(before, Phase.STAYS, Phase.BEGAN))
    last = rows["step"] >= record.samples - 1
    found = []
    for wrong, text in (
        (rows["phase"] != should, "a row that begins a contact or goes on with one, wrongly"),
        (ends & ~before, "a contact that ends without having lasted"),
        (~ends & ~after & ~last, "a contact whose end is not in the record"),
    ):
        for first, count in _by_pair(rows, np.asarray(wrong)):
            found.append(_one(record, rows[first], count, distance[first], text))
    return found


def _by_pair(rows: NDArray[np.void], wrong: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First wrong row of each pair, and how many it has."""
    seen: dict[tuple[int, int], list[int]] = {}
    for k in np.flatnonzero(wrong).tolist():
        seen.setdefault((int(rows["a"][k]), int(rows["b"][k])), []).append(k)
    return [(some[0], len(some)) for some in seen.values()]


def _one(record: Record, row: np.void, count: int, distance: float, what: str) -> Disagreement:
    a, b, step = (int(row[key]) for key in ("a", "b", "step"))
    return Disagreement(a, b, step, count, step * record.dt, float(distance), UNEXPLAINED, what)
