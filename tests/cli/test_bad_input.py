"""Bad input: exit code 2, one message on standard error that says what and where, nothing written.

The messages are told in full, so that a change of any is seen.
"""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from physim.registry import controller_names
from tests.cli.commands import SMALL, physim, shell, tree


def changed(old: str, new: str) -> str:
    assert SMALL.count(old) == 1
    return SMALL.replace(old, new)


WORLD_KEYS = (
    "name, description, seed, time, corridor, boundaries, reference_path, start, robots, "
    "formation, controller, sensing, filters, disturbances, arrival, obstacles, expect, physics"
)

REGISTERED = ", ".join(controller_names())

WORLDS = {
    "syntax": (
        changed("{step: 0.02, duration", "{step: 0.02 duration"),
        "w.yaml:3:",
    ),
    "no YAML at all": ("\0\1", "w.yaml:1:1: character U+0000 is not allowed in YAML\n"),
    "empty": (
        "",
        "w.yaml:1:1: the file is empty; a world needs name, time, corridor and robots\n",
    ),
    "unknown key": (
        changed("formation:", "formatoin:"),
        f'w.yaml:14:1: formatoin: unknown key; allowed: {WORLD_KEYS}; did you mean "formation"?\n',
    ),
    "unknown key within": (
        changed("width: 8.0", "widht: 8.0"),
        "w.yaml:4:43: corridor.widht: unknown key; allowed: centreline, width, end_margin; "
        'did you mean "width"?\n',
    ),
    "wrong type": (
        changed("width: 8.0", "width: wide"),
        "w.yaml:4:50: corridor.width: must be: [m] full width: one number, or one per point of "
        'the centreline; given "wide"\n',
    ),
    "not a number": (
        changed("[6.0, 1.0, 0.0]", "[.nan, 1.0, 0.0]"),
        "w.yaml:8:12: robots[0].pose[0]: .nan is not a finite number; finite ones are allowed\n",
    ),
    "infinite": (
        changed("duration: 2.0", "duration: .inf"),
        "w.yaml:3:30: time.duration: .inf is not a finite number; finite ones are allowed\n",
    ),
    "self-crossing footprint": (
        changed("{length: 1.8, width: 1.0}", "[[0, 0], [1, 1], [1, 0], [0, 1]]"),
        "w.yaml:7:16: robots[0].footprint: crosses or touches itself at (0.5, 0.5); the corners "
        "must go once round the outline\n",
    ),
    "robot outside": (
        changed("[6.0, 1.0, 0.0]", "[6.0, 11.0, 0.0]"),
        'w.yaml:8:11: robots[0].pose: "a" starts outside the accessible area, 6.5 m from it; '
        "move it inside\n",
    ),
    "robot in a wall": (
        changed("[6.0, 1.0, 0.0]", "[6.0, 3.8, 0.0]"),
        'w.yaml:8:11: robots[0].pose: "a" reaches 0.3 m over the edge of the corridor at the '
        "start; move it away\n",
    ),
    "robots overlap": (
        changed("[6.0, 1.0, 0.0]", "[3.5, -1.0, 0.0]"),
        'w.yaml:12:11: robots[1].pose: "b" overlaps "a" by 1 m at the start; part them\n',
    ),
    "step of zero": (
        changed("step: 0.02", "step: 0.0"),
        "w.yaml:3:14: time.step: must be greater than 0; given 0.0\n",
    ),
    "negative step": (
        changed("step: 0.02", "step: -0.02"),
        "w.yaml:3:14: time.step: must be greater than 0; given -0.02\n",
    ),
    "a speed that would tunnel": (
        changed("path: {offset: 1.0}", "path: {offset: 1.0}\n    limits: {v: 30.0, omega: 1.6}"),
        'w.yaml:10:13: robots[0].limits: "a" could move 0.6329 m in one step of 0.02 s (v 30 m/s '
        "+ 1.03 m x omega 1.6 rad/s); at most 0.25 m are allowed, a quarter of the smallest "
        'width, that of "a"; use a step of at most 0.00789 s or lower limits\n',
    ),
    "unknown controller": (
        SMALL + "controller: {type: mode_swiching}\n",
        'w.yaml:16:20: controller.type: no controller is called "mode_swiching"; registered: '
        f'{REGISTERED}; did you mean "mode_switching"?\n',
    ),
    "unknown setting": (
        SMALL + "controller: {betta: 0.2}\n",
        'w.yaml:16:14: controller.betta: unknown key; allowed: speed, look_ahead',
    ),
    "wrong setting": (
        SMALL + "controller: {beta: 2.0}\n",
        "w.yaml:16:20: controller.beta: must be less than 1; given 2.0\n",
    ),
    "class in a world": (
        SMALL + 'controller: {type: "os:system"}\n',
        'w.yaml:16:20: controller.type: "os:system" names a class; a world may name registered '
        f"controllers only: {REGISTERED}; give it on the command line by "
        "--controller\n",
    ),
}  # fmt: skip


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory with one good world, a file and an earlier run."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "small.yaml").write_text(SMALL)
    (tmp_path / "file").write_text("mine")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "earlier").mkdir()
    (tmp_path / "earlier/record.h5").write_text("mine")
    return tmp_path


@pytest.mark.parametrize("fault", WORLDS)
def test_faulty_world(fault: str, here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text, told = WORLDS[fault]
    (here / "w.yaml").write_text(text)
    before = tree(here)
    done = physim("run", "w.yaml", capture=capsys)
    check(done.code, done.out, done.err, told)
    assert tree(here) == before


def check(code: int, out: str, err: str, told: str) -> None:
    """Exit code 2 and one line; ``told`` without a line break at its end is how it begins."""
    assert (code, out) == (2, "")
    assert err == told if told.endswith("\n") else err.startswith(told)
    assert err.count("\n") == 1
    assert err.endswith("\n")
    assert "Traceback" not in err


def test_all_faults_of_a_world_are_told_at_once(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = SMALL.replace("step: 0.02", "stap: 0.02").replace("length: 1.8", "length: -1.8")
    (here / "w.yaml").write_text(text)
    done = physim("run", "w.yaml", capture=capsys)
    lines = done.err.splitlines()
    assert done.code == 2
    assert lines[0].startswith("w.yaml:3:8: time.stap: unknown key; ")
    assert any(line.startswith("w.yaml:7:25: robots[0].footprint.length: ") for line in lines)


ARGUMENTS = {
    "missing file": (["nope.yaml"], "nope.yaml: no such file; world files there: small.yaml\n"),
    "missing name": (
        ["strait"],
        'strait: no such file, and no shipped world is called "strait"; shipped: ',
    ),
    "folder": (["earlier/"], "earlier: is a folder, not a world file\n"),
    "existing output": (
        ["small.yaml", "-o", "earlier"],
        "earlier: holds an earlier run (record.h5); use --force to write over it, or -o for "
        "another folder\n",
    ),
    "output is a file": (
        ["small.yaml", "-o", "file"],
        "file: is a file; -o takes a folder\n",
    ),
    "output is a file, by force": (
        ["small.yaml", "-o", "file", "--force"],
        "file: is a file; -o takes a folder\n",
    ),
    "output under a file": (
        ["small.yaml", "-o", "file/run"],
        "file/run: cannot be written (Not a directory)\n",
    ),
    "output is a pipe": (
        ["small.yaml", "-o", "pipe"],
        "pipe: is a file; -o takes a folder\n",
    ),
    "output cannot be made": (
        ["small.yaml", "-o", "/proc/none/run"],
        "/proc/none/run: cannot be written (No such file or directory)\n",
    ),
    "nothing to set": (
        ["small.yaml", "--set", "time.step"],
        '--set time.step: "time.step" is not KEY=VALUE, as time.step=0.02 or '
        "robots.0.pose=[1, 2, 0]\n",
    ),
    "unknown key to set": (
        ["small.yaml", "--set", "time.stp=0.1"],
        "--set time.stp: unknown key; allowed: step, duration, record_every; did you "
        'mean "step"?\n',
    ),
    "no such entry to set": (
        ["small.yaml", "--set", "robots.5.name=x"],
        "--set robots.5.name: robots: there is no entry 5; this list has entries 0 to 1\n",
    ),
    "wrong value to set": (
        ["small.yaml", "--set", "time.step=abc"],
        '--set time.step: must be a number; given "abc"\n',
    ),
    "no YAML to set": (
        ["small.yaml", "--set", "time.step=[1"],
        "--set time.step: not valid YAML: ",
    ),
    "unknown controller": (
        ["small.yaml", "--controller", "nobody"],
        "--controller: no controller is called ",
    ),
    "no such module": (
        ["small.yaml", "--controller", "no_such_module:X"],
        '--controller: controller "no_such_module:X": no module "no_such_module" in the current '
        "folder or on the Python path\n",
    ),
    "no such class": (
        ["small.yaml", "--controller", "os:system"],
        '--controller: controller "os:system": module "os" has no class "system"\n',
    ),
    "class that does not decide": (
        ["small.yaml", "--controller", "pathlib:Path"],
        '--controller: controller "pathlib:Path": class '
        "Path has no method decide(observation, memory)\n",
    ),
}


@pytest.mark.parametrize("fault", ARGUMENTS)
def test_faulty_argument(fault: str, here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments, told = ARGUMENTS[fault]
    before = tree(here)
    done = physim("run", *arguments, capture=capsys)
    check(done.code, done.out, done.err, told)
    assert tree(here) == before


@pytest.mark.parametrize("seed", ["x", "-1", "1.5", "", "1e3", "99999999999999999999", "٣"])
def test_faulty_seed(seed: str, here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = tree(here)
    done = physim("run", "small.yaml", "--seed", seed, capture=capsys)
    shown = seed or '""'
    told = f"--seed {shown}: must be a whole number from 0 to 10^15 (see physim run --help)\n"
    check(done.code, done.out, done.err, told)
    assert tree(here) == before


@pytest.mark.parametrize("arguments", [["walk"], ["run"], ["run", "small.yaml", "--fast"]])
def test_faulty_command(
    arguments: list[str], here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = tree(here)
    done = physim(*arguments, capture=capsys)
    check(done.code, done.out, done.err, "--fast: " if "--fast" in arguments else "physim ")
    assert "--help)" in done.err
    assert tree(here) == before


@pytest.mark.parametrize("command", ["summary", "video"])
@pytest.mark.parametrize(
    "record", ["none.h5", "file", "small.yaml", "earlier", "earlier/record.h5"]
)
def test_faulty_record(
    command: str, record: str, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = tree(here)
    output = ["-o", "new.mp4"] if command == "video" else []
    done = physim(command, record, *output, capture=capsys)
    check(done.code, done.out, done.err, f"{record}: ")
    assert tree(here) == before


@pytest.mark.parametrize("output", ["file/x.mp4", "/proc/none/x.mp4", "none/x.mp4", "earlier"])
def test_video_that_cannot_be_written(
    output: str, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert physim("run", "small.yaml", "-o", "out", "--no-video", capture=capsys).code == 0
    before = tree(here)
    done = physim("video", "out/record.h5", "-o", output, capture=capsys)
    check(done.code, done.out, done.err, f"{output}: ")
    assert tree(here) == before


def test_controller_that_fails_in_the_middle(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What was recorded up to there stays; the message names controller, robot and time."""
    (here / "failing_controller.py").write_text(
        "from physim import Decision\n"
        "class Fails:\n"
        "    def decide(self, observation, memory):\n"
        "        return Decision(v=1.0 if observation.time < 0.5 else 9.0, omega=0.0, hold=0.1)\n"
    )
    done = shell(
        "run", "small.yaml", "--controller", "failing_controller:Fails", "-o", "out", folder=here
    )
    told = "controller Fails: a at 0.5 s: command v = 9 m/s; it must be finite and within 1.5 m/s"
    told += " either way\n"
    check(done.code, done.out, done.err, told)
    assert physim("summary", "out/record.h5", capture=capsys).code == 0


def test_observer_that_fails_at_the_very_end(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The run is over and whole: so are record, summary and video; the error comes last."""
    (here / "late_observer.py").write_text(
        "class Late:\n"
        "    def start(self, simulation): ...\n"
        "    def after_step(self, step): ...\n"
        "    def close(self, ended):\n"
        "        1 / 0\n"
    )
    done = shell(
        "run", "small.yaml", "--observer", "late_observer:Late", "-o", "out", "--no-video",
        "--quiet", folder=here,
    )  # fmt: skip
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith("observer Late at 2 s: ZeroDivisionError: division by zero (")
    assert "late_observer.py:5)" in done.err
    assert done.err.count("\n") == 1
    told = json.loads((here / "out" / "summary.json").read_text())
    assert told["ended"] == "duration"
    assert physim("summary", "out/record.h5", capture=capsys).code == 0


def test_as_a_user_sees_it(here: Path) -> None:
    (here / "w.yaml").write_text(WORLDS["unknown key"][0])
    done = shell("run", "w.yaml", folder=here)
    check(*done, WORLDS["unknown key"][1])
