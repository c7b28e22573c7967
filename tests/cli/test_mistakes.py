"""Mistakes on the command line: one line each, in one style; help pages that teach."""

from __future__ import annotations

import argparse
import re

import pytest

from physim.cli.parser import DESCRIPTION, build_parser
from physim.reproduction.studies import studies
from tests.cli.commands import physim


def commands() -> dict[str, argparse.ArgumentParser]:
    (choices,) = (a.choices for a in build_parser()._actions if isinstance(a.choices, dict))
    return choices


COMMANDS = tuple(commands())

MISTAKES = {
    ("validate", "x", "--sede", "3"): '--sede: physim validate has no such option; did you mean '
    '"--seed"? (see physim validate --help)',
    ("video", "x", "--seed", "3"): '--seed: physim video has no such option; did you mean '
    '"--speed"? (see physim video --help)',
    ("run", "x", "--fast=3"): "--fast: physim run has no such option (see physim run --help)",
    ("run", "a", "b c"): '"b c": is one too many; physim run takes WORLD alone '
    "(see physim run --help)",
    ("list", "a"): "a: is one too many; physim list takes options alone (see physim list --help)",
    ("--seed", "3", "run", "x"): "--seed: stands before the command; write physim COMMAND ... "
    "--seed (see physim --help)",
    ("validate", "x", "--json"): "--json: its FILE is missing; --json FILE: write everything to "
    "FILE (-: standard output) as JSON (see physim validate --help)",
    ("new", "--template"): "--template: its value is missing; must be one of corridor, bend, "
    "doorway, s_bend, roundabout, warehouse (see physim new --help)",
    ("new", "--template", "bent"): "--template bent: must be one of corridor, bend, doorway, "
    's_bend, roundabout, warehouse; did you mean "bend"? (see physim new --help)',
    ("run",): "physim run: WORLD is missing (see physim run --help)",
    ("import", "x"): "physim import: -o/--output is missing (see physim import --help)",
    ("import",): "physim import: SOURCE and -o/--output are missing (see physim import --help)",
    ("reproduce", "--figure", "1", "--study", "alpha"): "--study: does not go together with "
    "--figure (see physim reproduce --help)",
    ("run", "x", "--quiet=3"): "--quiet: takes no value; given 3 (see physim run --help)",
    ("validate", "x", "--s", "3"): "--s: may be any of --seeds, --seed, --set; write it out "
    "(see physim validate --help)",
    ("video", "x", "--fps", "0"): "--fps 0: must be a whole number from 1 to 240 "
    "(see physim video --help)",
    ("video", "x", "--fps", "241"): "--fps 241: must be a whole number from 1 to 240 "
    "(see physim video --help)",
    ("video", "x", "--speed", "0"): "--speed 0: must be a number from 0.001 to 1000000 "
    "(see physim video --help)",
    ("video", "x", "--speed", "nan"): "--speed nan: must be a number from 0.001 to 1000000 "
    "(see physim video --help)",
    ("crashtest", "--cases", "0"): "--cases 0: must be a whole number from 1 to 1000000000 "
    "(see physim crashtest --help)",
    ("crashtest", "--cases", ""): '--cases "": must be a whole number from 1 to 1000000000 '
    "(see physim crashtest --help)",
    ("reproduce", "--workers", "65"): "--workers 65: must be a whole number from 1 to 64 "
    "(see physim reproduce --help)",
    ("plot", "x", "--snapshots", "0"): "--snapshots 0: must be a number greater than 0 "
    "(see physim plot --help)",
    ("validate", "x", "--seeds", "3"): "--seeds 3: must be A:B, two whole numbers from 0 to 10^15, "
    "as 1:101 (see physim validate --help)",
    ("validate", "x", "--seeds", "3:3"): "--seeds 3:3: must be A:B with A below B: it goes from A "
    "to B - 1 (see physim validate --help)",
    ("import", "x", "-o", "y", "--from", "1"): "--from 1: must be X,Y, two numbers [m], as 14.5,-3 "
    "(see physim import --help)",
    ("import", "x", "-o", "y", "--start", "-1"): "--start -1: must be a number of 0 or more "
    "(see physim import --help)",
    ("plot", "x", "--only", "mode"): "--only mode: must be one of trajectories, deviation, speeds, "
    "formation, width, distances, collision_times, modes, prediction; did you mean \"modes\"?",
    ("summary",): "physim summary: RECORD is missing; or give --definitions",
    ("none.yaml", ): "physim none.yaml: no such command; there are "
    f"{', '.join(COMMANDS)} (see physim --help)",
    ("valdate", "x"): f"physim valdate: no such command; there are {', '.join(COMMANDS)}; did you "
    'mean "validate"? (see physim --help)',
    ("new",): "physim new: NAME is missing, as in physim new my_corridor",
    ("run", "a\nb\x1b[0m"): "a�b�[0m: no such file; ",
}  # fmt: skip
"""By arguments: all that is told, or how it begins where it ends in a space."""


@pytest.mark.parametrize("arguments", MISTAKES, ids=" ".join)
def test_a_mistake_is_told_in_one_line(
    arguments: tuple[str, ...], tmp_path, monkeypatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    told = MISTAKES[arguments]
    done = physim(*arguments, capture=capsys)
    assert (done.code, done.out) == (2, "")
    if told.endswith(" "):
        assert done.err.startswith(told.rstrip("; "))
    else:
        assert done.err == f"{told}\n"
    assert done.err.count("\n") == 1


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_names_itself_when_it_refuses_an_option(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    needed = {"import": ["a", "-o", "b"], "list": [], "schema": [], "crashtest": [],
              "reproduce": []}.get(name, ["a"])  # fmt: skip
    done = physim(name, *needed, "--no-such-thing", 3, capture=capsys)
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith(f"--no-such-thing: physim {name} has no such option")
    assert done.err.endswith(f"(see physim {name} --help)\n")
    assert done.err.count("\n") == 1


@pytest.mark.parametrize("name", COMMANDS)
def test_every_help_page_tells_the_exit_codes_and_fits_a_screen(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    done = physim(name, "--help", capture=capsys)
    assert done.code == 0
    _, codes = done.out.split("\nexit codes:\n")
    told = [int(line.split()[0]) for line in codes.split("\n\n")[0].splitlines() if line[2] != " "]
    assert {0, 2} <= set(told)
    assert told == sorted(told)
    assert "\nexamples:\n  physim " in done.out
    assert max(map(len, done.out.splitlines())) <= 100
    assert all(action.help for action in commands()[name]._actions)


def test_physim_alone_prints_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    alone = physim(capture=capsys)
    assert (alone.code, alone.err) == (0, "")
    assert alone.out == physim("--help", capture=capsys).out
    assert "exit codes:" in alone.out


def test_the_help_teaches_commands_that_exist(capsys: pytest.CaptureFixture[str]) -> None:
    taught = re.findall(r"^  physim ([\w-]+)", DESCRIPTION, re.MULTILINE)
    assert set(taught) | {"schema"} == set(COMMANDS)
    assert len(taught) == len(set(taught))
    assert max(map(len, DESCRIPTION.splitlines())) <= 80


def test_the_help_of_reproduce_names_every_study(capsys: pytest.CaptureFixture[str]) -> None:
    told = physim("reproduce", "--help", capture=capsys).out
    (names,) = re.findall(r"^studies: (.*\n(?: +.*\n)*)", told, re.MULTILINE)
    assert re.split(r",\s+", names.strip()) == [study.name for study in studies()]
