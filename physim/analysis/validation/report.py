"""The report of a validation as plain text, like one that a safety engineer would file."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from statistics import median

from physim.analysis.validation.comparison import Confusion
from physim.analysis.validation.contact import Contact
from physim.analysis.validation.finding import SLACK, UNEXPLAINED
from physim.analysis.validation.near_misses import LOOK, NearMiss
from physim.analysis.validation.prediction import AGREES, Prediction
from physim.analysis.validation.told import sentences, wrapped
from physim.analysis.validation.validation import Validation
from physim.errors import plural
from physim.record.layout import STANDING
from physim.tolerances import CONTACT, ONE_STEP
from physim.units import amount, joined, length, span

MOST_LISTED = 20
"""Disagreements of one sort, and predictions, that are listed one by one"""
MOST_PAIRS = 5
"""Pairs that have a line unless all is told"""
MOST_TOLD, MOST_TOLD_IN_FULL = 3, 100
"""Contacts that are told in sentences"""
BEFORE = 2.0
"""[s] before the first contact from which a branch is proposed"""
MOST_NAMED = 6
"""Boundaries and obstacles that are named"""
ENDS = {
    "finished": "all robots arrived",
    "duration": "ran for its whole duration",
    "interrupted": "INTERRUPTED: checked as far as it was recorded",
    "error": "BROKE OFF WITH AN ERROR: checked as far as it was recorded",
    "running": "KILLED: checked as far as it was recorded",
}


def report(validation: Validation, full: bool = False) -> str:
    """The report of one run, ending with the verdict and a line break.

    ``full`` adds what one does not read first: more contacts, the tables of the ledgers and of
    predictions, near misses, expectations that held, versions.
    """
    parts = [
        _head(validation, full),
        _contacts(validation, full),
        [*_checks(validation, full), *_disagreements(validation)],
        _expectations(validation, full),
        *([_predictions(validation)] if full and validation.run.setup.judged is None else []),
        *([_near_misses(validation)] if full else []),
        [*warning_lines(validation), f"verdict: {validation.verdict}"],
    ]
    return "\n\n".join("\n".join(part) for part in parts if part) + "\n"


def warning_lines(validation: Validation) -> list[str]:
    """What makes a verdict doubtful: contacts that are too deep, checks that could not be made."""
    names = validation.names
    deep = [("  WARNING  ", one.sentence(names)) for one in validation.deep]
    left_out = [("  NOT CHECKED  ", one) for one in validation.recomputed.left_out]
    return [line for head, said in deep + left_out for line in wrapped(said, head, len(head) * " ")]


def _head(validation: Validation, full: bool) -> list[str]:
    """What was run: world, controller and stages with their settings, and how it ended."""
    run = validation.run
    others = [body.name for body in run.bodies[run.robots :]]
    walls = joined(others) if others else "no boundaries"
    if len(others) > MOST_NAMED:
        movers = "movers, " * any(body.kind == "mover" for body in run.bodies)
        walls = f"{len(others)} {movers}boundaries and obstacles"
    (kind, controller), *stages = run.setup.lines()
    if kind in dict(run.given) and len(run.setup.controllers) == 1:  # else the module tells
        controller += ", given from Python"
    begun = f"begun at {run.begun:.2f} s, " if run.begun else ""
    end = f"of at most {run.planned:g} s, step {run.dt:g} s; {ENDS.get(run.ended, run.ended)}"
    if run.setup.judged is not None:
        end = f"of the log, step {run.dt:g} s"
    lines = [
        "COLLISION SAFETY REPORT",
        f"  run         {run.name}, seed {run.seed}: {plural(run.robots, 'robot')}, {walls}",
        f"  record      {run.source}",
        *(
            line
            for label, text in ((kind, controller), *stages)
            for line in wrapped(f"{label:<11} {text}", "  ", 14 * " ")
        ),
        f"  time        {begun}{run.seconds:.2f} s {end}",
    ]
    made = run.setup.made_with
    return [*lines, f"  made by     {made}"] if made and full else lines


def _contacts(validation: Validation, full: bool) -> list[str]:
    """How many contacts, a line for each pair that touched, and the worst in sentences."""
    run, names = validation.run, validation.names
    every = sorted(
        (*validation.contacts, *validation.grazes), key=lambda one: one.hardness, reverse=True
    )
    if not every:
        near, lead = validation.near_misses, f"CONTACTS: none in {run.seconds:.2f} s"
        some = (near.smallest_robots, near.smallest_boundary)
        nearest = "; ".join(_nearest(one, names) for one in some if one is not None)
        return [lead, *wrapped(f"nearest: {nearest or 'nothing'}", "  ", "    ")]
    robots, first = sum(one.b < run.robots for one in every), min(every, key=lambda one: one.time)
    walls, movers = sum(one.b >= run.moving for one in every), ""
    if run.moving > run.robots:
        movers = f"{len(every) - robots - walls} with movers or what can be pushed, "
    head = (
        f"CONTACTS: {robots} between robots, {movers}{walls} with boundaries or obstacles, "
        f"in {run.seconds:.2f} s, first {first.when}, {names[first.a]} and {names[first.b]}"
    )
    lines = wrapped(head, "", "  ")
    if swept := len(validation.grazes):
        why = "where the engine does not look" if run.setup.judged is None else "apart at both"
        lines.append(f"  {swept} of them between samples, {why}")
    pairs: dict[tuple[int, int], list[Contact]] = {}
    for one in every:
        pairs.setdefault((one.a, one.b), []).append(one)
    lines += _pair_rows(pairs, names, len(pairs) if full else MOST_PAIRS)
    kinds = {run.bodies[one.b].kind for one in every} if run.setup.judged is None else set()
    if not kinds.isdisjoint(STANDING):
        lines.append("  With a boundary or obstacle the robot is responsible: it must keep clear.")
    if "mover" in kinds:
        said = (
            "With a mover the robot is responsible unless it stood: a mover gives way to nobody. "
            "Where the robot stood, the mover ran into it."
        )
        lines += wrapped(said, "  ", "    ")
    if command := _branch(validation, first.time):
        lines.append(f"  Go on from before the first, with a change: {command}")
    if validation.undisturbed is not None:
        for text in validation.undisturbed.sentences(names, full):
            lines += wrapped(text, "  ", "    ")
    told = every[:MOST_TOLD_IN_FULL] if full else [some[0] for some in pairs.values()][:MOST_TOLD]
    for one in told:
        said = " ".join(sentences(one, names, run.considered))
        lines += wrapped(said, "  - ", "    ")
    if left := len(every) - len(told):
        lines.append(
            f"  and {left} more ({'--json FILE has all' if full else '--full prints them'})"
        )
    return lines


def _branch(validation: Validation, time: float) -> str:
    """The command that goes on from before a moment [s] of a run in a file; else empty."""
    run = validation.run
    if run.setup.judged is not None or Path(run.source).suffix not in (".h5", ".hdf5"):
        return ""
    at = max(run.begun, round((time - BEFORE) / run.dt) * run.dt)
    own = f" --original {run.controller}" if ":" in run.controller else ""
    return f"physim branch {shlex.quote(run.source)} --at {at:.10g}{own}"


def _nearest(one: NearMiss, names: list[str]) -> str:
    """How near two bodies came; a negative distance is an overlap."""
    near = f"came within {length(one.value)}"
    if one.value < -CONTACT:
        near = f"overlapped by {length(-one.value)}"
    along = one.along and f", {one.along}"
    return f"{' and '.join(names[body] for body in one.bodies)} {near} at {one.time:.2f} s{along}"


def _pair_rows(
    pairs: dict[tuple[int, int], list[Contact]], names: list[str], most: int
) -> list[str]:
    """A table of the pairs that touched; each has its worst contact first."""
    width = max(len(f"{names[a]} and {names[b]}") for a, b in pairs)
    first = {
        key: min(some, key=lambda one: one.time).when.removeprefix("at ")
        for key, some in pairs.items()
    }
    head = "first at"
    wide = max(map(len, [head, *first.values()]))
    head = f"{head:>{wide}}  in contact   closing  deepest        impulse   responsible"
    lines = [f"  {'worst first':<{width}}  contacts  {head}"]
    for (a, b), some in list(pairs.items())[:most]:
        who = sorted({i for one in some for i in one.responsible})
        closing = some[0].severity.closing
        speed = f"{closing:.2f} m/s" if isfinite(closing) else "-"
        lines.append(
            f"  {f'{names[a]} and {names[b]}':<{width}}  {len(some):>8}"
            f"  {first[a, b]:>{wide}}"
            f"  {sum(one.duration for one in some):>8.2f} s"
            f"  {speed:>8}"
            f"  {length(max(one.depth for one in some)):>7}"
            f"  {_impulses(some):>13}"
            f"   {joined([names[i] for i in who] or [''])}".rstrip()
        )
    left = len(pairs) - most
    return [*lines, f"  and {plural(left, 'more pair')}"] if left > 0 else lines


def _impulses(some: list[Contact]) -> str:
    """All that two bodies exchanged; of a log that is not known."""
    known = [one.impulse for one in some if one.impulse is not None]
    return amount(sum(known), "N s", 0) if known else "-"


def _checks(validation: Validation, full: bool) -> list[str]:
    """What was checked, and the result; in full with the tables of the ledgers."""
    comparison, motion, done = validation.comparison, validation.motion, validation.recomputed
    if validation.run.setup.judged is not None:
        told = "CHECKS: contacts against exact distances of the poses, every pair at every step"
        return [told, *(["  A single robot: there are no pairs."] * (validation.run.robots == 1))]
    lines = ["CHECKS: physical contacts against exact distances, every pair at every step"]
    if full:
        lines += [
            f"  {'':<34}{'both':>10}{'physical':>10}{'analytic':>10}{'neither':>14}",
            f"  {'':<34}{'contact':>10}{'only':>10}{'only':>10}",
        ]
        for kind, label in (
            ("robots", "robot and robot"), ("movers", "with movers or pushed"),
            ("boundaries", "robot and boundary"),
        ):  # fmt: skip
            row = comparison.at_samples.get(kind, Confusion(0, 0, 0, 0))
            if any(row):
                cells = f"{row.both:>10,}{row.physical_only:>10,}{row.analytic_only:>10,}"
                lines.append(f"  {f'{label}, at samples':<34}{cells}{row.neither:>14,}")
    said = []
    if comparison.rejected:
        times = "once" if comparison.rejected == 1 else f"{comparison.rejected:,} times"
        said.append(
            f"The engine reported a contact of shapes that were apart {times}; the exact check "
            "rejected it."
        )
    off, far = len(motion.off), len(motion.far)
    kinds, ways = "robots that touch nothing", "the arcs of their applied commands"
    if validation.run.moving > validation.run.robots:
        kinds, ways = "movers and of what touches nothing", f"their paths, or {ways}"
    said.append(
        f"Motion: {motion.checked:,} steps of {kinds}, compared with {ways}: "
        f"{f'{off} DIFFER' if off else f'all agree within {ONE_STEP:g} m'}."
    )
    if motion.held:
        said.append(
            f"Motion in contact: {motion.held:,} steps compared with the energy of the commands: "
            f"{f'{far} TOO FAR' if far else 'none is too far'}."
        )
    wrong, made = len(done.mismatches), ""
    if done.replayed:
        kind = validation.run.controller
        made = f", {done.replayed:,} of them made again by {kind} from what it sensed"
    result = f"{wrong} {'DIFFER' if wrong > 1 else 'DIFFERS'}" if wrong else "all agree"
    said.append(
        f"Decisions: {done.decisions:,}{made}. Commands, their limits and stages: {result}."
    )
    if validation.run.robots == 1:
        said.append("A single robot: there are no pairs of robots.")
    said += _again(validation)
    return [*lines, *(line for text in said for line in wrapped(text, "  ", "    "))]


def _again(validation: Validation) -> Iterator[str]:
    """What came of simulating the run again."""
    again = validation.rerun
    if again is None:
        return
    if again.difference is not None:
        yield "Simulated again: A DIFFERENT RUN, see below."
    elif again.same_digest:
        yield f"Simulated again: the same run, bit for bit, digest {again.digest}."
    elif again.exact:
        yield (
            f"Simulated again: the same values, bit for bit, in all {again.until:.2f} s of the "
            "record."
        )
    else:
        up_to = "" if again.whole else f", up to the first contact after {again.until:.2f} s"
        yield (
            "Simulated again with other versions than those that made the record "
            f"({validation.run.setup.made_with or 'unknown'}): the same within {SLACK:g}{up_to}."
        )


def _disagreements(validation: Validation) -> list[str]:
    """Every disagreement on a line of its own, `MOST_LISTED` of each sort."""
    sorts = validation.findings
    every = [one for sort in sorts for one in sort]
    if not every:
        return ["DISAGREEMENTS: none"]
    wrong = sum(one.cause == UNEXPLAINED for one in every)
    lines = [f"DISAGREEMENTS: {len(every)}, of which {wrong} unexplained"]
    for one in (one for sort in sorts for one in sort[:MOST_LISTED]):
        when = "" if one.time is None else f"{one.time:9.4f} s  "
        who = " and ".join(validation.names[body] for body in one.bodies)
        who += f", signed distance {one.distance:.3g} m" if isfinite(one.distance) else ""
        lasts = f" for {one.steps} samples" if one.steps > 1 else ""
        lines += wrapped(f"{when}{who}{': ' if who else ''}{one.words}{lasts}", "  ", 15 * " ")
    left = sum(len(sort[MOST_LISTED:]) for sort in sorts)
    return [*lines, f"  and {left} more (--json FILE has all)"] if left else lines


def _expectations(validation: Validation, full: bool) -> list[str]:
    """What the world expects and was not found, or all of it; nothing where it expects nothing."""
    if not validation.expectations:
        return []
    missed = len(validation.missed)
    head = f"EXPECTED: {missed} NOT HELD" if missed else "EXPECTED: all held"
    shown = validation.expectations if full else validation.missed
    return [head, *(f"  {one.key:<22} {one}" for one in shown)]


def _predictions(validation: Validation) -> list[str]:
    """Table of first contacts, and errors at the last decision."""
    every = [one.prediction for one in validation.contacts if one.prediction is not None]
    if not every:
        return []
    names = validation.names
    lines = [
        "FIRST CONTACT: predicted (collision time + time of prediction) against physical",
        f"  {'':<4}{'predicted at':>13}{'contact due':>14}{'touched':>14}{'seen at':>10}"
        f"{'error':>12}   pair",
    ]
    first: dict[tuple[int, int], tuple[int, Prediction]] = {}
    for number, p in enumerate(every, 1):
        first.setdefault((p.a, p.b), (number, p))
    for number, p in list(first.values())[:MOST_LISTED]:
        made = "-" if p.made is None else f"{p.made:.2f} s"
        error = "-" if p.error is None or not isfinite(p.error) else span(p.error)
        pair = f"{names[p.a]} and {names[p.b]}"
        note = "" if p.verdict == AGREES else f"  ({p.verdict})"
        lines.append(
            f"  {number:<4}{made:>13}{p.due_text(6):>14}{p.touched:>12.6f} s{p.found:>8.2f} s"
            f"{error:>12}   {pair}{note}"
        )
    compared = [p for p in every if p.error is not None]
    if not compared:
        lines.append("  At the last decision: none of them can be compared.")
    else:
        same = sum(p.verdict == AGREES for p in compared)
        share = f"{same} of {len(compared)}"
        lines.append(f"  Predicted by the last decision before contact: {share} in that step.")
        if sizes := [abs(p.error) for p in compared if p.error is not None and isfinite(p.error)]:
            lines.append(
                f"  Error: median {span(median(sizes))}, largest {span(max(sizes))}; between "
                "samples robots move on chords."
            )
        if left := len(every) - len(compared):
            lines.append(
                f"  {left} more cannot be compared: a robot in contact does not move as commanded."
            )
    return lines


def _near_misses(validation: Validation) -> list[str]:
    near, names = validation.near_misses, validation.names

    def rows(some: tuple[NearMiss, ...], unit: str, digits: int) -> Iterator[str]:
        for one in some:
            duty = one.along and f" {one.along}"
            if one.behind is not None:
                duty = f" ({names[one.behind]} had to give way)"
            yield (
                f"    {one.value:8.{digits}f} {unit}  at {one.time:8.2f} s  "
                f"{' and '.join(names[body] for body in one.bodies)}{duty}"
            )
        if not some:
            yield "    none"

    held = [
        "  smallest collision times of any two bodies under the commands that both hold, below "
        f"{LOOK:g} s",
        "  (the summary has the one with the robots considered, under the command chosen)",
    ]
    if validation.run.setup.judged is not None:
        held = [f"  smallest collision times of two bodies that go on as seen, below {LOOK:g} s"]
    return [
        "NEAR MISSES (of pairs that never touched, the smallest of each)",
        f"  smallest distances, below {near.reach:.2f} m",
        *rows(near.distances, "m", 4),
        *held,
        *rows(near.times, "s", 3),
    ]
