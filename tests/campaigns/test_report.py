"""Reports: rates by hand, failed runs counted apart, nothing dropped, hostile names only names."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import imageio.v3 as iio
import numpy as np
import pytest

from physim.campaigns import Row
from physim.cli import main
from physim.units import amount, interval, percent
from tests.campaigns.real import campaign
from tests.campaigns.tables import failed, hit, many, row
from tests.helpers import facts, inside

Outcomes = inside("physim.campaigns", "Outcomes")
Report, report_of, Shown = inside("physim.campaigns.report", "Report", "report_of", "Shown")
report_page = inside("physim.campaigns.report", "report_page")
report_text = inside("physim.campaigns.report", "report_text")
report_values = inside("physim.campaigns.report", "report_values")
read_goal, clopper_pearson = inside("physim.statistics", "read_goal", "clopper_pearson")
running = inside("physim.statistics", "running")

HOSTILE = '<script>alert("1")</script>\x1b[31m\u202e&\'">'


def report(rows: list[Row], **given: Any) -> Report:
    return report_of(Outcomes(rows), "yard", **given)


def pages(one: Report, **shown: Any) -> tuple[str, str]:
    return report_text(one), report_page(one, [Shown(**shown) for _ in one.pictured])


class Elements(HTMLParser):
    """All elements of a page and their attributes, and its text."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str]] = []
        self.open: list[str] = []
        self.said = ""
        self.feed(page)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: Any) -> None:
        self.tags.append(tag)
        self.attributes += attrs
        if tag not in ("meta", "img", "br"):
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: Any) -> None:
        self.tags.append(tag)
        self.attributes += attrs

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.said += data


SOME = [*(row(seed) for seed in range(8)), hit(8), failed(9), row(10, ended="duration")]


def test_rates_by_hand() -> None:
    (cell,) = report(SOME).cells
    assert [(rate.name, rate.good, rate.of) for rate in cell.rates] == [
        ("rate", 8, 11), ("contact_free", 9, 11), ("finished", 9, 11),
    ]  # fmt: skip
    for rate in cell.rates:
        assert (rate.low, rate.high) == clopper_pearson(rate.good, rate.of)
        assert rate.at_most is None
    assert (cell.failed, cell.touched) == (1, 1)


def test_failed_runs_count_as_no_success_and_are_told() -> None:
    """They are in no average of distances, and it says of how many that is."""
    one = report(SOME)
    near = one.cells[0].spreads["least_distance"]
    assert near.count == 10
    assert one.failures[0].seeds == (9,)
    for words in pages(one):
        assert re.search(facts("it broke", "crashed"), words)


def test_without_a_failure_it_says_what_that_shows() -> None:
    (cell,) = report([row(seed) for seed in range(100)]).cells
    assert cell.rates[0].at_most == pytest.approx(1 - 0.05 ** (1 / 100))
    assert cell.rates[0].needed == 2995


def test_a_campaign_with_a_goal_has_the_sequence_and_says_so() -> None:
    rows = [hit(seed) if seed % 25 == 0 else row(seed) for seed in range(600)]
    goal = read_goal("rate > 0.9")
    one = report(rows, goal=goal)
    (cell,) = one.cells
    looks = running([seed % 25 != 0 for seed in range(600)])
    runs = cell.decision.runs if cell.decision else 0
    assert runs < 600
    for rate in cell.rates[:2]:
        assert (rate.low, rate.high) == (looks.low[runs - 1], looks.high[runs - 1])
        assert (rate.good, rate.of) == (looks.successes[runs - 1], runs)
    assert cell.rates[2].needed == 8062
    for words, plain in zip(pages(one), pages(report(rows)), strict=True):
        assert "confidence sequence" in words
        assert f"decided after {runs} runs" in words
        assert "Clopper" in plain


@pytest.mark.parametrize(
    ("missing", "runs", "decided"), [({40}, 40, False), ({0, 40}, 0, False), (set(), None, True)]
)
def test_only_runs_without_a_gap_decide(missing: set[int], runs: int | None, decided: bool) -> None:
    """A run that is missing may be the one that takes long: what comes after it has no say."""
    rows = [row(seed) for seed in range(300) if seed not in missing]
    decision = report(rows, goal=read_goal("rate > 0.95"), first=0).cells[0].decision
    assert decision is not None
    assert decision.decided is decided
    assert runs in (None, decision.runs)


def test_the_worst_of_each_cell_are_its_severest_contacts() -> None:
    outcomes = Outcomes(many(3000, cells=3))
    speed = outcomes.column("closing_speed")
    for one in report_of(outcomes, "yard").cells:
        mine = speed[one.cell.rows]
        worst = sorted(mine[~np.isnan(mine)])[:-4:-1]
        assert list(speed[list(one.worst)])[: len(worst)] == worst
        assert len(one.worst) == 3
    (tied,) = report([row(seed, least_distance=0.5) for seed in range(30)]).cells
    assert tied.worst == tuple(range(10))
    assert report([failed()]).cells[0].worst == ()


def test_a_hard_hit_comes_before_a_deep_one_and_both_before_what_only_came_near() -> None:
    rows = [row(seed, least_distance=0.001) for seed in range(12)]
    rows += [hit(20 + k, depth=0.02, closing_speed=0.1, energy_lost=0.5) for k in range(9)]
    rows += [hit(30, depth=0.0001, closing_speed=1.46, energy_lost=35.6, impulse=48.0,
                 severest_contact_pair="r2, r3", severest_contact_time=7.5)]  # fmt: skip
    one = report(rows)
    assert [one.outcomes.seed[row] for row in one.cells[0].worst] == [30, *range(20, 29)]


def test_runs_that_did_not_finish_are_told_and_shown_by_cell() -> None:
    rows = [row(seed, ended="duration" if seed % 2 else "finished", not_arrived="r1, r3",
                stood="r3") for seed in range(20)]  # fmt: skip
    rows += [hit(seed, controller="other", ended="duration") for seed in range(3)]
    one = report(rows)
    assert [(len(cell.unfinished), cell.touched, cell.failed) for cell in one.cells] == [
        (10, 0, 0), (3, 3, 0),
    ]  # fmt: skip
    shown = [one.outcomes.rows[index] for index, moment in one.pictured if moment == "end"]
    assert {(row.controller, row.ended) for row in shown} == {
        ("good", "duration"), ("other", "duration"),
    }  # fmt: skip
    assert json.loads(json.dumps(report_values(one)))["unfinished"][0]["stood"] == {"r3": 10}


def test_hostile_names_are_only_names() -> None:
    rows = [
        row(1, world=HOSTILE, controller=HOSTILE, settings=HOSTILE, physim=HOSTILE,
            engine=HOSTILE, least_distance_pair=HOSTILE),
        hit(2, world=HOSTILE, least_distance_pair=HOSTILE),
        failed(3, reason=HOSTILE, world=HOSTILE),
    ]  # fmt: skip
    one = report_of(Outcomes(rows), HOSTILE)
    shown = [Shown(b"PNG", f"javascript:{HOSTILE}", HOSTILE) for _ in one.pictured]
    page = report_page(one, shown)
    plain = Elements(report_page(report([row(1), hit(2), failed(3)]), [Shown()] * 2))
    found = Elements(page)
    assert set(found.tags) <= {*plain.tags, "a", "img"}
    assert "script" not in found.tags
    assert [name for name, _ in found.attributes if name.startswith("on")] == []
    for words in (page, report_text(one, explain=True)):
        assert "\x1b" not in words
        assert "\u202e" not in words
    _, page = pages(report(SOME), still=b"\x89PNG")  # and a page loads nothing
    sources = [value for name, value in Elements(page).attributes if name in ("src", "href")]
    assert all(value.startswith("data:") for value in sources)
    json.dumps(report_values(one), allow_nan=False)


@pytest.mark.parametrize(
    ("share", "side", "text"),
    [
        (1.0, 0, "100.0 %"), (0.0, 0, "0.0 %"), (0.5, 0, "50.0 %"), (0.999, 0, "99.9 %"),
        (0.9995, 0, "99.95 %"), (0.99999, 0, "99.999 %"), (0.0004, 0, "0.04 %"),
        (0.12349, -1, "12.3 %"), (0.12341, 1, "12.4 %"), (0.95, -1, "95.0 %"), (0.95, 1, "95.0 %"),
    ],
)  # fmt: skip
def test_nothing_near_certain_is_written_as_certain(share: float, side: int, text: str) -> None:
    assert percent(share, None, side) == text


def test_ends_are_rounded_outward() -> None:
    assert interval(0.12349, 0.87651) == "[12.3 %, 87.7 %]"
    assert interval(0.963, 1.0) == "[96.3 %, 100.0 %]"
    assert amount(-1e-9, "m") == "0.000 m"


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.0304, "", "0.0304"), (1.23456, "rad/s", "1.235 rad/s"), (90.0, "", "90"),
        (1801.5, "", "1,801.5"), (-1.7e308, "kg", "-1.7e308 kg"), (0.31234, "m", "0.312 m"),
        (-0.00031234, "m", "-0.00031 m"), (0.0123, "s", "0.01 s"),
    ],
)  # fmt: skip
def test_each_unit_has_its_digits_and_what_is_small_two_at_least(
    value: float, unit: str, text: str
) -> None:
    assert amount(value, unit) == text


def films(page: Path) -> list[Path]:
    attributes = Elements(page.read_text()).attributes
    return sorted({(page.parent / value).resolve() for name, value in attributes if name == "href"})


def test_the_page_leads_to_a_film_of_every_run_and_makes_none_again(tmp_path: Path) -> None:
    folder, page = tmp_path / "runs", tmp_path / "pages/r.html"
    campaign(folder, range(2), ("mode_switching",))
    page.parent.mkdir()
    assert main(["report", str(folder), "--videos", "--quiet", "-o", str(page)]) == 0
    made = {film: film.stat().st_mtime_ns for film in (folder / "videos").resolve().iterdir()}
    assert films(page) == sorted(made)
    assert len(made) == 2
    for film in made:
        shown = sum(1 for _ in iio.imiter(film, plugin="FFMPEG"))
        found = iio.immeta(film, plugin="FFMPEG")
        assert shown / found["fps"] == pytest.approx(found["duration"], abs=0.05)
        assert found["duration"] >= 1.0  # the run, and its last picture
    assert main(["report", str(folder), "--quiet"]) == 0
    assert films(folder / "report.html") == sorted(made)
    assert {film: film.stat().st_mtime_ns for film in made} == made
