"""Contacts and distances of a record held against the shapes, step by step and pair by pair.

A disagreement has a cause. Explained are

- ``within tolerance``: the signed distance is within CONTACT = 1e-9 m of 0, where either answer
  is right;
- ``graze between samples``: apart at both samples of a step, touching in between. The engine
  looks at samples only; the swept check finds these, and the record lists them as contacts of
  their own kind;
- ``rejected false contact of the engine``: the engine reported a contact of shapes that are apart,
  and the exact check kept it out.

Everything else is ``unexplained``: one of the two is wrong. Of each contact at a sample its point,
its normal, its depth and, where it has ended, the gap are computed anew; its rows must make whole
episodes: one that begins, one for every sample while it lasts, one that ends. Distances are
computed anew at every sample of every robot.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.analysis.metrics.contacts import least_in_step
from physim.analysis.validation.analytic_contacts import (
    AnalyticContacts,
    pair_distance,
    pose_blocks,
)
from physim.analysis.validation.decisions import movers_of
from physim.analysis.validation.finding import UNEXPLAINED, Finding, differs, stretches
from physim.contacts import Kind, Phase, touching
from physim.errors import RecordError
from physim.geometry.bodies import describe_contacts
from physim.geometry.clearance import clearances
from physim.geometry.shapes import FloatArray, IntArray, joined_shapes
from physim.geometry.walls import build_wall_tree
from physim.record import Record
from physim.record.writer import Extremes
from physim.tolerances import CONTACT
from physim.world.ground.solids import solids_of

TOLERANCE = "within tolerance"
GRAZE = "graze between samples"
REJECTED = "rejected false contact of the engine"

ROUNDING = 1e-12
"""[m] Two ways to compute one distance differ by less, up to 10 km from the origin."""
DEPTH_SLACK = 1e-9
"""[m] How well a recorded depth or distance must agree with the one computed here."""
LEAST_SLACK = 1e-8
"""[m] Two searches for the least distance of a step agree to this: each ends within 1e-9 m of it,
from poses of one motion."""
NEAR_TOUCH = 2.0 * CONTACT
"""[m] A least distance within this of 0 may count as touching or not."""
SMALLEST = (
    (("clearance", "clearance_step", "clearance_other"), "nearest robot"),
    (("boundary_clearance", "boundary_step", "boundary_other"), "nearest boundary"),
)
"""Columns of a row of extremes: value, sample and other body; and what they are about."""

Rows = NDArray[np.void]


class Confusion(NamedTuple):
    """How often engine and shapes say contact or apart, counted over pairs and samples."""

    both: int
    physical_only: int
    analytic_only: int
    neither: int


@dataclass(frozen=True)
class Comparison:
    """A table for each kind of pairs, and every disagreement in the order of time."""

    at_samples: dict[str, Confusion]
    """keys "robots" and "boundaries", where something else moves also "movers", of what moves with
    movers and what can be pushed: contact at a sample"""
    rejected: int
    """contacts between separated shapes that the engine reported and its guard kept out, counted
    over pairs and samples"""
    disagreements: tuple[Finding, ...]

    @property
    def unexplained(self) -> int:
        """Number of disagreements without a cause."""
        return sum(one.cause == UNEXPLAINED for one in self.disagreements)


def compare(
    record: Record,
    analytic: AnalyticContacts,
    distances: Iterable[Finding],
) -> Comparison:
    """Hold the contacts of a record against the shapes; disagreements of ``distances`` are known.

    Raises RecordError for a contact between samples before the start.
    """
    found = [
        *_contacts(record, analytic), *_swept_contacts(record, analytic), *_false_contacts(record),
        *distances,
    ]  # fmt: skip
    found.sort(key=lambda one: (one.step or 0, one.bodies))
    theirs, ours = (_keys(rows, record) for rows in (touching(record.contacts), analytic.touching))
    at_samples, robots, moving, bodies = {}, record.robots, record.moving, len(record.bodies)
    movers = len(movers_of(record))
    every = {
        "robots": (0, robots, robots * (robots - 1) // 2),
        "movers": (robots, moving, (moving * (moving - 1) - robots * (robots - 1)
                                    - movers * (movers - 1)) // 2),
        "boundaries": (moving, bodies, (moving - movers) * (bodies - moving)),
    }  # fmt: skip
    for name, (first, end, pairs) in every.items():
        if name == "movers" and moving == robots:
            continue
        a, b = (keys[(first <= keys % bodies) & (keys % bodies < end)] for keys in (theirs, ours))
        both = len(np.intersect1d(a, b))
        rest = pairs * record.samples - len(a) - len(b) + both
        at_samples[name] = Confusion(both, len(a) - both, len(b) - both, rest)
    return Comparison(at_samples, len(record.false_contacts), tuple(found))


def _keys(rows: Rows, record: Record) -> IntArray:
    """One number for step and pair of each row, increasing with step, then a, then b."""
    n = len(record.bodies)
    return np.asarray((rows["step"] * n + rows["a"]) * n + rows["b"], dtype=np.int64)


def _told(
    record: Record,
    rows: Rows,
    distance: FloatArray,
    wrong: NDArray[np.bool_],
    what: str | Callable[[int], str],
    cause: str = UNEXPLAINED,
    near: bool = False,
) -> Iterator[Finding]:
    """What is wrong with rows (M,) of pairs that are ``distance`` (M,) [m] apart, one for each run
    of consecutive steps of a pair; ``near``: explained where all of a run as good as touch."""
    some = np.flatnonzero(wrong)
    step, a, b = (rows[key][some] for key in ("step", "a", "b"))
    for run in stretches(step, a, b):
        k, first = int(some[run[0]]), int(run[0])
        close = near and (np.abs(distance[some[run]]) <= CONTACT + ROUNDING).all()
        yield Finding(
            what if isinstance(what, str) else what(k), (int(a[first]), int(b[first])),
            int(step[first]), float(step[first] * record.dt), len(run), float(distance[k]),
            TOLERANCE if close else cause,
        )  # fmt: skip


def _contacts(record: Record, analytic: AnalyticContacts) -> Iterator[Finding]:
    """Contacts at samples: whether they are there, their rows, and whether they make episodes."""
    rows = record.contacts[record.contacts["kind"] == Kind.PHYSICAL]
    ours = analytic.touching
    exact = _exact(record, rows)
    distance, ended = -exact["depth"], rows["phase"] == Phase.ENDED
    theirs, known = _keys(rows, record), _keys(ours, record)
    both = np.isin(theirs, known) & ~ended
    yield from _told(
        record, rows, distance, ~both & ~ended, "contact in the record, shapes apart", near=True
    )
    yield from _told(
        record, ours, ours["distance"], ~np.isin(known, theirs[~ended]),
        "no contact in the record, shapes overlap", near=True,
    )  # fmt: skip
    yield from _told(
        record, ours, ours["distance"], np.isinf(ours["entry"]),
        "touching at the sample, but no contact in the step that led to it", near=True,
    )  # fmt: skip
    off = {name: np.abs(rows[name] - values) > DEPTH_SLACK for name, values in exact.items()}
    depth = {"depth": np.maximum(exact["depth"], 0.0)}
    gap = {"depth": -rows["depth"]}, {"depth": distance}
    for wrong, what, columns, recorded, true in (
        (both & (np.abs(rows["depth"] - depth["depth"]) > DEPTH_SLACK), "depth", ("depth",), rows,
         depth),
        (ended & off["depth"], "gap after a contact", ("depth",), *gap),
        (off["x"] | off["y"], "contact point", ("x", "y"), rows, exact),
        (off["nx"] | off["ny"], "normal", ("nx", "ny"), rows, exact),
    ):  # fmt: skip
        text = partial(_values, what, columns, recorded, true)
        yield from _told(record, rows, distance, wrong, text)
    lasting = theirs[~ended]
    pairs = len(record.bodies) ** 2
    before, after = np.isin(theirs - pairs, lasting), np.isin(theirs + pairs, theirs)
    if record.begun_at:  # what touches at the first sample may have touched before
        before |= (rows["step"] == record.begun_at) & (rows["phase"] == Phase.STAYS)
    should = np.where(ended, Phase.ENDED, np.where(before, Phase.STAYS, Phase.BEGAN))
    last = rows["step"] >= record.steps_run
    for wrong, what in (
        (rows["phase"] != should, "a row that begins a contact or goes on with one, wrongly"),
        (ended & ~before, "a contact that ends without having lasted"),
        (~ended & ~after & ~last, "a contact whose end is not in the record"),
    ):
        yield from _told(record, rows, distance, np.asarray(wrong), what)


def _values(
    what: str, columns: tuple[str, ...], rows: Any, exact: Mapping[str, FloatArray], k: int
) -> str:
    """A length or a pair of numbers in the record, and by the shapes."""
    texts = [", ".join(f"{of[name][k]:.6g}" for name in columns) for of in (rows, exact)]
    told, true = (f"({text})" if len(columns) > 1 else f"{text} m" for text in texts)
    return f"{what} {told} in the record, {true} by the shapes"


def _exact(record: Record, rows: Rows) -> dict[str, FloatArray]:
    """Columns of the rows (M,) by the shapes: point [m], normal, depth [m]."""
    shapes, faces = joined_shapes(record.shapes, record.walls), solids_of(record.walls).faces
    found = np.zeros((len(rows), 5))
    pose = np.zeros((len(shapes.body_start) - 1, 3))
    step, pairs = rows["step"], np.stack((rows["a"], rows["b"]), axis=1).astype(np.int64)
    for poses, start in pose_blocks(record) if len(rows) else ():
        first, last = np.searchsorted(step, (start + (start > record.begun_at), start + len(poses)))
        if first == last:
            continue
        edges = np.flatnonzero(np.diff(step[first:last], prepend=-1)) + first
        for low, high in zip(edges, [*edges[1:], last], strict=True):
            pose[: record.moving] = poses[step[low] - start]
            some = found[low:high]
            describe_contacts(shapes, faces, record.moving, pose, pairs[low:high], high - low, some)
    return dict(zip(("x", "y", "nx", "ny", "depth"), (*found.T[:4], -found[:, 4]), strict=True))


def _swept_contacts(record: Record, analytic: AnalyticContacts) -> Iterator[Finding]:
    """Contacts between two samples, which the engine cannot see: the record against the shapes.

    Where only one of the two has it, their depths differ, or the row tells of more than one moment
    without a force, it is unexplained. Raises RecordError for one before the start.
    """
    rows = record.contacts[record.contacts["kind"] == Kind.SWEPT]
    if (rows["step"] <= record.begun_at).any():
        raise RecordError(
            f"{record.where}: a contact between samples in the step that ends at "
            f"{record.begun_at}; steps are {record.begun_at + 1} to {record.steps_run}"
        )
    theirs, ours = (
        {tuple(row[key].item() for key in ("step", "a", "b")): row for row in some}
        for some in (rows, analytic.grazes)
    )
    for place in sorted({*theirs, *ours}):
        step, a, b = place
        row, graze = theirs.get(place), ours.get(place)
        least = float(least_in_step(record, a, b, step).distance)
        cause, what = GRAZE, "touching between two samples, apart at both"
        if row is None or graze is None:
            cause = TOLERANCE if abs(least) <= NEAR_TOUCH else UNEXPLAINED
            what += "; not in the record"
            if graze is None:
                what = "contact between samples in the record, shapes apart"
        elif abs(row["depth"] - max(-least, 0.0)) > LEAST_SLACK:
            cause = UNEXPLAINED
            what = (
                f"touching between two samples, depth {row['depth']:.3g} m in the record, "
                f"{max(-least, 0.0):.3g} m by the shapes"
            )
        elif row["phase"] != Phase.BEGAN or row["impulse"] != 0.0:
            cause = UNEXPLAINED
            what = "touching between two samples, with a push or another phase than began"
        if cause == GRAZE and record.judged is not None:
            continue  # no engine overlooked it
        time = (step - 1) * record.dt + (record.dt if graze is None else float(graze["entry"]))
        yield Finding(what, (a, b), step, time, 1, least, cause)


def _false_contacts(record: Record) -> Iterator[Finding]:
    """Contacts that the engine reported and the exact check rejected: unexplained where the shapes
    touch after all, or are not as far apart as recorded."""
    rows = record.false_contacts
    distance = -_exact(record, rows)["depth"]
    touch = distance <= CONTACT - ROUNDING
    off = ~touch & (np.abs(distance - rows["distance"]) > DEPTH_SLACK)
    what = "contact by the engine, rejected, but the shapes touch"
    yield from _told(record, rows, distance, touch, what)
    yield from _told(
        record, rows, distance, off,
        lambda k: f"false contact at a distance of {rows['distance'][k]:.3g} m in the record",
    )  # fmt: skip
    what = "contact by the engine, shapes apart; not counted"
    yield from _told(record, rows, distance, ~touch & ~off, what, REJECTED)


# Distances


def exact_distances(record: Record) -> tuple[Extremes, list[Finding]]:
    """Compute every distance of a record with the poses of every step, block by block.

    Shortest and largest distances, when, of whom; and where ``/steps/clearance`` or
    ``/steps/boundary_clearance`` differ by more than `DEPTH_SLACK`: one for each robot and block.
    """
    shapes, walls = record.shapes, record.walls
    wall_tree = build_wall_tree(walls)
    extremes = Extremes(record.robots)
    found: list[Finding] = []
    for poses, start in pose_blocks(record):
        first, end = start + (start > record.begun_at), start + len(poses)
        block = clearances(poses[first - start :], shapes, wall_tree, record.robots)
        extremes.note(np.arange(first, end), block)
        near = (block.clearance, block.other), (block.boundary_clearance, block.boundary_other)
        for ((column, *_), what), (exact, others) in zip(SMALLEST, near, strict=True):
            rows = first - record.begun_at, end - record.begun_at
            recorded = record.read(f"/steps/{column}", *rows)
            wrong = differs(recorded, exact, DEPTH_SLACK)
            for i in np.flatnonzero(wrong.any(axis=0)).tolist():
                k = int(np.argmax(wrong[:, i]))
                text = (
                    f"distance to the {what} {recorded[k, i]:.9g} m in the record, "
                    f"{exact[k, i]:.9g} m by the shapes"
                )
                other, steps = int(others[k, i]), int(np.count_nonzero(wrong[:, i]))
                found.append(_at(record, i, other, first + k, exact[k, i], text, steps))
    return extremes, found


def _at(
    record: Record, i: int, other: int, step: int, distance: float, what: str, steps: int = 1
) -> Finding:
    """A finding about a distance of robot ``i`` to another body, if there is one (else -1)."""
    bodies = (i,) if other < 0 or other == i else (min(i, other), max(i, other))
    return Finding(what, bodies, int(step), float(step * record.dt), steps, float(distance))


def distance_at(record: Record, a: int, b: int, step: int) -> float:
    """Signed distance [m] of bodies a < b at a sample, from the record's poses."""
    return pair_distance(record, record.pose_at(step), a, b)


def check_extremes(
    record: Record, whole: Record, analytic: AnalyticContacts, exact: Extremes
) -> Iterator[Finding]:
    """Where ``/extremes`` and ``/extremes_farthest`` are not those of the shapes.

    The shapes are those of the ``whole`` run, of every step. Smallest distances within reach of the
    analytic contacts are those of their nearest samples, which another code finds than notes them
    during a run. A killed run may have noted some of after its last sample, or not yet.
    """
    killed = record.ended == "running"
    due = exact.rows.copy()
    for step, a, b, distance, _ in reversed(analytic.nearest.tolist()):  # ends with the nearest
        columns, _ = SMALLEST[b >= record.moving]
        for me, other in ((a, b), (b, a)):
            if me < record.robots:
                for column, value in zip(columns, (distance, step, other), strict=True):
                    due[column][me] = value
    for columns, what in SMALLEST:
        least = due[columns[0]]
        most = whole.read(f"/steps/{columns[0]}", 0, record.steps_made + 1).min(axis=0)
        for i, pair in enumerate(zip(record.extremes, due, strict=True)):
            noted, true = ([row[column].item() for column in columns] for row in pair)
            is_one = least[i] <= noted[0] <= most[i] if killed else False
            yield from _moment(whole, i, noted, true, f"smallest distance to the {what}", is_one)
    (*noted, a, b), (*true, _, other) = record.farthest.item(), exact.farthest.item()
    what, is_one = "largest distance of robots", killed and noted[0] <= true[0]
    yield from _moment(whole, max(a, 0), [*noted, b], [*true, other], what, is_one)


def _moment(
    record: Record, i: int, noted: list[float], true: list[float], what: str, is_one: bool
) -> Iterator[Finding]:
    """Whether an extreme distance, its step and other body are as noted, or of equal ones, or of
    those of a part of the run where it ``is_one``, another: its moment is held by the distance."""
    value, at, other = noted[0], int(noted[1]), int(noted[2])
    if is_one or not differs(value, true[0], DEPTH_SLACK):
        if not np.isfinite(value):
            return
        if record.begun_at <= at <= record.steps_run and other >= 0 and other != i:
            there = distance_at(record, min(i, other), max(i, other), at)
            if abs(there - value) > DEPTH_SLACK:
                text = "at this sample in the record, but the shapes are"
                yield _at(record, i, other, at, value, f"{what}: {text} {there:.9g} m apart then")
            return
    recorded, shapes = (
        f"{length:.9g} m"
        + (f" ({record.bodies[int(who)].name} at {step * record.dt:.2f} s)" if who >= 0 else "")
        for length, step, who in (noted, true)
    )
    text = f"{what} {recorded} in the record, {shapes} by the shapes"
    yield _at(record, i, int(true[2]), max(int(true[1]), 0), true[0], text)
