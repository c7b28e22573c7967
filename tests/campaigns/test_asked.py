"""What a campaign was asked for and has no rows of, and when it has seen enough."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from physim.cli import main
from tests.campaigns.tables import row
from tests.cli.commands import physim, tree
from tests.helpers import check_error, examples, facts, inside

Until, read_until = inside("physim.campaigns", "Until", "read_until")
write_until = inside("physim.campaigns", "write_until")
read_goal = inside("physim.statistics", "read_goal")
merged, missing, Outcomes = inside("physim.campaigns", "merged", "missing", "Outcomes")

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


@examples(25, deep=100)
@given(RANGES, st.sets(st.integers(0, 40)))
def test_missing_are_the_seeds_without_a_row(ranges: list[range], seeds: set[int]) -> None:
    rows = [row(seed, controller=YARD[2]) for seed in seeds]
    asked = {k for one in ranges for k in one}
    found = missing({YARD: merged(ranges)}, Outcomes(rows))
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


def test_it_stops_at_the_first_run_that_decides(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = (
        "sweep",
        "small.yaml",
        "--seeds",
        "0:60",
        "-o",
        "out",
        "--until",
        "contact_free > 0.2",
    )
    first = json.loads(physim(*command, "--json", capture=capsys).out)["cells"][0]["decision"]
    again = json.loads(physim(*command, "--json", capture=capsys).out)
    assert again["cells"][0]["decision"] == first
    assert (again["run_now"], first["decided"], first["holds"]) == (0, True, True)
    assert first["runs"] < 60


def test_the_folder_tells_the_goal(tmp_path: Path) -> None:
    assert read_until(tmp_path) is None
    wanted = Until(read_goal("rate > 99%"), 5)
    write_until(tmp_path, wanted)
    assert read_until(tmp_path) == wanted
    write_until(tmp_path, Until(read_goal("0.02"), 9))
    assert read_until(tmp_path) == Until(read_goal("0.02"), 5)
