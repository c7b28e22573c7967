"""Comparisons as one page of HTML: what is better by how much, and every pair as a point."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from physim.campaigns.compare import Comparison, Finding
from physim.campaigns.report.comparison_text import (
    difference_text,
    difference_unit,
    headline,
    interval_text,
    is_share,
    method,
    p_text,
    pairs_text,
    title,
    told,
    unit_of,
    untested,
    value_text,
    won,
)
from physim.campaigns.report.contents import title_of
from physim.campaigns.report.markup import figures, page, text
from physim.campaigns.report.plots import paired_plot, shift_plot
from physim.errors import plural

MOST_POINTS = 400
MOST_PLOTS = 40
"""What a page shows of large comparisons; the rest is told."""
GENERATOR = "physim compare"
SHIFT_WIDTH = 220.0
"""[px]"""


def comparison_page(comparisons: Sequence[Comparison], name: str, looked: bool = False) -> str:
    """The page."""
    parts = [f"<h1>{text(name)}</h1>"]
    shown = sum(bool(f.better) for one in comparisons for f in one.findings)
    looks = sum(len(one.findings) for one in comparisons)
    parts.append(f'<p class="quiet">{looks} looked at; {shown} of them show a difference.</p>')
    room = MOST_PLOTS
    for one in comparisons:
        parts += _comparison(one, max(0, room))
        room -= len(one.findings)
    if room < 0:
        parts.append(f'<p class="quiet">Points of pairs are shown of the first {MOST_PLOTS}.</p>')
    parts += ["<h2>How this was found</h2>", f"<p>{text(method(comparisons, looked))}</p>"]
    return page(name, "\n".join(parts), GENERATOR)


def _comparison(one: Comparison, room: int) -> Iterator[str]:
    yield f"<h2>A {text(one.a.label)} · B {text(one.b.label)}</h2>"
    if one.common:
        yield f"<h3>{text(one.common)}</h3>"
    yield f"<p><b>{text(headline(one))}</b></p>"
    yield f'<p class="quiet">{text(told(one))}</p>'
    for difference in one.unlike:
        yield f"<p><b>Note:</b> {text(difference)}</p>"
    yield '<div class="wide"><table class="stack"><thead><tr><th></th><th class="number">A</th>'
    yield '<th class="number">B</th><th colspan="2">B − A</th><th>finding</th></tr></thead><tbody>'
    for f in one.findings:
        unit = unit_of(f)
        a, b = (figures(value_text(f, x, unit), unit) for x in (f.a, f.b))
        said = interval_text(f) if f.is_tested else difference_text(f)
        words, shift = _verdict(one, f), figures(said, difference_unit(f))
        scale = 100.0 if is_share(f) else 1.0
        value, low, high = (scale * x for x in (f.difference, f.low, f.high))
        plot = shift_plot(value, low, high, difference_unit(f), SHIFT_WIDTH, f"{title(f)}: {words}")
        yield (
            f'<tr><td class="name"><b>{text(title(f))}</b>'
            f"<span>{text(pairs_text(one, f).strip(' ()'))}</span></td>"
            f'<td class="number" data-name="A">{a}</td><td class="number" data-name="B">{b}</td>'
            f'<td>{plot}</td><td class="number">{shift}</td>'
            f'<td><span class="verdict">{text(words)}</span><br><small>{_tested(f)}<br>{won(f)}'
            "</small></td></tr>"
        )
    yield "</tbody></table></div>"
    measures = [f for f in one.findings if not f.is_rate][:room]
    if measures:
        yield '<div class="tiles">'
        for f in measures:
            yield from _points(one, f)
        yield "</div>"


def _tested(found: Finding) -> str:
    if not found.is_tested:
        return text(untested(found))
    return f"p {p_text(found.p)}, corrected {p_text(found.corrected)}"


def _verdict(one: Comparison, found: Finding) -> str:
    if not found.is_tested:
        return "too few to tell"
    if not found.better:
        return "no difference shown"
    label = one.a.label if found.better == "a" else one.b.label
    return f"{found.better.upper()} is better ({label})"


def _points(one: Comparison, found: Finding) -> Iterator[str]:
    """Every pair as a point, A to the right, B upward."""
    a, b = one.values(found.name)
    known = ~(np.isnan(a) | np.isnan(b))
    a, b = a[known], b[known]
    count = len(a)
    if count > MOST_POINTS:
        some = np.linspace(0, count - 1, MOST_POINTS).astype(int)
        a, b = a[some], b[some]
    what, unit = title_of(found.name)
    label = f"{what} [{unit}]" if unit else what
    yield f'<figure class="tile"><h3>{text(what)}</h3>'
    yield paired_plot(a, b, label, f"{what} of A and B, {plural(len(a), 'pair')}")
    thinned = f" of {count}, evenly chosen" if count > len(a) else ""
    yield (
        f"<figcaption>B upward, A to the right, {plural(len(a), 'pair')}{thinned}; above the "
        "line B has the larger value.</figcaption></figure>"
    )
