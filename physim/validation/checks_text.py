"""The checks of a validation in words: what was compared with what, and what does not agree."""

from __future__ import annotations

from math import isfinite

from physim.errors import plural
from physim.tolerances import ONE_STEP
from physim.validation.findings import UNEXPLAINED
from physim.validation.mismatch import SLACK
from physim.validation.numbers import joined, wrapped
from physim.validation.validation import Validation, confusions

SHOWN = 20
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
    strays = len(validation.motion.strays)
    said.append(
        f"Motion: {validation.motion.checked:,} steps of robots that touch nothing, held against "
        "the arcs of their applied commands: "
        f"{f'{strays} DIFFER' if strays else f'all agree within {ONE_STEP:g} m'}."
    )
    said += _decisions(validation)
    if not validation.origin.held:
        said.append("World: the record holds no text of its world; nothing is compared with it.")
    if run.robots == 1:
        said.append("A single robot: there are no pairs of robots.")
    said += _again(validation)
    return [*lines, *(line for text in said for line in wrapped(text, "  ", "    "))]


def _decisions(validation: Validation) -> list[str]:
    """What was computed of decisions, commands and the end, and what was not."""
    found = validation.recomputed
    parts = ["stations and formation errors"]
    if found.replayed:
        kind = validation.run.controller
        parts.append(f"{found.replayed:,} made again by {kind} from what it saw")
    if found.columns:
        columns = joined([name.replace("_", " ") for name in found.columns])
        parts.append(f"{columns} computed from the shapes")
    wrong = len(found.mismatches)
    result = f"{wrong} {'DIFFER' if wrong > 1 else 'DIFFERS'}" if wrong else "all agree"
    lines = [
        f"Decisions: {found.decisions:,}: {'; '.join(parts)}. Commands, their limits and stages, "
        f"arrival and the end of the run: {result}."
    ]
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
    """Every disagreement on a line of its own, `SHOWN` of each sort."""
    names = validation.names
    sorts = [
        [f"unexplained: {told}" for told in validation.origin.differences],
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
        for told in sort[:SHOWN]:
            lines += wrapped(told, "  ", 15 * " ")
    left = sum(len(sort[SHOWN:]) for sort in sorts)
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
            f"{stray.time:9.4f} s  {names[stray.robot]}: unexplained (it touches nothing, yet its "
            f"pose is {stray.gap:.3g} m and {stray.turn:.3g} rad from where its command leads from "
            f"the sample before{long})"
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
    head = f"EXPECTED: {plural(missed, 'thing')} not so" if missed else "EXPECTED: all of it"
    return [head, *(f"  {one.key:<22} {one}" for one in validation.expectations)]
