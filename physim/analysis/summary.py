"""The summary of a run from its record alone: as a value, as JSON and as a short table."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from types import MappingProxyType
from typing import Any, NamedTuple

from physim.analysis.expectations import Held, expectations
from physim.analysis.metrics import DEFINITIONS, Deep, Episode, Figures, Graze, Metric
from physim.analysis.metrics.distances import along_wall
from physim.analysis.metrics.modes import danger_of
from physim.errors import plural
from physim.html import labelled
from physim.json_text import json_text
from physim.record import Record
from physim.units import amount, between, percent
from physim.world.faults import describe


class ByController(NamedTuple):
    """What came of the robots of one controller."""

    controller: str
    """with its settings"""
    robots: tuple[int, ...]
    arrived: int
    contacts: int | None
    """episodes with one of them; None where contacts were not recorded"""
    danger_share: float | None
    """[-] of their active time"""


SHOWN_ROBOTS = 12
"""Robots that the table lists one by one."""
SHOWN_CONTACTS = 8
"""Contacts that the table lists one by one."""
ENDED = MappingProxyType(
    {
        "running": "not closed (killed, or still running)",
        "duration": "time limit reached",
        "error": "ended by an error",
    }
)
"""How a run ended, in words, where the record's own word does not say it."""
Rows = list[tuple[str, str]]
"""Lines of the table: label and text"""


@dataclass(frozen=True, repr=False)
class Summary:
    """Figures of a run; see `physim.metrics` for their definitions. None = has no meaning here.

    Bodies and robots are given by id; `names_of` gives their names.
    """

    run: Figures
    """contacts, who has not arrived, and all else; its record may be closed"""
    metrics: dict[str, Metric]
    """every named metric that has a meaning here"""
    metric_faults: tuple[str, ...]
    """why metrics that packages registered could not be computed, a line each"""
    expectations: tuple[Held, ...]
    controllers: tuple[ByController, ...]
    """by controller, where there are several"""

    def __repr__(self) -> str:
        """Whose, what came of it, and whether that was expected; `table` shows all of it."""
        record, count = self.run.record, self.value("contacts")
        contacts = "contacts not recorded" if count is None else f"contacts: {count}"
        begun, at = (f"begun at {record.begun:g} s, ", "at") if record.begun_at else ("", "after")
        end = f"{begun}ended {describe(record.ended)} {at} {self.value('simulated_time'):g} s"
        kept = ", as expected" if self.held else ", not as expected"
        kept = kept if self.expectations else ""
        name = describe(record.name)
        return f"<Summary of {name} seed {record.seed}: {end}, {contacts}{kept}>"

    def _repr_html_(self) -> str:
        """What a notebook shows of it: the lines of `table`."""
        return labelled(table_rows(self))

    @property
    def held(self) -> bool:
        """Whether the run showed everything that its world expects."""
        return all(one.held for one in self.expectations)

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names by id: robots, then boundaries, then obstacles."""
        return tuple(body.name for body in self.run.record.bodies)

    @property
    def contacts(self) -> tuple[Episode, ...] | None:
        """Contact episodes in the order of their beginning; None where they were not recorded."""
        return self.run.episodes if "contacts" in self.run.record.tables else None

    @property
    def no_safe_area(self) -> float | None:
        """[m] the safe distance of the controller, where no place is so far from all boundaries."""
        record = self.run.record
        return None if record.safe else record.safe_distance or None

    @property
    def warnings(self) -> tuple[str, ...]:
        """What makes the run another than the one that was meant, a sentence each."""
        told = tuple(one.sentence(self.bodies) for one in self.run.deep)
        if self.no_safe_area is None:
            return told
        sentence = (
            f"no place is {self.no_safe_area:.4g} m from every boundary: there was no safe area, "
            "and robots were led to where they had most room; physim check says how much that is"
        )
        return (*told, sentence)

    def value(self, metric: str) -> Any:
        """Value of a named metric; None where it has no meaning here."""
        found = self.metrics.get(metric)
        return None if found is None else found.value

    def names_of(self, *ids: int) -> tuple[str, ...]:
        """Names of bodies."""
        return tuple(self.bodies[i] for i in ids)

    def to_json(self) -> str:
        """JSON text with units in the keys; what is not a finite number is null.

        A figure stands in it once: numbers of contacts, distances, times and shares are
        ``metrics``, by name. Version 1 had some of them twice.
        """
        run, record = self.run, self.run.record
        tree = {
            "format": "physim-summary",
            "version": 2,
            "name": record.name,
            "seed": record.seed,
            "robots": record.robots,
            "ended": record.ended,
            **record.setup.to_dict(),
            "versions": record.setup.versions,
            "metrics": {name: self._metric(one) for name, one in sorted(self.metrics.items())},
            "metric_faults": self.metric_faults,
            "contacts": None if self.contacts is None else [self._contact(e) for e in run.episodes],
            "grazes": [self._contact(one) for one in run.grazes],
            "deep_contacts": [self._deep(one) for one in run.deep],
            "not_arrived": [
                {
                    "robot": self.bodies[one.robot],
                    "short_m": one.short,
                    "tolerance_m": one.tolerance,
                    "stands": one.stands,
                    "text": one.sentence(self.bodies[one.robot]),
                }
                for one in run.absent
            ],
            "no_safe_area_at_m": self.no_safe_area,
            **({"by_controller": self._by_controller} if self.controllers else {}),
            "rejected_contacts": record.rejected_contacts,
            "robot_steps": record.steps_made * record.robots,
            "modes": [str(mode) for mode in record.modes],
            "expectations": [dict(sorted(one._asdict().items())) for one in self.expectations],
            "wall_clock": dict(sorted(record.wall_clock.items())),
        }
        return json_text(tree)

    @property
    def _by_controller(self) -> list[dict[str, Any]]:
        return [one._asdict() | {"robots": self.names_of(*one.robots)} for one in self.controllers]

    def _metric(self, one: Metric) -> dict[str, Any]:
        """A metric with its unit; what it does not have is left out."""
        found = asdict(one) | {"bodies": self.names_of(*one.bodies) or None}
        if one.name == "shortest_boundary_distance":
            found["where"] = self.run.where_nearest_wall or None
        keys = {"time": "time_s", "station": "station_m"}
        return {keys.get(k, k): v for k, v in found.items() if v is not None and k != "name"}

    def _contact(self, one: Episode | Graze) -> dict[str, Any]:
        told = {"bodies": self.names_of(one.a, one.b), "time_s": one.time, "max_depth_m": one.depth}
        if isinstance(one, Episode):
            told |= {
                "duration_s": one.samples * self.run.record.dt,
                "impact_newton_seconds": one.impact,
                "impulse_newton_seconds": one.impulse,
            }
        where = self.where(one)
        return {**told, "where": where} if where else told

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

    def where(self, one: Episode | Graze) -> str:
        """Where along a wall a contact began; empty between robots."""
        return along_wall(self.run.record, one.b, one.place)


def summarise(record: Record) -> Summary:
    """Compute the summary of a run from its record alone. Raises RecordError if it is damaged."""
    run = Figures(record)
    metrics, faults = run.metrics()
    found = Summary(run, metrics, faults, tuple(expectations(record)), tuple(_by_controller(run)))
    found.to_json()  # reads all that it needs: the record may be closed
    return found


def _by_controller(run: Figures) -> Iterator[ByController]:
    """Figures of each controller, where there are several."""
    record = run.record
    controllers = record.setup.controllers
    absent = {one.robot for one in run.absent}
    for part, robots in controllers if len(controllers) > 1 else ():
        met = None
        if "contacts" in record.tables:
            met = sum(not {one.a, one.b}.isdisjoint(robots) for one in run.episodes)
        share = danger_of(record, robots) if "updates" in record.tables else None
        yield ByController(str(part), robots, len(set(robots) - absent), met, share)


def table(summary: Summary, brief: bool = False) -> str:
    """Short table in plain text, one figure a line, ending with a line break.

    ``brief`` leaves out what one does not read after a run: the width of the corridor, danger robot
    by robot, expectations that held, versions.
    """
    rows = table_rows(summary, brief)
    width = max(len(label) for label, _ in rows)
    return "".join(f"{label:<{width}}  {text}\n" for label, text in rows)


def table_rows(summary: Summary, brief: bool = False) -> Rows:
    """Label and text of each line of the table, for whoever sets it out otherwise."""
    s, run, record = summary, summary.run, summary.run.record
    begun, at = (f"begun at {record.begun:.2f} s, ", "at") if record.begun_at else ("", "after")
    how = ENDED.get(record.ended, record.ended) if record.judged is None else "the log ends"
    end = f"{begun}{how} {at} {s.value('simulated_time'):.2f} s"
    factor = record.wall_clock.get("factor")
    computes = s.value("collision_time_evaluations") is not None
    none = "none" if computes else "n/a (the controller computes none)"
    grazes, at_samples = "", ""
    if record.judged and run.nearest and run.nearest.time == run.nearest.step * record.dt:
        at_samples = "at samples alone: --every S looks between them"
    if run.grazes:
        first = between(run.grazes[0].step * record.dt, record.dt)
        grazes = f"{len(run.grazes)}, first {first}"
    return [
        ("run", f"{record.name}, seed {record.seed}, {plural(record.robots, 'robot')}: {end}"),
        *record.setup.lines(),
        ("contacts", _contacts(s)),
        *(("WARNING", sentence) for sentence in s.warnings),
        *_each_contact(s, run.episodes),
        *([("grazes between samples", grazes)] if grazes else []),
        *_each_contact(s, run.grazes),
        ("shortest distance", _told(s, "shortest_distance", 4, more=at_samples)),
        ("shortest boundary distance",
         _told(s, "shortest_boundary_distance", 4, more=run.where_nearest_wall)),
        ("shortest collision time",  # `physim validate` has those of all bodies
         _told(s, "shortest_collision_time", 3, none, "with what it considered")
         if record.judged is None else
         _told(s, "seen_collision_time", 3, "none", "if both go on as seen")),
        ("farthest pair", _told(s, "farthest_distance", 2)),
        ("formation error, peak", _told(s, "formation_error_peak", 2)),
        ("formation error, final", _told(s, "formation_error_final", 2)),
        *_joined(s, "path deviation, peak", ("deviation_peak", "deviation_rms"), ", rms "),
        *_joined(s, "speed averaged over 10 s", ("averaged_speed_min", "averaged_speed_max")),
        *([] if brief else _joined(s, "corridor width", ("width_min", "width_max"))),
        *([] if record.judged else [
            ("danger mode, share of time", _danger(s, 0 if brief else SHOWN_ROBOTS)),
            ("decisions", _decisions(s)),
        ]),
        *_commands(s),
        *_arrival(s),
        *((name, _told(s, name)) for name in s.metrics if name not in DEFINITIONS),
        *(("WARNING", fault) for fault in s.metric_faults),
        *_each_controller(s),
        *_expected(s, brief),
        *([] if record.judged else
          [("real-time factor", "n/a" if factor is None else f"{factor:.1f}")]),
        *([] if brief else [("made with", record.setup.made_with or "not known")]),
    ]  # fmt: skip


def _told(
    summary: Summary, name: str, digits: int | None = None, none: str = "n/a", more: str = ""
) -> str:
    """``0.1234 m (r1 and r2 at 3.19 s)``; ``none`` where it has no meaning."""
    one = summary.metrics.get(name)
    if one is None:
        return none
    value = str(one.value).lower()
    if not isinstance(one.value, bool):
        value = amount(one.value, one.unit.removeprefix("-"), digits)
    where = " and ".join(summary.names_of(*one.bodies))
    if one.time is not None:
        where = f"{where} at {one.time:.2f} s".lstrip()
    elif one.station is not None:
        where = f"path of {where} at {one.station:.1f} m"
    where = ", ".join(part for part in (where, more) if part)
    return f"{value} ({where})" if where else value


def _joined(summary: Summary, label: str, names: tuple[str, str], between: str = " to ") -> Rows:
    """A line of two metrics, those of them that have a meaning; none where the first has none."""
    if names[0] not in summary.metrics:
        return []
    texts = (_told(summary, name, 2) for name in names if name in summary.metrics)
    return [(label, between.join(texts))]


def _contacts(summary: Summary) -> str:
    if summary.contacts is None:
        return "n/a (not recorded)"
    count, walls = summary.value("contacts"), summary.value("contacts_with_boundaries")
    if not count:
        return "0"
    first = summary.value("first_contact")
    movers = summary.value("contacts_with_movers")
    kinds = f"{count - walls - (movers or 0)} between robots, {walls} with boundaries"
    kinds += "" if movers is None else f", {movers} with movers and boxes"
    return f"{count} ({kinds}), first at {first:.2f} s"


def _each_contact(summary: Summary, found: Sequence[Episode | Graze]) -> Rows:
    """A line for each of the first contacts, and one that says how many more there are."""
    rows = []
    for one in found[:SHOWN_CONTACTS]:
        names, where = summary.names_of(one.a, one.b), summary.where(one)
        when, dt = f"{one.time:.2f} s", summary.run.record.dt
        if isinstance(one, Episode):
            how = f"{one.samples * dt:.2f} s long, {1e3 * one.depth:.1f} mm deep"
            how += "" if one.impact is None else f", impact {amount(one.impact, 'N s', 1)}"
        else:
            when, how = between(one.step * dt, dt), f"{1e3 * one.depth:.3g} mm deep"
        rows.append((f"  {when}", f"{' and '.join(names)}{where and f' {where}'}, {how}"))
    return rows + _more(len(found) - len(rows))


def _more(count: int) -> Rows:
    """How many are not listed; no line where there are none."""
    return [("  ...", f"{count} more (physim summary --json has all)")] if count > 0 else []


def _danger(summary: Summary, most: int) -> str:
    """Share of time in modes of danger, of all and of each of the first ``most`` robots."""
    share = summary.metrics.get("danger_share")
    if share is None:
        why = "danger mode" if summary.run.record.modes else "modes"
        told = f" (the controller declares no {why}, or no robot was under way)"
        return "n/a" + (told if summary.value("decisions") else "")
    robots = share.robots or ()
    each = [
        f"{name} {'n/a' if one is None else percent(one, 0)}"
        for name, one in zip(summary.bodies, robots[:most], strict=False)
    ]
    if each and len(robots) > most:
        each[-1] += f", and {len(robots) - most} more"
    return percent(share.value) + (f" ({', '.join(each)})" if each else "")


def _decisions(summary: Summary) -> str:
    count, rate, messages, times = (
        summary.value(name)
        for name in ("decisions", "updates_per_second", "messages", "collision_time_evaluations")
    )
    if count is None:
        return "n/a (not recorded)"
    each = "" if rate is None else f" ({rate:.1f} per second and robot)"
    computed = "" if times is None else f", {times} collision times computed"
    return f"{count}{each}, {messages} messages{computed}"


def _commands(summary: Summary) -> Rows:
    """How often a stage changed commands; none of a run in which none did."""
    record, parts = summary.run.record, []
    for words, name in (
        ("filtered differs from nominal", "filtered_steps"),
        ("applied differs from filtered", "disturbed_steps"),
    ):
        if n := summary.value(name):
            share = percent(n / max(record.steps_made * record.robots, 1))
            parts.append(f"{words} in {n} robot-steps ({share})")
    return [("commands", ", ".join(parts))] if parts else []


def _arrival(summary: Summary) -> Rows:
    """Whether all have arrived, and why the first of those that have not did not."""
    away, label = summary.metrics.get("stop_distance"), "all robots arrived"
    if away is not None:
        far = summary.bodies[(away.robots or ()).index(away.value)]
        most = f"{amount(away.value, 'm', 2)} from its stop ({far})"
        return [(label, f"yes, at {summary.value('time_to_finish'):.2f} s; at most {most}")]
    absent, robots = summary.run.absent, summary.run.record.robots
    reasons = [
        ("  not arrived", one.sentence(summary.bodies[one.robot])) for one in absent[:SHOWN_ROBOTS]
    ]
    some = f", {robots - len(absent)} of {robots}" if absent else ""
    return [(label, f"no{some}"), *reasons, *_more(len(absent) - SHOWN_ROBOTS)]


def _each_controller(summary: Summary) -> Rows:
    """A line for each controller, where there are several."""
    rows: Rows = []
    for one in summary.controllers:
        met = "n/a" if one.contacts is None else str(one.contacts)
        share = "n/a" if one.danger_share is None else percent(one.danger_share)
        who = summary.run.record.setup.who(one.robots)
        did = f"{one.arrived} of {len(one.robots)} arrived, contacts {met}, danger mode {share}"
        rows.append(("" if rows else "by controller", f"{one.controller}: {did} ({who})"))
    return rows


def _expected(summary: Summary, brief: bool) -> Rows:
    """A line for each expectation; in brief for those that failed, or one for all."""
    if brief and summary.expectations and summary.held:
        return [("expected", "all held")]
    grazes = " (grazes included)" if summary.run.grazes else ""
    return [
        (f"expected {one.key}", f"{one}{grazes if one.key == 'contacts' else ''}")
        for one in summary.expectations
        if not (brief and one.held)
    ]
