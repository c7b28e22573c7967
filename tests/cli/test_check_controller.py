"""``physim check-controller``: what it prints and its exit codes."""

from __future__ import annotations

import json
import re

import pytest

from physim.testing import situations
from tests.cli.commands import physim
from tests.helpers import check_error, facts, inside

Bar = inside("physim.cli", "Bar")

BROKEN = "tests.testing.broken"
STRAIGHT = ("--world", "straight", "--seconds", 0.3)


def test_nothing_is_found(capsys: pytest.CaptureFixture[str]) -> None:
    done = physim("check-controller", f"{BROKEN}:Sound", *STRAIGHT, capture=capsys)
    assert (done.code, done.err) == (0, "")
    (line,) = done.out.splitlines()
    assert line.startswith(f"{BROKEN}:Sound: ")
    assert re.search(facts("no findings", "decisions", "1 world", "5 situations"), line)


def test_the_bar_names_the_world_under_way(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """It stood without a word as long as the first world took, and then named it."""
    told: list[tuple[float, str]] = []
    monkeypatch.setattr(Bar, "update", lambda self, done, note="": told.append((done, note)))
    assert physim("check-controller", f"{BROKEN}:Sound", *STRAIGHT, capture=capsys).code == 0
    assert told == list(enumerate(["straight", *situations()]))


def test_a_line_a_finding(capsys: pytest.CaptureFixture[str]) -> None:
    done = physim("check-controller", f"{BROKEN}:CountsOnItself", *STRAIGHT, capture=capsys)
    assert (done.code, done.err) == (1, "")
    *lines, last = done.out.splitlines()
    assert [line.partition(" at ")[0] for line in lines[:2]] == [
        "state: straight, r1", "state: nobody in sight, a",
    ]  # fmt: skip
    assert len(lines) == 1 + len(situations())
    assert last.startswith(f"{BROKEN}:CountsOnItself: {len(lines)} findings in ")


def test_as_json(capsys: pytest.CaptureFixture[str]) -> None:
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
    assert told["worlds"][0]["decisions"] > 4


def test_settings_are_given_as_for_a_run(capsys: pytest.CaptureFixture[str]) -> None:
    command = ("check-controller", f"{BROKEN}:Adjustable", *STRAIGHT, "--set")
    assert physim(*command, "controller.share=0.8", capture=capsys).code == 0
    done = physim(*command, "controller.share=1.1", capture=capsys)
    assert done.code == 1
    assert done.out.startswith("decision: straight, r1 at 0 s: ")
    assert "v = 1.65 m/s" in done.out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("nosuch",), ("no controller", '"nosuch"')),
        ((f"{BROKEN}:Sound", "--world", "strait"), ("strait:", "no such file", "straight")),
        (
            (f"{BROKEN}:Adjustable", "--set", "controller.shares=1"),
            ("--set controller.shares:", "unknown"),
        ),
        ((f"{BROKEN}:Adjustable", "--set", "controller.share=x"), ("--set controller.share:",)),
        ((f"{BROKEN}:Adjustable", "--set", "time.step=1"), ("--set time.step:", "no setting")),
        ((f"{BROKEN}:Sound", "--set", "controller.type=constant"), ("--set controller.type:",)),
        ((f"{BROKEN}:Sound", "--set", "controller=constant"), ("--set controller:",)),
        ((f"{BROKEN}:Sound", "--set", "share"), ("--set share:", '"share"', "KEY=VALUE")),
        ((f"{BROKEN}:Sound", "--seconds", "0"), ("--seconds 0:", "from 0.001 to")),
    ],
)
def test_bad_input(
    arguments: tuple[str, ...], said: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    done = physim("check-controller", *arguments, capture=capsys)
    assert (done.code, done.out) == (2, "")
    check_error(done.err, *said)


def test_it_is_said_what_is_compiled(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("physim.simulation.run.is_warm", lambda: False)
    done = physim("check-controller", "constant", *STRAIGHT, capture=capsys)
    assert done.err.startswith("compiling ")
    assert done.err.count("\n") == 1
    assert done.code == 0
