"""Numbers as reports write them, nothing near 100 % made 100 %; and which intervals are meant."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from physim.campaigns.asked import Missing
from physim.campaigns.report.contents import MEASURES, SEVERITY, SHOWN, Rate, Report, Robots
from physim.errors import decimal_text, plural
from physim.statistics import Decision, Goal

RATE_NAMES = {
    "rate": "contact-free and finished",
    "contact_free": "contact-free",
    "finished": "finished",
}
SHARES = ("danger_share",)
"""Measures that are written as shares."""
FEWEST_DIGITS, MOST_DIGITS = 1, 4
SEVERITY_UNITS = [(name, MEASURES[name][1]) for name in SEVERITY]
MOST_ROBOTS = 6
"""that are named of those that did not arrive"""
MOST_MISSING = 3
"""Cells of which is told what they lack"""
LARGE = 1e9
"""from which on values have an exponent"""


def digits_for(*shares: float) -> int:
    """Decimals of percentages with which shares near 0 and 1 can be told from these."""
    inside = [min(share, 1.0 - share) for share in shares if 0.0 < share < 1.0]
    if not inside or min(inside) >= 0.01:
        return FEWEST_DIGITS
    return min(MOST_DIGITS, max(FEWEST_DIGITS, -math.floor(math.log10(min(inside)) + 1e-9) - 2))


def percent(share: float, digits: int | None = None, side: int = 0) -> str:
    """``99.9 %``; rounded down for a ``side`` of -1, up for 1, else to the nearest.

    What is neither 0 nor 1 is not written as 0 % or 100 % where up to four decimals can help it.
    """
    if math.isnan(share):
        return "-"
    digits = digits_for(share) if digits is None else digits
    scaled = share * 100.0 * 10**digits
    slack = 1e-9 * max(1.0, abs(scaled))
    whole = (
        math.floor(scaled + slack) if side < 0
        else math.ceil(scaled - slack) if side > 0
        else round(scaled)
    )  # fmt: skip
    return f"{whole / 10**digits:.{digits}f} %"


def interval(low: float, high: float) -> str:
    """``[96.3 %, 100.0 %]``, both ends rounded outward."""
    digits = digits_for(low, high)
    return f"[{percent(low, digits, -1)}, {percent(high, digits, 1)}]"


def note_of(rate: Rate) -> str:
    """What a single run tells, or what it means that none went wrong; else empty."""
    if rate.of == 1:
        return (
            "one run: where nothing in the world is random it is all there is, and the interval "
            "tells nothing"
        )
    if rate.at_most is None or rate.needed is None:
        return ""
    most = percent(rate.at_most, None, 1)
    few = f"{number(rate.good)} of {number(rate.of)}: at most {most} go wrong"
    more, shown = rate.needed - rate.of, percent(SHOWN)
    if more > 0:
        return f"{few}; {number(more)} more, none of which does, would show {shown}"
    return f"{few}, which shows {shown}"


def over_seeds(runs: int, draws: str) -> str:
    """``over 100 seeds, which draw the starts``; empty where nothing is drawn."""
    return f"over {number(runs)} seeds, which draw {draws}" if draws and runs > 1 else ""


def of_cells(report: Report) -> str:
    """``, all of 1 of 6 cells``: where the worst runs leave cells out."""
    among, cells = report.cells_of_worst, len(report.cells)
    return f", all of {among} of {cells} cells" if among < cells else ""


def missing_words(missing: Sequence[Missing]) -> str:
    """What a campaign was asked for and has no rows of; empty where it has all."""
    if not missing:
        return ""
    few = "; ".join(
        f"{', '.join(filter(None, one.cell))}: {number(one.runs)} of {number(one.of)}"
        for one in missing[:MOST_MISSING]
    )
    more = len(missing) - MOST_MISSING
    rest = f"; {plural(more, 'further cell')}" if more > 0 else ""
    return (
        f"Not complete: {number(sum(one.runs for one in missing))} of the runs that were asked for "
        f"have no row ({few}{rest}). The sweep is under way, was interrupted or lacks a shard; the "
        "same command does the rest."
    )


def number(count: int) -> str:
    """``12,345``."""
    return f"{count:,}"


def amount(value: float, unit: str) -> str:
    """A measured value with its unit: three decimals of metres (up to six where it is small), two
    of seconds, whole counts, four digits of others and of what is very large."""
    if math.isnan(value):
        return "-"
    if math.isinf(value):
        return "unbounded"
    if abs(value) >= LARGE:
        large = f"{value:.4g}".replace("e+0", "e").replace("e+", "e")
        return f"{large} {unit}".rstrip()
    digits = {"m": 3, "s": 2}.get(unit)
    if digits is None:
        is_large = float(value).is_integer() or abs(value) >= 1000.0
        text = f"{value:,.1f}".removesuffix(".0") if is_large else f"{value:.4g}"
        return f"{text} {unit}".rstrip()
    text = decimal_text(value, digits, 6 if unit == "m" else digits)
    return f"{0.0:.{digits}f} {unit}" if float(text) == 0.0 else f"{text} {unit}"


def measured(name: str, value: float, unit: str) -> str:
    """`amount`, shares as percentages."""
    return percent(value) if name in SHARES else amount(value, unit)


def method(goal: Goal | None) -> str:
    """Which intervals these are, and why; one paragraph."""
    if goal is None:
        return (
            "95 % intervals are exact (Clopper and Pearson), for a number of runs fixed in advance."
            " They do not hold where a campaign was stopped because of what it showed; those of "
            "physim sweep --until do."
        )
    return (
        "95 % intervals are a confidence sequence (beta-binomial mixture): this campaign ran until "
        f"{goal_words(goal)} (--until), so it was looked at after every run, and these hold at "
        "every look. Exact intervals, for a number of runs fixed in advance, would be narrower and "
        "would not hold. Of each cell the first runs that decide count, in the order of seeds."
    )


def goal_words(goal: Goal) -> str:
    """What was to be known."""
    if not goal.sign:
        return f"the interval of the {goal.rate} was at most {percent(goal.number)} wide"
    than = "above" if goal.sign == ">" else "below"
    name = "rate" if goal.rate == "rate" else f"rate of {RATE_NAMES[goal.rate]} runs"
    return f"it was decided whether the {name} is {than} {percent(goal.number)}"


def decision_words(decision: Decision, goal: Goal) -> str:
    """What came of a goal in a cell."""
    runs = plural(decision.runs, "run")
    if not decision.decided:
        return f"undecided after {runs}"
    if decision.holds is None:
        return f"narrow enough after {runs}"
    than = "above" if (goal.sign == ">") == decision.holds else "below"
    return f"decided after {runs}: {RATE_NAMES[goal.rate]} {than} {percent(goal.number)}"


def severity_words(row: Mapping[str, Any]) -> str:
    """How hard the severest contact of a run was, or how near anything came."""
    known = [(name, unit) for name, unit in SEVERITY_UNITS if row[name] is not None]
    if known:
        return ", ".join(amount(float(f"{row[name]:.3g}"), unit) for name, unit in known)
    if row["contacts"] or row["grazes"]:
        return "contact"
    return amount(row["least_distance"], "m").replace("-", "−")


def pair_and_time(row: Mapping[str, Any]) -> tuple[str, float | None]:
    """Whose the severest contact of a run was and when [s], or else the least distance."""
    of = "least_distance" if row["severest_contact_time"] is None else "severest_contact"
    return row[f"{of}_pair"] or "", row[f"{of}_time"]


def robots_words(stood: Robots, moved: Robots, runs: int) -> str:
    """Which robots stood short of their stops and which still moved, each in how many runs."""
    parts = [
        f"{verb}: {_often(names, runs)}"
        for verb, names in (("stood", stood), ("still moved", moved))
        if names
    ]
    return "; ".join(parts) or "robots not known"


def _often(names: Robots, runs: int) -> str:
    shown = [name if runs == 1 else f"{name} ({number(count)})" for name, count in names]
    more = len(shown) - MOST_ROBOTS
    return ", ".join(shown[:MOST_ROBOTS]) + (f" and {number(more)} more" if more > 0 else "")
