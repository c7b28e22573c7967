"""What is said of how much a world can bear: sentences, a table, a picture, values for `--json`."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from physim.campaigns.bear import Borne
from physim.campaigns.measures import RATE_TITLES
from physim.campaigns.report.text import Table
from physim.drawing.plots.strengths import strengths
from physim.statistics import Decision
from physim.units import count, interval, joined, percent

VERDICTS = {True: "met", False: "missed", None: "undecided"}


def borne_text(found: Borne) -> str:
    """A table of the strengths that were tried, then what they say."""
    good, target = RATE_TITLES[found.goal.rate], _share(found.goal.number)
    rows = [
        (
            f"{strength:g}", count(one.runs), percent(_rate(one)), interval(one.low, one.high),
            VERDICTS[one.holds],
        )
        for strength, one in found.tried
    ]  # fmt: skip
    head = (found.vary, "runs", good, "interval", f"{target} is")
    return "\n".join([str(Table("", head, rows)), "", *sentences(found)]) + "\n"


def sentences(found: Borne) -> list[str]:
    """What the strengths say, a line each: the bracket, what is open, rises that were noticed."""
    good, target = RATE_TITLES[found.goal.rate], _share(found.goal.number)
    least, most = found.strengths[0], found.strengths[-1]
    lower, upper = found.bracket
    said = ["interrupted: this is what the runs until then say"] * found.interrupted
    if lower is not None:
        said.append(f"{found.vary} = {lower:g}: at least {target} of runs are {good}")
    if upper is not None:
        said.append(f"{found.vary} = {upper:g}: fewer than {target} of runs are {good}")
    if lower is not None and upper is not None:
        said.append("The limit is between the two, if the rate falls as the strength grows.")
    elif lower == most:
        said.append("The world bears the greatest strength; a greater --most may find its limit.")
    elif upper == least:
        said.append("The target is missed even at the least strength.")
    else:
        said.append("The limit is not found: the rest is undecided.")
    near = [f"{strength:g}" for strength, one in found.tried if one.holds is None]
    if near and not found.interrupted:
        said.append(
            f"At {joined(near)} the rate is too near the target to be decided with these seeds; "
            "more --seeds may decide it."
        )
    said += [
        f"NOTE: the rate is higher at {after:g} than at {before:g}: it does not only fall, and "
        "there may be limits outside of the bracket."
        for before, after in found.rises[:1]
    ]
    said.append(
        f"All intervals hold together with a confidence of {_share(found.confidence)}, whichever "
        f"of the {len(found.strengths)} strengths from {least:g} to {most:g} are tried."
    )
    return said


def borne_values(found: Borne) -> dict[str, Any]:
    """The same for programs; shares are from 0 to 1."""
    lower, upper = found.bracket
    return {
        "format": "physim-bear",
        "version": 1,
        "world": found.world,
        "controller": found.controller,
        "vary": found.vary,
        "rate": found.goal.rate,
        "target": found.goal.number,
        "confidence": found.confidence,
        "lower": lower,
        "upper": upper,
        "interrupted": found.interrupted,
        "said": sentences(found),
        "strengths": found.strengths,
        "tried": [
            {"strength": strength, "rate": _rate(one), **asdict(one)}
            for strength, one in found.tried
        ],
    }


def picture(found: Borne) -> Any:
    """Figure of the rates over the strengths."""
    good = RATE_TITLES[found.goal.rate]
    return strengths(
        found.tried, found.goal.number, found.bracket, (found.strengths[0], found.strengths[-1]),
        title=f"{found.world}, {found.controller}",
        source=f"intervals hold together with a confidence of {_share(found.confidence)}",
        strength=f"{found.vary} {found.unit}".strip(), rate=f"runs {good}",
    )  # fmt: skip


def _rate(one: Decision) -> float:
    """Share of runs that were good; nan before the first."""
    return one.successes / one.runs if one.runs else float("nan")


def _share(number: float) -> str:
    """``95 %``, ``99.9 %``: a share that somebody chose."""
    return f"{100.0 * number:.10g} %"
