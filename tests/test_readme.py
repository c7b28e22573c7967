"""Every command and every program of the README does what it says."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MARKED = ("main job", "tests")
"""Blocks that set up an environment of their own; run by whoever checks a fresh clone."""

Block = tuple[str, str, str]


def blocks() -> list[Block]:
    """(mark, language, text) of every fenced block of the README, in order."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    pattern = r"(?:<!-- ([a-z ]+) -->\n)?```(\w+)\n(.*?)```"
    return re.findall(pattern, text, flags=re.DOTALL)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Work folder in which the README's blocks follow one another."""
    return tmp_path_factory.mktemp("readme")


def test_the_two_marked_blocks_are_there() -> None:
    marks = [mark for mark, language, _ in blocks() if mark]
    assert sorted(marks) == sorted(MARKED)


@pytest.mark.parametrize("number", range(len([b for b in blocks() if not b[0]])))
def test_block(number: int, folder: Path) -> None:
    _, language, text = [block for block in blocks() if not block[0]][number]
    named = re.match(r"# (\w+\.(?:py|yaml))\n", text)
    if named:
        (folder / named[1]).write_text(text, encoding="utf-8")
        return
    if language not in ("sh", "python"):
        return
    command = ["bash", "-euo", "pipefail", "-c", text] if language == "sh" else [
        sys.executable, "-c", text
    ]  # fmt: skip
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        command, cwd=folder, env={**os.environ, "PATH": path}, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    if "path_following" in text:
        assert "exit code 1" in done.stdout
    if "record.contacts" in text:
        assert re.search(r"s: r\d and r\d, \d+ N s", done.stdout)
