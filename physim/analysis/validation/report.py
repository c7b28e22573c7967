"""The report of a validation as plain text, like one that a safety engineer would file."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

import numpy as np

from physim.analysis.validation.contact import Contact
from physim.analysis.validation.comparison import UNEXPLAINED
from physim.analysis.validation.mismatch import SLACK
from physim.analysis.validation.near_misses import LOOK, PARTED, TOGETHER, NearMiss
from physim.analysis.validation.prediction import AGREES, DISAGREES, Early, Prediction
from physim.analysis.validation.told import joined, length, sentences, short, wrapped
from physim.analysis.validation.validation import Run, Validation, confusions
from physim.errors import amount_text
from physim.tolerances import CONTACT, ONE_STEP

MOST_LISTED = 20
"""Disagreements of one sort, and predictions, that are listed one by one"""
MOST_PAIRS = 5
"""Pairs that have a line unless all is told"""
MOST_TOLD, MOST_TOLD_IN_FULL = 3, 100
"""Contacts that are told in sentences"""
MOST_NAMED = 6
"""Boundaries and obstacles that are named"""
LEADS = (0.0, 0.1, 0.5, 1.0, 2.0, 5.0, 10.0)
"""[s] edges of the table of lead times"""


def check_lines(validation: Validation, full: bool) -> list[str]:
    """What was checked, and the result; in full with the tables of the ledgers."""
    comparison, run = validation.comparison, validation.run
    lines = ["CHECKS: physical contacts against exact distances, every pair at every step"]
    if full:
        lines += [
            f"  {'':<34}{'both':>10}{'physical':>10}{'analytic':>10}{'neither':>14}",
            f"  {'':<34}{'contact':>10}{'only':>10}{'only':>10}",
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
    for p in validation.mispredicted:
        due = "none" if p.predicted is None or p.predicted > 1e9 else f"{p.predicted:.4f} s"
        lines.append(
            f"{p.found:9.4f} s  {names[p.a]} and {names[p.b]}: unexplained (first touch at "
            f"{p.touched:.6f} s, but contact predicted at {p.made:.2f} s: {due})"
        )
    return lines


def expectation_lines(validation: Validation, full: bool) -> list[str]:
    """What the world expects and was not found, or all of it; nothing where it expects nothing."""
    if not validation.expectations:
        return []
    missed = len(validation.missed)
    head = f"EXPECTED: {missed} NOT HELD" if missed else "EXPECTED: all held"
    shown = validation.expectations if full else validation.missed
    return [head, *(f"  {one.key:<22} {one}" for one in shown)]


def report(validation: Validation, full: bool = False) -> str:
    """The report of one run, ending with the verdict and a line break.

    ``full`` adds what one does not read first: more contacts, the tables of the ledgers and of
    predictions, near misses, expectations that held, versions.
    """
    parts = [
        _head(validation, full),
        _contacts(validation, full),
        [*check_lines(validation, full), *disagreement_lines(validation)],
        expectation_lines(validation, full),
        *([prediction_lines(validation), _near_misses(validation)] if full else []),
        [*warning_lines(validation), f"verdict: {validation.verdict}"],
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


def _head(validation: Validation, full: bool) -> list[str]:
    run = validation.run
    robots = "1 robot" if run.robots == 1 else f"{run.robots} robots"
    others = [body.name for body in run.bodies[run.robots :]]
    walls = joined(others) or "no boundaries"
    if len(others) > MOST_NAMED:
        walls = f"{len(others)} boundaries and obstacles"
    ends = {
        "finished": "all robots arrived",
        "duration": "ran for its whole duration",
        "interrupted": "INTERRUPTED: checked as far as it was recorded",
        "error": "BROKE OFF WITH AN ERROR: checked as far as it was recorded",
        "running": "KILLED: checked as far as it was recorded",
    }
    lines = [
        "COLLISION SAFETY REPORT",
        f"  run         {run.name}, seed {run.seed}: {robots}, {walls}",
        f"  record      {run.source}",
        *_parts(run),
        f"  time        {run.seconds:.2f} s of at most {run.planned:g} s, step {run.dt:g} s; "
        f"{ends.get(run.ended, run.ended)}",
    ]
    made = ", ".join(f"{name} {version}" for name, version in sorted(run.versions.items()))
    return [*lines, f"  made by     {made}"] if made and full else lines


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


def _contacts(validation: Validation, full: bool) -> list[str]:
    """How many contacts, a line for each pair that touched, and the worst in sentences."""
    run, names = validation.run, validation.names
    every = sorted(
        (*validation.contacts, *validation.grazes), key=lambda one: one.hardness, reverse=True
    )
    if not every:
        near = validation.near_misses
        nearest = [
            f"{names[one.a]} and {names[one.b]} {_came(one.value)} at {one.time:.2f} s"
            f"{one.along and f', {one.along}'}"
            for one in (near.smallest_robots, near.smallest_boundary)
            if one is not None
        ]
        lines = wrapped(f"nearest: {'; '.join(nearest) or 'nothing'}", "  ", "    ")
        return [f"CONTACTS: none in {run.seconds:.2f} s", *lines]
    robots = sum(one.b < run.robots for one in every)
    first = min(one.time for one in every)
    head = (
        f"CONTACTS: {robots} between robots, {len(every) - robots} with boundaries or obstacles, "
        f"in {run.seconds:.2f} s, the first at {first:.2f} s"
    )
    lines = wrapped(head, "", "  ")
    if swept := len(validation.grazes):
        lines.append(f"  {swept} of them between samples, where the engine does not look")
    pairs: dict[tuple[int, int], list[Contact]] = {}
    for one in every:
        pairs.setdefault((one.a, one.b), []).append(one)
    lines += _pair_rows(pairs, names, len(pairs) if full else MOST_PAIRS)
    if any(one.b >= run.robots for one in every):
        lines.append(
            "  Responsible with a boundary or obstacle is the robot: it has to keep clear."
        )
    told = every[:MOST_TOLD_IN_FULL] if full else [some[0] for some in pairs.values()][:MOST_TOLD]
    for one in told:
        lines += wrapped(" ".join(sentences(one, names)), "  - ", "    ")
    if left := len(every) - len(told):
        lines.append(
            f"  and {left} more ({'--json FILE has all' if full else '--full tells them'})"
        )
    return lines


def _came(distance: float) -> str:
    """How near two bodies came; a negative distance is an overlap."""
    near = f"came within {length(distance)}"
    return near if distance >= -CONTACT else f"overlapped by {length(-distance)}"


def _pair_rows(
    pairs: dict[tuple[int, int], list[Contact]], names: Sequence[str], most: int
) -> list[str]:
    """A table of the pairs that touched; each has its worst contact first."""
    width = max(len(f"{names[a]} and {names[b]}") for a, b in pairs)
    head = "contacts  first at  in contact   closing  deepest        impulse   responsible"
    lines = [f"  {'worst first':<{width}}  {head}"]
    for (a, b), some in list(pairs.items())[:most]:
        who = sorted({i for one in some for i in one.responsible})
        closing = some[0].severity.closing
        speed = f"{closing:.2f} m/s" if isfinite(closing) else "-"
        lines.append(
            f"  {f'{names[a]} and {names[b]}':<{width}}  {len(some):>8}"
            f"  {min(one.time for one in some):>6.2f} s"
            f"  {sum(one.duration for one in some):>8.2f} s"
            f"  {speed:>8}"
            f"  {length(max(one.depth for one in some)):>7}"
            f"  {amount_text(sum(one.impulse for one in some), 0):>9} N s"
            f"   {joined([names[i] for i in who])}".rstrip()
        )
    left = len(pairs) - most
    return [*lines, f"  and {left} more pairs"] if left > 0 else lines


def prediction_lines(validation: Validation) -> list[str]:
    """Table of first contacts, errors at the last decision, errors by lead time."""
    if not validation.contacts:
        return []
    predictions = [one.prediction for one in validation.contacts if one.prediction is not None]
    return [
        "FIRST CONTACT: predicted (collision time + time of prediction) against physical",
        *_table(validation),
        *_errors(predictions),
        *_by_lead([early for one in predictions for early in one.early]),
    ]


def _table(validation: Validation) -> list[str]:
    names = validation.names
    lines = [
        f"  {'':<4}{'predicted at':>13}{'contact due':>14}{'touched':>14}{'seen at':>10}"
        f"{'error':>12}   pair"
    ]
    first: dict[tuple[int, int], tuple[int, Prediction]] = {}
    for one in validation.contacts:
        if one.prediction is not None:
            first.setdefault((one.a, one.b), (one.number, one.prediction))
    for number, p in list(first.values())[:MOST_LISTED]:
        made = "-" if p.made is None else f"{p.made:.2f} s"
        due = "-" if p.predicted is None else "none"
        if p.predicted is not None and isfinite(p.predicted):
            due = f"{p.predicted:.6f} s"
        error = "-" if p.error is None or not isfinite(p.error) else short(p.error)
        pair = f"{names[p.a]} and {names[p.b]}"
        note = "" if p.verdict == AGREES else f"  ({p.verdict})"
        lines.append(
            f"  {number:<4}{made:>13}{due:>14}{p.touched:>12.6f} s{p.found:>8.2f} s"
            f"{error:>12}   {pair}{note}"
        )
    return lines


def _errors(all_of: list[Prediction]) -> list[str]:
    compared = [p for p in all_of if p.verdict in (AGREES, DISAGREES)]
    if not compared:
        return ["  At the last decision: none of them can be compared."]
    same = sum(p.verdict == AGREES for p in compared)
    errors = np.array([p.error for p in compared if p.error is not None and isfinite(p.error)])
    lines = [
        f"  Predicted by the last decision before contact: {same} of {len(compared)} in that step."
    ]
    if len(errors):
        size = np.abs(errors)
        lines.append(
            f"  Error: median {short(float(np.median(size)))}, "
            f"largest {short(float(size.max()))}; between samples robots move on chords."
        )
    left = len(all_of) - len(compared)
    if left:
        lines.append(
            f"  {left} more cannot be compared: a robot in contact does not move as commanded."
        )
    return lines


def _by_lead(early: list[Early]) -> list[str]:
    if not early:
        return []
    lines = [
        "  Earlier predictions for the first contact of each pair (commands change on the way):",
        "  (foretold: share of decisions after which it would have come, had all kept their "
        "commands)",
        f"  {'lead time':>16}{'decisions':>11}{'foretold':>10}{'median error':>14}{'largest':>12}",
    ]
    for low, high in zip(LEADS[:-1], LEADS[1:], strict=True):
        some = [e for e in early if low <= e.lead < high]
        if some:
            lines.append(_lead_row(low, high, some))
    return lines


def _lead_row(low: float, high: float, some: list[Early]) -> str:
    size = np.abs([e.error for e in some if isfinite(e.error)])
    errors = f"{'-':>14}{'-':>12}"
    if len(size):
        errors = f"{short(float(np.median(size))):>14}{short(float(size.max())):>12}"
    return f"  {f'{low:g} to {high:g} s':>16}{len(some):>11}{len(size) / len(some):>10.0%}{errors}"


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
