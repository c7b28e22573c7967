"""Reports: rates by hand, failed runs counted apart, nothing dropped, hostile names only names."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from typing import Any

import numpy as np
import pytest

from tests.campaigns.tables import failed, hit, many, row, table
from tests.helpers import facts, inside

figures, Outcomes = inside("physim.campaigns", "figures", "Outcomes")
Report, report_of, Shown = inside("physim.campaigns.report", "Report", "report_of", "Shown")
report_page, distribution = inside("physim.campaigns.report", "report_page", "distribution")
paired_plot, shift_plot = inside("physim.campaigns.report", "paired_plot", "shift_plot")
spread_axis, report_text = inside("physim.campaigns.report", "spread_axis", "report_text")
report_values, amount = inside("physim.campaigns.report", "report_values", "amount")
interval, percent = inside("physim.campaigns.report", "interval", "percent")
metres = inside("physim.drawing", "metres")
sprite = inside("physim.drawing.video", "sprite")
read_goal, clopper_pearson = inside("physim.statistics", "read_goal", "clopper_pearson")
running = inside("physim.statistics", "running")

HOSTILE = '<script>alert("1")</script>\x1b[31m\u202e&\'">'


def report(rows: list[dict[str, Any]], **given: Any) -> Report:
    return report_of(Outcomes(table(rows)), "yard", **given)


def pages(one: Report, **shown: Any) -> tuple[str, str]:
    commands = [f"physim replay yard:{one.outcomes.row(row)['run']}" for row, _ in one.pictured]
    page = report_page(one, [Shown(command, **shown) for command in commands])
    return report_text(one, commands), page


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
        if tag not in ("meta", "img", "br", "line", "circle", "rect"):
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
    near = one.cells[0].spread("least_distance")
    assert near.count == 10
    assert one.failures[0].seeds == (9,)
    text, page = pages(one)
    assert re.search(r"11 runs, of which 1 with contacts, 1 did not finish, 1 crashed", text)
    assert re.search(r"error: it broke", text)
    assert "of 10 that have one" in text
    said = Elements(page).said
    assert "1 run crashed" in said
    assert "it broke" in said
    assert "10 of 11 runs have one" in said


def test_without_a_failure_it_says_what_that_shows() -> None:
    (cell,) = report([row(seed) for seed in range(100)]).cells
    assert cell.rates[0].at_most == pytest.approx(1 - 0.05 ** (1 / 100))
    assert cell.rates[0].needed == 2995
    text, page = pages(report([row(seed) for seed in range(100)]))
    for words in (text, Elements(page).said):
        assert re.search(r"at most 3\.0 % go wrong; 2,895 more", words)
        assert "99.9 %" in words
    assert text.count("at most") == 1, "of three rates of 100 %, one line says it"
    text, _ = pages(report([row(seed) for seed in range(3000)]))
    assert re.search(r"at most 0\.10 % go wrong, which shows 99\.9 %", text)


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
    text, page = pages(one)
    for words in (text, Elements(page).said):
        assert "confidence sequence" in words
        assert re.search(
            rf"decided after {runs} runs: contact-free and finished above 90\.0 %", words
        )
    assert "Clopper" in pages(report(rows))[0]
    assert "Clopper" in pages(report(rows))[1]


def test_only_runs_without_a_gap_decide() -> None:
    """A run that is missing may be the one that takes long: what comes after it has no say."""
    rows = [row(seed) for seed in range(300) if seed != 40]
    goal = read_goal("rate > 0.95")
    decision = report(rows, goal=goal, first=0).cells[0].decision
    assert decision is not None
    assert (decision.runs, decision.decided) == (40, False)
    decision = report(rows[1:], goal=goal, first=0).cells[0].decision
    assert decision is not None
    assert (decision.runs, decision.decided) == (0, False)
    whole = report([row(seed) for seed in range(300)], goal=goal, first=0).cells[0].decision
    assert whole is not None
    assert whole.decided


def test_the_worst_are_the_ten_severest_contacts() -> None:
    outcomes = Outcomes(many(3000))
    one = report_of(outcomes, "yard")
    speed = outcomes.column("closing_speed")
    assert list(speed[list(one.worst)]) == sorted(speed[~np.isnan(speed)])[:-11:-1]
    tied = report([row(seed, least_distance=0.5) for seed in range(30)])
    assert tied.worst == tuple(range(10))
    assert report([failed()]).worst == ()


def test_a_hard_hit_comes_before_a_deep_one_and_both_before_what_only_came_near() -> None:
    rows = [row(seed, least_distance=0.001) for seed in range(12)]
    rows += [hit(20 + k, depth=0.02, closing_speed=0.1, energy_lost=0.5) for k in range(9)]
    rows += [hit(30, depth=0.0001, closing_speed=1.46, energy_lost=35.6, impulse=48.0,
                 severest_contact_pair="r2, r3", severest_contact_time=7.5)]  # fmt: skip
    one = report(rows)
    assert [one.outcomes.seed[row] for row in one.worst] == [30, *range(20, 29)]
    text, page = pages(one)
    for words in (text, Elements(page).said):
        assert re.search(facts("1.46 m/s", "35.6 J", "r2, r3 at 7.50 s"), words)


def test_runs_that_did_not_finish_are_told_and_shown_by_cell() -> None:
    rows = [row(seed, ended="duration" if seed % 2 else "finished", not_arrived="r1, r3",
                stood="r3") for seed in range(20)]  # fmt: skip
    rows += [hit(seed, controller="other", ended="duration") for seed in range(3)]
    one = report(rows)
    assert [(cell.unfinished, cell.touched, cell.failed) for cell in one.cells] == [
        (10, 0, 0), (3, 3, 0),
    ]  # fmt: skip
    shown = [one.outcomes.row(index) for index, moment in one.pictured if moment == "end"]
    assert {(row["controller"], row["ended"]) for row in shown} == {
        ("good", "duration"), ("other", "duration"),
    }  # fmt: skip
    text, page = pages(one, still=b"\x89PNG")
    for words in (text, Elements(page).said):
        said = facts("seeds 1, 3, 5", "r3 (10", "r1 (10", "still moved:")
        assert re.search(said, words)
        assert "failed" not in words
    assert page.count("<img") == len(one.worst) + len(shown)
    assert json.loads(json.dumps(report_values(one)))["unfinished"][0]["stood"] == {"r3": 10}


def test_cells_without_any_value_are_told_too() -> None:
    text, page = pages(report([failed(seed) for seed in range(3)]))
    assert "3 runs, of which 3 crashed" in text
    assert "no run has one" in Elements(page).said
    assert "nan" not in text + Elements(page).said
    empty, page = pages(report([]))
    assert "0 runs" in empty
    assert "no runs" in Elements(page).said


def test_hostile_names_are_only_names() -> None:
    rows = [
        row(1, world=HOSTILE, controller=HOSTILE, settings=HOSTILE, physim=HOSTILE,
            least_distance_pair=HOSTILE, run=HOSTILE),
        hit(2, world=HOSTILE, least_distance_pair=HOSTILE),
        failed(3, reason=HOSTILE, ended=HOSTILE, world=HOSTILE),
    ]  # fmt: skip
    one = report_of(Outcomes(table(rows)), HOSTILE)
    shown = [Shown(HOSTILE, b"PNG", f"javascript:{HOSTILE}", HOSTILE) for _ in one.pictured]
    page = report_page(one, shown)
    plain = Elements(report_page(report([row(1), hit(2), failed(3)]), [Shown("")] * 2))
    found = Elements(page)
    assert set(found.tags) <= {*plain.tags, "a", "img"}
    assert "script" not in found.tags
    assert [name for name, _ in found.attributes if name.startswith("on")] == []
    assert "\x1b" not in page
    assert "\u202e" not in page
    text = report_text(one, [HOSTILE] * len(one.worst))
    assert "\x1b" not in text
    assert "\u202e" not in text
    json.dumps(report_values(one), allow_nan=False)


def test_the_page_loads_nothing_and_runs_nothing() -> None:
    _, page = pages(report(SOME), still=b"\x89PNG")
    found = Elements(page)
    assert "script" not in found.tags
    assert "link" not in found.tags
    sources = [value for name, value in found.attributes if name in ("src", "href")]
    assert all(value.startswith("data:") for value in sources)
    assert "http" not in re.sub(r'"http-equiv"|http-equiv=', "", page)
    assert "url(" not in page


def test_values_of_a_report() -> None:
    values = json.loads(json.dumps(report_values(report(SOME)), allow_nan=False))
    (cell,) = values["cells"]
    assert (cell["runs"], cell["failed"]) == (11, 1)
    assert cell["rates"][0]["good"] == 8
    assert cell["measures"]["formation_error"]["median"] is None
    assert values["worst"][0]["least_distance"] == -0.01
    assert values["failures"][0]["seeds"] == [9]


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
        (0.0304, "", "0.0304"),
        (1.23456, "rad/s", "1.235 rad/s"),
        (90.0, "", "90"),
        (3.0, "rad", "3 rad"),
        (1801.5, "", "1,801.5"),
        (12345.0, "", "12,345"),
        (1e20, "", "1e20"),
        (-1.7e308, "kg", "-1.7e308 kg"),
        (1.23456e9, "m", "1.235e9 m"),
        (999999999.0, "", "999,999,999"),
        (0.31234, "m", "0.312 m"),
        (-0.00031234, "m", "-0.00031 m"),
        (0.0123, "s", "0.01 s"),
    ],
)
def test_each_unit_has_its_digits_and_what_is_small_two_at_least(
    value: float, unit: str, text: str
) -> None:
    assert amount(value, unit) == text
