"""All figures of a run: `Figures`, and `measure`, which gives its metrics by name."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cached_property
from typing import TypeVar

from physim.analysis.metrics.contacts import (
    Deep,
    Episode,
    Graze,
    Severity,
    contact_episodes,
    deep_contacts,
    grazes,
    severest,
)
from physim.analysis.metrics.distances import (
    Width,
    corridor_width,
    farthest_pair,
    shortest_boundary_distance,
    shortest_collision_time,
    shortest_distance,
)
from physim.analysis.metrics.metric import Metric, Moment, Series
from physim.analysis.metrics.motion import (
    AveragedSpeeds,
    averaged_speeds,
    formation_energy,
    sampled_errors,
)
from physim.analysis.metrics.progress import Absent, absent, active_steps
from physim.analysis.metrics.registered import own_metrics
from physim.analysis.metrics.registry import DEFINITIONS, definition
from physim.analysis.metrics.walls import near_wall
from physim.errors import PhysimError
from physim.geometry.shapes import FloatArray, IntArray
from physim.record import Record, check_record

T = TypeVar("T")


def _shared(find: Callable[[Record], T]) -> cached_property[T]:
    """A figure that a function finds in the record."""
    return cached_property(lambda run: find(run.record))


class Figures:
    """Figures of one run, each worked out from its record once, when it is first asked for.

    What was worked out stays with the record, so `Figures(record)` costs nothing: make one
    wherever a figure is needed. Arrays are shared; do not write into them. What has no meaning for
    the run is None. Raises TypeError for what is no record, RecordError for a damaged one.
    """

    __slots__ = ("__dict__", "record")
    record: Record

    def __init__(self, record: Record) -> None:
        """Take the figures of a record."""
        check_record(record)
        self.record = record
        self.__dict__ = vars(record).setdefault("figures", {})

    episodes: cached_property[tuple[Episode, ...]] = _shared(contact_episodes)
    """Contacts as `Episode`, in the order of their beginning"""
    grazes: cached_property[tuple[Graze, ...]] = _shared(grazes)
    """Contacts between two samples, `Graze`, in the order of time"""
    deep: cached_property[tuple[Deep, ...]] = _shared(deep_contacts)
    """Contacts too deep to be true, `Deep`, in the order of time"""
    nearest: cached_property[Moment | None] = _shared(shortest_distance)
    """`Moment` of the shortest distance [m] of two robots"""
    nearest_wall: cached_property[Moment | None] = _shared(shortest_boundary_distance)
    """`Moment` of the shortest distance [m] of a robot to a boundary or obstacle"""
    farthest: cached_property[Moment | None] = _shared(farthest_pair)
    """`Moment` of the largest distance [m] of two robots"""
    collision_time: cached_property[Moment | None] = _shared(shortest_collision_time)
    """`Moment` of the shortest collision time [s] at a decision"""
    absent: cached_property[tuple[Absent, ...]] = _shared(absent)
    """Robots that have not arrived, `Absent`"""
    active_steps: cached_property[IntArray] = _shared(active_steps)
    """(N,) steps until each robot was at its stop station for good"""
    averaged: cached_property[AveragedSpeeds] = _shared(averaged_speeds)
    """`AveragedSpeeds` over 10 s"""
    formation_errors: cached_property[FloatArray | None] = _shared(sampled_errors)
    """(K, N) [m] at the samples"""
    energy: cached_property[Series | None] = _shared(formation_energy)
    """Formation energy W [m^2] at the samples, a `Series`"""

    @cached_property
    def least(self) -> Moment | None:
        """The shortest distance [m] of a robot to anything, robot or wall."""
        found = [one for one in (self.nearest, self.nearest_wall) if one is not None]
        return min(found, key=lambda one: one.value, default=None)

    @cached_property
    def severest(self) -> tuple[Episode, Severity] | None:
        """The contact of the greatest closing speed; needs a sample of every step."""
        return severest(self.record, self.episodes)

    @cached_property
    def width(self) -> Width | None:
        """Width along the first robot's path."""
        return corridor_width(self.record) if self.record.robots else None

    @cached_property
    def where_nearest_wall(self) -> str:
        """Where along its wall the shortest boundary distance was; empty where not known."""
        at = self.nearest_wall
        return "" if at is None or at.b is None else near_wall(self.record, at.a, at.b, at.step)

    @cached_property
    def _taken(self) -> dict[str, Metric | None]:
        return {}

    def metric(self, name: str) -> Metric | None:
        """A metric by name; None where it has no meaning for the run.

        Registered ones are taken anew each time. Raises PhysimError, with the nearest name, for an
        unknown one, and for a registered metric that fails.
        """
        if name not in DEFINITIONS:
            return Metric.of(definition(name), self)
        if name not in self._taken:
            self._taken[name] = Metric.of(DEFINITIONS[name], self)
        return self._taken[name]

    def value(self, name: str) -> bool | int | float | None:
        """Value of a metric; None where it has no meaning for the run."""
        found = self.metric(name)
        return None if found is None else found.value

    def metrics(self) -> tuple[dict[str, Metric], tuple[str, ...]]:
        """Every metric that has a meaning for the run: physim's own, then registered ones.

        With a line for each registered one that failed.
        """
        own = own_metrics(DEFINITIONS)
        found, faults = {name: self.metric(name) for name in DEFINITIONS}, list(own.faults)
        for name, what in own.definitions.items():
            try:
                found[name] = Metric.of(what, self)
            except PhysimError as error:
                faults.append(str(error))
        return {name: one for name, one in found.items() if one is not None}, tuple(faults)


def measure(record: Record, names: Iterable[str] | None = None) -> dict[str, Metric]:
    """Take metrics of a run from its record alone: all, or those of ``names``, in their order.

    All are physim's own (`DEFINITIONS`) and those that packages registered. Metrics that have no
    meaning for the run are left out. Raises PhysimError for an unknown name and for a registered
    metric that fails, RecordError for a damaged record.
    """
    run = Figures(record)
    if names is None:
        found, faults = run.metrics()
        if faults:
            raise PhysimError(faults[0])
        return found
    taken = {name: run.metric(name) for name in names}
    return {name: metric for name, metric in taken.items() if metric is not None}
