"""``physim crashtest`` and ``physim plot`` as they are meant to be used."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from physim.analysis.crashtest import crash_test
from physim.drawing.plots import NAMES
from physim.record import Record
from tests.analysis.crashtest.sabotage import two_steps_late
from tests.cli.commands import physim, shell, tree
from tests.helpers import check_error, facts
from tests.helpers.records import make_record


@pytest.fixture(scope="module", autouse=True)
def _warm() -> None:
    """Kernels are compiled before any command runs, so that none says that it compiles."""
    crash_test(11)


def test_agreement_ends_with_0_and_writes_nothing_but_the_json(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    done = physim("crashtest", "--cases", 60, "--seed", 2, "--json", "found.json", capture=capsys)
    assert (done.code, done.err) == (0, "")
    last = done.out.splitlines()[-1]
    assert re.search(facts("agree", "0 of 60 cases", "seed 2", "unexplained"), last)
    assert list(tree(tmp_path)) == ["found.json"]
    first = (tmp_path / "found.json").read_bytes()
    found = json.loads(first)
    assert (found["format"], found["version"], found["cases"]) == ("physim-crashtest", 1, 60)
    again = ("crashtest", "--cases", 60, "--seed", 2, "--json", "found.json", "--force", "--quiet")
    assert physim(*again, capture=capsys) == (0, "", "")
    assert (tmp_path / "found.json").read_bytes() == first


def test_json_on_standard_output_stands_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    done = physim("crashtest", "--cases", 20, "--json", "-", capture=capsys)
    assert json.loads(done.out)["cases"] == 20
    last = done.err.splitlines()[-1]
    assert re.search(facts("agree", "0 of 20 cases", "seed 0", "unexplained"), last)
    assert list(tree(tmp_path)) == []


def test_a_disagreement_ends_with_3_and_worlds_that_run_replays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("physim.analysis.crashtest.experiment.predict", two_steps_late)
    done = physim("crashtest", "--cases", 60, "--json", "found.json", capture=capsys)
    assert done.code == 3
    assert "checks disagree" in done.out.splitlines()[-1]
    found = json.loads((tmp_path / "found.json").read_text())["unexplained"]
    assert [one["world"] for one in found] == [
        f"crashtest-0/{file.name}" for file in sorted(Path("crashtest-0").iterdir())
    ]
    hit = next(one for one in found if one["physical_sample"] is not None)
    assert hit["world"] in done.out
    run = physim("run", hit["world"], "-o", "again", "--no-video", "--quiet", capture=capsys)
    assert run == (0, "", "")
    with Record.load("again/record.h5") as record:
        assert record.contacts["step"].min() == hit["physical_sample"]


def test_in_a_pipe_there_is_no_bar(tmp_path: Path) -> None:
    done = shell("crashtest", "--cases", "20", folder=tmp_path)
    assert (done.code, done.err) == (0, "")
    assert done.out.count("\r") == 0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--cases", "0"), ("--cases 0:", "a whole number from 1 to 1000000000")),
        (("--json", "nowhere/x.json"), ("nowhere/x.json:", "no folder nowhere")),
        (("-o", "file"), ("file:", "is a file", "-o takes a folder")),
    ],
)
def test_bad_arguments_end_with_2(
    arguments: tuple[str, ...],
    said: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    done = physim("crashtest", *arguments, capture=capsys)
    assert (done.code, done.out) == (2, "")
    check_error(done.err, *said)


def test_plot_draws_beside_the_record(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    make_record("record.h5").close()
    done = physim("plot", "record.h5", "--only", "distances", "-o", "pictures", capture=capsys)
    assert done == (0, "pictures/distances.png\n", "")
    done = physim("plot", "record.h5", "--format", "svg", capture=capsys)
    assert done == (0, "".join(f"{name}.svg\n" for name in NAMES), "")
    refused = physim("plot", "record.h5", "--format", "svg", capture=capsys)
    assert refused.code == 2
    check_error(refused.err, "trajectories.svg:", "exists", "--force", "-o")
    unknown = physim("plot", "record.h5", "--only", "distance", capture=capsys)
    assert unknown.code == 2
    check_error(unknown.err, "--only distance:", ", ".join(NAMES), '"distances"')
    missing = physim("plot", "none.h5", capture=capsys)
    assert (missing.code, missing.out) == (2, "")
