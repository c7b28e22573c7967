"""What comparisons say: a sentence, a row for each finding, and values for `--json`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from physim.campaigns.compare import ALPHA, FEWEST_PAIRS, Comparison, Finding
from physim.campaigns.measures import measure_of
from physim.campaigns.outcomes import CELL
from physim.campaigns.report.text import Table, bare, plain, seeds_text
from physim.errors import plural
from physim.escaping import escaped
from physim.units import count

PAIRED = (
    "Differences are B minus A on the same seeds, with 95 % intervals that hold each for itself, "
    "for a number of seeds fixed in advance: of rates in percentage points (conservative, from "
    "exact parts), of measures the median of the differences (order statistics). The better one is "
    "that which succeeds alone (rates) or has the better value (measures) with more seeds; ties "
    "are left out. That is tested, exactly and on two sides (McNemar's test, the sign test). "
    f"p is corrected for all findings that {FEWEST_PAIRS} pairs or more tell of (Holm), and a "
    f"difference is shown where it is at most {ALPHA:g} (and the interval of a rate leaves out 0). "
    "That none is shown does not mean that there is none: the interval says how large it may be."
)
LOOKED = (
    "A campaign was stopped because of what it showed (sweep --until): intervals and p values are "
    "then too sure; compare campaigns of a number of runs fixed in advance."
)


def comparison_text(
    comparisons: Sequence[Comparison], looked: bool = False, explain: bool = False
) -> str:
    """All comparisons: which is better in what, then by how much."""
    parts = []
    for one in comparisons:
        common = f" ({one.common})" if one.common else ""
        lines = [f"{headline(one)}{common}", f"  {sides(one)}: {told(one)}"]
        lines += [f"  note: {difference}" for difference in one.unlike]
        table = [str(finding_table(one))] if one.findings else []
        parts.append("\n".join([*map(escaped, lines), *table]))
    parts += [PAIRED] * explain + [LOOKED] * looked
    return "\n\n".join(parts) + "\n"


def sides(one: Comparison) -> str:
    """Which is A, and which is B."""
    return f"A {one.a.label}, B {one.b.label}"


def headline(one: Comparison) -> str:
    """Which arm is better in what; one sentence."""
    if not any(f.is_tested for f in one.findings):
        return "too few pairs to tell"
    said = [
        f"{arm.label} ({side.upper()}) is better in {', '.join(names)}"
        for side, arm in (("a", one.a), ("b", one.b))
        if (names := [measure_of(f.name).title for f in one.findings if f.better == side])
    ]
    rest = ", ".join(measure_of(f.name).title for f in one.findings if not f.better)
    if not said:
        return "no difference shown"
    return "; ".join([*said, *([f"no difference shown in {rest}"] if rest else [])])


def told(one: Comparison) -> str:
    """How many seeds are compared, and what is left out."""
    text = f"{plural(one.seeds, 'seed')} in common"
    if one.seeds == 1:
        text += ": where nothing in the world is random it is all there is"
    for name, arm in (("A", one.a), ("B", one.b)):
        if arm.alone:
            only = f"{count(len(arm.alone))} that only {name} has are left out"
            text += f"; {only} ({seeds_text(arm.alone)})"
        if arm.failed:
            text += f"; {plural(arm.failed, 'run')} of {name} crashed"
    return text


def finding_table(one: Comparison) -> Table:
    """A row for each rate and measure: both sides, by how much, with how many seeds."""
    head = ("", "A", "B", "B - A [95 %]", "seeds won", "corrected p", "")
    return Table("", head, [finding_row(one, found) for found in one.findings])


def finding_row(one: Comparison, found: Finding) -> tuple[str, ...]:
    """What there is to say of one rate or measure, by the columns of `finding_table`."""
    title, unit, _ = measure_of(found.name)
    shift = [_signed(value, unit) for value in (found.difference, found.low, found.high)]
    name = title if unit in ("", "%") else f"{title} [{unit}]"
    if found.pairs < one.seeds:
        name += f", {plural(found.pairs, 'pair')}"
    won = f"A {found.only_a}, B {found.only_b}" if found.only_a or found.only_b else ""
    points = " points" if unit == "%" else ""
    if not found.is_tested:
        few = f"not tested: {plural(found.pairs, 'pair')}; it takes {FEWEST_PAIRS}"
        p, range_text = "", ""
    else:
        few = f"{found.better.upper()} is better" if found.better else "no difference shown"
        p, range_text = p_text(found.corrected), f" [{shift[1]}, {shift[2]}]"
    return (name, bare(found.a, unit), bare(found.b, unit), f"{shift[0]}{range_text}{points}", won,
            p, few)  # fmt: skip


def _signed(value: float, unit: str) -> str:
    """A difference without its unit; of shares in percentage points."""
    if math.isinf(value):
        return "unbounded"
    text = f"{100.0 * abs(value):.1f}" if unit == "%" else bare(abs(value), unit)
    if not text.strip("0.,"):  # rounded to 0
        return text
    return f"{'-' if value < 0.0 else '+'}{text}"


def p_text(p: float) -> str:
    """``0.031``, ``< 0.0001``."""
    return "< 0.0001" if p < 1e-4 else f"{p:.2g}" if p < 0.1 else f"{p:.2f}"


def comparison_values(comparisons: Sequence[Comparison], looked: bool = False) -> dict[str, Any]:
    """All comparisons in types that JSON knows; what is infinite or has no value is null."""
    values: dict[str, Any] = plain({
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
                    key: {"label": arm.label, **dict(zip(CELL, arm.cell.names, strict=True))}
                    for key, arm in (("a", one.a), ("b", one.b))
                },
                "seeds": one.seeds,
                "seeds_only_a": one.a.alone,
                "seeds_only_b": one.b.alone,
                "failed_a": one.a.failed,
                "failed_b": one.b.failed,
                "unlike": one.unlike,
                "findings": [
                    {
                        "name": f.name, "pairs": f.pairs, "a": f.a, "b": f.b,
                        "difference": f.difference, "low": f.low, "high": f.high,
                        "only_a": f.only_a, "only_b": f.only_b, "ties": f.ties,
                        "tested": f.is_tested, "p": f.p, "p_corrected": f.corrected,
                        "better": f.better or None,
                    }
                    for f in one.findings
                ],
            }
            for one in comparisons
        ],
    })  # fmt: skip
    return values
