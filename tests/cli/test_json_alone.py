"""JSON on standard output stands alone there, whatever code of the user's prints."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from tests.cli.commands import SMALL, physim

CHATTY = """\
from physim import Decision

print("imported")

class Chatty:
    def __init__(self):
        print("made")

    def decide(self, observation, memory):
        print("at", observation.station)
        return Decision(0.2, 0.0, 0.1)
"""
SHORT = ("--set", "time.duration=0.2")


@pytest.mark.parametrize(
    "command",
    [
        ("check-controller", "chatty:Chatty", "--world", "w.yaml", "--seconds", "0.1", "--json"),
        ("validate", "w.yaml", "--controller", "chatty:Chatty", *SHORT, "--json", "-"),
        ("validate", "w.yaml", "--controller", "chatty:Chatty", *SHORT, "--seeds", "1:3", "--json",
         "-"),
        ("sweep", "w.yaml", "--controller", "chatty:Chatty", *SHORT, "--seeds", "1:3", "-o", "out",
         "--workers", "1", "--json"),
        ("check", "w.yaml", "--controller", "chatty:Chatty", *SHORT, "--json"),
    ],
    ids=lambda command: " ".join(command[:1]),
)  # fmt: skip
def test_what_a_controller_prints_stands_elsewhere(
    command: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "w.yaml").write_text(SMALL)
    (tmp_path / "chatty.py").write_text(CHATTY)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "chatty", raising=False)
    done = physim(*command, capture=capfd)
    assert done.code in (0, 1), done
    assert json.loads(done.out)
    assert "at " in done.err
