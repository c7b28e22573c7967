"""Take the named metrics of a run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from physim.errors import PhysimError, nearest
from physim.metrics.definition import Definition, Metric
from physim.metrics.own import own_metrics
from physim.metrics.registry import DEFINITIONS, Courses
from physim.metrics.values import Each, Moment, Place
from physim.record import Record


def measure(record: Record, names: Iterable[str] | None = None) -> dict[str, Metric]:
    """Take metrics of a run from its record alone: all, or those of ``names``, in their order.

    All are physim's own (`DEFINITIONS`) and those that packages registered. Metrics that have no
    meaning for the run are left out. Raises PhysimError for an unknown name and for a registered
    metric that fails, RecordError for a damaged record.
    """
    if names is None:
        found, faults = measured(record)
        if faults:
            raise PhysimError(faults[0])
        return found
    known, run = dict(DEFINITIONS), Courses(record)
    wanted = list(names)
    if not known.keys() >= set(wanted):
        known = definitions()
    taken = {name: _metric(_known(name, known), run) for name in wanted}
    return {name: metric for name, metric in taken.items() if metric is not None}


def measured(record: Record) -> tuple[dict[str, Metric], tuple[str, ...]]:
    """Take all metrics of a run; with a line for each registered one that failed."""
    run, found, own = Courses(record), {}, own_metrics(DEFINITIONS)
    faults = list(own.faults)
    for name, what in (*DEFINITIONS.items(), *own.definitions.items()):
        try:
            metric = _metric(what, run)
        except PhysimError as error:
            if name in DEFINITIONS:
                raise
            faults.append(str(error))
            continue
        if metric is not None:
            found[name] = metric
    return found, tuple(faults)


def definitions() -> dict[str, Definition]:
    """Every metric by name: physim's own, then those that packages registered and can be used."""
    return {**DEFINITIONS, **own_metrics(DEFINITIONS).definitions}


def definition(name: str) -> Definition:
    """Definition of a metric. Raises PhysimError, with the nearest one, for an unknown name."""
    return DEFINITIONS[name] if name in DEFINITIONS else _known(name, definitions())


def _known(name: str, known: Mapping[str, Definition]) -> Definition:
    if name in known:
        return known[name]
    for fault in own_metrics(DEFINITIONS).faults:
        if f'"{name}"' in fault:
            raise PhysimError(fault)
    close = nearest(name[:100], list(known))
    raise PhysimError(f'no metric is called "{name[:100]}"{close} (physim summary --definitions)')


def _metric(what: Definition, run: Courses) -> Metric | None:
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
