"""docs/explanation/reproduction.md is what the code computes: made from its report; a run agrees.

Runs are chaotic: on another machine rounding may change when a robot switches its mode, and with
that the extremes of a run. So what a robot does over its whole way is compared within `STEADY`, an
extreme by its order, and every claim by the grade that the run gets.
"""

from __future__ import annotations

import functools
import math
import re

import pytest

from physim import simulate
from physim.world.file import load_world
from tests import reproduction_docs as docs
from tests.helpers import inside

ORDER, measures = inside("physim.reproduction", "ORDER", "measures")
parts, papers, shown = inside("physim.reproduction", "parts", "papers", "shown")
Report, Claim, Measures = inside("physim.reproduction", "Report", "Claim", "Measures")
Outcome, Part, Verdict = inside("physim.reproduction", "Outcome", "Part", "Verdict")

STEADY = 0.1
"""[-] relative difference of figures over a whole run"""
STEADY_FIGURES = (
    "deviation_rms", "deviation_at_turns", "error_in_bends", "spread_start", "spread_largest",
    "averaged_speed_max", "farthest_distance", "start_headings", "safe_share", "width_min",
    "width_max", "messages", "evaluations", "time_to_finish", "time_at_steady_speed",
    "safe_least_of_5_8_10", "formation_error_peak",
)  # fmt: skip
EXTREMES = ("shortest_distance", "collision_time_pairs", "collision_time_decided")
LARGEST_PICTURE = 150_000
"""bytes"""
WORLDS = ("single_robot", "three_robots", "ten_robots")

report = pytest.fixture(scope="module")(lambda: docs.report_of("mode_switching"))


@functools.cache
def fresh(world: str) -> Measures:
    """Figures of the run in the pictures, run now."""
    with simulate(load_world(world)) as record:
        return measures(record)


def claims_of(part: Part, report: Report) -> list[tuple[Claim, Verdict]]:
    section = next(one for one in report.sections if one.key == part.figure)
    return list(zip(part.claims, section.rows, strict=True))


@pytest.mark.parametrize("paper", docs.PAGES)
def test_page_is_written_from_its_report(paper: str) -> None:
    written = docs.PAGES[paper].read_text(encoding="utf-8")
    assert written == docs.text_of(docs.report_of(paper)), (
        "python -m tests.reproduction_docs writes it anew"
    )


def test_the_readme_tells_how_many_claims_are_met(report: Report) -> None:
    said = docs.INDEX.read_text(encoding="utf-8").split(docs.BEGIN)[1].split(docs.END)[0]
    assert said == docs.claims(report)


@pytest.mark.parametrize("paper", docs.PAGES)
def test_every_part_and_study_is_there_whole(paper: str) -> None:
    report, one = docs.report_of(paper), papers()[paper]
    known = [part.figure for part in one.parts()] + [study.name for study in one.studies()]
    assert [section.key for section in report.sections] == known
    assert not report.interrupted
    assert not any(one.missing for one in report.sections)
    assert report.seeds == 100
    assert all(section.rows for section in report.sections)


@pytest.mark.parametrize(("paper", "least"), [("mode_switching", 29), ("polytope_vo", 4)])
def test_pictures_are_there_and_small(paper: str, least: int) -> None:
    page, folder = docs.PAGES[paper], docs.pictures_of(paper)
    shown = re.findall(rf"\]\(({folder.name}/[^)]*)\)", page.read_text(encoding="utf-8"))
    files = {page.parent / name for name in shown}
    assert files == set(folder.glob("*.png"))
    assert len(files) >= least
    for file in files:
        content = file.read_bytes()
        assert content.startswith(b"\x89PNG"), file.name
        assert len(content) <= LARGEST_PICTURE, file.name


@pytest.mark.parametrize("part", parts(), ids=lambda part: str(part.figure))
def test_rows_are_those_of_the_claims(part: Part, report: Report) -> None:
    """Words, figures and verdict of each row follow from the figures that the report holds."""
    figures = report.figures[part.world]
    for claim, row in claims_of(part, report):
        assert (row.claim, row.reported) == (claim.words, claim.reported)
        bare, _, of_bare = row.without.partition(" of ")
        too = bool(bare) and int(bare) >= claim.needed * int(of_bare) and row.outcome is Outcome.MET
        assert row.remark.startswith(claim.remark)
        assert ("holds without avoidance" in row.remark) == too
        assert row.measured == shown(claim.measured, [figures])
        met, _, of = row.met.partition(" of ")
        most = int(met) >= claim.needed * int(of)
        grade = claim.graded(figures)
        if grade is Outcome.MET:
            expected = Outcome.MET if most else Outcome.PARTLY
        else:
            expected = Outcome.PARTLY if most else grade
        assert row.outcome is expected, row.claim


@pytest.mark.parametrize("part", parts(), ids=lambda part: str(part.figure))
def test_a_run_gets_the_same_grades(part: Part, report: Report) -> None:
    for claim, row in claims_of(part, report):
        now = claim.graded(fresh(part.world))
        assert now is claim.graded(report.figures[part.world]), f"{row.claim}: {now}"


@pytest.mark.parametrize("world", WORLDS)
def test_a_run_gets_the_same_figures(world: str, report: Report) -> None:
    stored, now = report.figures[world], fresh(world)
    assert set(stored) == {name for name, value in now.items() if math.isfinite(value)}
    for name in STEADY_FIGURES:
        if name in stored:
            assert math.isclose(stored[name], now[name], rel_tol=STEADY), name
    for name in EXTREMES:
        if name in stored:
            assert stored[name] / ORDER <= now[name] <= stored[name] * ORDER, name
