"""What of a record goes into the page: the scene, poses by their knots, decisions, contacts.

Poses are right to within `TOLERANCE` at every recorded sample, decisions to a thousandth (of many
to a hundredth) of their units; what is left out is told in the page.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.analysis.summary import Summary
from physim.drawing.crowd import MOST_LINES, NAMED
from physim.drawing.labels import clean
from physim.drawing.page.contacts import pack_contacts
from physim.drawing.page.curves import pack_curves
from physim.drawing.page.decisions import pack_decisions
from physim.drawing.page.events import pack_events
from physim.drawing.page.knots import find_knots
from physim.drawing.page.moments import moments
from physim.drawing.page.packing import Pack
from physim.drawing.page.place import place
from physim.drawing.page.why import explanations
from physim.drawing.timeline import Timeline
from physim.drawing.video.canvas import SHORT_TRAIL, TRAIL
from physim.drawing.video.ground import ground
from physim.drawing.video.panel import signs
from physim.errors import RecordError
from physim.record import Record

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


def run_data(record: Record, summary: Summary) -> str:
    """Everything the page draws of a record, as text for `assets/decode.js`.

    Raises RecordError for a record without samples or robots, or with robots too far apart or
    turned too often.
    """
    timeline, pack = Timeline(record), Pack()
    _check_room(record)
    crowd = timeline.robots > NAMED
    header = {
        "name": clean(record.name),
        "seed": record.seed,
        "dt": record.dt,
        "robots": timeline.robots,
        "duration": timeline.duration,
        "ended": record.ended,
        "crowd": crowd,
        "lines": timeline.robots <= MOST_LINES,
        "trail": SHORT_TRAIL if crowd else TRAIL,
        "tolerance": CROWD_TOLERANCE if crowd else TOLERANCE,
        "scene": _cleaned(place(timeline.scene)),
        "modes": [
            {"name": mode.name, "words": str(mode), "colour": mode.colour, "danger": mode.danger}
            for mode in timeline.scene.modes
        ],
        "explained": timeline.explained_modes,
        "modeless": timeline.modeless,
        "columns": [vars(column) for column in record.declared.columns],
        "signs": list(signs(timeline, ground(timeline))),
        "range": _range(record),
        "why": (why := explanations(record)),
        "decisions": pack_decisions(record, pack, why["thresholds"]),
        "contacts": pack_contacts(timeline, pack),
        "moments": moments(timeline, summary),
        "curves": pack_curves(timeline, pack),
    }
    _pack_poses(timeline, pack, crowd)
    pack_events(record, pack)
    pack.whole("arrived", record.arrived)
    return pack.to_base64(header)


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


def _pack_poses(timeline: Timeline, pack: Pack, crowd: bool) -> None:
    grid, turn = (CROWD_GRID, CROWD_TURN) if crowd else (GRID, TURN)
    quanta = np.array((grid, grid, turn))
    knots = find_knots(
        timeline.record.pose, timeline.time, quanta,
        CROWD_TOLERANCE if crowd else TOLERANCE, timeline.scene.reach,
    )  # fmt: skip
    pack.whole("knots", knots.counts)
    pack.whole("knot_step", timeline.record.steps[knots.row])
    for k, name in enumerate(("knot_x", "knot_y", "knot_heading")):
        pack.whole(name, knots.pose[:, k], float(quanta[k]), far=True)


def _cleaned(scene: dict[str, Any]) -> dict[str, Any]:
    """The scene with names on one line each."""
    for body in scene["bodies"]:
        body["name"] = clean(body["name"])
    return scene


def _range(record: Record) -> float | None:
    """Sensing range [m]; None where the world inside is faulty."""
    from physim.errors import PhysimError

    try:
        return float(record.world.sensing_range)
    except PhysimError:
        return None
