"""The example of docs/explanation/validation.md is what the command prints."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.cli.commands import physim

ROOT = Path(__file__).parents[3]


@pytest.mark.deep
def test_the_example_is_what_the_command_prints(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """All but the versions that made it, and the digest, which goes with them."""
    page = (ROOT / "docs/explanation/validation.md").read_text()
    command = r"physim (run .*?)  .*\nphysim (validate .*?)  .*\n```\n\n"
    found = re.search(command + r"```text\n(.*?)```", page, re.S)
    assert found
    monkeypatch.chdir(tmp_path)
    assert physim(*found[1].split(), capture=capsys).code in (0, 1)
    said = physim(*found[2].split(), capture=capsys).out
    lines = [
        [
            re.sub("[0-9a-f]{64}|[0-9a-f]{8}…", "DIGEST", line)
            for line in text.splitlines()
            if not line.startswith("  made by ")
        ]
        for text in (found[3], said)
    ]
    assert lines[0] == lines[1]
    assert len(lines[1]) <= 45
