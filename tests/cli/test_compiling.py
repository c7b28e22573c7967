"""Where kernels have to be compiled, it is said of what, how often and about how long."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from physim.analysis.crashtest import crash_test
from physim.cli.reproduce import _warm_up
from tests.cli.commands import SMALL, physim
from tests.helpers import facts, inside

make_plan = inside("physim.reproduction", "make_plan")

LINE = r"compiling (.+) \(.*\babout \d+ s\) \.\.\."


@pytest.mark.parametrize(
    ("arguments", "at", "what"),
    [
        (("run", "small.yaml", "--no-video"), "physim.cli.simulating", ("controller", "distances")),
        (("validate", "small.yaml"), "physim.analysis.validation", ("validation",)),
        (
            ("crashtest", "--cases", 5),
            "physim.analysis.crashtest.prediction",
            ("collision",),
        ),
    ],
)
def test_each_command_says_what_it_compiles(
    arguments: tuple[object, ...],
    at: str,
    what: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    crash_test(11)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "small.yaml").write_text(SMALL)
    monkeypatch.setattr(f"{at}.is_warm", lambda: False)
    told = physim(*arguments, capture=capsys).err.splitlines()
    found = re.fullmatch(LINE, told[0])
    assert found is not None
    assert re.search(facts(*what), found[1])
    assert physim(*arguments, "--quiet", "--force", capture=capsys).err == ""


def test_so_does_reproduce(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("physim.reproduction.reproduce.is_warm", lambda: False)
    monkeypatch.setattr("physim.reproduction.reproduce.warm_up", lambda: None)
    plan = make_plan(quick=True)
    _warm_up(plan, quiet=True)
    assert capsys.readouterr().err == ""
    _warm_up(plan, quiet=False)
    found = re.fullmatch(LINE + "\n", capsys.readouterr().err)
    assert found is not None
    assert re.search(facts("controller", "distances", "collision times"), found[1])
