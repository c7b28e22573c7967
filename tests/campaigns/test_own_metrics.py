"""Metrics that packages register reach rows, results, reports and comparisons."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

import pandas as pd
import pytest

from physim.campaigns import Folder, read, rows, run_one
from physim.errors import PhysimError
from tests.campaigns.samples import specs, write
from tests.campaigns.tables import row
from tests.cli.commands import physim
from tests.helpers import check_error, inside
from tests.helpers.packages import install

FINISHED, by, compare = inside("physim.campaigns", "FINISHED", "by", "compare")
row_without_run, Outcomes = inside("physim.campaigns", "row_without_run", "Outcomes")
measures = inside("physim.cli", "measures")

TEXT = '''
class Seed:
    """The seed, halved."""
    unit = "m"

    def measure(self, record):
        return record.seed / 2

class Even:
    """Whether the seed is even."""
    unit = "-"

    def measure(self, record):
        return True if record.seed % 2 == 0 else None

class Fails:
    """Has no meaning but of seed 3, where it fails."""
    unit = "-"

    def measure(self, record):
        return 1 / 0 if record.seed == 3 else None

class Unusable:
    unit = 3
'''
ENTRIES = {"half": "Seed", "even": "Even", "fails": "Fails", "unusable": "Unusable"}


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with a world, in which metrics are installed for this and for other processes."""
    package = tmp_path / "package"
    package.mkdir()
    install(package, monkeypatch, "own_figures", TEXT, {"physim.metrics": ENTRIES})
    monkeypatch.chdir(tmp_path)
    write(tmp_path)
    rows.installed.cache_clear()
    yield tmp_path
    rows.installed.cache_clear()


def test_a_row_has_the_metrics_that_have_a_meaning_for_its_run(here: Path) -> None:
    found = [run_one(spec) for spec in specs(4)]
    assert [one.metrics for one in found[:3]] == [
        {"even": 1.0, "half": 0.0}, {"half": 0.5}, {"even": 1.0, "half": 1.0},
    ]  # fmt: skip
    assert found[3].ended == "error"
    assert '"fails" fails: ZeroDivisionError' in found[3].reason
    assert "own_figures.py:21" in found[3].reason


@pytest.mark.usefixtures("in_process")
def test_from_a_sweep_to_its_results_and_a_comparison(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = ("--seeds", "0:3", "--controller", "constant,path_following", "-o", "out")
    swept = physim("sweep", "small.yaml", *given, capture=capsys)
    assert swept.code == 0, swept.err
    assert "unusable" in swept.err  # and none is left out in silence
    results = pd.read_csv(here / "out/results.csv")
    assert results["metric_half"].tolist() == [0.0, 0.5, 1.0] * 2
    assert results["metric_even"].isna().tolist() == [False, True, False] * 2
    done = physim("compare", "out", "--by", "controller", "--only", "half:less,even:more",
                  "--json", "-", capture=capsys)  # fmt: skip
    (compared,) = json.loads(done.out)["comparisons"]
    halves, evens = compared["findings"]
    assert (halves["a"], halves["b"], halves["difference"], halves["pairs"]) == (0.5, 0.5, 0.0, 3)
    assert evens["pairs"] == 2
    told = physim("report", "out", "--no-pictures", capture=capsys)
    assert told.code == 0, told.err
    assert "0.500" in told.out.split("half [m]")[1].splitlines()[1]


@pytest.mark.parametrize(("better", "named"), [("less", "a"), ("more", "b")])
def test_which_values_are_better_is_given(better: str, named: str) -> None:
    rows = [
        row(seed, controller=controller, metrics={"way": seed + shift})
        for seed in range(30)
        for controller, shift in (("a", 0.0), ("b", 1.5))
    ]
    outcomes = Outcomes(rows)
    ways = {"metric_way": 1 if better == "more" else -1}
    (found,) = compare(by(outcomes, "controller"), ways)[0].findings
    assert (found.difference, found.better) == (1.5, named)
    with pytest.raises(PhysimError, match=r"wy.*way"):
        compare(by(outcomes, "controller"), {"metric_wy": 1})


def test_the_command_line_takes_names_with_what_is_better() -> None:
    assert measures("rate,way:less, gap:more") == {"rate": 1, "metric_way": -1, "metric_gap": 1}
    for wrong in ("way", "way:much", "rate:less:more", "Way:less"):
        with pytest.raises(ValueError, match="NAME:less") as caught:
            measures(wrong)
        assert wrong in str(caught.value)
    with pytest.raises(ValueError, match="each once; given: way:less"):
        measures("way:more,way:less")


FORGED: list[object] = [{"A": 1.0}, {"a": float("nan")}, {"a": "1"}, {"<b>": 1.0}, {"": 1.0}, 3]


@pytest.mark.parametrize("forged", FORGED)
def test_what_are_no_numbers_by_name_is_told_with_its_line(tmp_path: Path, forged: object) -> None:
    place = Folder(tmp_path / "campaign")
    place.open(specs(1))
    good = row_without_run(specs(1)[0], FINISHED, "")
    file = tmp_path / "campaign/rows/9-2-x-1.jsonl"
    file.parent.mkdir(exist_ok=True)
    lines = [json.dumps({**asdict(good), "metrics": one}) for one in ({"a": -1.5e-07}, forged)]
    file.write_text("\n".join([*lines, ""]))
    with pytest.raises(PhysimError) as caught:
        read(tmp_path / "campaign")
    check_error(f"{caught.value}\n", f"{file}:2: metrics")
    file.write_text(lines[0] + "\n")
    assert [one.metrics for one in read(tmp_path / "campaign")] == [{"a": -1.5e-07}]
