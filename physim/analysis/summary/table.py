"""The summary of a run as a short table."""

from __future__ import annotations

from types import MappingProxyType

from physim.analysis.metrics import DEFINITIONS, Metric
from physim.analysis.summary.summary import Contacts, Summary
from physim.errors import amount_text, decimal_text

SHOWN_ROBOTS = 12
"""Robots that the table lists one by one."""
SHOWN_CONTACTS = 8
"""Contacts that the table lists one by one."""
ENDED = MappingProxyType(
    {
        "running": "not closed (killed, or still running)",
        "duration": "time is up",
        "error": "broken off by an error",
    }
)
"""How a run ended, in words, where the record's own word does not say it."""


def table(summary: Summary, brief: bool = False) -> str:
    """Short table in plain text, one figure a line, ending with a line break.

    ``brief`` leaves out what one does not read after a run: the width of the corridor, danger robot
    by robot, expectations that held, versions.
    """
    rows = table_rows(summary, brief)
    width = max(len(label) for label, _ in rows)
    return "".join(f"{label:<{width}}  {text}\n" for label, text in rows)


def table_rows(summary: Summary, brief: bool = False) -> list[tuple[str, str]]:
    """Label and text of each line of the table, for whoever sets it out otherwise."""
    s = summary
    end = f"{ENDED.get(s.ended, s.ended)} after {s.value('simulated_time'):.2f} s"
    factor = s.real_time_factor
    known = s.value("collision_time_evaluations") is not None
    no_time = "none" if known else "n/a (the controller computes none)"
    robots = "1 robot" if s.robots == 1 else f"{s.robots} robots"
    return [
        ("run", f"{s.name}, seed {s.seed}, {robots}: {end}"),
        *s.setup.lines(),
        ("contacts", _contacts_text(s.contacts)),
        *(("WARNING", sentence) for sentence in s.warnings),
        *_contact_rows(s),
        *_graze_rows(s),
        ("shortest distance", _metric_text(s, "shortest_distance", 4)),
        ("shortest boundary distance", _wall_text(s)),
        ("shortest collision time", _time_text(s, no_time)),
        ("farthest pair", _metric_text(s, "farthest_distance", 2)),
        ("formation error, peak", _metric_text(s, "formation_error_peak", 2)),
        ("formation error, final", _metric_text(s, "formation_error_final", 2)),
        *_motion_rows(s, brief),
        ("danger mode, share of time", _danger_text(s, 0 if brief else SHOWN_ROBOTS)),
        ("decisions", _decisions_text(s)),
        *_command_rows(s),
        *_arrival_rows(s),
        *_own_rows(s),
        *_expected_rows(s, brief),
        ("real-time factor", "n/a" if factor is None else f"{factor:.1f}"),
        *([] if brief else [("made with", s.setup.made_with or "not known")]),
    ]


def _arrival_rows(summary: Summary) -> list[tuple[str, str]]:
    """Whether all have arrived, and why the first of those that have not did not."""
    finish = summary.value("time_to_finish")
    if finish is not None:
        away = summary.metrics["stop_distance"]
        far = summary.bodies[(away.robots or ()).index(away.value)]
        most = f"{decimal_text(away.value, 2, 6)} m from its stop ({far})"
        return [("all robots arrived", f"yes, at {finish:.2f} s; at most {most}")]
    absent = summary.not_arrived
    some = f", {summary.robots - len(absent)} of {summary.robots}" if absent else ""
    reasons = [
        ("  not arrived", one.sentence(summary.bodies[one.robot])) for one in absent[:SHOWN_ROBOTS]
    ]
    return [("all robots arrived", f"no{some}"), *reasons, *_more(len(absent) - SHOWN_ROBOTS)]


def _more(count: int) -> list[tuple[str, str]]:
    """How many are not listed; no line where there are none."""
    return [("  ...", f"{count} more (physim summary --json lists all)")] if count > 0 else []


def _command_rows(summary: Summary) -> list[tuple[str, str]]:
    """How often a stage changed commands; none of a run in which none did."""
    stages = (
        ("filtered differs from nominal", summary.value("filtered_steps")),
        ("applied differs from filtered", summary.value("disturbed_steps")),
    )
    parts = [
        f"{words} in {count} robot-steps ({count / max(summary.robot_steps, 1):.1%})"
        for words, count in stages
        if count
    ]
    return [("commands", ", ".join(parts))] if parts else []


def _contact_rows(summary: Summary) -> list[tuple[str, str]]:
    """A line for each of the first contacts, and one that says how many more there are."""
    contacts = summary.contacts
    if contacts is None:
        return []
    rows = [
        (
            f"  {e.time:.2f} s",
            f"{summary.bodies[e.a]} and {summary.bodies[e.b]}{where and f' {where}'}, "
            f"{e.samples * summary.dt:.2f} s long, {1e3 * e.depth:.1f} mm deep, "
            f"impact {amount_text(e.impact, 1)} N s",
        )
        for e, where in zip(contacts.episodes[:SHOWN_CONTACTS], contacts.places, strict=False)
    ]
    return [*rows, *_more(contacts.count - len(rows))]


def _graze_rows(summary: Summary) -> list[tuple[str, str]]:
    """Lines of the contacts between samples; none where there are none."""
    grazes = summary.grazes
    if not grazes:
        return []
    rows = [
        (
            f"  {g.time:.2f} s",
            f"{summary.bodies[g.a]} and {summary.bodies[g.b]}{where and f' {where}'}, "
            f"{1e3 * g.depth:.3g} mm deep, apart at the samples before and after",
        )
        for g, where in zip(grazes[:SHOWN_CONTACTS], summary.graze_places, strict=False)
    ]
    first = ("grazes between samples", f"{len(grazes)}, first at {grazes[0].time:.2f} s")
    return [first, *rows, *_more(len(grazes) - len(rows))]


def _contacts_text(contacts: Contacts | None) -> str:
    if contacts is None:
        return "n/a (not recorded)"
    if not contacts.count:
        return "0"
    kinds = f"{contacts.between_robots} between robots, {contacts.with_boundaries} with boundaries"
    return f"{contacts.count} ({kinds}), first at {contacts.first_s:.2f} s"


def _expected_rows(summary: Summary, brief: bool) -> list[tuple[str, str]]:
    """A line for each expectation; in brief for those that failed, or one for all."""
    missed = tuple(one for one in summary.expectations if not one.held)
    if brief and summary.expectations and not missed:
        return [("expected", "all held")]
    grazes = " (grazes included)" if summary.grazes else ""
    return [
        (f"expected {one.key}", f"{one}{grazes if one.key == 'contacts' else ''}")
        for one in (missed if brief else summary.expectations)
    ]


def _motion_rows(summary: Summary, brief: bool) -> list[tuple[str, str]]:
    """Lines on deviations, averaged speeds and width, as far as they have a meaning."""
    found, rows = summary.metrics, []
    if "deviation_peak" in found:
        text = _metric_text(summary, "deviation_peak", 2)
        if "deviation_rms" in found:
            text += f", rms {decimal_text(found['deviation_rms'].value, 2, 4)} m"
        rows.append(("path deviation, peak", text))
    ranges = [("speed averaged over 10 s", "averaged_speed"), ("corridor width", "width")]
    for label, name in ranges[:1] if brief else ranges:
        if f"{name}_min" in found:
            ends = [_metric_text(summary, f"{name}_{end}", 2) for end in ("min", "max")]
            rows.append((label, " to ".join(ends)))
    return rows


def _own_rows(summary: Summary) -> list[tuple[str, str]]:
    """Metrics that packages registered, and why others of theirs failed."""
    own = {name: one for name, one in summary.metrics.items() if name not in DEFINITIONS}
    rows = [(name, _own_text(summary, one)) for name, one in own.items()]
    return [*rows, *(("WARNING", fault) for fault in summary.metric_faults)]


def _own_text(summary: Summary, metric: Metric) -> str:
    text = f"{metric.value:.4g}" if isinstance(metric.value, float) else str(metric.value).lower()
    text = text if metric.unit == "-" else f"{text} {metric.unit}"
    where = _where(summary, metric)
    return f"{text} ({where})" if where else text


def _where(summary: Summary, metric: Metric) -> str:
    """``r1 and r2 at 3.19 s``: whose value it is, and when or where; as far as that is known."""
    who = " and ".join(summary.names_of(*metric.bodies))
    if metric.time is not None:
        return f"{who} at {metric.time:.2f} s".lstrip()
    if metric.station is not None:
        return f"path of {who} at {metric.station:.1f} m"
    return who


def _metric_text(summary: Summary, name: str, digits: int, none: str = "n/a") -> str:
    """``0.1234 m (r1 and r2 at 3.19 s)``; ``none`` where it has no meaning."""
    metric = summary.metrics.get(name)
    if metric is None:
        return none
    value = decimal_text(metric.value, digits, max(digits, 4))
    return f"{value} {metric.unit} ({_where(summary, metric)})"


def _time_text(summary: Summary, none: str) -> str:
    """Shortest collision time, and of what: `physim validate` has those of all bodies."""
    said = _metric_text(summary, "shortest_collision_time", 3, none)
    return f"{said[:-1]}, to what it considered)" if said.endswith(" s)") else said


def _wall_text(summary: Summary) -> str:
    """Shortest boundary distance, and where along the wall it was."""
    said = _metric_text(summary, "shortest_boundary_distance", 4)
    where = summary.nearest_wall
    return said if not where or not said.endswith(")") else f"{said[:-1]}, {where})"


def _decisions_text(summary: Summary) -> str:
    count, rate, messages, times = (
        summary.value(name)
        for name in ("decisions", "updates_per_second", "messages", "collision_time_evaluations")
    )
    if count is None:
        return "n/a (not recorded)"
    each = f" ({rate:.1f} a second and robot)" if rate is not None else ""
    computed = "" if times is None else f", {times} collision times computed"
    return f"{count}{each}, {messages} messages{computed}"


def _danger_text(summary: Summary, most: int) -> str:
    """Share of time in modes of danger, of all and of each of the first ``most`` robots."""
    share = summary.value("danger_share")
    if share is None:
        if not summary.value("decisions"):
            return "n/a"
        why = "modes of danger" if summary.modes else "modes"
        return f"n/a (the controller declares no {why}, or no robot was under way)"
    each = [
        f"{summary.bodies[d.robot]} " + ("n/a" if d.time is None else f"{d.time:.0%}")
        for d in summary.danger[:most]
    ]
    if not each:
        return f"{share:.1%}"
    more = len(summary.danger) - len(each)
    rest = f", and {more} more" if more else ""
    return f"{share:.1%} ({', '.join(each)}{rest})"
