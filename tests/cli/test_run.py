"""``physim run``, ``summary``, ``video`` and ``list`` as they are meant to be used."""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from physim.cli import main
from physim.cli import run as run_command
from physim.record import Record
from physim.world.file import load_world
from tests.cli.commands import SMALL, frames, physim, tree
from tests.helpers import check_error, facts, inside

CONTROLLER, DISTURBANCE, DRIVE, SENSING = inside(
    "physim.parts", "CONTROLLER", "DISTURBANCE", "DRIVE", "SENSING"
)
part_names = inside("physim.parts", "part_names")
shipped_worlds = inside("physim.world.file", "shipped_worlds")

FILES = {"record.h5", "video.mp4", "summary.json"}


def test_a_run_too_large_for_the_disk_is_refused_before_anything_is_made(
    here: Path, capsys, monkeypatch
) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: SimpleNamespace(free=100, total=1e15))
    done = physim("run", "small.yaml", "--no-video", capture=capsys)
    assert done.code == 2
    assert done.out == ""
    check_error(done.err, f"{here}:", "0.0001 MB", "time.duration", "time.record_every", "robots")
    assert [file.name for file in here.iterdir()] == ["small.yaml"]


def test_a_run_writes_record_video_and_summary(here: Path, capsys) -> None:
    done = physim("run", "small.yaml", "--full", capture=capsys)
    assert done.code == 0
    folder = here / "runs" / "small-1"
    assert {file.name for file in folder.iterdir()} == FILES
    assert {file.name for file in here.iterdir()} == {"runs", "small.yaml"}
    with Record.load(folder / "record.h5") as record:
        assert record.ended == "duration"
        assert record.samples == 101
        assert record.world == load_world("small.yaml")
    assert frames(folder / "video.mp4") > 10

    assert "contacts" in done.out
    assert "runs/small-1" in done.out
    told = physim("summary", folder / "record.h5", capture=capsys)
    assert (told.code, told.err) == (0, "")
    assert done.out.startswith(told.out)
    as_json = physim("summary", folder / "record.h5", "--json", capture=capsys)
    assert as_json.out == (folder / "summary.json").read_text()
    figures = json.loads(as_json.out)
    assert figures["metrics"]["simulated_time"]["value"] == 2.0
    assert figures["contacts"] == []
    assert [one["key"] for one in figures["expectations"]] == ["contacts"]

    before = (folder / "video.mp4").read_bytes()
    again = physim("video", folder / "record.h5", "-o", "again.mp4", capture=capsys)
    assert again == (0, "again.mp4\n", "")
    assert (here / "again.mp4").read_bytes() == before
    refused = physim("video", folder / "record.h5", capture=capsys)
    assert refused.code == 2
    check_error(refused.err, f"{folder}/video.mp4:", "exists", "--force", "-o")
    assert (folder / "video.mp4").read_bytes() == before


def test_a_run_may_write_its_page_too(here: Path, capsys) -> None:
    given = ["run", "small.yaml", "--no-video", "--page", "-o", "run"]
    done = physim(*given, capture=capsys)
    assert done.code == 0
    assert "page.html" in done.out
    assert {file.name for file in (here / "run").iterdir()} == FILES - {"video.mp4"} | {"page.html"}
    page = (here / "run/page.html").read_bytes()
    again = physim("page", "run/record.h5", "-o", "again.html", capture=capsys)
    assert again == (0, "again.html\n", "")
    assert (here / "again.html").read_bytes() == page
    assert physim(*given, capture=capsys).code == 2
    forced = ("run", "small.yaml", "--no-video", "-o", "run", "--force")
    assert physim(*forced, capture=capsys).code == 0
    assert not (here / "run/page.html").exists()


def test_quiet_is_silent_and_changes_nothing(here: Path, capsys) -> None:
    loud = physim("run", "small.yaml", "-o", "loud", "--no-video", capture=capsys)
    assert (loud.code, loud.err) == (0, "")
    assert loud.out.startswith("run ")
    given = ("run", "small.yaml", "-o", "quiet", "--quiet", "--no-video")
    assert physim(*given, capture=capsys) == (0, "", "")
    with Record.load(here / "loud/record.h5") as a, Record.load(here / "quiet/record.h5") as b:
        assert a.digest() == b.digest()


def test_a_failed_expectation_gives_1_and_all_files(here: Path, capsys) -> None:
    done = physim(
        "run", "small.yaml", "--set", "expect.finished=true", "--no-video", capture=capsys
    )
    assert done.code == 1
    assert "NOT HELD" in done.out
    assert (here / "runs/small-1/summary.json").exists()
    held = physim(
        "run", "small.yaml", "--set", "expect.finished=false", "--no-video", "--force",
        capture=capsys,
    )  # fmt: skip
    assert held.code == 0


def test_the_record_holds_the_world_as_it_was_run(here: Path, capsys) -> None:
    done = physim(
        "run", "small.yaml", "-o", "out", "--no-video", "--seed", 5,
        "--set", "time.duration=1.0", "--set", "robots.1.pose=[3.0, -1.0, random]",
        "--set", "controller.beta=0.25", "--set", "name=other", capture=capsys,
    )  # fmt: skip
    assert done.code == 0
    with Record.load(here / "out/record.h5") as record:
        world = record.world
        assert record.seed == world.seed == 5
        assert record.name == world.name == "other"
        assert record.steps_run == 50
        assert world.controller.settings["beta"] == 0.25
        assert world.robots[1].pose == (3.0, -1.0, "random")
        assert world.robots[0] == load_world("small.yaml").robots[0]


OWN = """\
from pydantic import BaseModel

from physim import Decision


class Push:
    class Settings(BaseModel):
        strength: float = 0.5

    def __init__(self, settings):
        self.strength = settings.strength

    def decide(self, observation, memory):
        return Decision(v=self.strength, omega=0.0, hold=0.1)


class Late(Push):
    def decide(self, observation, memory):
        return Decision(v=0.5 if observation.time < 0.5 else 9.0, omega=0.0, hold=0.1)


class Broken:
    def __init__(self):
        self.build()

    def build(self):
        return {}["gain"]

    def decide(self, observation, memory):
        return None


class LateObserver:
    def start(self, simulation): ...
    def after_step(self, step): ...
    def close(self, ended):
        1 / 0

"""
OF_ANOTHER = "type: mode_switching, look_ahead: 1.5"


@pytest.fixture
def own(here: Path, monkeypatch) -> Path:
    """The working directory with a module of controllers of one's own."""
    (here / "own.py").write_text(OWN)
    monkeypatch.delitem(sys.modules, "own", raising=False)
    return here


@pytest.mark.parametrize(
    ("settings", "more", "speed", "told"),
    [
        ("strength: 0.7", (), 0.7, ()),
        (OF_ANOTHER, (), 0.5, ("WARNING", "small.yaml:16:", "look_ahead", "own:Push")),
        ("type: mode_switching", ("--set", "controller.strength=0.3"), 0.3, ()),
    ],
)
def test_settings_reach_the_controller_that_they_are_for_or_are_told(
    settings: str, more: tuple[str, ...], speed: float, told: tuple[str, ...], own: Path, capsys
) -> None:
    (own / "small.yaml").write_text(SMALL + f"controller: {{{settings}}}\n")
    given = ("run", "small.yaml", "--controller", "own:Push", "--no-video", "--quiet", "-o", "out")
    done = physim(*given, *more, capture=capsys)
    assert done.code == 0
    assert re.search(facts(*told), done.err) if told else done.err == ""
    with Record.load(own / "out/record.h5") as record:
        assert set(record.updates["applied_v"]) == {speed}
        assert "own:Push" in record.world_text
        assert record.pose[-1, 0] == pytest.approx([6.0 + 2.0 * speed, 1.0, 0.0], abs=1e-12)
    if not told:
        named = json.loads((own / "out/summary.json").read_text())["controller"]
        assert named == {"type": "own:Push", "settings": {"strength": speed}}
        again = ("validate", "out/record.h5", "--controller", "own:Late", "--quiet")
        told_again = physim(*again, capture=capsys).err
        assert re.search(facts("WARNING", "strength", "own:Push", "own:Late"), told_again)


def test_a_setting_that_nobody_knows_is_refused_by_name(own: Path, capsys) -> None:
    (own / "small.yaml").write_text(SMALL + "controller: {strenght: 0.7}\n")
    for name, part in (("own:Push", "strength"), ("own:Broken", "Broken")):
        done = physim("run", "small.yaml", "--controller", name, capture=capsys)
        assert done.code == 2
        check_error(done.err, "small.yaml:16:14: controller.strenght:", part)


def test_a_controller_that_fails_in_the_middle_leaves_what_was_recorded(own: Path, capsys) -> None:
    done = physim("run", "small.yaml", "--controller", "own:Late", "-o", "out", capture=capsys)
    assert (done.code, done.out) == (2, "")
    check_error(done.err, "controller Late, a at 0.5 s:", "v = 9 m/s", "within 1.5 m/s")
    assert physim("summary", "out/record.h5", capture=capsys).code == 0


def test_an_observer_that_fails_at_the_very_end_leaves_a_whole_run(own: Path, capsys) -> None:
    given = ("run", "small.yaml", "--observer", "own:LateObserver", "-o", "out", "--no-video")
    done = physim(*given, "--quiet", capture=capsys)
    assert (done.code, done.out, done.err.count("\n")) == (2, "", 1)
    assert done.err.startswith("observer LateObserver at 2 s: ")
    assert re.search(facts("ZeroDivisionError", "own.py:37"), done.err), done.err
    assert json.loads((own / "out/summary.json").read_text())["ended"] == "duration"


@pytest.mark.parametrize("asked", [False, True])
def test_traceback_shows_the_calls_that_led_to_an_error_of_ones_own(
    own: Path, capsys, asked: bool
) -> None:
    option = ["--traceback"] if asked else []
    done = physim("run", "small.yaml", "--controller", "own:Broken", *option, capture=capsys)
    assert done.code == 2
    *calls, said = done.err.splitlines()
    assert re.search(facts("own:Broken", "KeyError", "gain", "own.py:27"), said), said
    assert bool(calls) is asked
    assert any("self.build()" in line for line in calls) is asked


def test_a_run_has_its_folder_until_all_its_files_are_written(
    tmp_path: Path, monkeypatch, capsys
) -> None:
    """With --force another one removed the record while the first was making its video of it."""
    out, codes = tmp_path / "out", []
    command = ["run", "straight", "--set", "time.duration=0.2", "-o", str(out), "--quiet"]

    def meanwhile(record: Record, film: Path, *_: object) -> Path:
        codes.append(main([*command, "--force", "--no-video", "--seed", "7"]))
        film.write_bytes(b"film")
        return film

    monkeypatch.setattr(run_command, "write_video", meanwhile)
    assert main(command) in (0, 1)
    assert codes == [2]
    assert "summary.json" in capsys.readouterr().err
    with Record.load(out / "record.h5") as record:
        assert record.seed != 7
    assert sorted(file.name for file in out.iterdir()) == ["record.h5", "summary.json", "video.mp4"]
    monkeypatch.undo()
    assert main([*command, "--force", "--no-video"]) in (0, 1)


def test_force_removes_its_own_files_and_no_others(here: Path, capsys) -> None:
    out = here / "out"
    (out / "kept").mkdir(parents=True)
    (out / "kept/record.h5").write_text("mine")
    (out / "notes.txt").write_text("mine")
    (out / "video.mp4").write_text("an earlier one")
    before = tree(here)
    refused = physim("run", "small.yaml", "-o", "out", "--no-video", capture=capsys)
    assert refused.code == 2
    check_error(refused.err, "out:", "an earlier run", "video.mp4", "--force", "-o")
    assert tree(here) == before
    done = physim("run", "small.yaml", "-o", "out", "--no-video", "--force", capture=capsys)
    assert done.code == 0
    after = tree(here)
    for name in ("out/kept/record.h5", "out/notes.txt"):
        assert after[name] == b"mine"
    assert set(after) - set(before) == {"out/record.h5", "out/summary.json"}
    assert set(before) - set(after) == {"out/video.mp4"}


@pytest.mark.parametrize("name", ["record.h5", "video.cut_short.mp4"])
def test_no_link_in_the_output_folder_is_written_over(name: str, here: Path, capsys) -> None:
    (here / "out").mkdir()
    (here / "elsewhere").write_text("mine")
    (here / "out" / name).symlink_to(here / "elsewhere")
    before = tree(here)
    done = physim("run", "small.yaml", "-o", "out", "--no-video", "--force", capture=capsys)
    assert (done.code, done.out) == (2, "")
    check_error(done.err, f"out/{name}:", "not a regular file", "a link")
    assert tree(here) == before
    assert (here / "out" / name).is_symlink()


@pytest.mark.parametrize("name", ['it\'s "quoted"', "../../up", "/etc/passwd", ".", "-rf", "ü\\n"])
def test_no_name_of_a_world_leaves_the_output_folder(name: str, here: Path, capsys) -> None:
    inner = here / "deep" / "inner"
    inner.mkdir(parents=True)
    os.chdir(inner)
    quoted = json.dumps(name, ensure_ascii=False)
    (inner / "w.yaml").write_text(SMALL.replace("name: small", f"name: {quoted}", 1))
    before = set(tree(here))
    done = physim("run", "w.yaml", "--no-video", "--set", "time.duration=0.1", capture=capsys)
    assert done.code == 0, done.err
    made = set(tree(here)) - before
    (folder,) = (inner / "runs").iterdir()
    inside = f"deep/inner/runs/{folder.name}"
    assert made == {
        "deep/inner/runs", inside, f"{inside}/record.h5", f"{inside}/summary.json"
    }  # fmt: skip
    assert folder.name.endswith("-1")
    with Record.load(folder / "record.h5") as record:
        assert record.name == name


def test_list_names_every_world_and_controller(
    capsys,
) -> None:
    done = physim("list", "--json", capture=capsys)
    assert done.code == 0
    listed = json.loads(done.out)
    assert listed.pop("worlds") == shipped_worlds()
    grouped = {group: listed.pop(group) for group in ("league", "training")}
    assert grouped == {group: shipped_worlds(group) for group in grouped}
    assert listed.pop("controllers") == part_names(CONTROLLER)
    for kind, key in ((SENSING, "sensing"), (DISTURBANCE, "disturbances"), (DRIVE, "drives")):
        assert listed.pop(key) == part_names(kind)
    assert listed
    assert not any(listed.values())  # physim ships no parts of the other kinds
    shown = physim("list", capture=capsys).out
    for name, line in {**shipped_worlds(), **part_names(CONTROLLER)}.items():
        assert any(name in row and line in row for row in shown.splitlines())
    assert all(name.split("/")[1] in shown for names in grouped.values() for name in names)
