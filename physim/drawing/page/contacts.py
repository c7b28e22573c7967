"""Contacts as the page shows them: when, who, where, and what `validate` says of each."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.compiled import is_cached
from physim.drawing.page.packing import Pack
from physim.drawing.timeline import Episodes, Timeline
from physim.errors import RecordError
from physim.record import Record

MOST_TOLD = 100
"""Contacts, the first of the run, that have a paragraph each."""
MOVED = 0.02
"""[m] by which the mark of a contact moves at least"""


def is_warm() -> bool:
    """Whether the kernels for the paragraphs lie compiled on disk; one stands for all."""
    from physim.analysis.validation.analytic_contacts import scan_walls

    return is_cached(scan_walls)


def pack_contacts(timeline: Timeline, pack: Pack) -> dict[str, Any]:
    """Add all contacts by the time they begin; returns what the header says of them."""
    found, dt = timeline.contacts, timeline.record.dt
    rows, count = _places(found)
    pack.whole("contact_step", np.rint(found.began / dt))
    pack.whole("contact_samples", np.rint((found.ended - found.began) / dt))
    pack.whole("contact_a", found.bodies[:, 0])
    pack.whole("contact_b", found.bodies[:, 1])
    pack.whole("contact_swept", found.swept)
    deep = np.where(np.isfinite(found.deep), found.deep / dt, -1.0)
    pack.whole("contact_deep", np.rint(deep))
    pack.whole("contact_places", count)
    pack.whole("place_step", np.rint(found.times[rows] / dt))
    pack.real("place_x", found.places[rows, 0], 1e-3)
    pack.real("place_y", found.places[rows, 1], 1e-3)
    return {
        "recorded": "contacts" in timeline.record.tables,
        "count": len(found.began),
        "told": _told(timeline.record, found),
    }


def _places(found: Episodes) -> tuple[list[int], list[int]]:
    """Rows of ``places`` that are kept, and how many each contact has: those where it has moved."""
    rows: list[int] = []
    count = []
    for first, last in zip(found.first.tolist(), found.last.tolist(), strict=True):
        kept = [first]
        for row in range(first + 1, last + 1):
            if np.abs(found.places[row] - found.places[kept[-1]]).max() > MOVED:
                kept.append(row)
        rows += kept
        count.append(len(kept))
    return rows, count


def _told(record: Record, found: Episodes) -> dict[int, dict[str, Any]]:
    """What is told by the number of the contact in ``found``; none where poses or tables lack."""
    if found.swept.all():
        return {}
    from physim.analysis.validation.analytic_contacts import analytic_contacts
    from physim.analysis.validation.contact import contacts_of
    from physim.analysis.validation.decisions import DecisionTable
    from physim.analysis.validation.prediction import Predictor
    from physim.analysis.validation.told import sentences
    from physim.analysis.validation.validation import check_complete

    try:
        check_complete(record)
    except RecordError:
        return {}
    table = DecisionTable(record)
    contacts = contacts_of(
        record, analytic_contacts(record), table, Predictor(record, table), MOST_TOLD
    )
    names = [body.name for body in record.bodies]
    began = np.rint(found.began / record.dt).astype(int)
    number = {
        key: k
        for k, key in enumerate(zip(began.tolist(), *found.bodies.T.tolist(), strict=True))
        if not found.swept[k]
    }
    told = {}
    for one in contacts:
        row = number[(round(one.time / record.dt), one.a, one.b)]
        told[row] = {
            "lines": sentences(one, names),
            "responsible": list(one.responsible),
            "safe": None if not one.warning else round(one.time - one.warning, 6),
        }
    return told
