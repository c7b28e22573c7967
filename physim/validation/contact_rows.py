"""The rows of the contact table against the shapes and against each other.

Of each contact at a sample its point, its normal and, where it has ended, the gap are computed
anew; its rows must make whole episodes: one that begins, one for every sample while it lasts, one
that ends.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from physim.contacts import Kind, Phase
from physim.geometry.closeness import describe_pairs
from physim.geometry.shapes import FloatArray, joined_shapes
from physim.record import Record
from physim.validation.findings import DEPTH_SLACK, Disagreement
from physim.validation.ledger import pose_blocks


def check_contact_rows(record: Record) -> list[Disagreement]:
    """Contacts whose rows are not those of the shapes, or make no episode: one for each pair."""
    rows = record.contacts[record.contacts["kind"] == Kind.PHYSICAL]
    exact = _exact(record, rows)
    return [
        Disagreement.at(
            record,
            (int(rows["a"][k]), int(rows["b"][k])),
            rows["step"][k],
            -exact["depth"][k],
            what,
            steps=count,
        )
        for k, count, what in (*_described(rows, exact), *_episodes(record, rows))
    ]


def _exact(record: Record, rows: NDArray[np.void]) -> dict[str, FloatArray]:
    """Columns of the rows (M,) by the shapes: point [m], normal, depth [m]."""
    shapes = joined_shapes(record.shapes, record.walls)
    found = np.zeros((len(rows), 5))
    pose = np.zeros((len(shapes.body_start) - 1, 3))
    step, pairs = rows["step"], np.stack((rows["a"], rows["b"]), axis=1).astype(np.int64)
    for poses, start in pose_blocks(record):
        first, last = np.searchsorted(
            step, (start if start == 0 else start + 1, start + len(poses))
        )
        if first == last:
            continue
        edges = np.flatnonzero(np.diff(step[first:last], prepend=-1)) + first
        for low, high in zip(edges, [*edges[1:], last], strict=True):
            pose[: record.robots] = poses[step[low] - start]
            found[low:high] = describe_pairs(shapes, pose, pairs[low:high])
    x, y, nx, ny, distance = found.T
    return {"x": x, "y": y, "nx": nx, "ny": ny, "depth": -distance}


def _described(
    rows: NDArray[np.void], exact: dict[str, FloatArray]
) -> Iterator[tuple[int, int, str]]:
    """First row of each pair that differs, how many do, and in what."""
    wrong = {name: np.abs(rows[name] - values) > DEPTH_SLACK for name, values in exact.items()}
    for one, other, what, unit in (("x", "y", "contact point", " m"), ("nx", "ny", "normal", "")):
        for k, count in _by_pair(rows, wrong[one] | wrong[other]):
            recorded, true = (
                f"({some[one][k]:.6g}, {some[other][k]:.6g}){unit}" for some in (rows, exact)
            )
            yield k, count, f"{what} {recorded} in the record, {true} by the shapes"
    ended = rows["phase"] == Phase.ENDED  # the depths of the others are held elsewhere
    for k, count in _by_pair(rows, wrong["depth"] & ended):
        recorded, true = (f"{-some['depth'][k]:.6g} m" for some in (rows, exact))
        yield k, count, f"gap after a contact {recorded} in the record, {true} by the shapes"


def _episodes(record: Record, rows: NDArray[np.void]) -> Iterator[tuple[int, int, str]]:
    """Rows that do not follow on each other as those of an episode do."""
    n = len(record.bodies)
    place = (rows["a"].astype(np.int64) * n + rows["b"]) * (record.samples + 1) + rows["step"]
    ends = rows["phase"] == Phase.ENDED
    touching = place[~ends]
    before, after = np.isin(place - 1, touching), np.isin(place + 1, place)
    should = np.where(ends, Phase.ENDED, np.where(before, Phase.STAYS, Phase.BEGAN))
    last = rows["step"] >= record.samples - 1
    for wrong, what in (
        (rows["phase"] != should, "a row that begins a contact or goes on with one, wrongly"),
        (ends & ~before, "a contact that ends without having lasted"),
        (~ends & ~after & ~last, "a contact whose end is not in the record"),
    ):
        for k, count in _by_pair(rows, np.asarray(wrong)):
            yield k, count, what


def _by_pair(rows: NDArray[np.void], wrong: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First wrong row of each pair, and how many it has."""
    some = np.flatnonzero(wrong)
    pairs = np.stack((rows["a"][some], rows["b"][some]), axis=1)
    _, first, count = np.unique(pairs, axis=0, return_index=True, return_counts=True)
    return list(zip(some[first].tolist(), count.tolist(), strict=True))
