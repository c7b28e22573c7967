"""The report of a validation as plain text, like one that a safety engineer would file."""

from __future__ import annotations

from math import isfinite

from physim.analysis.validation.contact_text import (
    contact_lines,
    opening,
    prediction_lines,
    table_lines,
)
from physim.analysis.validation.disagreements import UNEXPLAINED
from physim.analysis.validation.mismatch import SLACK
from physim.analysis.validation.near_misses import LOOK, PARTED, TOGETHER, NearMiss
from physim.analysis.validation.validation import Run, Validation, confusions
from physim.analysis.validation.wording import listed, wrapped
from physim.tolerances import ONE_STEP

MOST_LISTED = 20
"""Disagreements of one sort that are listed one by one"""


def check_lines(validation: Validation) -> list[str]:
    """What was checked, and the result."""
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
    said = []
    if comparison.rejected:
        times = "once" if comparison.rejected == 1 else f"{comparison.rejected:,} times"
        said.append(
            f"The engine reported a contact of shapes that were apart {times}; the exact check "
            "rejected it."
        )
    motion = validation.motion
    off = sum(stray.allowed is None for stray in motion.strays)
    far = len(motion.strays) - off
    said.append(
        f"Motion: {motion.checked:,} steps of robots that touch nothing, held against the arcs of "
        f"their applied commands: {f'{off} DIFFER' if off else f'all agree within {ONE_STEP:g} m'}."
    )
    if motion.held:
        said.append(
            f"Motion in contact: {motion.held:,} steps held to the energy of the commands: "
            f"{f'{far} TOO FAR' if far else 'none goes farther'}."
        )
    said += _decisions(validation)
    if run.robots == 1:
        said.append("A single robot: there are no pairs of robots.")
    said += _again(validation)
    return [*lines, *(line for text in said for line in wrapped(text, "  ", "    "))]


def _decisions(validation: Validation) -> list[str]:
    """What was held of decisions and commands, and what was not."""
    found, made = validation.recomputed, ""
    if found.replayed:
        kind = validation.run.controller
        made = f", {found.replayed:,} of them made again by {kind} from what it saw"
    wrong = len(found.mismatches)
    result = f"{wrong} {'DIFFER' if wrong > 1 else 'DIFFERS'}" if wrong else "all agree"
    lines = [f"Decisions: {found.decisions:,}{made}. Commands, their limits and stages: {result}."]
    return [*lines, *(f"Not computed: {what}." for what in found.left_out)]


def _again(validation: Validation) -> list[str]:
    """What came of simulating the run again."""
    again, run = validation.rerun, validation.run
    if again is None:
        return []
    if again.difference is not None:
        return ["Simulated again: ANOTHER RUN, see below."]
    if again.same_digest:
        return [f"Simulated again: the same run to the bit, digest {again.digest}."]
    if again.exact:
        return [
            f"Simulated again: the same values to the bit in all {again.until:.2f} s that are in "
            "the record."
        ]
    up_to = "" if again.whole else f", up to the first contact after {again.until:.2f} s"
    made = ", ".join(f"{name} {version}" for name, version in sorted(run.versions.items()))
    return [
        f"Simulated again by other versions than made the record ({made or 'unknown'}): the same "
        f"within {SLACK:g}{up_to}."
    ]


def disagreement_lines(validation: Validation) -> list[str]:
    """Every disagreement on a line of its own, `MOST_LISTED` of each sort."""
    names = validation.names
    sorts = [
        [f"unexplained: {line}" for line in validation.origin.differences],
        [f"unexplained: {one.line(names)}" for one in validation.recomputed.mismatches],
        _rerun(validation, names),
        _strays(validation, names),
        _pairs(validation, names),
        _mispredicted(validation, names),
    ]
    count = sum(len(sort) for sort in sorts)
    if not count:
        return ["DISAGREEMENTS: none"]
    explained = sum(one.cause != UNEXPLAINED for one in validation.comparison.disagreements)
    lines = [f"DISAGREEMENTS: {count}, of which {count - explained} unexplained"]
    for sort in sorts:
        for text in sort[:MOST_LISTED]:
            lines += wrapped(text, "  ", 15 * " ")
    left = sum(len(sort[MOST_LISTED:]) for sort in sorts)
    return [*lines, f"  and {left} more (--json FILE has all)"] if left else lines


def _rerun(validation: Validation, names: list[str]) -> list[str]:
    again = validation.rerun
    if again is None or again.difference is None:
        return []
    return [f"unexplained, the first difference of the run: {again.difference.line(names)}"]


def _strays(validation: Validation, names: list[str]) -> list[str]:
    lines = []
    for stray in validation.motion.strays:
        long = f" for {stray.steps} steps" if stray.steps > 1 else ""
        lines.append(
            f"{stray.time:9.4f} s  {names[stray.robot]}: unexplained ({stray.sentence}{long})"
        )
    return lines


def _pairs(validation: Validation, names: list[str]) -> list[str]:
    """Disagreements about contacts and distances, those without a cause first."""
    lines = []
    found = validation.comparison.disagreements
    for one in sorted(found, key=lambda one: one.cause != UNEXPLAINED):
        who = names[one.a] + ("" if one.b is None else f" and {names[one.b]}")
        long = f" for {one.steps} samples" if one.steps > 1 else ""
        apart = f", signed distance {one.distance:.3g} m" if isfinite(one.distance) else ""
        lines.append(f"{one.time:9.4f} s  {who}{apart}{long}: {one.cause} ({one.what})")
    return lines


def _mispredicted(validation: Validation, names: list[str]) -> list[str]:
    lines = []
    for contact in validation.mispredicted:
        p = contact.prediction
        due = "none" if p.predicted is None or p.predicted > 1e9 else f"{p.predicted:.4f} s"
        lines.append(
            f"{p.found:9.4f} s  {names[p.a]} and {names[p.b]}: unexplained (first touch at "
            f"{p.touched:.6f} s, but contact predicted at {p.made:.2f} s: {due})"
        )
    return lines


def expectation_lines(validation: Validation) -> list[str]:
    """What the world expects, and what was found; nothing where it expects nothing."""
    if not validation.expectations:
        return []
    missed = len(validation.missed)
    head = f"EXPECTED: {missed} NOT HELD" if missed else "EXPECTED: all held"
    return [head, *(f"  {one.key:<22} {one}" for one in validation.expectations)]


def report(validation: Validation) -> str:
    """Full report of one run, ending with the verdict and a line break."""
    parts = [
        _head(validation),
        ["VERDICT  " + validation.verdict, *warning_lines(validation), *opening(validation)],
        _contacts(validation),
        check_lines(validation),
        disagreement_lines(validation),
        expectation_lines(validation),
        prediction_lines(validation),
        _near_misses(validation),
        warning_lines(validation),
        [f"verdict: {validation.verdict}"],
    ]
    return "\n\n".join("\n".join(part) for part in parts if part) + "\n"


def warning_lines(validation: Validation) -> list[str]:
    """What makes the record unfit to be believed: contacts that are too deep."""
    names = validation.names
    return [
        line
        for one in validation.deep
        for line in wrapped(one.sentence(names), "  WARNING  ", 11 * " ")
    ]


def _head(validation: Validation) -> list[str]:
    run = validation.run
    robots = "1 robot" if run.robots == 1 else f"{run.robots} robots"
    others = [body.name for body in run.bodies[run.robots :]]
    ends = {
        "finished": "all robots arrived",
        "duration": "ran for its whole duration",
        "interrupted": "INTERRUPTED: checked as far as it was recorded",
        "error": "BROKE OFF WITH AN ERROR: checked as far as it was recorded",
        "running": "KILLED: checked as far as it was recorded",
    }
    lines = [
        "COLLISION SAFETY REPORT",
        f"  run         {run.name}, seed {run.seed}: {robots}, {listed(others, 6)}",
        f"  record      {run.source}",
        *_parts(run),
        f"  time        {run.seconds:.2f} s of at most {run.planned:g} s, step {run.dt:g} s; "
        f"{ends.get(run.ended, run.ended)}",
    ]
    made = ", ".join(f"{name} {version}" for name, version in sorted(run.versions.items()))
    return [*lines, f"  made by     {made}"] if made else lines


def _parts(run: Run) -> list[str]:
    """The controller and what stands between it and the robots, with their settings."""
    setup, python = run.setup, ", given from Python"
    is_known = setup.controller.name == run.controller
    controller = str(setup.controller) if is_known else run.controller
    parts = [("controller", controller + (python if "controller" in dict(run.given) else ""))]
    for stage, ones in setup.stages.items():
        parts += [(stage.removesuffix("s"), str(one)) for one in ones]
    for one in setup.others:
        kind, _, name = one.partition(" ")
        parts.append((kind, name + python))
    return [line for kind, text in parts for line in wrapped(f"{kind:<11} {text}", "  ", 14 * " ")]


def _contacts(validation: Validation) -> list[str]:
    if not validation.contacts:
        return []
    return ["CONTACTS", *table_lines(validation), *contact_lines(validation)]


def _near_misses(validation: Validation) -> list[str]:
    near = validation.near_misses
    return [
        "NEAR MISSES (approaches that did not end in contact)",
        f"  (two of a pair only where {TOGETHER:g} s lie between them and it parted by more than "
        f"{PARTED:g} m)",
        f"  smallest distances, of approaches nearer than {near.reach:.2f} m",
        *_near_rows(validation, near.distances, "m", 4),
        f"  smallest collision times of any two bodies under the commands that both hold, below "
        f"{LOOK:g} s",
        "  (that of a run's summary is of the robots considered, under the command chosen)",
        *_near_rows(validation, near.times, "s", 3),
    ]


def _near_rows(
    validation: Validation, some: tuple[NearMiss, ...], unit: str, digits: int
) -> list[str]:
    names = validation.names
    lines = []
    for one in some:
        duty = one.along and f" {one.along}"
        if one.behind is not None:
            duty = f" ({names[one.behind]} had to give way)"
        lines.append(
            f"    {one.value:8.{digits}f} {unit}  at {one.time:8.2f} s  "
            f"{names[one.a]} and {names[one.b]}{duty}"
        )
    return lines or ["    none"]
