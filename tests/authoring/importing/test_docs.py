"""The output shown in docs/how-to/import-a-map.md is what the commands print."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path

import pytest

from tests.authoring.importing.plans import SAMPLES
from tests.cli.commands import physim

TEXT = (Path(__file__).parents[3] / "docs/how-to/import-a-map.md").read_text(encoding="utf-8")
SHOWN = re.findall(r"```text\n\$ physim (.*)\n((?:.*\n)*?)```", TEXT)


def test_every_format_is_shown() -> None:
    assert {shlex.split(command)[1].rpartition(".")[2] for command, _ in SHOWN} == {
        "csv", "yaml", "svg",
    }  # fmt: skip


@pytest.mark.parametrize(("command", "output"), SHOWN, ids=[c.split()[1] for c, _ in SHOWN])
def test_output(
    command: str,
    output: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    for file in SAMPLES.iterdir():
        shutil.copy(file, tmp_path)
    monkeypatch.chdir(tmp_path)
    assert physim(*shlex.split(command), capture=capsys) == (0, output, "")
