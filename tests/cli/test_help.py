"""Help pages that teach; their texts are kept in tests/goldens."""

from __future__ import annotations

import re

import pytest

from tests.cli.commands import physim
from tests.helpers import inside

COMMANDS, GROUPS, app_of = inside("physim.cli", "COMMANDS", "GROUPS", "app_of")
papers = inside("physim.reproduction", "papers")


@pytest.mark.parametrize("name", COMMANDS)
def test_every_help_page_tells_every_option_and_the_exit_codes(name: str, capsys) -> None:
    done = physim(name, "--help", capture=capsys)
    assert done.code == 0
    _, codes = done.out.split("\nexit codes:\n")
    told = [int(line.split()[0]) for line in codes.split("\n\n")[0].splitlines() if line[2] != " "]
    assert {0, 2} <= set(told)
    assert told == sorted(told)
    assert "\nexamples:\n  physim " in done.out
    for one in app_of(name).assemble_argument_collection():
        if one.parse and not one.children:
            assert one.parameter.help
            names = one.names if one.index is None else [one.parameter.metavar]
            assert all(each in done.out for each in names)


def test_physim_alone_prints_the_help_with_every_command_on_one_screen(monkeypatch, capsys) -> None:
    """30 lines of 80 characters, one of them for what is typed next."""
    monkeypatch.setenv("COLUMNS", "80")
    alone = physim(capture=capsys)
    assert (alone.code, alone.err) == (0, "")
    assert alone.out == physim("--help", capture=capsys).out == physim("-h", capture=capsys).out
    lines = alone.out.splitlines()
    assert len(lines) + 1 <= 30
    assert max(map(len, lines)) <= 80
    table = [line for line in lines if re.match(r"(\w+ +| {8})[a-z-]+ {2,}\S", line)]
    told = [line[8:].split()[0] for line in table]
    assert told == [name for members in GROUPS.values() for name in members]
    assert sorted(told) == sorted(COMMANDS)


def test_the_help_of_reproduce_names_every_study(capsys) -> None:
    told = physim("reproduce", "--help", capture=capsys).out
    lists = re.findall(r"^studies(?: of \w+)?: (.*\n(?: +.*\n)*)", told, re.MULTILINE)
    known = [[study.name for study in paper.studies()] for paper in papers().values()]
    assert [re.split(r",\s+", names.strip()) for names in lists] == known
