"""Reports and comparisons as pages of HTML that need nothing beside them."""

from __future__ import annotations

import base64
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np

from physim.campaigns.compare import Comparison, Finding, pairs
from physim.campaigns.measures import MEASURES, NEAREST, measure_of
from physim.campaigns.report import charts, text
from physim.campaigns.report.contents import MOST_PICTURED, Report, who_stood
from physim.drawing.page.colours import styles
from physim.errors import plural
from physim.html import Html, page, table, tag
from physim.units import amount, count, percent, true_minus

REPORT, COMPARISON = "physim report", "physim compare"
"""By which a page is known: the next report takes the place of a report alone"""
PLOT_WIDTH, INTERVAL_WIDTH = 320.0, 200.0
"""[px]"""
MOST_PLOTS, MOST_DRAWN, MOST_POINTS = 60, 10, 400
"""What a page shows of a large campaign"""


@dataclass(frozen=True)
class Shown:
    """How a run with a picture is shown."""

    still: bytes = b""
    """PNG of the moment; empty where there is none"""
    video: str = ""
    """link to its video, relative to the page"""
    page: str = ""
    """link to its page for the browser, relative, at the moment"""
    fault: str = ""
    """why there is no still"""


def is_report(file: Path) -> bool:
    """Whether a file is the page of a report."""
    try:
        with open(file, "rb") as stream:
            return f'<meta name="generator" content="{REPORT}">'.encode() in stream.read(1000)
    except OSError:
        return False


def report_page(report: Report, shown: Sequence[Shown]) -> Html:
    """The page; ``shown`` are the runs of `Report.pictured`."""
    pictures = dict(zip(report.pictured, shown, strict=True))
    worst = {at: one for at, one in pictures.items() if at[1] != "end"}
    late = {at: one for at, one in pictures.items() if at[1] == "end"}
    cpu = amount(float(np.nansum(report.outcomes.column("cpu_seconds"))), "s")
    few = f" (of the first {MOST_PICTURED} cells)" if len(report.cells) > MOST_PICTURED else ""
    parts = [
        tag("h1", report.title),
        tag("p", f"{text.opening(report)}; {cpu} of processor time", class_="quiet"),
        tag("p", text.missing_words(report.missing), class_="bad") if report.missing else None,
        _verdicts(report),
        _section(
            f"The worst runs of each cell{few}",
            "First the severest contacts, by closing speed, energy lost and impulse; then the "
            "least distances. Each picture shows that moment; the command repeats the run, with "
            "its record and video.",
            _tiles(report, worst),
        ) if worst else None,
        _section(
            f"Runs that did not finish{few}",
            "They reached their time limit before all robots had arrived. The table names the "
            "robots that had not arrived, with the number of runs: they stood short of their "
            "stops, or still moved. Each picture shows the end of a run.",
            _stacked(text.late_table(report)), _tiles(report, late),
        ) if late else None,
        _section(
            "Runs that crashed",
            "They ended by an error, at their time limit or with a killed worker. In every rate "
            "they count as neither contact-free nor finished.",
            _stacked(text.crash_table(report)),
        ) if report.failures else None,
        _section(
            "How close do robots come to each other and to walls?",
            "The least distance between two robots, or a robot and a wall, over all physics steps "
            "of a run. A value below 0, left of the dashed line, is a contact; it does not measure "
            "how severe. Vertical axis: share of runs. Cells of one world have the same axes.",
            tag("div", _distances(report), class_="tiles"),
        ),
        _section(
            "Times and other measures",
            "Over the runs that have a value; the last column says how many, if not all have one.",
            _stacked(text.measure_table(report, (*MEASURES, *report.outcomes.own))),
        ),
        _section("How this was found", text.EXACT if report.goal is None else text.SEQUENCE),
    ]  # fmt: skip
    return _page(f"{report.title}: campaign", parts, REPORT)


def _page(title: str, parts: Sequence[Html | None], generator: str) -> Html:
    sheet = tag("main", parts, class_="sheet")
    return page(title, sheet, style=styles("campaign.css"), generator=generator)


def _section(title: str, words: str, *parts: object) -> Html:
    return Html(tag("h2", title) + tag("p", words) + "".join(tag("div", one) for one in parts))


def _stacked(shown: text.Table, plots: Mapping[int, Sequence[Html]] = MappingProxyType({})) -> Html:
    """A table whose cells stand below one another on a phone.

    ``plots`` are further columns, each before that of its number.
    """

    def cell(name: str, place: int, words: str) -> Html:
        if name in text.TO_THE_RIGHT:
            return tag("td", true_minus(words), data_name=name, class_="number")
        return tag("td", words, data_name=name or None, class_=None if place else "name")

    head = [
        tag("th", name, class_="number" if name in text.TO_THE_RIGHT else None)
        for name in shown.head
    ]
    rows = [
        [cell(name, k, words) for k, (name, words) in enumerate(zip(shown.head, line, strict=True))]
        for line in shown.some()
    ]
    for place, column in plots.items():
        head.insert(place, tag("th"))
        for row, plot in zip(rows, column, strict=True):
            row.insert(place, tag("td", plot))
    return table(head, rows, class_="stack")


def _verdicts(report: Report) -> Html:
    """A row for each cell: how often it went well, on one axis, and what else came of it."""
    cells = report.cells[: text.MOST_ROWS]
    axis = charts.rate_axis([one.rates[0].low for one in cells], INTERVAL_WIDTH)
    ends = percent(axis.low, 0), percent(axis.high, 0)

    def rows() -> Iterator[list[Html]]:
        for one in cells:
            rate = one.rates[0]
            first, *others = text.verdict(report, one)
            plot = charts.interval_plot(rate.share, rate.low, rate.high, axis, ends, first)
            small = ([tag("br"), tag("small", words)] for words in others)
            parts = (tag("span", words) for words in one.cell.names[:0:-1] if words)
            name = tag("td", tag("b", one.cell.world), parts, class_="name")
            yield [name, tag("td", plot), tag("td", tag("b", first), small)]

    more = len(report.cells) - text.MOST_ROWS
    left = tag("p", f"and {plural(more, 'further cell')}: --json has all") if more > 0 else ""
    return Html(table((), rows(), class_="stack") + left)


def _tiles(report: Report, shown: Mapping[tuple[int, str], Shown]) -> Iterator[Html]:
    """Runs with their pictures, cell by cell."""
    for one in report.cells[:MOST_PICTURED]:
        mine = [tag("figure", _tile(report, *at, picture), class_="tile")
                for at, picture in shown.items()
                if one.cell.start <= at[0] < one.cell.stop]  # fmt: skip
        if mine:
            yield tag("h3", one.cell.name)
            yield tag("div", mine, class_="tiles large")


def _tile(report: Report, index: int, moment: str, shown: Shown) -> Iterator[Html | None]:
    row, is_end = report.outcomes.rows[index], moment == "end"
    said = text.robots_words(*who_stood([row]), 1) if is_end else text.where(row)
    if shown.still:
        data = base64.b64encode(shown.still).decode("ascii")
        alt = f"{row.world}, seed {row.seed}: {said}"
        yield tag("img", src=f"data:image/png;base64,{data}", alt=alt)
    severity = "" if is_end else f": {true_minus(text.severity_words(row))}"
    bad = " bad" if report.outcomes.touched[index] else ""
    yield tag("p", f"seed {row.seed}{severity}", class_=f"big{bad}")
    kinds = {
        "contacts_between_robots": ("contact of robots", "contacts of robots"),
        "contacts_with_movers": ("contact with movers or boxes", "contacts with movers or boxes"),
        "contacts_with_boundaries": ("contact with walls", "contacts with walls"),
        "grazes": ("graze between samples", "grazes between samples"),
    }
    found = {key: getattr(row, key) for key in kinds}
    counts = [plural(many, *kinds[key]) for key, many in found.items() if many]
    lines: list[object] = [f"{said}; {', '.join(counts) or 'no contact'}"]
    lines += [f"no picture: {shown.fault}"] if shown.fault else []
    links = {"watch this moment, and ask why": shown.page, "video": shown.video}
    lines += [tag("a", words, href=to) for words, to in links.items() if to]
    lines.append(tag("code", text.replay(report.title, report.outcomes, row)))
    yield tag("figcaption", (tag("div", line) for line in lines))


def _distances(report: Report) -> Iterator[Html]:
    """Least distances of each cell as a distribution, on axes that a world's cells have alike."""
    near, cells = report.outcomes.column(NEAREST), report.cells[:MOST_PLOTS]
    for one in cells:
        alike = [near[other.cell.rows] for other in cells if other.cell.world == one.cell.world]
        axis = charts.spread_axis(np.concatenate(alike), PLOT_WIDTH)
        top = max(float(charts.shares(values, axis)[0].max()) for values in alike)
        found, what = one.spreads[NEAREST], "least distance of a run [m]"
        ends = [amount(value, "m") for value in (found.median, found.least, found.most)]
        said = f"median {ends[0]}, from {ends[1]} to {ends[2]}"
        if found.count < one.cell.count:
            said += f"; {count(found.count)} of {plural(one.cell.count, 'run')} have one"
        label = ", ".join(part for part in (one.cell.controller, one.cell.settings) if part)
        yield tag(
            "figure",
            tag("h3", one.cell.world),
            tag("p", label, class_="quiet"),
            charts.distribution(
                near[one.cell.rows], axis, top, "least distance of a run [m]", what
            ),
            tag("figcaption", true_minus(said) if found.count else "no run has one"),
            class_="tile",
        )
    if (more := len(report.cells) - MOST_PLOTS) > 0:
        yield tag("p", f"and {plural(more, 'further cell')}")


def comparison_page(comparisons: Sequence[Comparison], name: str, looked: bool = False) -> Html:
    """The page: what is better by how much, and every pair as a point."""
    better = sum(bool(f.better) for one in comparisons for f in one.findings)
    looks = sum(len(one.findings) for one in comparisons)
    parts: list[Html | None] = [
        tag("h1", name),
        tag("p", f"{looks} looked at; {better} of them show a difference", class_="quiet"),
    ]
    for place, one in enumerate(comparisons):
        parts += _comparison(one, place < MOST_DRAWN)
    if len(comparisons) > MOST_DRAWN:
        parts.append(tag("p", f"Pairs are drawn of the first {MOST_DRAWN}.", class_="quiet"))
    parts.append(_section("How this was found", text.PAIRED + f" {text.LOOKED}" * looked))
    return _page(name, parts, COMPARISON)


def _comparison(one: Comparison, drawn: bool) -> Iterator[Html]:
    yield tag("h2", f"{text.sides(one)}{': ' if one.common else ''}{one.common}")
    yield tag("p", tag("b", text.headline(one)))
    yield tag("p", text.told(one), class_="quiet")
    yield from (tag("p", tag("b", "Note: "), difference) for difference in one.unlike)
    yield _stacked(text.finding_table(one), {3: [_shift(found) for found in one.findings]})
    if drawn:
        points = (_points(one, found) for found in one.findings if not found.is_rate)
        yield tag("div", points, class_="tiles")


def _shift(found: Finding) -> Html:
    """A difference with its interval, on an axis with 0 in its middle."""
    title, unit, _ = measure_of(found.name)
    unit, scale = ("points", 100.0) if unit == "%" else (unit, 1.0)
    value, low, high = (scale * each for each in (found.difference, found.low, found.high))
    axis = charts.shift_axis([value, low, high], INTERVAL_WIDTH)
    ends = [f"{sign}{axis.label(end)} {unit}" for sign, end in (("", axis.low), ("+", axis.high))]
    return charts.interval_plot(value, low, high, axis, ends, title)


def _points(one: Comparison, found: Finding) -> Html:
    """Every pair as a point, A to the right, B upward."""
    a, b = pairs(one.a, one.b, found.name)
    some = np.linspace(0, len(a) - 1, min(len(a), MOST_POINTS)).astype(int)
    title, label = measure_of(found.name).title, measure_of(found.name).label
    thinned = f" of {len(a)}, evenly chosen" if len(some) < len(a) else ""
    drawn = f"{plural(len(some), 'pair')}{thinned}"
    return tag(
        "figure",
        tag("h3", title),
        charts.paired_plot(a[some], b[some], label, f"{title} of A and B, {drawn}"),
        tag("figcaption", f"B upward, A to the right, {drawn}; above the line B is larger."),
        class_="tile",
    )
