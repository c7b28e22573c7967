"""Comparisons as text for the terminal, and as values for `--json`."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from physim.campaigns.compare import ALPHA, FEWEST_PAIRS, Comparison, Finding
from physim.campaigns.report.contents import title_of
from physim.campaigns.report.text import plain, seeds_text
from physim.campaigns.report.wording import RATE_NAMES, SHARES, measured, number, percent
from physim.errors import plural
from physim.escaping import escaped

LOOKED = (
    " Here a campaign was stopped because of what it showed (sweep --until): intervals and p "
    "values are then too sure; compare campaigns of a number of runs fixed in advance."
)


def comparison_text(comparisons: Sequence[Comparison], looked: bool = False) -> str:
    """All comparisons, then how they were made."""
    lines: list[str] = []
    for one in comparisons:
        lines += [*_lines(one), ""]
    lines.append(method(comparisons, looked))
    return "\n".join(lines) + "\n"


def _lines(one: Comparison) -> Iterator[str]:
    yield escaped(f"{headline(one)}{' (' + one.common + ')' if one.common else ''}")
    yield escaped(f"  A {one.a.label}, B {one.b.label}: {told(one)}")
    for difference in one.unlike:
        yield escaped(f"  note: {difference}")
    for f in one.findings:
        unit = unit_of(f)
        a, b = (value_text(f, value, unit) for value in (f.a, f.b))
        yield f"  {title(f):<26}A {a}, B {b}{pairs_text(one, f)}"
        yield f"  {'':<26}{verdict(f)}"


def headline(one: Comparison) -> str:
    """Which arm is better in what; one sentence."""
    said = [
        f"{arm.label} ({side.upper()}) is better in {', '.join(names)}"
        for side, arm in (("a", one.a), ("b", one.b))
        if (names := [title(f) for f in one.findings if f.better == side])
    ]
    if not any(f.is_tested for f in one.findings):
        return "too few pairs to tell"
    rest = ", ".join(title(f) for f in one.findings if not f.better)
    if not said:
        return f"no difference shown, in none of {rest}"
    return "; ".join([*said, *([f"no difference shown in {rest}"] if rest else [])])


def told(one: Comparison) -> str:
    """How many seeds are compared, and what is left out."""
    text = f"{plural(one.seeds, 'seed')} in common"
    if one.seeds == 1:
        text += ": where nothing in the world is random it is all there is"
    for name, seeds in (("A", one.only_a), ("B", one.only_b)):
        if seeds:
            text += (
                f"; {number(len(seeds))} that only {name} has are left out ({seeds_text(seeds)})"
            )
    for name, failed in (("A", one.failed_a), ("B", one.failed_b)):
        if failed:
            text += f"; {plural(failed, 'run')} of {name} crashed"
    return text


def title(found: Finding) -> str:
    """What was looked at."""
    return RATE_NAMES[found.name] if found.is_rate else title_of(found.name)[0]


def is_share(found: Finding) -> bool:
    """Whether its differences are in percentage points."""
    return found.is_rate or found.name in SHARES


def unit_of(found: Finding) -> str:
    """Unit of a measure; empty of rates and shares."""
    return "" if found.is_rate else title_of(found.name)[1]


def value_text(found: Finding, value: float, unit: str) -> str:
    """A rate or a median."""
    return percent(value) if found.is_rate else measured(found.name, value, unit)


def pairs_text(one: Comparison, found: Finding) -> str:
    """Of how many pairs, where not of all."""
    if found.pairs == one.seeds:
        return ""
    both = "both finished" if found.name == "time_to_finish" else "both have one"
    return f" (medians of the {plural(found.pairs, 'pair')} in which {both})"


def verdict(found: Finding) -> str:
    """Which is better and by how much, or that no difference is shown; never that there is none."""
    if not found.is_tested:
        return f"B - A = {difference_text(found)}; {untested(found)}"
    p = f"p {p_text(found.p)}, corrected {p_text(found.corrected)}"
    range_text = interval_text(found)
    if not found.is_rate:
        said = f"{found.better.upper()} is better" if found.better else "no difference shown"
        return f"{said}: {won(found)}; {p}; median of B - A {range_text}"
    if not found.better:
        return f"no difference shown: B - A = {range_text}; {p}"
    sign = -1.0 if found.difference < 0.0 else 1.0
    name = found.better.upper()
    return f"{name} is better by {_size(found, sign)}; {p}"


def won(found: Finding) -> str:
    """With how many seeds each is the better one; of a rate, succeeds alone."""
    what = "alone succeeds" if found.is_rate else "is better"
    ties = f"; {plural(found.ties, 'tie')}" if found.ties and not found.is_rate else ""
    return f"A {what} with {plural(found.only_a, 'seed')}, B with {found.only_b}{ties}"


def untested(found: Finding) -> str:
    """Why a finding of few pairs is not tested."""
    return (
        f"not tested: {plural(found.pairs, 'pair')}; it takes {FEWEST_PAIRS} to show a difference"
    )


def _size(found: Finding, sign: float) -> str:
    """Difference without its sign, with the interval of its size."""
    low, high = sorted((sign * found.low, sign * found.high))
    value, low_text, high_text = (_amount(found, x) for x in (abs(found.difference), low, high))
    return f"{value} [{low_text}, {high_text}] {difference_unit(found)}".rstrip()


def interval_text(found: Finding) -> str:
    """``+0.031 [-0.002, +0.064] m``, B minus A."""
    value, low, high = (_signed(found, x) for x in (found.difference, found.low, found.high))
    return f"{value} [{low}, {high}] {difference_unit(found)}".rstrip()


def difference_text(found: Finding) -> str:
    """``+0.031 m``, B minus A."""
    return f"{_signed(found, found.difference)} {difference_unit(found)}".rstrip()


def difference_unit(found: Finding) -> str:
    """Unit of a difference: of shares percentage points."""
    return "points" if is_share(found) else unit_of(found)


def _amount(found: Finding, value: float) -> str:
    """A number without its unit."""
    if math.isinf(value):
        return "unbounded"
    if is_share(found):
        return f"{100.0 * value:.1f}"
    unit = unit_of(found)
    return measured(found.name, value, unit).removesuffix(f" {unit}")


def _signed(found: Finding, value: float) -> str:
    text = _amount(found, abs(value))
    if math.isinf(value) or not text.strip("0.,%"):  # rounded to 0
        return text
    return f"{'-' if value < 0.0 else '+'}{text}"


def p_text(p: float) -> str:
    """``0.031``, ``< 0.0001``."""
    return "< 0.0001" if p < 1e-4 else f"{p:.2g}" if p < 0.1 else f"{p:.2f}"


def method(comparisons: Sequence[Comparison], looked: bool) -> str:
    """How differences were estimated and tested; one paragraph.

    ``looked``: a campaign was stopped because of what it showed, which is told.
    """
    looks = sum(f.is_tested for one in comparisons for f in one.findings)
    if not looks:
        return (
            "Differences are B minus A on the same seeds; none is tested, as it takes "
            f"{FEWEST_PAIRS} pairs to show one.{LOOKED if looked else ''}"
        )
    return (
        "Differences are B minus A on the same seeds, with 95 % intervals that hold each for "
        "itself, for a number of seeds fixed in advance: of rates in percentage points "
        "(conservative, from exact parts), of measures the median of the differences (order "
        "statistics). The better one is that which succeeds alone (rates) or has the better value "
        "(measures) with more seeds; ties are left out. That is tested, "
        "exactly and on two sides (McNemar's test, the sign test); p is "
        f"corrected for all {plural(looks, 'finding')} that {FEWEST_PAIRS} pairs or more tell of "
        f"(Holm), and a difference is shown where it is at most {ALPHA:g} (and the interval of a "
        "rate leaves out 0). That none is shown does "
        "not mean that there is none: the interval says how large it may be."
        f"{LOOKED if looked else ''}"
    )


def comparison_values(comparisons: Sequence[Comparison], looked: bool = False) -> dict[str, Any]:
    """All comparisons in types that JSON knows; what is infinite or has no value is null."""
    return {
        "format": "physim-comparison",
        "version": 1,
        "units": "m, s; shares from 0 to 1; differences are b minus a",
        "confidence": 0.95,
        "number_of_runs_fixed_in_advance": not looked,
        "tests": {"rates": "McNemar, exact", "measures": "sign", "correction": "Holm"},
        "comparisons": [
            {
                "common": one.common,
                "verdict": headline(one),
                **{
                    key: {"label": arm.label, **dict(zip(_CELL, arm.cell.names, strict=True))}
                    for key, arm in (("a", one.a), ("b", one.b))
                },
                "seeds": one.seeds,
                "seeds_only_a": list(one.only_a),
                "seeds_only_b": list(one.only_b),
                "failed_a": one.failed_a,
                "failed_b": one.failed_b,
                "unlike": list(one.unlike),
                "findings": [
                    {
                        "name": f.name, "pairs": f.pairs, "a": plain(f.a), "b": plain(f.b),
                        "difference": plain(f.difference), "low": plain(f.low),
                        "high": plain(f.high), "only_a": f.only_a, "only_b": f.only_b,
                        "ties": f.ties,
                        "tested": f.is_tested, "p": f.p, "p_corrected": f.corrected,
                        "better": f.better or None,
                    }
                    for f in one.findings
                ],
            }
            for one in comparisons
        ],
    }  # fmt: skip


_CELL = ("world", "settings", "controller")
