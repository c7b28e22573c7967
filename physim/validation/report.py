"""The report of a validation as plain text, like one that a safety engineer would file."""

from __future__ import annotations

from physim.validation.checks_text import (
    check_lines,
    disagreement_lines,
    expectation_lines,
)
from physim.validation.contact_text import contact_lines, opening, table_lines
from physim.validation.near_misses import LOOK, NearMiss
from physim.validation.numbers import listed, wrapped
from physim.validation.prediction_text import prediction_lines
from physim.validation.validation import Validation


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
    made = ", ".join(f"{name} {version}" for name, version in sorted(run.versions.items()))
    return [*lines, f"  made by     {made}"] if made else lines


def _contacts(validation: Validation) -> list[str]:
    if not validation.contacts:
        return []
    return ["CONTACTS", *table_lines(validation), *contact_lines(validation)]


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
    names = validation.names
    lines = []
    for one in some:
        duty = "" if one.behind is None else f" ({names[one.behind]} had to give way)"
        lines.append(
            f"    {one.value:8.{digits}f} {unit}  at {one.time:8.2f} s  "
            f"{names[one.a]} and {names[one.b]}{duty}"
        )
    return lines or ["    none"]
