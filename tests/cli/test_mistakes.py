"""Mistakes on the command line: one line each, in one style; help pages that teach."""

from __future__ import annotations

import re

import click
import pytest

from physim.drawing.plots import NAMES
from physim.reproduction.studies import studies
from tests.cli.commands import physim
from tests.helpers import check_error, inside

COMMANDS, GROUPS, commands = inside("physim.cli", "COMMANDS", "GROUPS", "commands")

TEMPLATES = "corridor, bend, doorway, s_bend, roundabout, warehouse, random"
THERE_ARE = ", ".join(COMMANDS)

MISTAKES = {
    ("validate", "x", "--sede", "3"): ("--sede", "physim validate", '"--seed"'),
    ("video", "x", "--seed", "3"): ("--seed", "physim video", '"--speed"'),
    ("run", "x", "--fast=3"): ("--fast", "physim run"),
    ("run", "x", "-q"): ("-q", "physim run"),
    ("run", "a", "b c"): ('"b c"', "physim run takes WORLD"),
    ("list", "a"): ("a", "physim list takes options"),
    ("--seed", "3", "run", "x"): ("--seed", "physim COMMAND ... --seed"),
    ("--versoin",): ("--versoin", "no such option", '"--version"'),
    ("--version=3",): ("--version", "given 3"),
    ("validate", "x", "--json"): ("--json", "FILE is missing", "standard output"),
    ("validate", "x", "--json", "--quiet"): ("--json", "FILE is missing", "standard output"),
    ("run", "x", "--set", "--force"): ("--set", "KEY=VALUE is missing"),
    ("run", "x", "-o", "--force"): ("-o/--output", "DIR is missing", "runs/NAME-SEED"),
    ("run", "x", "-o", ""): ('-o/--output ""', "name of a file or folder"),
    ("summary", ""): ('RECORD ""', "name of a file or folder"),
    ("new", "--template"): ("--template", "missing", TEMPLATES),
    ("new", "--template", "bent"): ("--template bent", TEMPLATES, '"bend"'),
    ("plot", "x", "--format", "pgn"): ("--format pgn", "png, svg, pdf", '"png"'),
    ("run",): ("physim run", "WORLD is missing"),
    ("check",): ("physim check", "WORLD is missing"),
    ("import", "x"): ("physim import", "-o/--output is missing"),
    ("import",): ("physim import", "SOURCE and -o/--output are missing"),
    ("run", "x", "--quiet=3"): ("--quiet", "given 3"),
    ("validate", "x", "--s", "3"): ("--s", "--seeds", "--seed", "--set"),
    ("video", "x", "--fps", "0"): ("--fps 0", "whole number from 1 to 240"),
    ("video", "x", "--fps", "241"): ("--fps 241", "whole number from 1 to 240"),
    ("video", "x", "--fp", "241"): ("--fps 241", "whole number from 1 to 240"),
    ("video", "x", "--speed", "0"): ("--speed 0", "number from 0.001 to 1000000"),
    ("video", "x", "--speed=nan"): ("--speed nan", "number from 0.001 to 1000000"),
    ("video", "x", "--width", "641"): ("--width 641", "even number from 160 to 1280"),
    ("crashtest", "--cases", "0"): ("--cases 0", "whole number from 1 to 1000000000"),
    ("crashtest", "--cases", ""): ('--cases ""', "whole number from 1 to 1000000000"),
    ("reproduce", "--workers", "65"): ("--workers 65", "whole number from 1 to 64"),
    ("plot", "x", "--width", "0.3"): ("--width 0.3", "column", "page", "from 3.3 to 20"),
    ("plot", "x", "--width", "colum"): ("--width colum", "column", "page", "from 3.3 to 20"),
    ("plot", "x", "--snapshots", "0"): ("--snapshots 0", "number greater than 0"),
    ("plot", "x", "--snapshots", "inf"): ("--snapshots inf", "number greater than 0"),
    ("run", "x", "--set", "robots[0].name=a", "--set", "robots.0.name=b"): (
        "--set robots.0.name", "given twice",
    ),
    ("validate", "x", "--seeds", "3"): ("--seeds 3", "A:B", "whole numbers from 0 to 10^15"),
    ("validate", "x", "--seeds", "3:3"): ("--seeds 3:3", "A below B"),
    ("import", "x", "-o", "y", "--from", "1"): ("--from 1", "X,Y", "two numbers", "14.5,-3"),
    ("import", "x", "-o", "y", "--start", "-1"): ("--start -1", "number of 0 or more"),
    ("import", "x", "-o", "y", "--lanes", "0"): ("--lanes 0", "whole number from 1 to 10000"),
    ("import", "x", "-o", "y", "--robot", "1,0"): ("--robot 1,0", "LENGTH,WIDTH", "1.8,1.0"),
    ("page", "x.h5", "-o", "a\nb.html"): (r"-o/--output a\u000ab.html", "in one line"),
    ("video", "no\nsuch.h5"): (r"RECORD no\u000asuch.h5", "in one line"),
    ("compare", "x", "--by", "controller", "--only", "finish"): ("--only", "given: finish; did"),
    ("none.yaml",): ("physim none.yaml", THERE_ARE),
    ("valdate", "x"): ("physim valdate", THERE_ARE, '"validate"'),
}  # fmt: skip
"""By arguments: place, and what else is said."""

FOUND_LATER = {
    ("plot", "x", "--only", "mode"): ("--only mode", ", ".join(NAMES), '"modes"'),
    ("reproduce", "--figure", "1", "--study", "alpha"): ("--study", "--figure"),
    ("video", "x", "--at", "5", "-o", "a.mp4"): ("--at 5", "still", '"a.png"'),
    ("video", "x", "--at", "5", "--to", "7"): ("--to", "--at 5"),
    ("video", "x", "--at", "5", "--fps", "7"): ("--fps", "--at 5"),
    ("video", "x", "-o", "a.png"): ("a.png", "--at T"),
    ("video", "x", "-o", "a.avi"): ("a.avi", ".mp4, .m4v, .gif, .webp"),
    ("video", "x", "-o", "a.gif", "--fps", "30"): ("--fps 30", "GIF", "25"),
    ("video", "x", "y", "--beside", "z"): ("--beside z", "y"),
    ("summary",): ("physim summary", "RECORD is missing", "--definitions"),
    ("new",): ("physim new", "NAME is missing"),
    ("replay", "a\nb:0"): (r"a\u000ab:0", "DIR:ROW"),
    ("run", "a\nb\x1b[0m"): (r"a\u000ab\u001b[0m", "no such file"),
}
"""The same where the command itself finds it."""


@pytest.mark.parametrize("arguments", [*MISTAKES, *FOUND_LATER], ids=" ".join)
def test_a_mistake_is_told_in_one_line(
    arguments: tuple[str, ...], tmp_path, monkeypatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    done = physim(*arguments, capture=capsys)
    assert (done.code, done.out) == (2, "")
    check_error(done.err, *{**MISTAKES, **FOUND_LATER}[arguments])
    if arguments in MISTAKES:
        command = f"physim {arguments[0]}" if arguments[0] in COMMANDS else "physim"
        assert done.err.endswith(f"(see {command} --help)\n")


def test_nothing_is_suggested_that_is_not_near(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in (("run", "x", "--fast"), ("none.yaml",), ("new", "--template", "q")):
        assert "did you mean" not in physim(*arguments, capture=capsys).err


def test_an_option_may_be_cut_short_as_long_as_it_is_one(
    capsys: pytest.CaptureFixture[str],
) -> None:
    whole = physim("new", "a", "--robots", "99", capture=capsys)
    assert physim("new", "a", "--ro=99", capture=capsys) == whole
    assert physim("new", "a", "--ro", "99", capture=capsys) == whole
    assert "--robots 99" in whole.err


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_names_itself_when_it_refuses_an_option(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    needed = {"import": ["a", "-o", "b"], "list": [], "schema": [], "crashtest": [],
              "reproduce": []}.get(name, ["a"])  # fmt: skip
    done = physim(name, *needed, "--no-such-thing", 3, capture=capsys)
    assert (done.code, done.out) == (2, "")
    check_error(done.err, "--no-such-thing:", f"physim {name}", f"physim {name} --help")


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
    assert "" not in [line.strip().removesuffix(":") for line in done.out.splitlines() if line]
    described = [p for p in params(name) if isinstance(p, click.Option | click.Argument)]
    assert all(param.help for param in described)
    for param in described:
        assert (param.opts[-1] if isinstance(param, click.Option) else param.metavar) in done.out


def params(name: str) -> list[click.Parameter]:
    with commands.make_context("physim", [name]) as context:
        command = commands.get_command(context, name)
    assert command is not None
    return command.params


def test_physim_alone_prints_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    alone = physim(capture=capsys)
    assert (alone.code, alone.err) == (0, "")
    assert alone.out == physim("--help", capture=capsys).out == physim("-h", capture=capsys).out


def test_the_help_shows_all_commands_by_job_on_one_screen(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """24 lines of 80 characters, one of them for what is typed next."""
    monkeypatch.setenv("COLUMNS", "80")
    lines = physim("--help", capture=capsys).out.splitlines()
    assert len([line for line in lines if line]) + 1 <= 24
    assert len(lines) <= 24
    assert max(map(len, lines)) <= 80
    told: dict[str, list[str]] = {}
    table = [line for line in lines if re.match(r"(\w+ +| {8})[a-z-]+ {2,}\S", line)]
    for line in table:
        if line[0] != " ":
            group = line.split()[0]
        told.setdefault(group, []).append(line[8:].split()[0])
    assert list(told) == ["run", "judge", "author", "study"]
    assert told == {group: list(members) for group, members in GROUPS.items()}
    assert sum(map(len, told.values())) == len(COMMANDS) == 20
    text = " ".join(" ".join(lines).split())
    for code in ("0 success", "1 ", "2 bad input", "3 ", "70 ", "130 interrupted"):
        assert f" {code}" in text
    assert "physim COMMAND --help" in text
    assert "--version" in text


def test_the_help_of_reproduce_names_every_study(capsys: pytest.CaptureFixture[str]) -> None:
    told = physim("reproduce", "--help", capture=capsys).out
    (names,) = re.findall(r"^studies: (.*\n(?: +.*\n)*)", told, re.MULTILINE)
    assert re.split(r",\s+", names.strip()) == [study.name for study in studies()]
