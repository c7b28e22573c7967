"""The report of a validation as plain text, like one that a safety engineer would file."""

from __future__ import annotations

from math import isfinite

from physim.tolerances import ONE_STEP
from physim.validation.contact_text import contact_lines, opening, table_lines
from physim.validation.near_misses import LOOK, NearMiss
from physim.validation.numbers import listed, names_of, wrapped
from physim.validation.prediction_text import prediction_lines
from physim.validation.validation import Validation, confusions

SHOWN_DISAGREEMENTS = 20


def report(validation: Validation) -> str:
    """Full report of one run, ending with the verdict and a line break."""
    parts = [
        _head(validation),
        ["VERDICT  " + validation.verdict, *warning_lines(validation), *opening(validation)],
        _contacts(validation),
        _checks(validation),
        _disagreements(validation),
        prediction_lines(validation),
        _near_misses(validation),
        warning_lines(validation),
        [f"verdict: {validation.verdict}"],
    ]
    return "\n\n".join("\n".join(part) for part in parts if part) + "\n"


def warning_lines(validation: Validation) -> list[str]:
    """What makes the record unfit to be believed: contacts that are too deep."""
    names = names_of(validation)
    return [
        line
        for one in validation.deep
        for line in wrapped(one.sentence(names), "  WARNING  ", 11 * " ")
    ]


def _head(validation: Validation) -> list[str]:
    run = validation.run
    given = dict(run.given)
    robots = "1 robot" if run.robots == 1 else f"{run.robots} robots"
    others = [body.name for body in run.bodies[run.robots :]]
    ends = {
        "finished": "all robots arrived",
        "duration": "ran for its whole duration",
        "interrupted": "INTERRUPTED: judged as far as it was recorded",
        "error": "BROKE OFF WITH AN ERROR: judged as far as it was recorded",
        "running": "KILLED: judged as far as it was recorded",
    }
    lines = [
        "COLLISION SAFETY REPORT",
        f"  run         {run.name}, seed {run.seed}: {robots}, {listed(others, 6)}",
        f"  record      {run.source}",
        f"  controller  {run.controller}{', given from Python' if 'controller' in given else ''}",
        f"  time        {run.seconds:.2f} s of at most {run.planned:g} s, step {run.dt:g} s; "
        f"{ends.get(run.ended, run.ended)}",
    ]
    lines += [
        f"  {kind:<11} {name}, given from Python"
        for kind, name in run.given
        if kind != "controller"
    ]
    if validation.resimulated:
        lines.append("  samples     not all in the record: simulated again, and those in it agree")
    made = ", ".join(f"{name} {version}" for name, version in sorted(run.versions.items()))
    return [*lines, f"  made by     {made}"] if made else lines


def _contacts(validation: Validation) -> list[str]:
    if not validation.contacts:
        return []
    return ["CONTACTS", *table_lines(validation), *contact_lines(validation)]


def _checks(validation: Validation) -> list[str]:
    comparison, run = validation.comparison, validation.run
    pad = 34 * " "
    lines = [
        "CHECKS: physical contacts against exact distances, every pair at every step",
        f"  {pad}{'both':>10}{'physical':>10}{'analytic':>10}{'neither':>14}",
        f"  {pad}{'contact':>10}{'only':>10}{'only':>10}",
    ]
    for label, row in confusions(validation):
        cells = f"{row.both:>10,}{row.physical_only:>10,}{row.analytic_only:>10,}"
        lines.append(f"  {label:<34}{cells}{row.neither:>14,}")
    if comparison.rejected:
        times = "once" if comparison.rejected == 1 else f"{comparison.rejected:,} times"
        lines.append(
            f"  The engine reported a contact of shapes that were apart {times}; the exact check "
            "rejected it."
        )
    lines.append(
        f"  Motion: {validation.motion.checked:,} steps of robots that touch nothing, held against "
        "the arcs of"
    )
    strays = len(validation.motion.strays)
    lines.append(
        f"  their commands: {f'{strays} DIFFER' if strays else f'all agree within {ONE_STEP:g} m'}."
    )
    if not validation.origin.held:
        lines.append("  World: the record holds no text of its world; nothing is held against it.")
    if run.robots == 1:
        lines.append("  A single robot: there are no pairs of robots.")
    return lines


def _disagreements(validation: Validation) -> list[str]:
    found = validation.comparison.disagreements
    strays = validation.motion.strays
    differences = validation.origin.differences
    count = len(found) + len(validation.mispredicted) + len(strays) + len(differences)
    if not count:
        return ["DISAGREEMENTS: none"]
    names = names_of(validation)
    unexplained = validation.unexplained + len(strays) + len(differences)
    lines = [f"DISAGREEMENTS: {count}, of which {unexplained} unexplained"]
    for told in differences[:SHOWN_DISAGREEMENTS]:
        lines += wrapped(f"unexplained: {told}", "  ", 15 * " ")
    for stray in strays[:SHOWN_DISAGREEMENTS]:
        long = f" for {stray.steps} steps" if stray.steps > 1 else ""
        lines += wrapped(
            f"{stray.time:9.4f} s  {names[stray.robot]}: unexplained (it touches nothing, yet its "
            f"pose is {stray.gap:.3g} m and {stray.turn:.3g} rad from where its command leads from "
            f"the sample before{long})", "  ", 15 * " ",
        )  # fmt: skip
    shown = sorted(found, key=lambda one: one.cause != "unexplained")[:SHOWN_DISAGREEMENTS]
    for one in shown:
        who = names[one.a] + ("" if one.b is None else f" and {names[one.b]}")
        long = f" for {one.steps} samples" if one.steps > 1 else ""
        apart = f", signed distance {one.distance:.3g} m" if isfinite(one.distance) else ""
        lines += wrapped(
            f"{one.time:9.4f} s  {who}{apart}{long}: "
            f"{one.cause} ({one.what})", "  ", 15 * " ",
        )  # fmt: skip
    for contact in validation.mispredicted[:SHOWN_DISAGREEMENTS]:
        p = contact.prediction
        due = "none" if p.predicted is None or p.predicted > 1e9 else f"{p.predicted:.4f} s"
        lines += wrapped(
            f"{p.found:9.4f} s  {names[p.a]} and {names[p.b]}: unexplained (first touch at "
            f"{p.touched:.6f} s, but contact predicted at {p.made:.2f} s: {due})", "  ", 15 * " ",
        )  # fmt: skip
    left = count - len(shown) - len(validation.mispredicted[:SHOWN_DISAGREEMENTS])
    left -= len(strays[:SHOWN_DISAGREEMENTS]) + len(differences[:SHOWN_DISAGREEMENTS])
    return [*lines, f"  and {left} more (--json FILE has all)"] if left else lines


def _near_misses(validation: Validation) -> list[str]:
    near = validation.near_misses
    return [
        "NEAR MISSES (approaches that did not end in contact)",
        f"  smallest distances, of approaches nearer than {near.reach:.2f} m",
        *_near_rows(validation, near.distances, "m", 4),
        f"  smallest collision times under the commands of the moment, below {LOOK:g} s",
        *_near_rows(validation, near.times, "s", 3),
    ]


def _near_rows(
    validation: Validation, some: tuple[NearMiss, ...], unit: str, digits: int
) -> list[str]:
    names = names_of(validation)
    lines = []
    for one in some:
        duty = "" if one.behind is None else f" ({names[one.behind]} had to give way)"
        lines.append(
            f"    {one.value:8.{digits}f} {unit}  at {one.time:8.2f} s  "
            f"{names[one.a]} and {names[one.b]}{duty}"
        )
    return lines or ["    none"]
