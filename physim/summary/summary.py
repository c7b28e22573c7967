"""The summary of a run: its figures as a value and as JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

from physim import metrics
from physim.expectations import Held, expectations
from physim.record import Record


@dataclass(frozen=True)
class Contact:
    """One contact episode: who touched whom, when and how hard."""

    bodies: tuple[str, str]
    begin_s: float
    duration_s: float
    max_depth_m: float
    impact_newton_seconds: float
    """[N s] impulse of the first sample: the hit"""
    impulse_newton_seconds: float
    """[N s] over the whole episode: the hit and all pushing after it"""


@dataclass(frozen=True)
class Contacts:
    """Contact episodes of a run."""

    count: int
    between_robots: int
    with_boundaries: int
    first_s: float | None
    """[s] begin of the first one"""
    max_depth_m: float | None
    max_impact_newton_seconds: float | None
    """[N s] largest impulse in the first sample of an episode"""
    episodes: tuple[Contact, ...]
    """every one, in the order of their beginning"""


@dataclass(frozen=True)
class Graze:
    """One contact between two samples: apart at both, so that the engine let it pass."""

    bodies: tuple[str, str]
    time_s: float
    """[s] of the sample after it"""
    max_depth_m: float


@dataclass(frozen=True)
class DeepContact:
    """A pair of bodies that sank deeper than `physim.tolerances.DEEP` into each other."""

    bodies: tuple[str, str]
    from_s: float
    """[s] when it first was deeper than that"""
    max_depth_m: float
    time_s: float
    """[s] of the greatest depth"""
    place_m: tuple[float, float]
    text: str
    """the same in words"""


@dataclass(frozen=True)
class Extreme:
    """An extreme value of a run, when it was taken and by whom (names of bodies)."""

    value: float
    time_s: float
    bodies: tuple[str, ...]


@dataclass(frozen=True)
class Absent:
    """A robot that had not arrived at the end, see `metrics.absent`."""

    robot: str
    short_m: float
    """[m] along its path from where it was to its stop station; negative when past it"""
    tolerance_m: float
    stands: bool
    """it moved no more than 1 cm in the last 0.5 s"""
    text: str
    """the same in words"""


@dataclass(frozen=True)
class Commands:
    """How many robot-steps had a command that one stage changed."""

    robot_steps: int
    """of the whole run"""
    filtered_differs_from_nominal: int
    applied_differs_from_filtered: int


@dataclass(frozen=True)
class Danger:
    """Shares of danger mode of one robot, see `metrics.danger_shares`."""

    robot: str
    decisions: float | None
    time: float | None


@dataclass(frozen=True)
class Figure:
    """One named metric of a run, see `metrics.DEFINITIONS`; None (in JSON absent) = not so."""

    value: bool | int | float
    unit: str
    time_s: float | None
    """[s] when, where it was taken at a moment"""
    station_m: float | None
    """[m] along the path of the body, where it belongs to a place"""
    bodies: tuple[str, ...] | None
    """names, where it belongs to some bodies"""
    robots: tuple[float | None, ...] | None
    """of each robot in file order, where each has its own"""


@dataclass(frozen=True)
class Summary:
    """Figures of a run; see `physim.metrics` for their definitions. None = has no meaning here."""

    name: str
    seed: int
    robots: int
    ended: str
    simulated_s: float
    finished: bool
    """all robots have arrived, judged by their motion alone"""
    time_to_finish_s: float | None
    not_arrived: tuple[Absent, ...]
    """robots that have not arrived, and why"""
    contacts: Contacts | None
    grazes: tuple[Graze, ...]
    """contacts between two samples, in the order of time; none of ``contacts``"""
    deep_contacts: tuple[DeepContact, ...]
    """contacts too deep to be true: from the first on the record is not physical"""
    rejected_contacts: int
    shortest_distance_m: Extreme | None
    shortest_boundary_distance_m: Extreme | None
    farthest_pair_m: Extreme | None
    shortest_collision_time_s: Extreme | None
    formation_error_peak_m: Extreme | None
    formation_error_final_m: Extreme | None
    danger: tuple[Danger, ...]
    danger_time_share: float | None
    modes: tuple[str, ...]
    """words of the modes that the controller declares"""
    decisions: int | None
    messages: int | None
    collision_time_evaluations: int | None
    commands: Commands
    mean_speed_m_per_s: float | None
    metrics: dict[str, Figure]
    """every named metric that has a meaning here"""
    metric_faults: tuple[str, ...]
    """why metrics that packages registered could not be had, a line each"""
    expectations: tuple[Held, ...]
    wall_clock: dict[str, float]
    """all else is the same in every run of the same world and seed"""

    @property
    def held(self) -> bool:
        """Whether the run showed everything that its world expects."""
        return all(one.held for one in self.expectations)

    @property
    def real_time_factor(self) -> float | None:
        """[-] simulated time over wall-clock time, where it is known."""
        return self.wall_clock.get("factor")

    def to_json(self) -> str:
        """JSON text with units in the keys; what is not a finite number is null."""
        return json.dumps(_plain(self), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def summarise(record: Record) -> Summary:
    """Work out the summary of a run from its record alone. Raises RecordError if it is damaged."""
    names = [body.name for body in record.bodies]

    def named(moment: metrics.Moment | None) -> Extreme | None:
        if moment is None:
            return None
        who = [i for i in (moment.a, moment.b) if i is not None]
        return Extreme(moment.value, moment.time, tuple(names[i] for i in who))

    shares = metrics.danger_shares(record)
    found, faults = metrics.measured(record)
    return Summary(
        name=record.name,
        seed=record.seed,
        robots=record.robots,
        ended=record.ended,
        simulated_s=record.steps_run * record.dt,
        finished=metrics.finished(record),
        time_to_finish_s=metrics.time_to_finish(record),
        not_arrived=tuple(
            Absent(names[a.robot], a.short, a.tolerance, a.stands, a.sentence(names[a.robot]))
            for a in metrics.absent(record)
        ),
        contacts=(
            _contacts(metrics.contact_episodes(record), names, record.dt)
            if "contacts" in record.tables
            else None
        ),
        grazes=tuple(
            Graze((names[g.a], names[g.b]), g.time, g.depth) for g in metrics.grazes(record)
        ),
        deep_contacts=tuple(
            DeepContact(
                (names[d.a], names[d.b]), d.time, d.depth, d.depth_time, d.place, d.sentence(names)
            )
            for d in metrics.deep_contacts(record)
        ),
        rejected_contacts=record.rejected_contacts,
        shortest_distance_m=named(metrics.shortest_distance(record)),
        shortest_boundary_distance_m=named(metrics.shortest_boundary_distance(record)),
        farthest_pair_m=named(metrics.farthest_pair(record)),
        shortest_collision_time_s=named(metrics.shortest_collision_time(record)),
        formation_error_peak_m=named(metrics.formation_error_peak(record)),
        formation_error_final_m=named(metrics.formation_error_final(record)),
        danger=tuple(Danger(names[s.robot], s.decisions, s.time) for s in shares),
        danger_time_share=metrics.danger_time_share(record),
        modes=tuple(str(mode) for mode in record.modes),
        decisions=metrics.decisions(record),
        messages=metrics.messages(record),
        collision_time_evaluations=metrics.evaluations(record),
        commands=Commands(
            record.steps_run * record.robots,
            metrics.filtered_steps(record),
            metrics.disturbed_steps(record),
        ),
        mean_speed_m_per_s=metrics.mean_speed(record),
        metrics={
            name: Figure(
                metric.value,
                metric.unit,
                metric.time,
                metric.station,
                tuple(names[i] for i in metric.bodies) or None,
                metric.robots,
            )
            for name, metric in found.items()
        },
        metric_faults=faults,
        expectations=tuple(expectations(record)),
        wall_clock=record.wall_clock,
    )


def _contacts(episodes: tuple[metrics.Episode, ...], names: Sequence[str], dt: float) -> Contacts:
    robots = sum(episode.robots for episode in episodes)
    told = tuple(
        Contact((names[e.a], names[e.b]), e.time, e.samples * dt, e.depth, e.impact, e.impulse)
        for e in episodes
    )
    return Contacts(
        count=len(episodes),
        between_robots=robots,
        with_boundaries=len(episodes) - robots,
        first_s=episodes[0].time if episodes else None,
        max_depth_m=max((episode.depth for episode in episodes), default=None),
        max_impact_newton_seconds=max((episode.impact for episode in episodes), default=None),
        episodes=told,
    )


def _plain(value: Any) -> Any:
    """Value in types that JSON knows; infinite and NaN become None."""
    if isinstance(value, Figure):
        given = ((field.name, getattr(value, field.name)) for field in fields(value))
        return {name: _plain(part) for name, part in given if part is not None}
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: _plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Held):
        return _plain(value._asdict())
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in sorted(value.items())}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value
