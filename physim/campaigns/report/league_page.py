"""What a league says, the answer first, as blocks of a page: LEAGUE.md and league.html.

Every sentence is made from the figures of `standings`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from math import isnan
from pathlib import Path
from typing import NamedTuple

from physim._version import __version__
from physim.blocks import Block, Words, html, markdown
from physim.campaigns.league import STUCK, outcome_of
from physim.campaigns.report.league import (
    FAILS,
    FEWEST_SOLVED,
    HOLDS,
    OPEN,
    PARTLY,
    Standings,
    Verdict,
)
from physim.campaigns.report.league_tables import (
    by_arrival,
    cell_costs,
    cell_table,
    cost_table,
    matrix,
    outcome_table,
    value_of,
    world_table,
)
from physim.campaigns.report.pictures import film_of
from physim.campaigns.report.text import Table, missing_words, replay
from physim.campaigns.rows import Row
from physim.drawing.page.colours import styles
from physim.errors import PhysimError, plural
from physim.units import count, joined, percent

TITLE, GENERATOR = "The league of controllers", "physim league"
MARKDOWN, PAGE = "LEAGUE.md", "league.html"
CLAIM = "outperforms some state-of-the-art methods"
MOST_TOLD = 5
"""Refusals and errors that the terminal tells"""
COLOURS = {HOLDS: "met", PARTLY: "partly met", FAILS: "not met", OPEN: "undecided"}


class Film(NamedTuple):
    """A run that is shown."""

    entrant: str
    which: str
    """best or worst"""
    row: Row
    file: str = ""
    """relative to the page; empty where it was not made"""


def pages(found: Standings, folder: Path, films: Sequence[Film], command: str) -> dict[str, str]:
    """Texts of the files that present a league, by name; films stand in the page for browsers."""
    style = styles("reproduction.css", "league.css")
    return {
        MARKDOWN: markdown(content(found, str(folder), (), command)),
        PAGE: html(TITLE, content(found, str(folder), films, command), folder, style, GENERATOR),
    }


def films_of(
    found: Standings, folder: Path, most: int, controllers: Collection[str],
    progress: Callable[[int, int, str], None], stop: Callable[[], bool],
) -> list[Film]:  # fmt: skip
    """Worst runs of all entrants, then their best; films of the first ``most`` that can be made.

    Code of one's own is run only where it is among ``controllers``. Raises PhysimError where a film
    cannot be written.
    """
    names = [name for name, _ in by_arrival(found, found.worlds)]
    every = [Film(name, *one) for name in names for one in found.films(name)]
    every.sort(key=lambda film: film.which != "worst")
    made = 0
    for k, film in enumerate(every):
        if made == most or stop():
            break
        progress(made, most, f"{film.entrant}, {film.which}")
        try:
            file = film_of(folder, film.row, controllers)
        except PhysimError:
            continue
        every[k], made = film._replace(file=file), made + 1
    return every


def content(found: Standings, folder: str, films: Sequence[Film], command: str) -> Iterator[Block]:
    """The page, block by block."""
    runs, seeds = len(found.outcomes), found.outcomes.seed
    between = f", seeds {seeds.min()} to {seeds.max()}" if runs else ""
    yield "h1", TITLE
    yield (
        "p", f"{plural(len(found.entrants), 'entrant')} in {plural(len(found.worlds), 'world')}: "
        f"{count(runs)} runs{between}. Every number, sign and verdict on this page was computed "
        "from these runs by ", Words("code", command), "; contacts are those of the physics.",
    )  # fmt: skip
    if found.missing:
        yield "p", Words("strong", missing_words(found.missing))
    yield "h2", "The answer"
    yield from (("p", *line) for line in answer(found))
    yield "table", outcome_table(found, found.worlds, costs=True)
    yield "h3", "Who is surely better"
    yield (
        "p", "+ : the entrant of the row is surely better than that of the column; − : surely "
        "worse; · : cannot be told with these runs. Differences are means over the worlds in which "
        "both could drive, each world weighing alike, on the same seeds.",
    )  # fmt: skip
    for ranking in found.rankings:
        yield (
            "p", Words("strong", ranking.criterion.title.capitalize()),
            f" (value: {ranking.criterion.value})",
        )  # fmt: skip
        yield "table", matrix(found, ranking)
    if found.verdicts:
        yield "h2", f"Where {found.reference} wins and where it loses"
        for verdict in found.verdicts:
            head = Words("strong", f"Against {verdict.entrant} it {verdict.verdict}")
            yield "p", head, ": ", _against(found, verdict)
        yield (
            "p", f"World by world, the number of seeds with which {found.reference} alone arrives "
            "without contact, and with which the entrant alone does. + : a difference is shown "
            f"(p of at most 0.05 after correction), {found.reference} wins; − : it loses; · : no "
            "difference is shown.",
        )  # fmt: skip
        yield "table", world_table(found, "rate")
        yield "p", "The same of runs without contact, whether they arrive or not."
        yield "table", world_table(found, "contact_free")
    yield "h2", "What it costs"
    yield (
        "p", f"Over the runs that the entrant and {found.reference} both solve; in parentheses the "
        f"value of {found.reference} over the same runs. Means over worlds with at least "
        f"{FEWEST_SOLVED} such runs, which weigh alike.",
    )  # fmt: skip
    yield "table", cost_table(found, found.worlds)
    if films:
        yield "h2", "Best and worst runs"
        yield "p", FILMS
        for film in films:
            if film.file:
                yield "run", film.file, _film_words(film)
        yield "table", _film_table(found, folder, films)
    if len(found.league.groups) > 1:
        yield "h2", "By kind of world"
        for group in found.league.groups:
            there = [world for world in group.worlds if world in found.worlds]
            if there:
                yield "h3", group.name
                yield "p", ", ".join(there)
                yield "table", outcome_table(found, there)
                yield "table", cost_table(found, there)
    yield "h2", "Every world"
    for world in found.worlds:
        yield "h3", world
        yield "table", cell_table(found, world)
        yield from (("p", line) for line in _troubles(found, world))
        yield "table", cell_costs(found, world)
    yield "h2", "Who takes part"
    yield "table", [("entrant", "controller", "settings", "told of others", ""), *(
        (one.name, one.controller, one.values.replace("controller.", "") or "by default",
         one.told or "not stated", one.about)
        for one in found.entrants
    )]  # fmt: skip
    yield "h2", "What the words mean"
    yield "table", [("word", "meaning"), *DEFINITIONS]
    yield "h2", "How it was made"
    versions = sorted({f"physim {row.physim}, {row.engine}" for row in found.outcomes.rows})
    yield (
        "table",
        [
            ("", ""),
            ("versions", "; ".join(versions) or f"physim {__version__}"),
            ("machine", "; ".join(found.league.machines)),
            (
                "processor time",
                _hours(float(sum(r.cpu_seconds or 0.0 for r in found.outcomes.rows))),
            ),
            (
                "tuning",
                found.league.budget
                if any(one.settings for one in found.entrants)
                else "no settings but the defaults",
            ),
        ],
    )


FILMS = (
    "Worst run of an entrant: its contact with the greatest closing speed; without contacts its "
    "longest deadlock, then a run whose time was up. Best run: it arrived, fastest beside the "
    "median of all that arrived in that world. Films show the worst run of each entrant in the "
    "order of the table above, then the best, as many as the command was asked for; the commands "
    "make any run again, with record and film."
)
DEFINITIONS = (
    ("arrived", "no contact and no graze, and every robot stood at its stop station within the "
     "time of the world"),
    ("contact", "a robot touched a robot, a wall, a mover or a box, between samples or at one, "
     "whether all arrived or not"),
    ("deadlock", f"no contact; at the end no robot that had not arrived had advanced 0.1 m along "
     f"its path for {STUCK:g} s"),
    ("timeout", "no contact and no deadlock; the time was up before all had arrived"),
    ("error", "the controller failed, or the run took too long to compute or was killed; it counts "
     "as neither contact-free nor arrived"),
    ("cannot", "the world refuses the entrant, for the reason given: no run, and no part in any "
     "mean or comparison"),
    ("[95 %]", "of shares the exact interval (Clopper and Pearson); of makespans the interval of "
     "the median of paired ratios by order statistics. Each is valid by itself"),
    ("p", "McNemar's exact test of the seeds with which one of the two alone succeeds; corrected "
     "by Holm for all tests of this page's cells: contact-free, arrived and makespan, world by "
     "world"),
    ("surely better", "the interval of the mean difference leaves out 0 and the exact sign test "
     "over all seeds, corrected by Holm for all pairs, has p of at most 0.05. Intervals hold for "
     "all pairs at once with about 95 %: seeds are drawn anew within each world, 2000 times, the "
     "same for all entrants"),
    ("makespan", "time until the last robot stood at its stop station; ratios are to the "
     f"reference, over seeds that both solve; means over worlds (of logarithms) are of those with "
     f"{FEWEST_SOLVED} such seeds or more"),
    ("deviation", "root mean square of the distance from the own path until arrival"),
    ("formation error", "root mean square of (10) of the paper, in worlds with a formation"),
    ("speed changes, rotation changes", "sum of |Δv| and of |Δω| of the commands of a robot, per "
     "second until it arrives; smooth driving has small values"),
    ("messages", "considered robots and decisions, (14), a robot and second, of entrants that use "
     "what robots tell one another: their stations and commands. 0 where poses and velocities that "
     "are seen are enough. Stations that formation control alone listens to are not counted"),
    ("decision", "processor time of a decision of one robot, in one thread; robots that decide "
     "together share the time alike. Median and 99 % quantile of each run; the median over runs"),
)  # fmt: skip


def answer(found: Standings) -> Iterator[tuple[str | Words, ...]]:
    """The verdict, and who is safe, gets through, and at what cost: lines of words."""
    by_name = {one.name: one for one in found.entrants}
    its = by_name[found.reference].controller if found.reference in by_name else ""
    judged = []
    for one in found.verdicts:
        rival = by_name[one.entrant]
        if not rival.is_own and rival.controller != its:
            judged.append(one)
    if not judged:
        yield (
            f"No verdict on the paper's claim: {found.reference} has no runs here beside those of "
            "a method that physim has.",
        )
    else:
        by = {word: [v.entrant for v in judged if v.verdict == word]
              for word in (HOLDS, PARTLY, FAILS, OPEN)}  # fmt: skip
        whole = next(word for word in by if by[word])
        yield (
            f'The paper says that its controller "{CLAIM}". For {found.reference}, in these '
            "worlds, the claim is ", Words("outcome", COLOURS[whole]), ": ",
            "; ".join(f"it {word} against {joined(names)}" for word, names in by.items() if names),
            ".",
        )  # fmt: skip
    if found.verdicts:
        yield (
            "It holds against an entrant where it is surely more often without contact, or surely "
            "arrives more often without contact, and is surely worse in neither; in part where it "
            "is better in one and worse in the other. Time is a price beside that. Settings of its "
            "own controller and controllers of one's own have no say in it.",
        )
    yield from _won_and_lost(found)
    yield from _leaders(found)


def _against(found: Standings, one: Verdict) -> str:
    """Why, in figures: rates over the worlds that both could drive in, then time."""
    of, k = found.place(found.reference), found.place(one.entrant)
    said = []
    for ranking in found.rankings:
        name = ranking.criterion.name
        sure = "surely " if name in (*one.better, *one.worse) else ""
        gap = ranking.difference(of, k)
        if isnan(gap):
            continue
        if name == "time":
            ratio = 1.0 / ranking.values[k]
            way = "longer" if ratio > 1.0 else "shorter"
            size = percent(abs(ratio - 1.0), 0)
            how = f"{sure}{size} {way}" if round(100.0 * abs(gap)) else "alike"
            said.append(f"where both arrive its makespan is {how}")
        else:
            what = "is without contact" if name == "contact_free" else "arrives without contact"
            points = round(100.0 * abs(gap))
            way = "more" if gap > 0.0 else "less"
            how = f"{sure}{way} often, by {plural(points, 'point')}" if points else "as often"
            said.append(f"it {what} {how}")
    return f"{'; '.join(said)}." if said else "they have no runs to compare."


def _leaders(found: Standings) -> Iterator[tuple[str | Words, ...]]:
    """Of each criterion those that nobody is surely better than, with their values."""
    heads = ("Safe", "Gets through", "Fast")
    for head, ranking in zip(heads, found.rankings, strict=True):
        every = [k for k, value in enumerate(ranking.values) if not isnan(value)]
        first = [k for k in every if not any(ranking.sure(a, k) > 0 for a in every if a != k)]
        first.sort(key=lambda k: ranking.values[k], reverse=ranking.criterion.name != "time")
        names = [f"{found.entrants[k].name} ({value_of(ranking, k)})" for k in first]
        if names and len(every) > 1:
            than = "nobody is surely better than " if len(first) < len(every) else (
                "nobody is surely better than anybody: ")  # fmt: skip
            yield (
                Words("strong", head), f" ({ranking.criterion.title}, "
                f"{ranking.criterion.value}): {than}{joined(names)}.",
            )  # fmt: skip


def _won_and_lost(found: Standings) -> Iterator[tuple[str | Words, ...]]:
    """Worlds in which the reference is shown to win against somebody, and to lose."""
    for which in ("wins", "loses"):
        by = {world: [v.entrant for v in found.verdicts if world in getattr(v, which)]
              for world in found.worlds}  # fmt: skip
        told = [f"{world} ({', '.join(names)})" for world, names in by.items() if names]
        if found.verdicts:
            where = f"in {joined(told)}" if told else "in no world is that shown"
            words = Words("strong", f"Where {found.reference} {which}")
            yield words, f" (and against whom): {where}."


def _troubles(found: Standings, world: str) -> Iterator[str]:
    """Why some entrants cannot drive in a world, and by what errors runs of others ended."""
    for one in found.league.refused:
        if one.world == world:
            yield f"{one.entrant} cannot drive here: {one.reason}"
    for (where, name), cell in found.rows.items():
        if where == world:
            failed = [row for row in found.outcomes.rows[cell.rows] if row.failed]
            reasons = dict.fromkeys(row.reason or row.ended for row in failed)
            if failed:
                yield f"{name}: {plural(len(failed), 'error')}: {next(iter(reasons))}"


def _film_words(film: Film) -> str:
    return (
        f"{film.entrant}, {film.which} run: {film.row.world}, seed {film.row.seed}, "
        f"{_came(film.row)}"
    )


def _film_table(
    found: Standings, folder: str, films: Sequence[Film]
) -> list[tuple[str | Words, ...]]:
    rows: list[tuple[str | Words, ...]] = [("entrant", "run", "world", "came", "command")]
    for film in films:
        again = Words("code", replay(folder, found.outcomes, film.row))
        rows.append((film.entrant, film.which, f"{film.row.world}, seed {film.row.seed}",
                     _came(film.row), again))  # fmt: skip
    return rows


def _came(row: Row) -> str:
    word = outcome_of(row)
    if word == "arrived":
        return f"arrived at {row.time_to_finish:.1f} s"
    if word == "contact" and row.first_contact is not None:
        speed = "" if row.closing_speed is None else f", closing at {row.closing_speed:.2f} m/s"
        return f"contact at {row.first_contact:.1f} s ({row.first_contact_pair}){speed}"
    return f"{word} after {row.seconds:.0f} s"


def _hours(seconds: float) -> str:
    return f"{seconds / 3600.0:.1f} h" if seconds >= 3600.0 else f"{seconds / 60.0:.1f} min"


def said(found: Standings) -> list[str]:
    """The answer as plain lines."""
    return ["".join(w if isinstance(w, str) else w.text for w in line) for line in answer(found)]


def league_text(found: Standings) -> str:
    """What the terminal tells: the answer, and the table of all worlds."""
    head, *rows = outcome_table(found, found.worlds)
    table = Table("", tuple(map(str, head)), [tuple(map(str, row)) for row in rows])
    troubles = [f"{world}: {line}" for world in found.worlds for line in _troubles(found, world)]
    rest = [f"{len(troubles) - MOST_TOLD} more in {MARKDOWN}"] * (len(troubles) > MOST_TOLD)
    return "\n".join([str(table), "", *said(found), *troubles[:MOST_TOLD], *rest]) + "\n"
