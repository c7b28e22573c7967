"""A report as one page of HTML that needs nothing beside it."""

from __future__ import annotations

import base64
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from physim.campaigns.report.contents import (
    MEASURES,
    SHOWN,
    CellReport,
    Rate,
    Report,
    Spread,
    title_of,
    who_stood,
)
from physim.campaigns.report.markup import code, figures, page, text
from physim.campaigns.report.plots import distribution, rate_axis, rate_plot, spread_axis
from physim.campaigns.report.text import seeds_text, where
from physim.campaigns.report.wording import (
    RATE_NAMES,
    decision_words,
    interval,
    measured,
    method,
    missing_words,
    note_of,
    number,
    of_cells,
    over_seeds,
    percent,
    robots_words,
    severity_words,
)
from physim.errors import plural

PLOT_WIDTH, RATE_WIDTH = 320.0, 190.0
"""[px]"""
MOST_CELLS = 200
MOST_PLOTS = 60
MOST_FAILURES = 100
MOST_REASON = 400
"""What a page shows of a large campaign; what it leaves out is told, and is in `--json`."""


@dataclass(frozen=True)
class Shown:
    """How a run with a picture is shown."""

    command: str
    """that makes it again"""
    still: bytes = b""
    """PNG of the moment; empty where there is none"""
    video: str = ""
    """link to its video, relative to the page"""
    fault: str = ""
    """why there is no still"""
    page: str = ""
    """link to its page for the browser, relative, at the moment"""
    left_out: str = ""
    """why there is no page"""


def report_page(report: Report, shown: Sequence[Shown]) -> str:
    """The page; ``shown`` are the runs of `Report.pictured`."""
    count = len(report.worst)
    parts = [*_opening(report), *_rates(report), *_worst(report, shown[:count])]
    parts += [*_unfinished(report, shown[count:]), *_failures(report)]
    parts += [*_distances(report), *_measures(report)]
    return page(f"{report.title}: campaign", "\n".join(parts))


def _opening(report: Report) -> Iterator[str]:
    outcomes = report.outcomes
    failed = sum(one.failed for one in report.cells)
    cpu = outcomes.column("cpu_seconds")
    yield f"<h1>{text(report.title)}</h1>"
    seeds = f"seeds {outcomes.seed.min()} to {outcomes.seed.max()}" if len(outcomes) else "no runs"
    worlds, _, controllers = (
        len({names[k] for names in (one.cell.names for one in report.cells)}) for k in range(3)
    )
    yield (
        f'<p class="quiet">{plural(worlds, "world")}, {plural(controllers, "controller")}, '
        f"{plural(len(report.cells), 'cell')}, {seeds}. {text(', '.join(report.versions()))}.</p>"
    )
    if report.missing:
        yield f'<p class="bad">{text(missing_words(report.missing))}</p>'
    figures = [
        ("runs", number(report.runs), False),
        ("crashed", number(failed), failed > 0),
        ("processor time", _hours(float(np.nansum(cpu))), False),
    ]  # fmt: skip
    cells = "".join(
        f"<div><dt>{name}</dt><dd{' class=bad' if bad else ''}>{value}</dd></div>"
        for name, value, bad in figures
    )
    yield f'<dl class="figures">{cells}</dl>'


def _hours(seconds: float) -> str:
    if seconds < 100.0:
        return f"{seconds:.1f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200.0 else f"{seconds / 3600:.1f} h"


def _rates(report: Report) -> Iterator[str]:
    yield "<h2>How often does it go well?</h2>"
    yield f"<p>{text(method(report.goal))} Each interval holds for itself, not all at once.</p>"
    failed = sum(one.failed for one in report.cells)
    if failed:
        yield (
            f"<p>{plural(failed, 'run')} crashed (an error, the limit of time, a killed worker). "
            "They count in every rate, as neither contact-free nor finished.</p>"
        )
    cells = report.cells[:MOST_CELLS]
    axis = rate_axis([one.rates[0].low for one in cells], RATE_WIDTH)
    yield '<div class="wide"><table class="stack"><thead><tr><th>cell</th><th class="number">runs'
    yield '</th><th class="number">with contacts</th><th class="number">not finished</th>'
    yield '<th class="number">crashed</th>'
    yield f'<th colspan="2">{RATE_NAMES["rate"]}</th>'
    yield f"<th>{RATE_NAMES['contact_free']}</th><th>{RATE_NAMES['finished']}</th></tr></thead>"
    yield "<tbody>"
    for one in cells:
        both, free, finished = one.rates
        plot = rate_plot(both.share, both.low, both.high, axis, _in_words(both))
        decided = dict.fromkeys(RATE_NAMES, "")
        if report.goal is not None and one.decision is not None:
            words = decision_words(one.decision, report.goal)
            decided[report.goal.rate] = f'<br><small class="verdict">{text(words)}</small>'
        notes = filter(None, (note_of(both), over_seeds(one.cell.count, one.draws)))
        yield (
            f"<tr>{_name(one)}"
            f'<td class="number" data-name="runs">{number(one.cell.count)}</td>'
            f'<td class="number" data-name="with contacts">{number(one.touched)}</td>'
            f'<td class="number" data-name="not finished">{number(one.unfinished)}</td>'
            f'<td class="number" data-name="crashed">{number(one.failed)}</td>'
            f"<td>{plot}</td>"
            f'<td data-name="{RATE_NAMES["rate"]}">{_rate(both)}{decided["rate"]}'
            f"{''.join(f'<br><small>{text(note)}</small>' for note in notes)}</td>"
            f'<td data-name="{RATE_NAMES["contact_free"]}">{_rate(free)}'
            f"{decided['contact_free']}</td>"
            f'<td data-name="{RATE_NAMES["finished"]}">{_rate(finished)}'
            f"{decided['finished']}</td></tr>"
        )
    yield "</tbody></table></div>"
    yield from _left_out(len(report.cells), MOST_CELLS, "cells")
    if any(one.rates[0].at_most is not None for one in report.cells):
        needed = next(one.rates[0].needed for one in report.cells if one.rates[0].needed)
        yield (
            f'<p class="quiet">Where no run went wrong, the bound {_bound(report)}: '
            f"{number(needed)} runs none of which goes wrong show {percent(SHOWN)}.</p>"
        )


def _bound(report: Report) -> str:
    exact = "is one-sided, of 95 %"
    return exact if report.goal is None else "is that of the confidence sequence"


def _in_words(rate: Rate) -> str:
    return f"{percent(rate.share)} {interval(rate.low, rate.high)}"


def _rate(rate: Rate) -> str:
    return (
        f'<b>{percent(rate.share)}</b> <small class="kept">{number(rate.good)} of '
        f"{number(rate.of)}<br>{interval(rate.low, rate.high)}</small>"
    )


def _name(one: CellReport) -> str:
    cell = one.cell
    more = f"<span>{text(cell.settings)}</span>" if cell.settings else ""
    return (
        f'<td class="name"><b>{text(cell.world)}</b><span>{text(cell.controller)}</span>{more}</td>'
    )


def _left_out(count: int, most: int, what: str) -> Iterator[str]:
    if count > most:
        yield (
            f'<p class="quiet">The first {most} of {number(count)} {what} are shown; '
            "<code>physim report --json</code> has all.</p>"
        )


def _distances(report: Report) -> Iterator[str]:
    yield "<h2>How close do robots come to each other and to walls?</h2>"
    yield (
        "<p>The least distance of a whole run, robots and walls, over all physics steps. Below 0, "
        "left of the dashed line, there was a contact; how far below is no measure of its "
        "severity. Upright: the share of runs. Cells "
        "of a world have the same axis.</p>"
    )
    near = report.outcomes.column("least_distance")
    axes = {}
    for world in {one.cell.world for one in report.cells}:
        rows = [near[one.cell.rows] for one in report.cells if one.cell.world == world]
        axes[world] = spread_axis(np.concatenate(rows), PLOT_WIDTH)
    yield '<div class="tiles">'
    for one in report.cells[:MOST_PLOTS]:
        values = near[one.cell.rows]
        known = values[~np.isnan(values)]
        spread = one.spread("least_distance")
        name = ", ".join(part for part in (one.cell.controller, one.cell.settings) if part)
        yield f'<figure class="tile"><h3>{text(one.cell.world)}</h3>'
        yield f'<p class="quiet">{text(name)}</p>'
        if len(known):
            what = f"least distances of {one.cell.name}: {_five(spread, 'm')}"
            yield distribution(known, axes[one.cell.world], "least distance of a run [m]", what)
            seed = report.outcomes.seed[one.worst] if one.worst is not None else ""
            yield (
                f"<figcaption>{_five(spread, 'm')}; the least with seed {seed}"
                f"{_of(spread, one)}</figcaption>"
            )
        else:
            yield "<figcaption>no run has one</figcaption>"
        yield "</figure>"
    yield "</div>"
    yield from _left_out(len(report.cells), MOST_PLOTS, "cells")


def _five(spread: Spread, unit: str) -> str:
    values = [measured(spread.name, x, unit) for x in (spread.median, spread.least, spread.most)]
    return f"median {values[0]}, from {values[1]} to {values[2]}".replace("-", "−")


def _of(spread: Spread, one: CellReport) -> str:
    """Of how many runs: nothing is dropped in silence."""
    if spread.count == one.cell.count:
        return ""
    return f"; {number(spread.count)} of {number(one.cell.count)} runs have one"


def _measures(report: Report) -> Iterator[str]:
    names = [n for n in (*MEASURES, *report.outcomes.own) if n != "least_distance"]
    names = [n for n in names if any(one.spread(n).count for one in report.cells)]
    if not names:
        return
    yield "<h2>Times and other measures</h2>"
    yield (
        "<p>The median over runs, and in brackets the middle half of them. Runs without a value "
        "(of finish times, those that did not finish) are left out; then it says how many have "
        "one.</p>"
    )
    heads = "".join(f'<th class="number">{text(title_of(name)[0])}</th>' for name in names)
    yield '<div class="wide"><table class="stack dense"><thead><tr><th>cell</th>'
    yield f"{heads}</tr></thead><tbody>"
    for one in report.cells[:MOST_CELLS]:
        yield f"<tr>{_name(one)}"
        for name in names:
            spread, (what, unit) = one.spread(name), title_of(name)
            half = " to ".join(
                measured(name, x, unit).removesuffix(f" {unit}")
                for x in (spread.quarter, spread.three_quarters)
            )
            few = spread.count < one.cell.count
            inside = (
                f"{figures(measured(name, spread.median, unit), unit)}"
                f"<br><small>[{figures(half, unit)}]"
                f"{f'<br>of {number(spread.count)} runs' if few else ''}</small>"
            )
            yield (
                f'<td class="number" data-name="{text(what)}">'
                f"{inside if spread.count else 'no run has one'}</td>"
            )
        yield "</tr>"
    yield "</tbody></table></div>"
    yield from _left_out(len(report.cells), MOST_CELLS, "cells")


def _worst(report: Report, shown: Sequence[Shown]) -> Iterator[str]:
    if not report.worst:
        return
    touched = report.outcomes.touched[list(report.worst)]
    ranks = "the severest contacts" if touched.any() else ""
    if not touched.all():
        ranks += f"{', then ' if ranks else ''}the least distances"
    yield f"<h2>{ranks[:1].upper()}{ranks[1:]}</h2>"
    if left := of_cells(report):
        yield f"<p>They are{left.removeprefix(',')}; each least distance is told below.</p>"
    yield "<p>Of each run the closing speed of its severest contact, the energy lost and the "
    yield "impulse, by which they are ranked in this order; of one without a contact the least "
    yield "distance. Each picture is that moment. The command makes the run again, with its record "
    yield "and video.</p>"
    yield from _tiles(report, report.worst, shown)


def _tiles(report: Report, rows: Sequence[int], shown: Sequence[Shown]) -> Iterator[str]:
    """Runs with their pictures."""
    yield '<div class="tiles large">'
    for place, (index, one) in enumerate(zip(rows, shown, strict=True), start=1):
        row = report.outcomes.row(index)
        is_end = rows is report.stuck
        yield '<figure class="tile">'
        said = robots_words(*who_stood([row]), 1) if is_end else where(row)
        if one.still:
            data = base64.b64encode(one.still).decode("ascii")
            alt = f"{row['world']}, seed {row['seed']}: {said}"
            yield f'<img src="data:image/png;base64,{data}" alt="{text(alt)}">'
        if not is_end:
            bad = " bad" if report.outcomes.touched[index] else ""
            yield f'<p class="big{bad}">{severity_words(row)}</p>'
        yield f"<h3>{place}. {text(row['world'])}, seed {row['seed']}</h3>"
        name = ", ".join(str(row[k]) for k in ("controller", "settings") if row[k])
        yield f"<figcaption>{text(name)}; {text(said)}; {_contacts(row)}"
        if one.fault:
            yield f"<br>no picture: {text(one.fault)}"
        links = {"watch this moment, and ask why": one.page, "video": one.video}
        if any(links.values()):
            named = (f'<a href="{text(to)}">{words}</a>' for words, to in links.items() if to)
            yield f"<br>{', '.join(named)}"
        if one.left_out:
            yield f"<br>no page: {text(one.left_out)}"
        yield f"<br>{code(one.command)}</figcaption></figure>"
    yield "</div>"


def _unfinished(report: Report, shown: Sequence[Shown]) -> Iterator[str]:
    if not report.unfinished:
        return
    yield "<h2>Runs that did not finish</h2>"
    yield "<p>Their time was up before all robots had arrived. Named are those that had not, with "
    yield "the number of runs: they stood short of their stops, or still moved.</p>"
    yield '<div class="wide"><table class="stack"><thead><tr><th>cell</th>'
    yield '<th class="number">runs</th><th>robots</th><th>seeds</th></tr></thead><tbody>'
    for one in report.unfinished[:MOST_CELLS]:
        robots = robots_words(one.stood, one.moved, len(one.seeds))
        yield (
            f'<tr><td class="name">{text(one.cell.name)}</td>'
            f'<td class="number" data-name="runs">{number(len(one.seeds))}</td>'
            f'<td data-name="robots">{text(robots)}</td>'
            f'<td data-name="seeds">{seeds_text(one.seeds)}</td></tr>'
        )
    yield "</tbody></table></div>"
    yield from _left_out(len(report.unfinished), MOST_CELLS, "cells")
    yield "<p>Each picture is the end of a run, of every cell in turn.</p>"
    yield from _tiles(report, report.stuck, shown)


def _contacts(row: dict[str, object]) -> str:
    kinds = {
        "contacts_between_robots": ("contact of robots", "contacts of robots"),
        "contacts_with_boundaries": ("contact with walls", "contacts with walls"),
        "grazes": ("graze between samples", "grazes between samples"),
    }
    counts = [plural(int(str(row[key])), *words) for key, words in kinds.items() if row[key]]
    return ", ".join(counts) or "no contact"


def _failures(report: Report) -> Iterator[str]:
    if not report.failures:
        return
    yield "<h2>Runs that crashed</h2>"
    yield '<div class="wide"><table class="stack"><thead><tr><th>cell</th>'
    yield '<th class="number">runs</th>'
    yield "<th>ended by</th><th>reason</th><th>seeds</th></tr></thead><tbody>"
    for one in report.failures[:MOST_FAILURES]:
        reason = one.reason if len(one.reason) <= MOST_REASON else one.reason[:MOST_REASON] + "…"
        yield (
            f'<tr><td class="name">{text(one.cell.name)}</td>'
            f'<td class="number" data-name="runs">{number(len(one.seeds))}</td>'
            f'<td data-name="ended by">{text(one.ended)}</td>'
            f'<td data-name="reason">{text(reason)}</td>'
            f'<td data-name="seeds">{seeds_text(one.seeds)}</td></tr>'
        )
    yield "</tbody></table></div>"
    yield from _left_out(len(report.failures), MOST_FAILURES, "kinds of crash")
