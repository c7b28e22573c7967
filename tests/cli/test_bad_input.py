"""Bad input: exit code 2, one message on standard error that says what and where, nothing written.

What is said is matched by its meaning: place, what was given, what is allowed.
"""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from tests.cli.commands import SMALL, Done, physim, shell, tree
from tests.helpers import check_error, inside
from tests.helpers.records import make_record

controller_names = inside("physim.parts", "controller_names")


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
    "no YAML at all": ("\0\1", "w.yaml:1:1:", "U+0000"),
    "empty": ("", "w.yaml:1:1:", "empty", "name, time, corridor and robots"),
    "unknown key": (
        changed("formation:", "formatoin:"),
        "w.yaml:14:1: formatoin:", WORLD_KEYS, '"formation"',
    ),
    "a list without brackets": (
        changed("[6.0, 1.0, 0.0]", "6.0, 1.0, 0.0"),
        "w.yaml:8:11: robots[0].pose:", "[6.0, 1.0, 0.0]",
    ),
    "unknown key within": (
        changed("width: 8.0", "widht: 8.0"),
        "w.yaml:4:43: corridor.widht:", "centreline, width, end_margin", '"width"',
    ),
    "wrong type": (
        changed("width: 8.0", "width: wide"),
        "w.yaml:4:50: corridor.width:", "[m] full width", "one number", '"wide"',
    ),
    "not a number": (
        changed("[6.0, 1.0, 0.0]", "[.nan, 1.0, 0.0]"),
        "w.yaml:8:12: robots[0].pose[0]:", ".nan", "finite",
    ),
    "infinite": (
        changed("duration: 2.0", "duration: .inf"),
        "w.yaml:3:30: time.duration:", ".inf", "finite",
    ),
    "self-crossing footprint": (
        changed("{length: 1.8, width: 1.0}", "[[0, 0], [1, 1], [1, 0], [0, 1]]"),
        "w.yaml:7:16: robots[0].footprint:", "(0.5, 0.5)", "corners",
    ),
    "robot outside": (
        changed("[6.0, 1.0, 0.0]", "[6.0, 11.0, 0.0]"),
        "w.yaml:8:11: robots[0].pose:", '"a"', "6.5 m", "outside",
    ),
    "robot in a wall": (
        changed("[6.0, 1.0, 0.0]", "[6.0, 3.8, 0.0]"),
        "w.yaml:8:11: robots[0].pose:", '"a"', "0.3 m", "edge of the corridor",
    ),
    "robots overlap": (
        changed("[6.0, 1.0, 0.0]", "[3.5, -1.0, 0.0]"),
        "w.yaml:12:11: robots[1].pose:", '"b" overlaps "a"', "1 m",
    ),
    "step of zero": (
        changed("step: 0.02", "step: 0.0"),
        "w.yaml:3:14: time.step:", "at least 1e-06", "given 0.0",
    ),
    "negative step": (
        changed("step: 0.02", "step: -0.02"),
        "w.yaml:3:14: time.step:", "at least 1e-06", "given -0.02",
    ),
    "a speed that would tunnel": (
        changed("path: {offset: 1.0}", "path: {offset: 1.0}\n    limits: {v: 30.0, omega: 1.6}"),
        "w.yaml:10:13: robots[0].limits:", '"a"', "0.6329 m", "step of 0.02 s", "30 m/s",
        "1.6 rad/s", "at most 0.25 m", "at most 0.00789 s",
    ),
    "unknown controller": (
        SMALL + "controller: {type: mode_swiching}\n",
        "w.yaml:16:20: controller.type:", '"mode_swiching"', REGISTERED, '"mode_switching"',
    ),
    "unknown setting": (
        SMALL + "controller: {betta: 0.2}\n",
        "w.yaml:16:14: controller.betta:", "speed, look_ahead",
    ),
    "wrong setting": (
        SMALL + "controller: {beta: 2.0}\n",
        "w.yaml:16:20: controller.beta:", "less than 1", "given 2.0",
    ),
    "class in a world": (
        SMALL + 'controller: {type: "os:system"}\n',
        "w.yaml:16:20: controller.type:", '"os:system"', REGISTERED, "--controller",
    ),
}  # fmt: skip
"""By fault: the world; where the error is; what else it says."""


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory with one good world, a file and an earlier run."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "small.yaml").write_text(SMALL)
    (tmp_path / "file").write_text("mine")
    (tmp_path / "link").symlink_to("nowhere")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "earlier").mkdir()
    (tmp_path / "earlier/record.h5").write_text("mine")
    return tmp_path


@pytest.mark.parametrize("fault", WORLDS)
def test_faulty_world(fault: str, here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text, place, *parts = WORLDS[fault]
    (here / "w.yaml").write_text(text)
    before = tree(here)
    done = physim("run", "w.yaml", capture=capsys)
    check(done, place, *parts)
    assert tree(here) == before


def check(done: Done, place: str, *parts: str) -> None:
    """Exit code 2 and one line."""
    assert (done.code, done.out) == (2, "")
    check_error(done.err, place, *parts)


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
    "missing file": (["nope.yaml"], "nope.yaml:", "no such file", "small.yaml"),
    "missing name": (["strait"], "strait:", "no such file", '"strait"', "straight"),
    "folder": (["earlier/"], "earlier:", "folder"),
    "existing output": (["small.yaml", "-o", "earlier"], "earlier:", "record.h5", "--force", "-o"),
    "output is a link to nothing": (["small.yaml", "-o", "link"], "link:", "-o takes a folder"),
    "output is a file": (["small.yaml", "-o", "file"], "file:", "-o takes a folder"),
    "output is a file, by force": (
        ["small.yaml", "-o", "file", "--force"], "file:", "-o takes a folder",
    ),
    "output under a file": (["small.yaml", "-o", "file/run"], "file/run:", "Not a directory"),
    "output is a pipe": (["small.yaml", "-o", "pipe"], "pipe:", "-o takes a folder"),
    "output cannot be made": (
        ["small.yaml", "-o", "/proc/none/run"], "/proc/none/run:", "No such file or directory",
    ),
    "nothing to set": (
        ["small.yaml", "--set", "time.step"], "--set time.step:", '"time.step"', "KEY=VALUE",
    ),
    "an option with two values": (
        ["small.yaml", "--seed", "1", "--set", "seed=1", "--see=2"], "--seed:", "twice",
    ),
    "a key with two values": (
        ["small.yaml", "--set", "time.step=0.02", "--set", "time.step =0.01"],
        "--set time.step:", "twice",
    ),
    "a seed with two values": (
        ["small.yaml", "--set", "seed=1", "--seed", "2"], "--set seed:", "twice", "--seed",
    ),
    "two outputs": (["small.yaml", "-o", "a", "--output", "b"], "--output:", "twice"),
    "unknown key to set": (
        ["small.yaml", "--set", "time.stp=0.1"],
        "--set time.stp:", "step, duration, record_every", '"step"',
    ),
    "no such entry to set": (
        ["small.yaml", "--set", "robots.5.name=x"],
        "--set robots.5.name:", "no entry 5", "entries 0 to 1",
    ),
    "wrong value to set": (
        ["small.yaml", "--set", "time.step=abc"], "--set time.step:", "a number", '"abc"',
    ),
    "no YAML to set": (["small.yaml", "--set", "time.step=[1"], "--set time.step:", "YAML"),
    "unknown controller": (
        ["small.yaml", "--controller", "nobody"], "--controller:", '"nobody"', REGISTERED,
    ),
    "a file": (["small.yaml", "--controller", "own/ctl.py"], "--controller:", "own.ctl:CLASS"),
    "a module with a class": (
        ["small.yaml", "--controller", "ctl.Ttc"], "--controller:", "MODULE:CLASS", "ctl:Ttc",
    ),
    "no such module": (
        ["small.yaml", "--controller", "no_such_module:X"],
        "--controller:", '"no_such_module:X"', 'no module "no_such_module"',
    ),
    "no such package": (
        ["small.yaml", "--controller", "no_such.module:X"],
        "--controller:", '"no_such.module:X"', 'no module "no_such.module" in the current folder',
    ),
    "no such class": (
        ["small.yaml", "--controller", "os:system"],
        "--controller:", '"os:system"', 'module "os" has no class "system"',
    ),
    "class that does not decide": (
        ["small.yaml", "--controller", "pathlib:Path"],
        "--controller:", '"pathlib:Path"', "decide(observation, memory)",
    ),
}  # fmt: skip
"""By fault: the arguments; where the error is; what else it says."""


@pytest.mark.parametrize("fault", ARGUMENTS)
def test_faulty_argument(fault: str, here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments, place, *parts = ARGUMENTS[fault]
    before = tree(here)
    done = physim("run", *arguments, capture=capsys)
    check(done, place, *parts)
    assert tree(here) == before


@pytest.mark.parametrize("seed", ["x", "-1", "1.5", "", "1e3", "99999999999999999999", "٣"])
def test_faulty_seed(seed: str, here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = tree(here)
    done = physim("run", "small.yaml", "--seed", seed, capture=capsys)
    given = seed or '""'
    check(done, f"--seed {given}:", "a whole number from 0 to 10^15", "physim run --help")
    assert tree(here) == before


@pytest.mark.parametrize("scale", ["1_0", "١", "1e", "0x1", "1,0", ""])
def test_faulty_number(scale: str, here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = tree(here)
    done = physim("import", "a.svg", "-o", "w.yaml", "--scale", scale, capture=capsys)
    check(done, f"--scale {scale or chr(34) * 2}:", "physim import --help")
    assert tree(here) == before


@pytest.mark.parametrize("arguments", [["walk"], ["run"], ["run", "small.yaml", "--fast"]])
def test_faulty_command(
    arguments: list[str], here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = tree(here)
    done = physim(*arguments, capture=capsys)
    check(done, "--fast:" if "--fast" in arguments else "physim", "--help")
    assert tree(here) == before


@pytest.mark.parametrize("command", ["summary", "video"])
@pytest.mark.parametrize("record", ["none.h5", "file", "small.yaml", "earlier/record.h5"])
def test_faulty_record(
    command: str, record: str, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = tree(here)
    output = ["-o", "new.mp4"] if command == "video" else []
    done = physim(command, record, *output, capture=capsys)
    check(done, f"{record}:")
    assert tree(here) == before


@pytest.mark.parametrize("output", ["file/x.mp4", "/proc/none/x.mp4", "none/x.mp4", "earlier"])
def test_video_that_cannot_be_written(
    output: str, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert physim("run", "small.yaml", "-o", "out", "--no-video", capture=capsys).code == 0
    before = tree(here)
    done = physim("video", "out/record.h5", "-o", output, capture=capsys)
    check(done, f"{output}:")
    assert tree(here) == before


@pytest.mark.parametrize(
    ("times", "said"),
    [
        (("--from", "300", "--to", "2"), ("--from 300, --to 2:", "1 s")),
        (("--from", "0.5", "--to", "0.5"), ("--from 0.5, --to 0.5:", "1 s")),
        (("--from", "1"), ("--from 1:", "1 s")),
    ],
)
def test_times_of_a_film_that_show_nothing(
    times: tuple[str, ...], said: tuple[str, ...], here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    make_record(here / "record.h5", seconds=1.0).close()
    before = tree(here)
    done = physim("video", "record.h5", *times, capture=capsys)
    check(done, *said, "--from", "--to")
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
    check(done, "controller Fails: a at 0.5 s:", "v = 9 m/s", "finite", "within 1.5 m/s")
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
    assert done.err.startswith("observer Late at 2 s: ")
    assert "ZeroDivisionError: division by zero" in done.err
    assert "late_observer.py:5)" in done.err
    assert done.err.count("\n") == 1
    told = json.loads((here / "out" / "summary.json").read_text())
    assert told["ended"] == "duration"
    assert physim("summary", "out/record.h5", capture=capsys).code == 0


def test_as_a_user_sees_it(here: Path) -> None:
    (here / "w.yaml").write_text(WORLDS["unknown key"][0])
    done = shell("run", "w.yaml", folder=here)
    check(done, *WORLDS["unknown key"][1:])
