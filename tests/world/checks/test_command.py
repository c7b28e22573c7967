"""``physim check``: what it prints, its exit codes, and --watch as a real process."""

from __future__ import annotations

import json
import os
import queue
import re
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from physim.cli import main
from tests.helpers import facts
from tests.world.worlds import CORRIDOR, DRAWN, changed, check_finding


def run(capsys, *arguments: object) -> tuple[int, str, str]:
    capsys.readouterr()
    code = main(["check", *map(str, arguments)])
    done = capsys.readouterr()
    return code, done.out, done.err


@pytest.fixture
def here(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_errors_and_warnings_stand_apart_in_the_order_of_the_file(capsys, here):
    text = changed(
        CORRIDOR,
        ("pose: [3.0, -1.0", "pose: [6.0, 1.5"),
        ("1.0, 0.0]\n    path: {offset: 1.0}", "3.5, 45]\n    path: {offset: 1.0}"),
    )
    (here / "w.yaml").write_text(text)
    code, out, err = run(capsys, "w.yaml")
    assert (code, err) == (2, "")
    lines = out.splitlines()
    assert lines[0] == "errors:"
    check_finding(lines[1], "  w.yaml:7:11: robots[0].pose:", '"a"', "over", "corridor")
    assert lines[2:4] == ["", "warnings:"]
    check_finding(lines[4], "  w.yaml:7:22: robots[0].pose[2]:", "45 rad", "0.785398")
    check_finding(lines[-1], "w.yaml:", "1 error", "1 warning")


def test_several_worlds_and_names_of_shipped_ones(capsys, here):
    (here / "w.yaml").write_text(CORRIDOR)
    code, out, _ = run(capsys, "straight", "w.yaml", "missing.yaml")
    assert code == 2
    ends = [line for line in out.splitlines() if re.search(facts("no errors", "no warnings"), line)]
    assert [Path(line.partition(": ")[0]).name for line in ends] == ["straight.yaml", "w.yaml"]
    (missing,) = [line for line in out.splitlines() if line.startswith("  missing.yaml:")]
    check_finding(missing, "  missing.yaml:", "no such file")


def test_json(capsys, here):
    (here / "w.yaml").write_text(changed(CORRIDOR, ("width: 8.0", "width: -8")))
    (here / "v.yaml").write_text(DRAWN)
    code, out, _ = run(capsys, "w.yaml", "v.yaml", "--json")
    found = json.loads(out)
    assert code == 2
    assert (found["format"], found["version"]) == ("physim-check", 2)
    assert (found["errors"], found["warnings"]) == (1, 0)
    first, second = found["worlds"]
    (error,) = first["errors"]
    assert re.search(facts("greater than 0", "-8"), error.pop("message"))
    assert error == {"file": "w.yaml", "line": 3, "column": 50, "key": "corridor.width"}
    assert second["errors"] == []
    profile = second["clearance"][0]
    assert profile["robot"] == "a"
    assert profile["verdict"] == "fits at any heading"
    assert len(profile["station"]) == len(profile["clearance"]) > 100


class Watching:
    """``physim check --watch`` as a process; its rounds arrive in a queue."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        command = [sys.executable, "-m", "physim", "check", *arguments, "--watch"]
        self.process = subprocess.Popen(
            command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        self.lines: queue.Queue[str] = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.lines.put(line.rstrip("\n"))

    def until(self, errors: str, file: str = "w.yaml") -> list[str]:
        """Lines up to the end of the next round, which counts so many errors and no warnings."""
        end = facts(file, errors, "no warnings")
        found = [self.lines.get(timeout=60)]
        while not re.search(end, found[-1]):
            found.append(self.lines.get(timeout=60))
        return found


@pytest.fixture
def watching(here):
    (here / "w.yaml").write_text(CORRIDOR)
    started = Watching(here, "w.yaml")
    try:
        yield started
    finally:
        if started.process.poll() is None:
            started.process.kill()
        started.process.wait()
        for stream in (started.process.stdout, started.process.stderr):
            if stream is not None:
                stream.close()


@pytest.mark.deep
def test_watch_checks_again_on_save_and_ends_in_one_line(watching, here):
    file = here / "w.yaml"
    watching.until("no errors")
    file.write_text(changed(CORRIDOR, ("width: 8.0", "width: eight")))
    watching.until("1 error")
    file.write_text(CORRIDOR[:40])  # half written
    assert any("not valid YAML" in line for line in watching.until("1 error"))
    file.unlink()
    assert any("no such file" in line for line in watching.until("1 error"))
    (here / "new").write_text(CORRIDOR)
    os.replace(here / "new", file)  # as editors do
    watching.until("no errors")
    file.write_bytes(b"\xff\xfe")
    assert any("is not UTF-8" in line for line in watching.until("1 error"))
    watching.process.send_signal(signal.SIGINT)
    assert watching.process.wait(timeout=30) == 130
    assert watching.process.stderr is not None
    assert watching.process.stderr.read() == "interrupted\n"


def test_seed_controller_and_values_are_those_of_a_run(capsys, here):
    """What `physim run` with the same options would refuse is an error, and nothing else."""
    (here / "w.yaml").write_text(CORRIDOR)
    code, out, _ = run(capsys, "w.yaml", "--set", "corridor.width=2.0")
    assert code == 2
    assert "robots[0].pose" in out
    code, out, _ = run(capsys, "w.yaml", "--controller", "path_folowing")
    assert code == 2
    assert re.search(facts("controller", '"path_following"'), out)
    (here / "bad.yaml").write_text(CORRIDOR + "controller: {type: nobody}\n")
    assert run(capsys, "bad.yaml")[0] == 2
    assert run(capsys, "bad.yaml", "--controller", "path_following")[0] == 0
    code, out, _ = run(capsys, "w.yaml", "--set", "time.stp=1")
    assert code == 2
    check_finding(out.splitlines()[1], "  --set time.stp:", "unknown key", "step")
    code, out, _ = run(capsys, "w.yaml", "--set", "time.stp=1", "--json")
    (error,) = json.loads(out)["worlds"][0]["errors"]
    assert (error["file"], error["line"], error["key"]) == ("--set time.stp", None, "time.stp")
