"""The summary of a run as a short table."""

from __future__ import annotations

from types import MappingProxyType

from physim.expectations import Held
from physim.metrics import DEFINITIONS
from physim.summary.summary import Contacts, Extreme, Figure, Graze, Summary

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


def table(summary: Summary) -> str:
    """Short table in plain text, one figure a line, ending with a line break."""
    rows = table_rows(summary)
    width = max(len(label) for label, _ in rows)
    return "".join(f"{label:<{width}}  {text}\n" for label, text in rows)


def table_rows(summary: Summary) -> list[tuple[str, str]]:
    """Label and text of each line of the table, for whoever sets it out otherwise."""
    s = summary
    end = f"{ENDED.get(s.ended, s.ended)} after {s.simulated_s:.2f} s"
    factor = s.real_time_factor
    known = s.collision_time_evaluations is not None
    no_time = "none" if known else "n/a (the controller works none out)"
    robots = "1 robot" if s.robots == 1 else f"{s.robots} robots"
    return [
        ("run", f"{s.name}, seed {s.seed}, {robots}: {end}"),
        ("contacts", _contacts_text(s.contacts)),
        *(("WARNING", one.text) for one in s.deep_contacts),
        *_contact_rows(s.contacts),
        *_graze_rows(s.grazes),
        ("shortest distance", _extreme_text(s.shortest_distance_m, "m", 4)),
        ("shortest boundary distance", _extreme_text(s.shortest_boundary_distance_m, "m", 4)),
        ("shortest collision time", _extreme_text(s.shortest_collision_time_s, "s", 3, no_time)),
        ("farthest pair", _extreme_text(s.farthest_pair_m, "m", 2)),
        ("formation error, peak", _extreme_text(s.formation_error_peak_m, "m", 2)),
        ("formation error, final", _extreme_text(s.formation_error_final_m, "m", 2)),
        *_motion_rows(s),
        ("danger mode, share of time", _danger_text(s)),
        ("decisions", _decisions_text(s)),
        *_command_rows(s),
        *_arrival_rows(s),
        *_own_rows(s),
        *((f"expected {one.key}", _held_text(one) + _with(one, s)) for one in s.expectations),
        ("real-time factor", "n/a" if factor is None else f"{factor:.1f}"),
    ]


def _arrival_rows(summary: Summary) -> list[tuple[str, str]]:
    """Whether all have arrived, and why the first of those that have not did not."""
    if summary.time_to_finish_s is not None:
        return [("all robots arrived", f"yes, at {summary.time_to_finish_s:.2f} s")]
    absent = summary.not_arrived
    some = f", {summary.robots - len(absent)} of {summary.robots}" if absent else ""
    rows = [("all robots arrived", f"no{some}")]
    rows += [("  not arrived", one.text) for one in absent[:SHOWN_ROBOTS]]
    more = len(absent) - SHOWN_ROBOTS
    return [*rows, *([("  ...", f"{more} more (physim summary --json lists all)")] * (more > 0))]


def _command_rows(summary: Summary) -> list[tuple[str, str]]:
    """How often a stage changed commands; none of a run in which none did."""
    commands = summary.commands
    told = (
        ("filtered differs from nominal", commands.filtered_differs_from_nominal),
        ("applied from filtered", commands.applied_differs_from_filtered),
    )
    parts = [
        f"{words} in {count} robot-steps ({count / max(commands.robot_steps, 1):.1%})"
        for words, count in told
        if count
    ]
    return [("commands", ", ".join(parts))] if parts else []


def _contact_rows(contacts: Contacts | None) -> list[tuple[str, str]]:
    """A line for each of the first contacts, and one that says how many more there are."""
    if contacts is None:
        return []
    rows = [
        (
            f"  {c.begin_s:.2f} s",
            f"{c.bodies[0]} and {c.bodies[1]}, {c.duration_s:.2f} s long, "
            f"{1e3 * c.max_depth_m:.1f} mm deep, impact {c.impact_newton_seconds:.1f} N s",
        )
        for c in contacts.episodes[:SHOWN_CONTACTS]
    ]
    more = contacts.count - len(rows)
    return [*rows, *([("  ...", f"{more} more (physim summary --json lists all)")] if more else [])]


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
    return [
        *rows,
        *([("  ...", f"{more} more (physim summary --json lists all)")] if more > 0 else []),
    ]


def _contacts_text(contacts: Contacts | None) -> str:
    if contacts is None:
        return "n/a (not recorded)"
    if not contacts.count:
        return "0"
    kinds = f"{contacts.between_robots} between robots, {contacts.with_boundaries} with boundaries"
    return f"{contacts.count} ({kinds}), first at {contacts.first_s:.2f} s"


def _extreme_text(extreme: Extreme | None, unit: str, digits: int, none: str = "n/a") -> str:
    if extreme is None:
        return none
    who = " and ".join(extreme.bodies)
    return f"{extreme.value:.{digits}f} {unit} ({who} at {extreme.time_s:.2f} s)"


def _motion_rows(summary: Summary) -> list[tuple[str, str]]:
    """Lines on deviations, averaged speeds and width, as far as they have a meaning."""
    found, rows = summary.metrics, []
    if "deviation_peak" in found:
        peak = _figure_text(found["deviation_peak"], 2)
        rms = f", rms {found['deviation_rms'].value:.2f} m" if "deviation_rms" in found else ""
        rows.append(("path deviation, peak", peak + rms))
    for label, name, digits in (
        ("speed averaged over 10 s", "averaged_speed", 2),
        ("corridor width", "width", 2),
    ):
        if f"{name}_min" in found:
            ends = (found[f"{name}_min"], found[f"{name}_max"])
            rows.append((label, " to ".join(_figure_text(end, digits) for end in ends)))
    return rows


def _own_rows(summary: Summary) -> list[tuple[str, str]]:
    """Metrics that packages registered, and why others of theirs failed."""
    rows = []
    for name, figure in summary.metrics.items():
        if name not in DEFINITIONS:
            value = figure.value
            text = f"{value:.4g}" if isinstance(value, float) else str(value).lower()
            rows.append((name, text if figure.unit == "-" else f"{text} {figure.unit}"))
    return [*rows, *(("WARNING", fault) for fault in summary.metric_faults)]


def _figure_text(figure: Figure, digits: int) -> str:
    who = " and ".join(figure.bodies or ())
    when = f"{who} at {figure.time_s:.2f} s" if figure.time_s is not None else ""
    where = f"path of {who} at {figure.station_m:.1f} m" if figure.station_m is not None else ""
    return f"{figure.value:.{digits}f} {figure.unit} ({when or where})"


def _decisions_text(summary: Summary) -> str:
    if summary.decisions is None:
        return "n/a (not recorded)"
    rate = summary.metrics.get("updates_per_second")
    each = f" ({rate.value:.1f} a second and robot)" if rate is not None else ""
    messages, times = summary.messages, summary.collision_time_evaluations
    worked = "" if times is None else f", {times} collision times worked out"
    return f"{summary.decisions}{each}, {messages} messages{worked}"


def _danger_text(summary: Summary) -> str:
    if summary.danger_time_share is None:
        if not summary.decisions:
            return "n/a"
        why = "modes of danger" if summary.modes else "modes"
        return f"n/a (the controller declares no {why})"
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
