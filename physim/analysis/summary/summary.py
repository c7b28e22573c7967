"""The summary of a run: its figures as a value and as JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain, repeat
from typing import Any

from physim.analysis.expectations import Held, expectations
from physim.analysis.metrics import (
    Absent,
    DangerShare,
    Deep,
    Episode,
    Figures,
    Graze,
    Metric,
)
from physim.analysis.metrics.walls import along_wall, touched_wall
from physim.escaping import html_table
from physim.record import Record
from physim.record.setup import Setup
from physim.world.faults import describe

EXTREMES = (
    ("shortest_distance_m", "shortest_distance"),
    ("shortest_boundary_distance_m", "shortest_boundary_distance"),
    ("farthest_pair_m", "farthest_distance"),
    ("shortest_collision_time_s", "shortest_collision_time"),
    ("formation_error_peak_m", "formation_error_peak"),
    ("formation_error_final_m", "formation_error_final"),
)
"""Keys of the JSON that give a metric with its time and bodies, and the metric's name."""


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
    episodes: tuple[Episode, ...]
    """every one, in the order of their beginning"""
    places: tuple[str, ...]
    """where along a wall each of the first `MOST_PLACED` episodes began; empty between robots"""


MOST_PLACED = 20
"""Contacts, and grazes, whose place along a wall is looked up."""


@dataclass(frozen=True, repr=False)
class Summary:
    """Figures of a run; see `physim.metrics` for their definitions. None = has no meaning here.

    Bodies and robots are given by id; `names_of` gives their names.
    """

    name: str
    seed: int
    dt: float
    """[s]"""
    robots: int
    bodies: tuple[str, ...]
    """names by id: robots, then boundaries, then obstacles"""
    ended: str
    setup: Setup
    """controller, stages and versions"""
    metrics: dict[str, Metric]
    """every named metric that has a meaning here"""
    metric_faults: tuple[str, ...]
    """why metrics that packages registered could not be computed, a line each"""
    not_arrived: tuple[Absent, ...]
    """robots that have not arrived, and why"""
    contacts: Contacts | None
    grazes: tuple[Graze, ...]
    """contacts between two samples, in the order of time; none of ``contacts``"""
    graze_places: tuple[str, ...]
    """where along a wall the first ones were; empty between robots"""
    deep_contacts: tuple[Deep, ...]
    """contacts too deep to be true: from the first on the record is not physical"""
    no_safe_area: float | None
    """[m] the safe distance of the controller, where no place is so far from all boundaries"""
    rejected_contacts: int
    danger: tuple[DangerShare, ...]
    """of each robot"""
    modes: tuple[str, ...]
    """words of the modes that the controller declares"""
    nearest_wall: str
    """where along its wall the shortest boundary distance was; empty where that is not known"""
    robot_steps: int
    """of the whole run"""
    expectations: tuple[Held, ...]
    wall_clock: dict[str, float]
    """all else is the same in every run of the same world and seed"""

    def __repr__(self) -> str:
        """Whose, what came of it, and whether that was expected; `table` shows all of it."""
        found = self.contacts
        contacts = "contacts not recorded" if found is None else f"contacts: {found.count}"
        end = f"ended {describe(self.ended)} after {self.value('simulated_time'):g} s"
        kept = ", as expected" if self.held else ", not as expected"
        kept = kept if self.expectations else ""
        return f"<Summary of {describe(self.name)} seed {self.seed}: {end}, {contacts}{kept}>"

    def _repr_html_(self) -> str:
        """What a notebook shows of it: the lines of `table`."""
        from physim.analysis.summary.table import table_rows

        return html_table(table_rows(self))

    @property
    def held(self) -> bool:
        """Whether the run showed everything that its world expects."""
        return all(one.held for one in self.expectations)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What makes the run another than the one that was meant, a sentence each."""
        told = tuple(one.sentence(self.bodies) for one in self.deep_contacts)
        if self.no_safe_area is None:
            return told
        sentence = (
            f"no place is {self.no_safe_area:.4g} m from every boundary: there was no safe area, "
            "and robots were led to where they had most room; physim check says how much that is"
        )
        return (*told, sentence)

    @property
    def real_time_factor(self) -> float | None:
        """[-] simulated time over wall-clock time, where it is known."""
        return self.wall_clock.get("factor")

    def value(self, metric: str) -> Any:
        """Value of a named metric; None where it has no meaning here."""
        found = self.metrics.get(metric)
        return None if found is None else found.value

    def names_of(self, *ids: int) -> tuple[str, ...]:
        """Names of bodies."""
        return tuple(self.bodies[i] for i in ids)

    def to_json(self) -> str:
        """JSON text with units in the keys; what is not a finite number is null."""
        tree = {
            "format": "physim-summary",
            "version": 1,
            "name": self.name,
            "seed": self.seed,
            "robots": self.robots,
            "ended": self.ended,
            **self.setup.to_dict(),
            "versions": self.setup.versions,
            "simulated_s": self.value("simulated_time"),
            "finished": self.value("finished"),
            "time_to_finish_s": self.value("time_to_finish"),
            "stop_distance_m": self.value("stop_distance"),
            "not_arrived": [self._absent(one) for one in self.not_arrived],
            "contacts": self._contacts(),
            "grazes": _with_places(
                [
                    {"bodies": self.names_of(g.a, g.b), "time_s": g.time, "max_depth_m": g.depth}
                    for g in self.grazes
                ],
                self.graze_places,
            ),
            "deep_contacts": [self._deep(one) for one in self.deep_contacts],
            "no_safe_area_at_m": self.no_safe_area,
            "rejected_contacts": self.rejected_contacts,
            **{key: self._extreme(metric) for key, metric in EXTREMES},
            "danger": [
                {"robot": self.bodies[d.robot], "decisions": d.decisions, "time": d.time}
                for d in self.danger
            ],
            "danger_time_share": self.value("danger_share"),
            "modes": self.modes,
            "decisions": self.value("decisions"),
            "messages": self.value("messages"),
            "collision_time_evaluations": self.value("collision_time_evaluations"),
            "commands": {
                "robot_steps": self.robot_steps,
                "filtered_differs_from_nominal": self.value("filtered_steps"),
                "applied_differs_from_filtered": self.value("disturbed_steps"),
            },
            "mean_speed_m_per_s": self.value("mean_speed"),
            "metrics": {name: self._metric(self.metrics[name]) for name in sorted(self.metrics)},
            "metric_faults": self.metric_faults,
            "expectations": [dict(sorted(one._asdict().items())) for one in self.expectations],
            "wall_clock": dict(sorted(self.wall_clock.items())),
        }
        return json.dumps(_finite(tree), indent=2, ensure_ascii=False, allow_nan=False) + "\n"

    def _contacts(self) -> dict[str, Any] | None:
        if self.contacts is None:
            return None
        episodes = [
            {
                "bodies": self.names_of(e.a, e.b),
                "begin_s": e.time,
                "duration_s": e.samples * self.dt,
                "max_depth_m": e.depth,
                "impact_newton_seconds": e.impact,
                "impulse_newton_seconds": e.impulse,
            }
            for e in self.contacts.episodes
        ]
        episodes = _with_places(episodes, self.contacts.places)
        found = {**vars(self.contacts), "episodes": episodes}
        del found["places"]
        return found

    def _absent(self, one: Absent) -> dict[str, Any]:
        name = self.bodies[one.robot]
        return {
            "robot": name,
            "short_m": one.short,
            "tolerance_m": one.tolerance,
            "stands": one.stands,
            "text": one.sentence(name),
        }

    def _deep(self, one: Deep) -> dict[str, Any]:
        return {
            "bodies": self.names_of(one.a, one.b),
            "from_s": one.time,
            "max_depth_m": one.depth,
            "time_s": one.depth_time,
            "place_m": one.place,
            **({"where": one.along} if one.along else {}),
            "text": one.sentence(self.bodies),
        }

    def _extreme(self, metric: str) -> dict[str, Any] | None:
        """A metric that was taken at a moment."""
        if (one := self.metrics.get(metric)) is None:
            return None
        return {"value": one.value, "time_s": one.time, "bodies": self.names_of(*one.bodies)}

    def _metric(self, one: Metric) -> dict[str, Any]:
        """A metric with its unit; what it does not have is left out."""
        given = {
            "value": one.value,
            "unit": one.unit,
            "time_s": one.time,
            "station_m": one.station,
            "bodies": self.names_of(*one.bodies) or None,
            "robots": one.robots,
        }
        return {key: value for key, value in given.items() if value is not None}


def summarise(record: Record) -> Summary:
    """Compute the summary of a run from its record alone. Raises RecordError if it is damaged."""
    run, recorded = Figures(record), "contacts" in record.tables
    found, faults = run.metrics()
    return Summary(
        name=record.name,
        seed=record.seed,
        dt=record.dt,
        robots=record.robots,
        bodies=tuple(body.name for body in record.bodies),
        ended=record.ended,
        setup=record.setup,
        metrics=found,
        metric_faults=faults,
        not_arrived=run.absent,
        contacts=_contacts(record, run.episodes) if recorded else None,
        grazes=run.grazes,
        graze_places=tuple(along_wall(record, g.b, g.place) for g in run.grazes[:MOST_PLACED]),
        deep_contacts=run.deep,
        no_safe_area=None if record.safe else record.safe_distance or None,
        rejected_contacts=record.rejected_contacts,
        danger=run.danger,
        modes=tuple(str(mode) for mode in record.modes),
        nearest_wall=run.where_nearest_wall,
        robot_steps=record.steps_run * record.robots,
        expectations=tuple(expectations(record)),
        wall_clock=record.wall_clock,
    )


def _contacts(record: Record, episodes: Sequence[Episode]) -> Contacts:
    robots = sum(episode.robots for episode in episodes)
    return Contacts(
        count=len(episodes),
        between_robots=robots,
        with_boundaries=len(episodes) - robots,
        first_s=episodes[0].time if episodes else None,
        max_depth_m=max((episode.depth for episode in episodes), default=None),
        max_impact_newton_seconds=max((episode.impact for episode in episodes), default=None),
        episodes=tuple(episodes),
        places=tuple(touched_wall(record, episode) for episode in episodes[:MOST_PLACED]),
    )


def _with_places(told: list[dict[str, Any]], places: Sequence[str]) -> list[dict[str, Any]]:
    """Contacts with where along a wall they were, those that were at one."""
    along = chain(places, repeat(""))
    return [
        {**one, "where": place} if place else one for one, place in zip(told, along, strict=False)
    ]


def _finite(value: Any) -> Any:
    """Value in types that JSON knows; infinite and NaN become None."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
