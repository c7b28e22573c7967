"""Take the named metrics of a run."""

from __future__ import annotations

from collections.abc import Iterable

from physim.errors import PhysimError, nearest
from physim.metrics.definition import Definition, Metric, Run
from physim.metrics.registry import DEFINITIONS
from physim.metrics.values import Each, Moment, Place
from physim.record import Record


def measure(record: Record, names: Iterable[str] | None = None) -> dict[str, Metric]:
    """Take metrics of a run from its record alone: all, or those of ``names``, in their order.

    Metrics that have no meaning for the run are left out. Raises PhysimError for an unknown name,
    RecordError for a damaged record.
    """
    run, found = Run(record), {}
    for name in DEFINITIONS if names is None else names:
        metric = _taken(definition(name), run)
        if metric is not None:
            found[name] = metric
    return found


def definition(name: str) -> Definition:
    """Definition of a metric. Raises PhysimError, with the nearest one, for an unknown name."""
    if name not in DEFINITIONS:
        close = nearest(name[:100], list(DEFINITIONS))
        raise PhysimError(
            f'no metric is called "{name[:100]}"{close} (physim summary --definitions)'
        )
    return DEFINITIONS[name]


def _taken(what: Definition, run: Run) -> Metric | None:
    found = what.find(run)
    if found is None:
        return None
    if isinstance(found, Moment):
        bodies = (found.a,) if found.b is None else (found.a, found.b)
        return Metric(what, found.value, time=found.time, bodies=bodies)
    if isinstance(found, Place):
        return Metric(what, found.value, station=found.station, bodies=(found.robot,))
    if isinstance(found, Each):
        return Metric(what, found.value, robots=found.robots)
    return Metric(what, found)
