"""Every command and every program of the README does what it says; every command of docs exists."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.commands import physim
from tests.helpers import extending, inside

COMMANDS, app_of = inside("physim.cli", "COMMANDS", "app_of")

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "worlds/README.md", *sorted((ROOT / "docs").glob("*.md"))]
MARKED = ("main job", "tests")
"""Blocks that set up an environment of their own; run by whoever checks a fresh clone."""
SHORT = {"--from 6 --to 9": "--from 0.2 --to 0.6", "--at 7.5": "--at 0.5", "--to 40": "--to 0.5"}
"""Times that lie within runs of one second"""

Block = tuple[str, str, str]


def blocks(text: str) -> list[Block]:
    """(mark, language, text) of every fenced block of a page, in order."""
    pattern = r"(?:<!-- ([a-z ]+) -->\n)?```(\w+)\n(.*?)```"
    return re.findall(pattern, text, flags=re.DOTALL)


def lines_of(text: str) -> list[list[str]]:
    """Arguments of every line of the blocks of a page that calls ``physim``."""
    found = []
    for *_, block in blocks(text):
        for line in re.findall(r"^(?:\$ )?physim .*", block.replace("\\\n", " "), re.MULTILINE):
            words = shlex.split(line.removeprefix("$ "), comments=True)
            end = (k for k, word in enumerate(words) if word in ("||", "&&", "|"))
            found.append(words[1 : next(end, len(words))])
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_command_and_option_of_a_page_exists(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    told = lines_of(text)
    for inline in re.findall(r"`physim ([a-z][^`]*)`", text):
        if not re.search("…|\\.\\.\\.", inline):
            told.append(shlex.split(inline.replace("\n", " ")))
    for words in told:
        assert words[0] in COMMANDS, words
        app = app_of(words[0])
        arguments = app.assemble_argument_collection()
        options = {name for one in arguments for name in one.names}
        given = {word.partition("=")[0] for word in words if re.match(r"--?[a-zA-Z]", word)}
        assert given <= options | {"--help", "-h"}, words
        if words in lines_of(text):
            app.parse_args(words[1:], exit_on_error=False, print_error=False)


def test_every_kind_of_part_has_an_example() -> None:
    """docs/EXTENDING.md; the examples themselves run in the deep tier."""
    groups = extending.entry_points()
    kinds = inside("physim.parts", "KINDS", "METRIC", "PLOT")
    assert {kind.group for kind in (*kinds[0], *kinds[1:])} == set(groups)
    sections = [{one.section for one in extending.of(kind)} for kind in ("python", "sh", "text")]
    assert sections[0] == sections[1] == sections[2]
    assert len(sections[0]) == len(groups)


def test_the_jobs_of_the_readme_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """One after the other in one folder, as a reader would try them; runs of a second."""
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    jobs = re.findall(r"^## Job \d: .*?(?=^## )", text, flags=re.DOTALL | re.MULTILINE)
    assert len(jobs) == 3
    for job in jobs:
        for long, short in SHORT.items():
            job = job.replace(long, short)
        for words in lines_of(job):
            if words[0] == "run":
                words += ["--set", "time.duration=1.0"]
            done = physim(*words, capture=capsys)
            assert done.code in (0, 1), (words, done)
            assert "Traceback" not in done.err


@pytest.mark.deep
def test_every_block_does_what_it_says(tmp_path: Path) -> None:
    """They follow one another in one folder, as a reader would try them."""
    found = blocks((ROOT / "README.md").read_text(encoding="utf-8"))
    assert sorted(mark for mark, *_ in found if mark) == sorted(MARKED)
    for mark, language, text in found:
        named = re.match(r"# (\w+\.(?:py|yaml))\n", text)
        if named:
            (tmp_path / named[1]).write_text(text, encoding="utf-8")
        elif not mark and language in ("sh", "python"):
            check_block(language, text, tmp_path)


def check_block(language: str, text: str, folder: Path) -> None:
    """Run a block and look at what it says."""
    shell = ["bash", "-euo", "pipefail", "-c", text]
    command = shell if language == "sh" else [sys.executable, "-c", text]
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        command, cwd=folder, env={**os.environ, "PATH": path}, capture_output=True, text=True
    )
    assert done.returncode == 0, f"{text}\n{done.stdout}\n{done.stderr}"
    assert "Traceback" not in done.stderr
    if 'echo "exit code' in text:
        assert "exit code 1" in done.stdout
    if "record.contacts" in text:
        assert re.search(r"s: r\d and r\d, \d+ N s", done.stdout)
