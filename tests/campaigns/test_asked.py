"""What a campaign was asked for and has no rows of: a shard, the rest of an interrupted one."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from physim.cli import main
from tests.campaigns.tables import row, table
from tests.cli.commands import physim, tree
from tests.helpers import check_error, examples, facts, inside

as_stored, merged, missing = inside("physim.campaigns", "as_stored", "merged", "missing")
ranges_of, Outcomes = inside("physim.campaigns", "ranges_of", "Outcomes")

pytestmark = pytest.mark.usefixtures("in_process")

RANGES = st.lists(st.builds(range, st.integers(0, 40), st.integers(0, 40)), max_size=6)
YARD = ("yard", "", "mode_switching")


@examples(25, deep=100)
@given(RANGES)
@example([range(0, 2), range(2, 4)])
@example([range(0, 2), range(3, 4)])
def test_ranges_hold_the_same_seeds_in_as_few_pieces_as_can_be(ranges: list[range]) -> None:
    found = merged(ranges)
    assert [k for one in found for k in one] == sorted({k for one in ranges for k in one})
    assert all(one.stop < other.start for one, other in zip(found, found[1:], strict=False))
    assert ranges_of(json.loads(json.dumps(as_stored(found)))) == found


@examples(25, deep=100)
@given(RANGES, st.sets(st.integers(0, 40)))
def test_missing_are_the_seeds_without_a_row(ranges: list[range], seeds: set[int]) -> None:
    rows = [{**row(seed), "world": "yard", "settings": "", "controller": YARD[2]} for seed in seeds]
    asked = {k for one in ranges for k in one}
    found = missing({YARD: merged(ranges)}, Outcomes(table(rows)))
    lacking = len(asked - seeds)
    assert found == (((YARD, lacking, len(asked)),) if lacking else ())


def swept(*command: object) -> None:
    assert main([str(one) for one in ("sweep", *command, "--workers", "1", "--quiet")]) == 0


def shards(folder: Path, *numbers: int) -> None:
    for number in numbers:
        swept("small.yaml", "fixed.yaml", "--seeds", "0:5", "-o", folder, "--shard", f"{number}/3")


def test_a_missing_shard_is_told_and_one_that_is_there_is_not(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = here / "out"
    report = ("report", out, "--no-pictures", "--json", here / "figures.json", "--force")
    shards(out, 1, 3)
    done = physim(*report, capture=capsys)
    assert done.code == 0
    figures = json.loads((here / "figures.json").read_text())
    lacks = figures["runs"], figures["missing"]
    assert "Not complete: 2" in done.out
    assert re.search(facts("small, mode_switching: 2 of 5", "shard"), done.out)
    assert lacks == (4, [{"cell": "small, mode_switching", "runs": 2, "of": 5}])
    assert "Not complete: 2" in (out / "report.html").read_text(encoding="utf-8")
    shards(out, 2)
    done = physim(*report, capture=capsys)
    assert "complete" not in done.out
    assert "complete" not in (out / "report.html").read_text(encoding="utf-8")
    figures = json.loads((here / "figures.json").read_text())
    assert (figures["runs"], figures["missing"]) == (6, [])


def test_a_comparison_of_a_part_says_so(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    both = ("--controller", "constant,path_following")
    command = ("small.yaml", "--seeds", "0:6", "-o", "out", *both)
    swept(*command, "--shard", "1/2")
    done = physim("compare", "out", "--by", "controller", "--only", "deviation", capture=capsys)
    assert "Not complete: 6" in done.err
    swept(*command)
    done = physim("compare", "out", "--by", "controller", "--only", "deviation", capture=capsys)
    assert "complete" not in done.err


def test_more_seeds_and_seeds_apart_are_asked_for_together(here: Path) -> None:
    out = here / "out"
    for seeds in ("0:2", "5:7", "1:3"):
        swept("small.yaml", "--seeds", seeds, "-o", out)
    (cell,) = json.loads((out / "campaign.json").read_text())["cells"]
    assert cell["seeds"] == [[0, 3], [5, 7]]


def test_until_a_goal_is_decided_no_number_is_asked_for(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    swept("small.yaml", "--seeds", "0:60", "-o", "out", "--until", "rate < 0.8")
    done = physim("report", "out", "--no-pictures", capture=capsys)
    assert "complete" not in done.out


NO_SEEDS = (7, [[0]], [[0, True]], [[-1, 3]], [[0, 10**30]], [[0, 1]] * 2000)


@pytest.mark.parametrize("seeds", NO_SEEDS)
def test_seeds_that_are_none_are_refused(
    here: Path, seeds: object, capsys: pytest.CaptureFixture[str]
) -> None:
    shards(here / "out", 1)
    file = here / "out" / "campaign.json"
    found = json.loads(file.read_text())
    found["cells"][0]["seeds"] = seeds
    file.write_text(json.dumps(found))
    before = tree(here / "out")
    done = physim("report", "out", "--no-pictures", capture=capsys)
    assert done.code == 2
    check_error(done.err, "out/campaign.json", "seeds")
    assert tree(here / "out") == before
