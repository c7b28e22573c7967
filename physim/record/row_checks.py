"""Checks of the rows of a record's datasets: indices, steps, kinds and modes, poses, distances.

Every check goes over whole columns at once. What is refused is one line: file, table, row, what
was given and what is allowed.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.contacts import Kind, Phase
from physim.errors import RecordError
from physim.geometry.shapes import FloatArray
from physim.parts.controller import FASTEST, LONGEST_HOLD
from physim.parts.declarations import NO_NUMBER
from physim.record import layout
from physim.record.repeats import repeated
from physim.tolerances import SHARE

FINITE: dict[str, tuple[str, ...]] = {
    "/updates": ("nominal_v", "nominal_omega", "applied_v", "applied_omega"),
    "/commands": (layout.COMMAND.names or ())[2:],
    "/considered": (),
    "/contacts": ("x", "y", "nx", "ny", "depth", "impulse"),
    "/false_contacts": ("distance",),
}
"""Columns of the tables that are finite in every row."""
FARTHEST_POINT = 1.0e8
"""[m] no point of a scene lies beyond; a world's coordinates end at 10^6"""
FARTHEST_POSE = (FARTHEST_POINT, FARTHEST_POINT, float(np.finfo(np.float64).max))
"""[m, m, rad] no robot is beyond; headings are finite"""
FARTHEST_APART = 3.0e8
"""[m] no two points of a scene are farther apart"""
MOST: dict[str, float] = {
    **{f"{stage}_{part}": FASTEST for stage in layout.COMMAND_STAGES for part in ("v", "omega")},
    "x": FARTHEST_POINT, "y": FARTHEST_POINT, "depth": FARTHEST_APART, "distance": FARTHEST_APART,
    "nx": 1.0 + SHARE, "ny": 1.0 + SHARE,
}  # fmt: skip
"""[m, m/s, rad/s, -] Greatest size of the values of columns in `FINITE`, where there is one."""
MOST_TURN = float(np.pi)
"""[rad] no robot turns more in a step; the time step of a world allows far less"""
STATIONS = ("/robots/stop_station", "/robots/lead")
"""[m] Lengths along paths, one for each robot."""
ONCE = {
    "/updates": ("robot",),
    "/commands": ("robot",),
    "/considered": ("robot",),
    "/contacts": ("a", "b", "kind"),
    "/false_contacts": ("a", "b"),
}
"""Columns that no two rows of one step have alike."""

Range = tuple[str, Any, Any]
"""A column, its least and its greatest value: numbers, or one for each row."""


class Bounds(NamedTuple):
    """What the values of a record are held against."""

    robots: int
    bodies: int
    last_step: int
    """last step of the run"""
    modes: int
    rules: int
    """how many the controller declares"""
    every: int
    """steps from sample to sample, at most"""


class Source(NamedTuple):
    """Where rows come from, as messages name it."""

    where: str
    """the file"""
    path: str
    """of the dataset"""
    first: int = 0
    """number of the first row"""

    def refuse(self, wrong: NDArray[np.bool_], fault: Callable[[int], str]) -> None:
        """Raise RecordError for the first wrong row; ``fault`` says what is given and allowed."""
        if wrong.any():
            k = int(np.argmax(wrong))
            row = self.first + k
            raise RecordError(
                f"{self.where}: {self.path}, row {row}: {fault(k)}; make the record again"
            )

    def within(self, name: str, values: NDArray[Any], low: Any, high: Any) -> None:
        """Raise RecordError for the first value out of its range."""

        def fault(k: int) -> str:
            least, most = (int(np.broadcast_to(bound, len(values))[k]) for bound in (low, high))
            return f"{name} is {values[k]}; allowed: {least} to {most}"

        self.refuse((values < low) | (values > high), fault)


def check_table(source: Source, rows: NDArray[np.void], bounds: Bounds) -> None:
    """Check rows of one of `layout.TABLES`.

    Raises RecordError for the first value that is out of its range, for a number that is not
    finite and has to be, an impulse below 0, and where the rows are not in
    the order of steps or one is there twice.
    """
    for column, low, high in _ranges(source.path, rows, bounds):
        source.within(column, rows[column], low, high)
    for column in FINITE[source.path]:
        check_finite(source, column, rows[column])
        _check_size(source, column, rows[column], MOST.get(column, np.inf))
    step = rows["step"]
    if source.path == "/contacts":
        impulse = rows["impulse"]
        source.refuse(
            impulse < 0.0, lambda k: f"impulse is {impulse[k]:.6g}; it must not be negative"
        )
    source.refuse(
        np.diff(step, prepend=step[:1]) < 0,
        lambda k: (
            f"step {step[k]} comes after step {step[k - 1]}; rows must be in the order of steps"
        ),
    )
    _check_once(source, rows)


def check_finite(source: Source, column: str, values: NDArray[Any]) -> None:
    """Raise RecordError for the first value that is not finite."""
    source.refuse(~np.isfinite(values), lambda k: f"{column} is {values[k]}; it must be finite")


def _check_size(source: Source, column: str, values: NDArray[Any], most: float) -> None:
    """Raise RecordError for the first value that is larger than any can be, of either sign."""
    source.refuse(
        np.abs(values) > most,
        lambda k: f"{column} is {values[k]:.6g}; allowed: {-most:g} to {most:g}",
    )


def _check_once(source: Source, rows: NDArray[np.void]) -> None:
    """Raise RecordError for a second row of the same step and bodies."""
    names = ONCE[source.path]

    def fault(k: int) -> str:
        who = ", ".join(f"{name} {rows[name][k]}" for name in names)
        return f"step {rows['step'][k]}, {who} again; it may be there once"

    source.refuse(repeated([rows["step"], *(rows[name] for name in names)]), fault)


def check_steps(source: Source, rows: NDArray[Any], every: int) -> None:
    """Check rows of one of `layout.STEPS`: steps that increase from 0, poses and distances near
    enough, no NaN, turns that a robot can make in ``every`` steps.

    Raises RecordError for the first sample that is not so.
    """
    if source.path == "/steps/step":
        source.refuse(
            np.diff(rows, prepend=rows[:1] - 1) <= 0,
            lambda k: f"step {rows[k]} comes after step {rows[k - 1]}; steps must increase from 0",
        )
        if source.first == 0:
            source.refuse(rows[:1] != 0, lambda _: f"the first step is {rows[0]}; it must be 0")
        return
    is_pose = source.path == "/steps/pose"
    wrong: NDArray[np.bool_] = ~(np.abs(rows) <= FARTHEST_POSE) if is_pose else ~_is_distance(rows)

    def fault(k: int) -> str:
        robot, *column = (int(index) for index in np.argwhere(wrong[k])[0])
        what = ("x", "y", "heading")[column[0]] if is_pose else "distance"
        must = f"finite, x and y at most {FARTHEST_POINT:g}" if is_pose else DISTANCE
        return f"{what} of robot {robot} is {rows[(k, robot, *column)]}; it must be {must}"

    source.refuse(np.asarray(wrong.any(axis=tuple(range(1, wrong.ndim)))), fault)
    if is_pose:
        _check_turns(source, rows, MOST_TURN * every)


def _check_turns(source: Source, pose: FloatArray, most: float) -> None:
    turn = np.abs(np.diff(pose[:, :, 2], axis=0, prepend=pose[:1, :, 2]))

    def fault(k: int) -> str:
        robot = int(np.argmax(turn[k]))
        return (
            f"robot {robot} turns by {turn[k, robot]:.4g} rad from the sample before; "
            f"allowed: {most:.4g}"
        )

    source.refuse(np.asarray((turn > most).any(axis=1)), fault)


_MOMENTS = {
    layout.EXTREMES: (("clearance_step", "clearance_other"), ("boundary_step", "boundary_other")),
    layout.EXTREMES_FARTHEST: (("step", "a", "b"),),
}
"""Columns that say when and of whom: all of them, or nobody and never."""
DISTANCE = f"a number, finite at most {FARTHEST_APART:g}"
"""What a distance must be."""


def _is_distance(values: NDArray[Any], none: float = np.inf) -> NDArray[np.bool_]:
    """Whether distances [m] are such as a scene has, or ``none``, which stands for no other."""
    return np.asarray((np.abs(values) <= FARTHEST_APART) | (values == none))


def check_extremes(source: Source, rows: NDArray[np.void], bounds: Bounds) -> None:
    """Check who and when of `layout.EXTREMES` or `layout.EXTREMES_FARTHEST`; -1 is nobody, never.

    Raises RecordError for the first value that is out of its range, distances too.
    """
    rows = np.atleast_1d(rows)
    last, robots, bodies = bounds.last_step, bounds.robots, bounds.bodies
    highest = {"step": last, "a": robots - 1, "b": robots - 1}
    distances = ["farthest"]
    if source.path == layout.EXTREMES:
        highest = {"clearance_step": last, "clearance_other": robots - 1,
                   "boundary_step": last, "boundary_other": bodies - 1}  # fmt: skip
        distances = ["clearance", "boundary_clearance"]
    for column, high in highest.items():
        source.within(column, rows[column], -1, high)
    for when, *others in _MOMENTS[source.path]:
        for other in others:
            _check_moment(source, rows, when, other)
    for column, (when, *_) in zip(distances, _MOMENTS[source.path], strict=True):
        none = -np.inf if column == "farthest" else np.inf
        _check_number(source, column, rows[column], none)
        _check_never(source, rows, column, when, none)


def _check_never(
    source: Source, rows: NDArray[np.void], column: str, when: str, none: float
) -> None:
    source.refuse(
        (rows[when] < 0) != (rows[column] == none),
        lambda k: f"{column} is {rows[column][k]:.6g} and {when} {rows[when][k]}; -1 is never",
    )


def _check_moment(source: Source, rows: NDArray[np.void], when: str, who: str) -> None:
    source.refuse(
        (rows[when] < 0) != (rows[who] < 0),
        lambda k: f"{who} is {rows[who][k]} and {when} {rows[when][k]}; -1 is both or neither",
    )


def _check_number(source: Source, column: str, values: NDArray[Any], none: float) -> None:
    source.refuse(
        ~_is_distance(values, none), lambda k: f"{column} is {values[k]:.6g}; it must be {DISTANCE}"
    )


def check_starts(
    source: Source,
    start: NDArray[Any],
    whole: int,
    *,
    empty: bool = True,
    runs: int | None = None,
) -> None:
    """Check the starts of packed runs: from 0 to ``whole``, never back.

    ``empty``: whether runs may have nothing in them; ``runs``: how many there must be, if that is
    known. Raises RecordError for the first wrong one.
    """
    what = f"{source.where}: {source.path}"
    if start.ndim != 1 or not len(start) or not np.issubdtype(start.dtype, np.integer):
        raise RecordError(f"{what} holds no list of starts; make the record again")
    if runs is not None and len(start) != runs + 1:
        raise RecordError(
            f"{what}: {len(start)} rows; {runs + 1} are needed; make the record again"
        )
    source.within("it", start, 0, whole)
    ends = start.copy()
    ends[[0, -1]] = 0, whole
    source.refuse(start != ends, lambda k: f"it is {start[k]}; it must be {ends[k]}")
    source.refuse(
        np.diff(start, prepend=start[:1] - 1) < (0 if empty else 1),
        lambda k: f"{start[k]} comes after {start[k - 1]}; starts must increase",
    )


def check_points(source: Source, points: NDArray[Any]) -> None:
    """Check points (n, 2) [m]. Raises RecordError for another shape, and for what is not finite."""
    if points.ndim != 2 or points.shape[1] != 2 or points.dtype != np.float64:
        raise RecordError(f"{source.where}: dataset {source.path} holds no points (n, 2)")
    wrong = ~(np.abs(points) <= FARTHEST_POINT)

    def fault(k: int) -> str:
        column = int(np.argmax(wrong[k]))
        must = f"finite, at most {FARTHEST_POINT:g}"
        return f"{'xy'[column]} is {points[k, column]}; it must be {must}"

    source.refuse(wrong.any(axis=1), fault)


def _ranges(path: str, rows: NDArray[np.void], bounds: Bounds) -> list[Range]:
    robots, bodies, last, modes, rules, _ = bounds
    step: Range = ("step", 0, last)
    robot: Range = ("robot", 0, robots - 1)
    if path == "/updates":
        at = rows["step"]
        return [
            step,
            robot,
            ("mode", NO_NUMBER, modes - 1),
            ("rule", NO_NUMBER, rules - 1),
            ("considered", 0, robots - 1),
            ("next_step", at + 1, at + LONGEST_HOLD),
        ]
    if path == "/commands":
        return [step, robot]
    if path == "/considered":
        return [step, robot, ("count", 0, robots - 1)]
    found = [step, ("a", 0, robots - 1), ("b", rows["a"] + 1, bodies - 1)]
    if path == "/contacts":
        found += [("phase", min(Phase), max(Phase)), ("kind", min(Kind), max(Kind))]
    return found
