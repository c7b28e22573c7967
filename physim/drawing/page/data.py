"""What of a record goes into the page: the scene, poses by their knots, decisions, contacts.

Poses are right to within `TOLERANCE` at every recorded sample, decisions to a thousandth (of many
to a hundredth) of their units; what is left out is told in the page.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from physim.analysis.metrics import Metric
from physim.analysis.parting import Parting
from physim.analysis.summary import Summary
from physim.analysis.validation import Validation
from physim.drawing.crowd import MOST_LINES, NAMED
from physim.drawing.items import Level, items
from physim.drawing.labels import clean
from physim.drawing.page.curves import pack_curves
from physim.drawing.page.decisions import pack_decisions
from physim.drawing.page.knots import find_knots
from physim.drawing.page.packing import Pack
from physim.drawing.page.why import explanations
from physim.drawing.scene_model import ROLL, SceneModel
from physim.drawing.timeline import Episodes, Timeline
from physim.drawing.video.canvas import SHORT_TRAIL, TRAIL
from physim.drawing.video.ground import ground
from physim.drawing.video.panel import signs
from physim.errors import PhysimError, RecordError
from physim.geometry.shapes import FloatArray, IntArray
from physim.record import Record
from physim.simulation.arrival import STILL_TIME, still_distances
from physim.units import amount, between, true_minus

TOLERANCE, CROWD_TOLERANCE = 0.002, 0.005
"""[m] by which a point of a robot is drawn beside where it was at a sample, at most; of a crowd"""
MOST_APART = 2e5
"""[m] between places of robots in a run"""
MOST_TURNED = 1e5
"""[rad] between headings of robots in a run"""
GRID, CROWD_GRID = 5e-4, 1e-3
"""[m] that places are rounded to"""
TURN, CROWD_TURN = 2e-4, 5e-4
"""[rad] that headings are rounded to"""


DECIMALS = 3
"""of lengths [m] of the scene"""
MOMENTS = (
    ("shortest_distance", "shortest distance"),
    ("shortest_boundary_distance", "nearest to a wall"),
    ("shortest_collision_time", "shortest collision time"),
    ("seen_collision_time", "shortest collision time, if both go on"),
    ("first_contact", "first contact"),
    ("deepest_contact", "deepest contact"),
    ("formation_error_peak", "largest formation error"),
    ("farthest_distance", "farthest pair"),
)
"""Metrics that are of a moment, and what they are called."""
CONTACTS = ("first_contact", "deepest_contact")
MOST_GRAZES = 5
"""Grazes, the first of the run, among the moments; the table of contacts has more."""
MOST_STEERED = 200_000
"""Steering angles; of more, so many are kept, evenly spread in time"""
MOST_TOLD = 100
"""Contacts, the first of the run, that have a paragraph each."""
MOVED = 0.02
"""[m] by which the mark of a contact moves at least"""
LEAST = 1.0
"""[s] for which a robot stands at least"""


def run_data(
    record: Record,
    summary: Summary,
    validation: Validation | None = None,
    parted: Parting | None = None,
) -> str:
    """Everything the page draws of a record, as text for `assets/decode.js`.

    ``parted`` is where a branch and its original, which is beside it, part.

    Raises RecordError for a record without samples or robots, or with robots too far apart or
    turned too often.
    """
    timeline, pack = Timeline(record), Pack()
    _check_room(record)
    crowd = timeline.robots > NAMED
    tolerance = CROWD_TOLERANCE if crowd else TOLERANCE
    why = explanations(record)
    header = {
        "name": clean(record.name),
        "seed": record.seed,
        "dt": record.dt,
        "robots": timeline.robots,
        "begin": timeline.begin,
        "duration": timeline.duration,
        "ended": record.ended,
        "crowd": crowd,
        "lines": timeline.robots <= MOST_LINES,
        "trail": SHORT_TRAIL if crowd else TRAIL,
        "tolerance": tolerance,
        "scene": place(timeline.scene),
        "modes": [
            {"name": mode.name, "words": str(mode), "colour": mode.colour, "danger": mode.danger}
            for mode in timeline.scene.modes
        ],
        "explained": timeline.explained_modes,
        "modeless": timeline.modeless,
        **({} if record.judged is None else {"judged": True}),
        "columns": [vars(column) for column in record.declared.columns],
        "signs": list(signs(timeline, ground(timeline))),
        "drivers": [one._asdict() for one in timeline.drivers],
        "marks": timeline.marks,
        **_drives(record, pack),
        "range": _range(record),
        "why": why,
        "decisions": pack_decisions(
            record, pack, [one for driver in why["drivers"] for one in driver["thresholds"]]
        ),
        "contacts": _pack_contacts(timeline, pack, validation),
        "moments": moments(timeline, summary, parted),
        "curves": pack_curves(timeline, pack),
    }
    grid, turn = (CROWD_GRID, CROWD_TURN) if crowd else (GRID, TURN)
    quanta = np.array((grid, grid, turn))
    scene = timeline.scene
    pose, reach = record.pose, scene.reach
    if scene.moved:
        pose, reach = record.moving_pose, record.shapes.radius
    knots = find_knots(pose, timeline.time, quanta, tolerance, reach)
    pack.whole("knots", knots.counts)
    pack.whole("knot_step", record.steps[knots.row])
    for k, name in enumerate(("knot_x", "knot_y", "knot_heading")):
        pack.whole(name, knots.pose[:, k], float(quanta[k]), far=True)
    _pack_events(record, pack)
    pack.whole("arrived", record.arrived)
    return pack.to_base64(header)


def _drives(record: Record, pack: Pack) -> dict[str, Any]:
    """Names of the drives of the robots that have one other than a plain unicycle, and whether
    steering angles were added; nothing where none has."""
    found = {str(i): name for name, some in record.setup.drives.items() for i in some}
    steers = record.holds("/steps/steering")
    if steers:
        every = -(-record.steering.size // MOST_STEERED) or 1
        pack.whole("steering_step", record.steps[::every])
        pack.real("steering", record.steering[::every].T.ravel(), 1e-3)
    return {"drives": found, "steers": steers} if found else {}


def _check_room(record: Record) -> None:
    """Raise RecordError where poses are too far from each other to be packed."""
    wide, high, turned = (float(most) for most in np.ptp(record.pose, axis=(0, 1)))
    apart = max(wide, high)
    if apart >= MOST_APART:
        raise RecordError(
            f"{record.where}: robots are {apart:.3g} m apart; a page shows {MOST_APART:g} m at most"
        )
    if turned >= MOST_TURNED:
        raise RecordError(
            f"{record.where}: headings differ by {turned:.3g} rad; a page shows {MOST_TURNED:g} "
            "rad at most"
        )


def _range(record: Record) -> float | None:
    """Sensing range [m]; None where the world inside is faulty, and of a log."""
    if record.judged is not None:
        return None
    try:
        return float(record.world.sensing_range)
    except PhysimError:
        return None


def place(scene: SceneModel) -> dict[str, Any]:
    """What does not move as plain values, lengths [m], world frame unless said.

    Each path is there once: who follows it, -1 for all of a crowd, and its pieces in the safe area
    and outside of it. So is every different footprint, in its own frame, and the way of each mover.
    """
    drawn = items(scene)
    paths: dict[tuple[int, ...], dict[str, Any]] = {}
    for item in drawn:
        if item.what == "path":
            robots = list(item.robots) if len(item.robots) <= NAMED else [-1]
            pieces = paths.setdefault(item.robots, {"robots": robots, "safe": [], "danger": []})
            pieces["danger" if item.dash else "safe"] += map(_points, item.lines)
    moving = *scene.shapes, *scene.moved_shapes
    shapes = list(dict.fromkeys(moving))
    ways = [
        {"robots": [scene.robots + k], "safe": list(map(_points, way)), "danger": []}
        for k, way in enumerate(scene.ways)
    ]
    number = {shape: k for k, shape in enumerate(shapes)}
    wheels = {
        car: {"at": _points(at), "half": round(ROLL * float(scene.wheelbase[car]), DECIMALS)}
        for car, at in scene.wheels.items()
    }
    return {
        **({"wheels": wheels} if wheels else {}),
        "areas": [
            {"name": item.what, "key": item.key, "rings": [_points(ring) for ring in item.lines]}
            for item in drawn
            if item.level == Level.AREA
        ],
        "walls": [_points(line) for line in scene.boundaries],
        "obstacles": [_points(ring) for ring in scene.solid_rings],
        "reference": _points(scene.reference),
        "paths": [*paths.values(), *ways],
        "stops": _points(scene.stops),
        "shapes": [
            {
                "rings": [_points(ring) for ring in one.rings],
                "mark": _points(one.mark),
                "eccentric": bool(one.eccentric),
            }
            for one in shapes
        ],
        "shape": [number[shape] for shape in moving],
        "extent": _points(scene.extent),
        "bodies": [{"kind": body.kind, "name": clean(body.name)} for body in scene.bodies],
    }


def _points(line: Iterable[FloatArray]) -> list[list[float]]:
    return [[round(float(value), DECIMALS) + 0.0 for value in point] for point in line]


def moments(
    timeline: Timeline, summary: Summary, parted: Parting | None = None
) -> list[dict[str, Any]]:
    """What there is to look at: label, words, time [s], and the robot or contact to ask why.

    Of two robots the one that was behind along the reference path.
    """
    found: list[dict[str, Any]] = []
    if parted is not None:
        words = f"at {parted.time:.2f} s ({clean(parted.name)} first)"
        found.append({
            "label": "branch and original part", "time": parted.time, "words": words,
            "robot": parted.body if parted.body < timeline.robots else -1,
        })  # fmt: skip
    for name, label in MOMENTS:
        metric = summary.metrics.get(name)
        if metric is None or metric.time is None:
            continue
        words = true_minus(amount(metric.value, metric.unit))
        words += f" ({' and '.join(map(clean, summary.names_of(*metric.bodies)))})"
        if metric.value != metric.time:
            words += f" at {metric.time:.2f} s"
        one: dict[str, Any] = {"label": label, "time": float(metric.time), "words": words}
        contact = _contact(timeline, metric) if name in CONTACTS else None
        robots = [body for body in metric.bodies if body < timeline.robots]
        stations = timeline.record.course[int(timeline.sample(metric.time)), :, 2]
        who = min(robots, key=lambda i: (stations[i], -i), default=None)
        found.append(one | ({"robot": who} if contact is None else {"contact": contact}))
    contacts, names = timeline.contacts, [clean(body.name) for body in timeline.record.bodies]
    for k in np.flatnonzero(contacts.swept)[:MOST_GRAZES].tolist():
        time, (a, b) = float(contacts.moment[k]), contacts.bodies[k].tolist()
        words = between(float(contacts.began[k]), timeline.record.dt)
        grazed = f"{names[a]} and {names[b]} grazed"
        found.append({"label": grazed, "time": time, "words": words, "contact": k})
    return found


def _contact(timeline: Timeline, metric: Metric) -> int | None:
    """Number of the contact of these bodies that lasts at that time."""
    contacts, time = timeline.contacts, metric.time or 0.0
    same = (contacts.bodies == metric.bodies).all(axis=1) & ~contacts.swept
    same &= (contacts.began <= time + 1e-6) & (time < contacts.ended - 1e-6)
    rows = np.flatnonzero(same)
    return int(rows[0]) if len(rows) else None


def _pack_contacts(timeline: Timeline, pack: Pack, validation: Validation | None) -> dict[str, Any]:
    """Add all contacts by the time they begin; returns what the header says of them.

    One between two samples begins at the earlier of them.
    Of the places of a contact those are kept where it has moved.
    """
    found, dt = timeline.contacts, timeline.record.dt
    rows: list[int] = []
    count = []
    for first, last in zip(found.first.tolist(), found.last.tolist(), strict=True):
        kept = [first]
        for row in range(first + 1, last + 1):
            if np.abs(found.places[row] - found.places[kept[-1]]).max() > MOVED:
                kept.append(row)
        rows += kept
        count.append(len(kept))
    deep = np.where(np.isfinite(found.deep), found.deep / dt, -1.0)
    for name, values in (
        ("contact_step", found.began / dt - found.swept),
        ("contact_samples", (found.ended - found.began) / dt),
        ("contact_a", found.bodies[:, 0]), ("contact_b", found.bodies[:, 1]),
        ("contact_swept", found.swept), ("contact_deep", deep), ("contact_places", count),
        ("place_step", found.times[rows] / dt),
    ):  # fmt: skip
        pack.whole(name, np.rint(np.asarray(values, dtype=np.float64)))
    pack.real("contact_time", found.moment, 1e-4)
    pack.real("place_x", found.places[rows, 0], 1e-3)
    pack.real("place_y", found.places[rows, 1], 1e-3)
    return {
        "recorded": "contacts" in timeline.record.tables,
        "count": len(found.began),
        "told": {} if found.swept.all() else _told(timeline.record, found, validation),
    }


def _told(
    record: Record, found: Episodes, validation: Validation | None
) -> dict[int, dict[str, Any]]:
    """What a validation says of contacts by their number in ``found``; none where poses or tables
    lack."""
    from physim.analysis.validation.analytic_contacts import analytic_contacts
    from physim.analysis.validation.contact import contacts_of
    from physim.analysis.validation.decisions import DecisionTable
    from physim.analysis.validation.prediction import Predictor
    from physim.analysis.validation.told import sentences
    from physim.analysis.validation.validation import check_complete

    if validation is not None:
        contacts = validation.contacts[:MOST_TOLD]
    else:
        try:
            check_complete(record)
        except RecordError:
            return {}
        table = DecisionTable(record)
        contacts = contacts_of(
            record, analytic_contacts(record), table, Predictor(record, table), MOST_TOLD
        )
    names = [body.name for body in record.bodies]
    began = np.rint(found.began / record.dt).astype(int).tolist()
    number = {
        key: k
        for k, key in enumerate(zip(began, *found.bodies.T.tolist(), strict=True))
        if not found.swept[k]
    }
    told = {}
    for one in contacts:
        row = number.get((round(one.time / record.dt), one.a, one.b))
        if row is not None:  # the run simulated again may have others
            told[row] = {
                "lines": sentences(
                    one, names, "robot" if record.moving == record.robots else "other"
                ),
                "responsible": list(one.responsible),
                "safe": None if not one.warning else round(one.time - one.warning, 6),
            }
    return told


def _pack_events(record: Record, pack: Pack) -> None:
    """Add the closest moments of each robot, and the spans in which it stood before it arrived."""
    found = record.extremes
    for name, column, prefix in (
        ("near", "clearance", "clearance"), ("near_wall", "boundary_clearance", "boundary")
    ):  # fmt: skip
        pack.real(name, found[column], 1e-3)
        pack.whole(f"{name}_step", found[f"{prefix}_step"])
        pack.whole(f"{name}_body", found[f"{prefix}_other"])
    stood = stands(record)
    for k, name in enumerate(("stand_robot", "stand_from", "stand_to")):
        pack.whole(name, stood[:, k])


def stands(record: Record) -> IntArray:
    """Spans (S, 3) in which robots stood for `LEAST` or longer: robot, first and last step.

    It ends where the robot arrives.
    """
    steps = np.asarray(record.steps, dtype=np.int64)
    spans: list[tuple[int, int, int]] = []
    still = still_distances(record.shapes.radius[: record.robots]) / STILL_TIME
    """[m/s] A robot that moves slower from sample to sample stands."""
    took = np.diff(steps) * record.dt
    for robot in range(record.robots):
        moved = np.hypot(*np.diff(record.pose[:, robot, :2], axis=0).T)
        edges = np.diff(np.concatenate(([0], moved < still[robot] * took, [0])).astype(np.int8))
        arrived = int(np.searchsorted(steps, record.arrived[robot]))  # the sample
        for first, end in zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True):
            last = end if record.arrived[robot] < 0 else min(int(end), arrived)
            if (steps[last] - steps[first]) * record.dt >= LEAST - 1e-9:
                spans.append((robot, int(steps[first]), int(steps[last])))
    return np.array(spans, dtype=np.int64).reshape(-1, 3)
