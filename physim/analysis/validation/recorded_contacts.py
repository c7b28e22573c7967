"""The contacts of a record against the shapes: rows, contacts between samples, false contacts.

Of each contact at a sample its point, its normal and, where it has ended, the gap are computed
anew; its rows must make whole episodes: one that begins, one for every sample while it lasts, one
that ends. Contacts between two samples, which the engine cannot see, and false contacts that were
rejected are single events.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from physim.analysis.validation.analytic_contacts import AnalyticContacts, pose_blocks
from physim.analysis.validation.disagreements import (
    DEPTH_SLACK,
    GRAZE,
    REJECTED,
    ROUNDING,
    TOLERANCE,
    UNEXPLAINED,
    Disagreement,
    distances_over,
    places,
    row_keys,
    stretches,
)
from physim.contacts import Kind, Phase
from physim.errors import RecordError
from physim.geometry.shapes import FloatArray, IntArray, joined_shapes
from physim.geometry.solids import describe_contacts, solids_of
from physim.geometry.swept import least_gap_pair, least_gap_walls
from physim.record import Record
from physim.tolerances import CONTACT

LEAST_SLACK = 1e-8
"""[m] Two searches for the least distance of a step agree to this: each ends within 1e-9 m of it,
from poses of one motion."""

NEAR_TOUCH = 2.0 * CONTACT
"""[m] A least distance within this of 0 may count as touching or not."""


def check_swept_contacts(record: Record, analytic: AnalyticContacts) -> list[Disagreement]:
    """Contacts between two samples, which the engine cannot see: the record against the shapes.

    Where only one of the two has it, their depths differ, or the row tells of more than one moment
    without a force, it is unexplained. Raises RecordError for one before the start.
    """
    rows = record.contacts[record.contacts["kind"] == Kind.SWEPT]
    if (rows["step"] == 0).any():
        raise RecordError(
            f"{record.where}: a contact between samples in the step that ends at 0; steps are 1 to "
            f"{record.samples - 1}"
        )
    swept = analytic.grazes
    entries = dict(zip(places(swept), swept["entry"].tolist(), strict=True))
    depths = dict(zip(places(rows), rows["depth"].tolist(), strict=True))
    more = (rows["phase"] != Phase.BEGAN) | (rows["impulse"] != 0.0)
    forced = set(places(rows[more]))
    found = []
    for place in sorted({*entries, *depths}):
        step, a, b = place
        least = _least(record, a, b, step)
        cause, what = GRAZE, "touching between two samples, apart at both"
        if place not in depths:
            cause, what = _one_sided(least), f"{what}; not in the record"
        elif place not in entries:
            cause, what = _one_sided(least), "contact between samples in the record, shapes apart"
        elif abs(depths[place] - max(-least, 0.0)) > LEAST_SLACK:
            cause = UNEXPLAINED
            what = (
                f"touching between two samples, depth {depths[place]:.3g} m in the record, "
                f"{max(-least, 0.0):.3g} m by the shapes"
            )
        elif place in forced:
            cause = UNEXPLAINED
            what = "touching between two samples, with a push or another phase than began"
        time = (step - 1) * record.dt + entries.get(place, record.dt)
        found.append(Disagreement(a, b, step, 1, time, least, cause, what))
    return found


def check_false_contacts(record: Record) -> list[Disagreement]:
    """Contacts that the engine reported and the exact check rejected, by stretches of samples.

    Unexplained where the shapes touch after all, or are not as far apart as recorded.
    """
    rows, bodies = record.false_contacts, len(record.bodies)
    recorded = dict(zip(places(rows), rows["distance"].tolist(), strict=True))
    found = []
    for a, b, step, steps in stretches(row_keys(rows, bodies), bodies):
        exact = distances_over(record, a, b, step, steps)
        cause, what = REJECTED, "contact by the engine, shapes apart; not counted"
        for k, d in enumerate(exact):
            noted = recorded[step + k, a, b]
            if d <= CONTACT - ROUNDING:
                cause, what = UNEXPLAINED, "contact by the engine, rejected, but the shapes touch"
            elif abs(d - noted) > DEPTH_SLACK:
                cause = UNEXPLAINED
                what = f"false contact at a distance of {noted:.3g} m in the record"
        found.append(
            Disagreement.at(record, (a, b), step, exact[0], what, steps=steps, cause=cause)
        )
    return found


def _one_sided(least: float) -> str:
    """Cause of a contact between samples that only record or shapes have."""
    return TOLERANCE if math.fabs(least) <= NEAR_TOUCH else UNEXPLAINED


def _least(record: Record, a: int, b: int, step: int) -> float:
    """Least signed distance [m] of two bodies within the step that ends at a sample."""
    shapes = record.shapes
    old, new = record.pose_at(step - 1), record.pose_at(step)
    if b < record.robots:
        return float(least_gap_pair(shapes, a, old[a], new[a], b, old[b], new[b], record.dt)[0])
    walls = record.walls
    first, last = walls.body_start[b - record.robots : b - record.robots + 2]
    parts: IntArray = np.arange(first, last)
    return float(least_gap_walls(shapes, a, old[a], new[a], walls, parts, record.dt)[0])


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
    shapes, faces = joined_shapes(record.shapes, record.walls), solids_of(record.walls).faces
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
            found[low:high] = describe_contacts(shapes, faces, pose, pairs[low:high])
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
