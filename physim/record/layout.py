"""What a record file holds: the one table of its attributes and datasets.

`Layout` names each of them once: the property that reads it, where it is, of which shape, type and
unit, what it means, and which values a run writes. The file is plain HDF5. All lengths are metres,
angles radians, times seconds, in the world frame; steps count from 0, the start.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Annotated, Any, Literal, TypeVar, get_args, get_type_hints

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field, Json, create_model

from physim.contacts import Kind, Phase
from physim.geometry.shapes import (
    FloatArray,
    IntArray,
    Polylines,
    Shapes,
    pack_polylines,
    read_only,
)
from physim.parts.declarations import NO_NUMBER, Declared, Line
from physim.parts.given import GivenSettings
from physim.record.table import Column, Dataset, Packed
from physim.world.differences import stages_apart
from physim.world.rules import MOST_STEPS
from physim.world.scene import Body

T = TypeVar("T")
Rows = NDArray[np.void]
Format = Literal["physim-record"]
Version = Literal["5"]
"""Raised with every change of the layout. 5: names and declarations are attributes of JSON."""
Units = Literal[
    "m, rad, s, N s; world frame; headings counter-clockwise from the x axis, unwrapped"
]
FORMAT, VERSION, UNITS = (get_args(one)[0] for one in (Format, Version, Units))
ENDED_BYTES = 16
"""Length of the attribute ``ended``: fixed, so that it changes in place (see `crash_safe`)."""
WALL_CLOCK = "/wall_clock"
"""Group whose attributes are figures of the wall clock: outside the digest."""
FAR = 1.0e8
"""[m, m/s, rad/s, rad] No length, speed or angle of a run is larger: a world ends at 10^6 m."""
STRONGEST = 1.0e15
"""[N s] nor any impulse"""


# Attributes


STANDING = ("boundary", "obstacle")


def moving(bodies: tuple[Body, ...]) -> int:
    """How many bodies move: those before the first boundary, but for obstacles without one."""
    kinds = [body.kind for body in bodies]
    if "boundary" in kinds:
        return kinds.index("boundary")
    return len(kinds) - kinds.count("obstacle")


def numbered(bodies: tuple[Body, ...]) -> tuple[Body, ...]:
    """Return bodies that stand each at the place of its id, in their order: robots, movers, what
    stands and what can be pushed. Raises ValueError."""
    robots, movers = (sum(body.kind == kind for body in bodies) for kind in ("robot", "mover"))
    for k, body in enumerate(bodies):
        kinds = ("robot",) if k < robots else ("mover",) if k < robots + movers else STANDING
        if body.id != k or body.kind not in kinds or not body.name.isprintable():
            raise ValueError(f"row {k} is {body}; it must have this id and be {' or '.join(kinds)}")
    return bodies


@dataclass(frozen=True)
class Origin:
    """The run that a branch went on from, at its first sample."""

    digest: Annotated[str, Field(pattern="^([0-9a-f]{64})?$")] = ""
    """that of its record; empty where the run is no branch of a record"""
    changed: dict[Line, tuple[Line, Line]] = field(default_factory=dict)
    """value of a key of the world before and after, for each that was changed"""

    def __str__(self) -> str:
        """What was changed, in words."""
        changed, stages = stages_apart(self.changed)
        words = [after for _, after in stages]
        words += [f"{key} from {before} to {after}" for key, (before, after) in changed.items()]
        return ", ".join(words) or "nothing"


NO_ORIGIN = Origin()

Whole = Annotated[int, Field(strict=True, ge=0, le=2**63 - 1)]
Steps = Annotated[int, Field(strict=True, ge=0, le=MOST_STEPS)]
Ended = Literal["running", "finished", "duration", "interrupted", "error"]
TableName = Literal["updates", "considered", "contacts", "false_contacts", "sensed"]
ENDED: tuple[Ended, ...] = get_args(Ended)
SENSED: TableName = "sensed"
"""The table that a record has only where the run was asked for it"""
OPTIONAL = tuple(name for name in get_args(TableName) if name != SENSED)
"""Tables that a run may leave out; the commands and the samples are always there."""


@dataclass(frozen=True)
class Judged:
    """Where the poses of a record came from that no run made: the log that was judged."""

    source: str
    """name of the log"""
    sha256: str
    """of the log"""
    begun: float
    """[s] time of the log at step 0"""
    notes: tuple[str, ...]
    """what was done to the log, a sentence each"""


class Attributes:
    """Root attributes of the file, as properties of `Record`: type, bounds, and what each means.

    ``alias`` is the name in the file where it is not the property's.
    """

    format: Annotated[Format, "what the file is"]
    version: Annotated[Version, "version of the format"]
    units: Annotated[Units, "units of all values that name no other"]
    name: Annotated[Line, "name of the world"]
    world_text: Annotated[str, Field(alias="world"), "YAML text of the effective world"]
    seed: Annotated[Whole, "seed of the run"]
    dt: Annotated[float, Field(strict=True, ge=1e-9, le=10.0), "[s] physics step"]
    steps_planned: Annotated[Steps, "physics steps of the whole duration"]
    begun_at: Annotated[
        Steps,
        "physics step of the first sample: 0, or that of the state from which the run went on",
    ]
    record_every: Annotated[
        int, Field(strict=True, ge=1, le=1_000_000), "physics steps from one sample to the next"
    ]
    tables: Annotated[
        Json[tuple[TableName, ...]], "JSON list of the optional tables that were recorded"
    ]
    given: Annotated[
        Json[tuple[tuple[str, str], ...]],
        "JSON list of the parts, [kind, name], that came from Python beside or in place of those "
        "that the world names",
    ]
    safe_distance: Annotated[
        float,
        Field(strict=True, ge=0.0, le=1e6),
        "[m] distance from walls beyond which /areas/safe lies",
    ]
    ended: Annotated[Ended, f"{', '.join(ENDED)}; of a run that was killed running"]
    steps_run: Annotated[Steps, "physics step of the last sample"]
    rejected_contacts: Annotated[
        Whole, "number of false contacts: reported by the engine, refuted by the exact distance"
    ]
    bodies: Annotated[
        Json[tuple[Body, ...]],
        AfterValidator(numbered),
        "JSON list: id, kind and name of robots, movers, obstacles that can be pushed, boundaries, "
        "other obstacles",
    ]
    declared: Annotated[
        Json[Declared],
        "JSON object: modes, rules and columns of the controller, by their numbers",
    ]
    given_settings: Annotated[
        Json[tuple[GivenSettings, ...]],
        "JSON list: for each part in given, what differs from its defaults and what is not known",
    ]
    origin: Annotated[
        Json[Origin],
        Field(default=NO_ORIGIN),
        "of a branch alone, JSON object: digest of the record that it went on from, and changed, "
        "for each key of the world that is another [before, after]",
    ]
    versions: Annotated[
        Json[dict[str, str]], "JSON object: versions of physim and its libraries, and the processor"
    ]
    judged: Annotated[
        Json[Judged] | None,
        Field(default=None),
        "of a log that was judged alone, JSON object: which, and what was done to it; commands, "
        "decisions, modes and impulses are not known then",
    ]


_HINTS = get_type_hints(Attributes, include_extras=True)
AttributesModel = create_model("AttributesModel", **_HINTS)
"""Checks all of them at once."""


# Datasets


def _points(path: str, words: str) -> Dataset[FloatArray]:
    return Dataset(path, "V 2", "<f8", words, "m", -FAR, FAR)


def _starts(path: str, shape: str, of: str, fewest: int = 1) -> Dataset[IntArray]:
    words = f"where each run of {of} begins, and where the last ends"
    return Dataset(path, shape, "<i8", words, starts=of, fewest=fewest)


def _shapes(group: str, bodies: str, corners: int, words: str) -> Packed[Shapes]:
    def put(vertices: FloatArray, part_start: IntArray, body_start: IntArray) -> Shapes:
        lengths = np.hypot(vertices[:, 0], vertices[:, 1])
        first = part_start[body_start[:-1]]
        radius = np.maximum.reduceat(lengths, first) if len(first) else lengths
        return Shapes(vertices, part_start, body_start, read_only(radius))

    points = _points(f"{group}/vertices", words)
    parts = _starts(f"{group}/part_start", "P+1", points.path, corners)
    return Packed(put, words, points, parts, _starts(f"{group}/body_start", bodies, parts.path))


def _lines(
    group: str, lines: str, fewest: int, words: str, put: Callable[[FloatArray, IntArray], T]
) -> Packed[T]:
    points = _points(f"{group}/points", words)
    return Packed(put, words, points, _starts(f"{group}/start", lines, points.path, fewest))


def _runs(points: FloatArray, start: IntArray) -> tuple[FloatArray, ...]:
    return tuple(points[first:last] for first, last in pairwise(start))


def _polylines(points: FloatArray, start: IntArray) -> Polylines:
    return pack_polylines(_runs(points, start))


COMMAND_STAGES = ("nominal", "filtered", "applied")
"""Of a command: as it was decided, after the filters, after the disturbances."""
_UNITS = {"v": "m/s", "omega": "rad/s"}
SIDEWAYS = "lateral"
"""Part of a command, left positive [m/s], that it has in worlds with an omnidirectional robot"""
PARTS = ("v", "omega", SIDEWAYS)
_STEP = Column("step", "<i8", "", "physics step", 0, "steps")
_ROBOT = Column("robot", "<i4", "", "which robot", 0, "robots")
_PAIR = (
    _STEP,
    Column("a", "<i4", "", "body that moves", 0, "moving"),
    Column("b", "<i4", "", "other body, a < b", "a", "bodies"),
)


def _command(stage: str, words: str) -> tuple[Column, ...]:
    return tuple(
        Column(f"{stage}_{part}", "<f8", unit, words, -FAR, FAR) for part, unit in _UNITS.items()
    )


DECISION = (
    _STEP,
    _ROBOT,
    Column("mode", "i1", "", "number of its mode, -1 without one", NO_NUMBER, "modes"),
    Column("rule", "i1", "", "number of its rule, -1 without one", NO_NUMBER, "rules"),
    *_command("nominal", "command decided"),
    *_command("applied", "command applied in this step"),
    Column("station", "<f8", "m", "along its own path"),
    Column("reference_station", "<f8", "m", "along the reference path"),
    Column("formation_error", "<f8", "m", "formation error"),
    Column("deviation", "<f8", "m", "from its own path, left positive"),
    Column("considered", "<i4", "", "how many bodies it considered", 0, "moving"),
    Column("next_step", "<i8", "", "step of its next decision", "step"),
)
_WHEN, _WHO = "physics step, -1 for never", "which, -1 for none"

_MOTION = {"x": "m", "y": "m", "heading": "rad", "vx": "m/s", "vy": "m/s", "omega": "rad/s"}


class Layout(Attributes):
    """All that a record has, as properties of `Record`, which can ``read`` a dataset."""

    stop_station = Dataset[FloatArray](
        "/robots/stop_station", "N", "<f8", "where it stops, along its own path", "m", -FAR, FAR
    )
    lead = Dataset[FloatArray](
        "/robots/lead", "N", "<f8",
        "desired lead over the first robot along the reference path", "m", -FAR, FAR,
    )  # fmt: skip
    shapes = _shapes(
        "/footprints", "B+1", 3, "corners of the convex parts of what moves, in the own frames"
    )
    walls = _shapes(
        "/walls", "W+1", 2, "corners of the parts of boundaries and obstacles that stand"
    )
    paths = _lines("/paths", "N+1", 2, "own path of each robot", _polylines)
    reference = _lines("/reference", "2", 2, "the reference path s*", _polylines)
    accessible = _lines("/areas/accessible", "R+1", 3, "rings of the accessible area", _runs)
    safe = _lines("/areas/safe", "R+1", 3, "rings of the safe area", _runs)
    extremes = Dataset[Rows](
        "/extremes", "N",
        (
            Column("clearance", "<f8", "m", "least to what moves, inf alone", -FAR, np.inf),
            Column("clearance_step", "<i8", "", _WHEN, -1, "steps"),
            Column("clearance_other", "<i4", "", _WHO, -1, "moving"),
            Column("boundary_clearance", "<f8", "m", "to a wall, inf without", -FAR, np.inf),
            Column("boundary_step", "<i8", "", _WHEN, -1, "steps"),
            Column("boundary_other", "<i4", "", _WHO, -1, "bodies"),
        ),
        "shortest distances of each robot over all physics steps",
    )  # fmt: skip
    farthest = Dataset[Rows](
        "/extremes_farthest", "",
        (
            Column("farthest", "<f8", "m", "largest distance, -inf for one robot", -np.inf, FAR),
            Column("step", "<i8", "", _WHEN, -1, "steps"),
            Column("a", "<i4", "", _WHO, -1, "robots"),
            Column("b", "<i4", "", _WHO, -1, "robots"),
        ),
        "largest distance of two robots over all physics steps",
    )  # fmt: skip
    begun_along = Dataset[FloatArray](
        "/robots/begun_along", "N 3", "<f8",
        "at the first sample: station on its own path, deviation from it, station on s*; NaN where "
        "the run began at step 0", "m",
    )  # fmt: skip
    arrived = Dataset[IntArray](
        "/robots/arrived", "N", "<i8",
        "step from which on it has arrived, to the end of the run, begun_at at the earliest; -1 "
        "where it has not", "", -1, "steps",
    )  # fmt: skip
    updates = Dataset[Rows](
        "/updates", "M", DECISION,
        "a row per decision, with the columns that the controller declares, NaN where left out",
    )  # fmt: skip
    commands = Dataset[Rows](
        "/commands", "M",
        (
            _STEP, _ROBOT, *_command("nominal", "decided"), *_command("filtered", "after filters"),
            *_command("applied", "after disturbances"),
        ),
        "command over the step that begins at a sample, where its stages differ or the nominal one "
        "is not that of the last decision; elsewhere all three are that, and 0 before the first",
    )  # fmt: skip
    considering = Dataset[Rows](
        "/considered", "M",
        (_STEP, _ROBOT, Column("count", "<i4", "", "how many bodies", 0, "moving")),
        "how many robots and other bodies each decision considered",
    )  # fmt: skip
    contacts = Dataset[Rows](
        "/contacts", "M",
        (
            *_PAIR,
            Column("phase", "i1", "", "0 began, 1 stays, 2 ended", min(Phase), max(Phase)),
            Column("kind", "i1", "", "0 at a sample, 1 a graze between two", min(Kind), max(Kind)),
            Column("x", "<f8", "m", "deepest point", -FAR, FAR),
            Column("y", "<f8", "m", "deepest point", -FAR, FAR),
            Column("nx", "<f8", "", "normal from a to b", -FAR, FAR),
            Column("ny", "<f8", "", "normal from a to b", -FAR, FAR),
            Column("depth", "<f8", "m", "minus the distance when they part", -FAR, FAR),
            Column("impulse", "<f8", "N s", "in the step that led there, friction included", 0.0,
                   STRONGEST),
        ),
        "a row per touching pair and step, and one where it parts",
    )  # fmt: skip
    false_contacts = Dataset[Rows](
        "/false_contacts", "M",
        (*_PAIR, Column("distance", "<f8", "m", "signed distance there", -FAR, FAR)),
        "contacts that the engine reported and the exact distance refuted",
    )  # fmt: skip
    others = Dataset[NDArray[Any]](
        "/considered_others", "M", "<i4", "the bodies that were considered, decision after "
        "decision, as many as /considered counts", "", 0, "moving",
    )  # fmt: skip
    sensed = Dataset[Rows](
        "/sensed", "M",
        (
            _STEP, Column("observer", "<i4", "", "robot that decided", 0, "robots"),
            Column("body", "<i4", "", "body that it sensed, itself too", 0, "bodies"),
            *(Column(one, "<f8", unit, "as sensed, NaN unseen") for one, unit in _MOTION.items()),
            Column("age", "<f8", "s", "how old all these are", 0.0),
            Column("reference_station", "<f8", "m", "along the reference path, as told"),
            Column("heard", "<f8", "s", "how old that is; inf: not told, but estimated", 0.0),
        ),
        "what each robot that decided sensed of bodies within range and knew of formation "
        "neighbours; only where it was asked for (physim run --keep-sensed)", needed=False,
    )  # fmt: skip
    state_bytes = Dataset[NDArray[np.uint8]](
        "/state_bytes", "S", "u1", "states that were kept, one after the other, each NumPy's .npz"
    )
    states = Dataset[Rows](
        "/states", "M", (_STEP, Column("size", "<i8", "bytes", "in /state_bytes", 0)),
        "a row per kept state, from which another run can start",
    )  # fmt: skip
    steps = Dataset[IntArray](
        "/steps/step", "K", "<i8", "physics step of each sample, from begun_at", "", 0, MOST_STEPS
    )
    moving_pose = Dataset[FloatArray](
        "/steps/pose", "K B 3", "<f8", "x, y, heading, unwrapped, of all that moves, robots first",
        "m, m, rad", -FAR, FAR,
    )  # fmt: skip
    clearance = Dataset[FloatArray](
        "/steps/clearance", "K N", "<f8",
        "to the nearest other body that moves, negative = depth, inf alone; of a coarse record the "
        "least since the sample before", "m", -FAR, np.inf,
    )  # fmt: skip
    steering = Dataset[FloatArray](
        "/steps/steering", "K N", "<f8",
        "angle of the steered wheels in the step before, left positive, 0 of robots without; only "
        "of worlds with such robots", "rad", -FAR, FAR, needed=False,
    )  # fmt: skip
    boundary_clearance = Dataset[FloatArray](
        "/steps/boundary_clearance", "K N", "<f8",
        "to the nearest boundary or obstacle, negative = depth, inf without; of a coarse record "
        "the least since the sample before", "m", -FAR, np.inf,
    )  # fmt: skip


PACKED: tuple[Dataset[Any], ...] = tuple(
    one for made in vars(Layout).values() if isinstance(made, Packed) for one in made.datasets
)
TABLE: dict[str, Dataset[Any]] = {
    one.path: one
    for made in vars(Layout).values()
    for one in (made.datasets if isinstance(made, Packed) else (made,))
    if isinstance(one, Dataset)
}
"""Every dataset of a record, by its path; those not needed may be absent."""
EXTREMES, EXTREMES_FARTHEST = Layout.extremes.path, Layout.farthest.path
ARRIVED, OTHERS = Layout.arrived.path, Layout.others.path
TABLES = tuple(path for path, one in TABLE.items() if one.shape == ("M",) and one.fields[0].name)
"""Growing tables, in the order of steps."""
STEPS = tuple(path for path, one in TABLE.items() if one.shape[:1] == ("K",) and one.needed)
"""Growing datasets with one row a recorded sample; they come last in the file, see `crash_safe`."""

COMMAND, CONSIDERING = Layout.commands.dtype, Layout.considering.dtype
EXTREME, FARTHEST = Layout.extremes.dtype, Layout.farthest.dtype
CONSIDERED = np.dtype([("step", "<i8"), ("robot", "<i4"), ("other", "<i4")])
"""A robot that was considered in the decision of another, as `Record.considered` gives it."""


def update_type(columns: Sequence[str], sideways: bool = False) -> np.dtype[np.void]:
    """Row of the table of decisions, with the columns that the controller declares."""
    return np.dtype([*_widened(DECISION, sideways), *((name, "<f8") for name in columns)])


def _widened(columns: Sequence[Column], sideways: bool) -> list[tuple[str, str]]:
    """Names and kinds of columns, with the lateral speed of a command behind its omega."""
    found = []
    for column in columns:
        found.append((column.name, column.kind))
        stage, _, part = column.name.rpartition("_")
        if sideways and part == "omega":
            found.append((f"{stage}_{SIDEWAYS}", column.kind))
    return found


def row_types(
    robots: int, moving: int, columns: Sequence[str], sideways: bool, also: Collection[str] = ()
) -> dict[str, np.dtype[Any]]:
    """Type and shape of a row of each dataset that grows, for N robots, B bodies that move and
    declared columns.

    ``sideways``: whether commands have a lateral speed; ``also``: paths of those that grow though
    not every record needs them.
    """
    growing = [path for path, one in TABLE.items() if one.needed or path in also]
    types: dict[str, np.dtype[Any]] = {
        path: TABLE[path].dtype for path in TABLES if path in growing
    }
    types[Layout.updates.path] = update_type(columns, sideways)
    types[Layout.commands.path] = np.dtype(_widened(Layout.commands.fields, sideways))
    types[Layout.state_bytes.path] = np.dtype("u1")
    types[OTHERS] = np.dtype("<u2" if moving <= 1 << 16 else "<i4")
    sizes = {"N": robots, "B": moving, "3": 3}
    for path in (path for path in growing if TABLE[path].shape[:1] == ("K",)):
        rest = tuple(sizes[size] for size in TABLE[path].shape[1:])
        types[path] = np.dtype((TABLE[path].dtype, rest))
    return types
