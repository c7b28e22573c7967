"""Every command and every program of the README does what it says."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
MARKED = ("main job", "tests")
"""Blocks that set up an environment of their own; run by whoever checks a fresh clone."""

Block = tuple[str, str, str]


def blocks() -> list[Block]:
    """(mark, language, text) of every fenced block of the README, in order."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    pattern = r"(?:<!-- ([a-z ]+) -->\n)?```(\w+)\n(.*?)```"
    return re.findall(pattern, text, flags=re.DOTALL)


def test_the_two_marked_blocks_are_there() -> None:
    marks = [mark for mark, language, _ in blocks() if mark]
    assert sorted(marks) == sorted(MARKED)


def test_every_block_does_what_it_says(tmp_path: Path) -> None:
    """They follow one another in one folder, as a reader would try them."""
    for mark, language, text in blocks():
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
