"""The summary of a run: its figures as a value, as JSON and as a short table."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass
from types import MappingProxyType
from typing import Any

from physim import metrics
from physim.expectations import Held, expectations
from physim.record import Record

SHOWN_ROBOTS = 12
"""Robots whose own share of danger mode the table shows."""
SHOWN_CONTACTS = 8
"""Contacts that the table tells one by one."""
ENDED = MappingProxyType(
    {
        "running": "not closed (killed, or still running)",
        "duration": "time is up",
        "error": "broken off by an error",
    }
)
"""How a run ended, in words, where the record's own word does not say it."""


@dataclass(frozen=True)
class Contact:
    """One contact episode: who touched whom, when and how hard."""

    bodies: tuple[str, str]
    begin_s: float
    duration_s: float
    max_depth_m: float
    impact_ns: float
    """[N s] impulse of the first sample: the hit"""
    impulse_ns: float
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
    max_impact_ns: float | None
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
class Extreme:
    """An extreme value of a run, when it was taken and by whom (names of bodies)."""

    value: float
    time_s: float
    bodies: tuple[str, ...]


@dataclass(frozen=True)
class Danger:
    """Shares of danger mode of one robot, see `metrics.danger_shares`."""

    robot: str
    decisions: float | None
    time: float | None


@dataclass(frozen=True)
class Summary:
    """Figures of a run; see `physim.metrics` for their definitions. None = has no meaning here."""

    name: str
    seed: int
    robots: int
    ended: str
    simulated_s: float
    finished: bool
    time_to_finish_s: float | None
    contacts: Contacts
    grazes: tuple[Graze, ...]
    """contacts between two samples, in the order of time; none of ``contacts``"""
    rejected_contacts: int
    shortest_distance_m: Extreme | None
    shortest_boundary_distance_m: Extreme | None
    farthest_pair_m: Extreme | None
    shortest_collision_time_s: Extreme | None
    formation_error_peak_m: Extreme | None
    formation_error_final_m: Extreme | None
    danger: tuple[Danger, ...]
    danger_time_share: float | None
    decisions: int
    messages: int
    collision_time_evaluations: int
    mean_speed_m_per_s: float | None
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
    return Summary(
        name=record.name,
        seed=record.seed,
        robots=record.robots,
        ended=record.ended,
        simulated_s=record.steps_run * record.dt,
        finished=metrics.finished(record),
        time_to_finish_s=metrics.time_to_finish(record),
        contacts=_contacts(metrics.contact_episodes(record), names, record.dt),
        grazes=tuple(
            Graze((names[g.a], names[g.b]), g.time, g.depth) for g in metrics.grazes(record)
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
        decisions=metrics.decisions(record),
        messages=metrics.messages(record),
        collision_time_evaluations=metrics.evaluations(record),
        mean_speed_m_per_s=metrics.mean_speed(record),
        expectations=tuple(expectations(record)),
        wall_clock=record.wall_clock,
    )


def table(summary: Summary) -> str:
    """Short table in plain text, one figure a line, ending with a line break."""
    rows = table_rows(summary)
    width = max(len(label) for label, _ in rows)
    return "".join(f"{label:<{width}}  {text}\n" for label, text in rows)


def table_rows(summary: Summary) -> list[tuple[str, str]]:
    """Label and text of each line of the table, for whoever sets it out otherwise."""
    s = summary
    end = f"{ENDED.get(s.ended, s.ended)} after {s.simulated_s:.2f} s"
    arrived = f"yes, at {s.time_to_finish_s:.2f} s" if s.time_to_finish_s is not None else "no"
    factor = s.real_time_factor
    no_time = "none" if s.collision_time_evaluations else "n/a (the controller works none out)"
    robots = "1 robot" if s.robots == 1 else f"{s.robots} robots"
    return [
        ("run", f"{s.name}, seed {s.seed}, {robots}: {end}"),
        ("contacts", _contacts_text(s.contacts)),
        *_contact_rows(s.contacts),
        *_graze_rows(s.grazes),
        ("shortest distance", _extreme_text(s.shortest_distance_m, "m", 4)),
        ("shortest boundary distance", _extreme_text(s.shortest_boundary_distance_m, "m", 4)),
        ("shortest collision time", _extreme_text(s.shortest_collision_time_s, "s", 3, no_time)),
        ("farthest pair", _extreme_text(s.farthest_pair_m, "m", 2)),
        ("formation error, peak", _extreme_text(s.formation_error_peak_m, "m", 2)),
        ("formation error, final", _extreme_text(s.formation_error_final_m, "m", 2)),
        ("danger mode, share of time", _danger_text(s)),
        ("all robots arrived", arrived),
        *((f"expected {one.key}", _held_text(one) + _with(one, s)) for one in s.expectations),
        ("real-time factor", "n/a" if factor is None else f"{factor:.1f}"),
    ]


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
        max_impact_ns=max((episode.impact for episode in episodes), default=None),
        episodes=told,
    )


def _contact_rows(contacts: Contacts) -> list[tuple[str, str]]:
    """A line for each of the first contacts, and one that says how many more there are."""
    rows = [
        (
            f"  {c.begin_s:.2f} s",
            f"{c.bodies[0]} and {c.bodies[1]}, {c.duration_s:.2f} s long, "
            f"{1e3 * c.max_depth_m:.1f} mm deep, impact {c.impact_ns:.1f} N s",
        )
        for c in contacts.episodes[:SHOWN_CONTACTS]
    ]
    more = contacts.count - len(rows)
    return [*rows, *([("  ...", f"{more} more (--json lists all)")] if more else [])]


def _graze_rows(grazes: tuple[Graze, ...]) -> list[tuple[str, str]]:
    """Lines of the contacts between samples; none where there are none."""
    if not grazes:
        return []
    rows = [("grazes between samples", f"{len(grazes)}, first at {grazes[0].time_s:.2f} s")]
    rows += [
        (
            f"  {g.time_s:.2f} s",
            f"{g.bodies[0]} and {g.bodies[1]}, {1e3 * g.max_depth_m:.3g} mm deep, "
            "apart at the samples before and after",
        )
        for g in grazes[:SHOWN_CONTACTS]
    ]
    more = len(grazes) - SHOWN_CONTACTS
    return [*rows, *([("  ...", f"{more} more (--json lists all)")] if more > 0 else [])]


def _contacts_text(contacts: Contacts) -> str:
    if not contacts.count:
        return "0"
    kinds = f"{contacts.between_robots} between robots, {contacts.with_boundaries} with boundaries"
    return f"{contacts.count} ({kinds}), first at {contacts.first_s:.2f} s"


def _extreme_text(extreme: Extreme | None, unit: str, digits: int, none: str = "n/a") -> str:
    if extreme is None:
        return none
    who = " and ".join(extreme.bodies)
    return f"{extreme.value:.{digits}f} {unit} ({who} at {extreme.time_s:.2f} s)"


def _danger_text(summary: Summary) -> str:
    if summary.danger_time_share is None:
        return "n/a"
    shown = summary.danger[:SHOWN_ROBOTS]
    each = [f"{d.robot} " + ("n/a" if d.time is None else f"{d.time:.0%}") for d in shown]
    more = len(summary.danger) - len(shown)
    rest = f", and {more} more" if more else ""
    return f"{summary.danger_time_share:.1%} ({', '.join(each)}{rest})"


def _with(one: Held, summary: Summary) -> str:
    return " (grazes included)" if one.key == "contacts" and summary.grazes else ""


def _held_text(one: Held) -> str:
    sign = "=" if one.key == "finished" else ">=" if one.key.startswith("min_") else "<="

    def text(value: object) -> str:
        if isinstance(value, bool):
            return "true" if value else "false"
        return (
            "n/a" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)
        )

    return f"{'held' if one.held else 'NOT HELD'}: {text(one.got)} {sign} {text(one.wanted)}"


def _plain(value: Any) -> Any:
    """Value in types that JSON knows; infinite and NaN become None."""
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


__all__ = ["Contacts", "Danger", "Extreme", "Graze", "Summary", "summarise", "table", "table_rows"]
