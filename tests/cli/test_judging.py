"""``summary``, ``page``, ``plot``, ``check-controller`` and ``crashtest``, as they are meant."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from physim.analysis.crashtest import crash_test
from physim.analysis.metrics import DEFINITIONS, measure
from physim.drawing.plots import NAMES
from physim.record import Record
from physim.testing import situations
from tests.analysis.crashtest.sabotage import two_steps_late
from tests.cli.commands import physim, tree
from tests.helpers import check_error, facts, inside
from tests.helpers.records import make_record

Bar = inside("physim.cli", "Bar")

BROKEN = "tests.testing.broken"
STRAIGHT = ("--world", "straight", "--seconds", 0.3)


def test_definitions_tell_every_metric(capsys) -> None:
    done = physim("summary", "--definitions", capture=capsys)
    assert (done.code, done.err) == (0, "")
    lines = done.out.splitlines()
    assert [line.split()[0] for line in lines if line[0] != " "] == list(DEFINITIONS)
    told = json.loads(physim("summary", "--definitions", "--json", capture=capsys).out)
    assert told["shortest_collision_time"]["unit"] == "s"
    assert list(told) == list(DEFINITIONS)


def test_a_summary_holds_every_metric_of_the_record(here: Path, capsys) -> None:
    make_record(here / "r.h5", robots=1, seconds=12.0).close()
    told = json.loads(physim("summary", "r.h5", "--json", capture=capsys).out)
    with Record.load(here / "r.h5") as record:
        found = measure(record)
    assert {name: one["value"] for name, one in told["metrics"].items()} == {
        name: one.value for name, one in found.items()
    }
    assert told["metrics"]["contacts"] == {"value": 0, "unit": "-"}


def test_a_page_is_written_beside_its_record_or_of_several(here: Path, capsys) -> None:
    for name in ("a", "b"):
        (here / name).mkdir()
        make_record(here / name / "record.h5", 2, 2.0, contacts=False).close()
    assert physim("page", "a/record.h5", capture=capsys) == (0, "a/page.html\n", "")
    text = (here / "a/page.html").read_text(encoding="utf-8")
    assert text.startswith("<!DOCTYPE html>")
    assert text.count('class="run">') == 2
    both = physim("page", "a", "b", "-o", "both.html", "--quiet", capture=capsys)
    assert (both.code, both.out) == (0, "")
    assert (here / "both.html").read_text(encoding="utf-8").count('class="run">') == 3
    assert {file.name for file in (here / "a").iterdir()} == {"record.h5", "page.html"}


def test_plot_draws_beside_the_record(here: Path, capsys) -> None:
    make_record("record.h5", seconds=2.0).close()
    done = physim("plot", "record.h5", "--only", "distances", "-o", "pictures", capture=capsys)
    assert done == (0, "pictures/distances.png\n", "")
    given = ("plot", "record.h5", "--only", "modes,speeds", "--format", "svg")
    assert physim(*given, capture=capsys) == (0, "modes.svg\nspeeds.svg\n", "")
    refused = physim(*given, capture=capsys)
    assert refused.code == 2
    check_error(refused.err, "modes.svg:", "exists", "--force", "-o")
    unknown = physim("plot", "record.h5", "--only", "distance", capture=capsys)
    check_error(unknown.err, "no figure is called", '"distance"', ", ".join(NAMES), '"distances"')


def test_a_controller_without_findings(monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    """The bar names the world under way, not the one before."""
    told: list[tuple[float, str]] = []
    monkeypatch.setattr(Bar, "update", lambda self, done, note="": told.append((done, note)))
    done = physim("check-controller", f"{BROKEN}:Sound", *STRAIGHT, capture=capsys)
    assert (done.code, done.err) == (0, "")
    (line,) = done.out.splitlines()
    assert line.startswith(f"{BROKEN}:Sound: ")
    assert re.search(facts("no findings", "decisions", "1 world", "5 situations"), line)
    assert told == list(enumerate(["straight", *situations()]))


def test_a_line_a_finding_or_json(capsys) -> None:
    done = physim("check-controller", f"{BROKEN}:CountsOnItself", *STRAIGHT, capture=capsys)
    assert (done.code, done.err) == (1, "")
    *lines, last = done.out.splitlines()
    assert [line.partition(" at ")[0] for line in lines[:2]] == [
        "state: straight, r1", "state: nobody in sight, a",
    ]  # fmt: skip
    assert len(lines) == 1 + len(situations())
    assert last.startswith(f"{BROKEN}:CountsOnItself: {len(lines)} findings in ")

    done = physim("check-controller", f"{BROKEN}:Throws", *STRAIGHT, "--json", capture=capsys)
    assert (done.code, done.err) == (1, "")
    told = json.loads(done.out)
    assert (told["format"], told["version"]) == ("physim-check-controller", 1)
    first = told["findings"][0]
    assert {key: first[key] for key in ("rule", "world", "robot", "time")} == {
        "rule": "repeats", "world": "straight", "robot": "r1", "time": 0.0,
    }  # fmt: skip
    assert [world["world"] for world in told["worlds"]] == ["straight", *situations()]
    assert [world["situation"] for world in told["worlds"]] == [False] + [True] * 5


def test_settings_of_a_checked_controller_are_given_as_for_a_run(capsys) -> None:
    command = ("check-controller", f"{BROKEN}:Adjustable", *STRAIGHT, "--set")
    assert physim(*command, "controller.share=0.8", capture=capsys).code == 0
    done = physim(*command, "controller.share=1.1", capture=capsys)
    assert done.code == 1
    assert done.out.startswith("decision: straight, r1 at 0 s: ")
    assert "v = 1.65 m/s" in done.out


def test_agreement_ends_with_0_and_writes_nothing_but_the_json(here: Path, capsys) -> None:
    crash_test(11)
    given = ("crashtest", "--cases", 20, "--seed", 2, "--json")
    done = physim(*given, "found.json", capture=capsys)
    assert (done.code, done.err) == (0, "")
    agree = facts("agree", "0 of 20 cases", "seed 2", "unexplained")
    assert re.search(agree, done.out.splitlines()[-1])
    assert list(tree(here)) == ["found.json", "small.yaml"]
    first = (here / "found.json").read_bytes()
    found = json.loads(first)
    assert (found["format"], found["version"], found["cases"]) == ("physim-crashtest", 1, 20)
    assert physim(*given, "found.json", "--force", "--quiet", capture=capsys) == (0, "", "")
    assert (here / "found.json").read_bytes() == first
    alone = physim(*given, "-", capture=capsys)
    assert json.loads(alone.out) == found
    assert re.search(agree, alone.err.splitlines()[-1])


def test_a_disagreement_ends_with_3_and_worlds_that_run_replays(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    monkeypatch.setattr("physim.analysis.crashtest.experiment.predict", two_steps_late)
    done = physim("crashtest", "--cases", 20, "--json", "found.json", capture=capsys)
    assert done.code == 3
    assert "checks disagree" in done.out.splitlines()[-1]
    found = json.loads((here / "found.json").read_text())["unexplained"]
    assert [one["world"] for one in found] == [
        f"crashtest-0/{file.name}" for file in sorted(Path("crashtest-0").iterdir())
    ]
    hit = next(one for one in found if one["physical_sample"] is not None)
    assert hit["world"] in done.out
    run = physim("run", hit["world"], "-o", "again", "--no-video", "--quiet", capture=capsys)
    assert run == (0, "", "")
    with Record.load("again/record.h5") as record:
        assert record.contacts["step"].min() == hit["physical_sample"]
