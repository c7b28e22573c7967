"""A record leads on: it is a world to be run again, and the folder of a run stands for it."""

from __future__ import annotations

import importlib
from pathlib import Path

import h5py
import pytest

import physim as package
from physim.record import Record
from tests.cli.commands import SMALL, physim

SHORT = SMALL.replace("duration: 2.0", "duration: 0.4")
OWN = """\
from physim import Decision, Mode

class Straight:
    modes = (Mode("go", "#0072b2", "on its way"),)
    def decide(self, observation, memory):
        return Decision(v=0.5, omega=0.0, hold=0.1, mode="go")
"""


@pytest.fixture
def here(here: Path) -> Path:
    """Working folder with the record of a run in ``ran``: seed 7, one speed changed by --set."""
    world = package.parse_world(SHORT, overrides=["robots.0.limits.v=1.2", "seed=7"])
    (here / "ran").mkdir()
    package.simulate(world, path=here / "ran" / "record.h5").close()
    return here


def test_a_record_is_taken_for_the_world_of_its_run(here, capsys):
    code, _, err = physim("run", "ran/record.h5", "-o", "again", "--no-video", capture=capsys)
    assert code == 0, err
    with Record.load(here / "ran/record.h5") as one, Record.load(here / "again/record.h5") as other:
        assert (other.seed, other.digest()) == (7, one.digest())
        assert other.world.robots[0].limits.v == 1.2
    seeded = ("run", "ran/record.h5", "--seed", 3, "-o", "seeded", "--no-video")
    assert physim(*seeded, capture=capsys).code == 0
    with Record.load(here / "seeded/record.h5") as other:
        assert other.seed == 3
    assert physim("check", "ran/record.h5", capture=capsys).code == 0
    assert physim("preview", "ran/record.h5", capture=capsys).code == 0
    assert (here / "ran.png").exists()


def test_faults_of_the_world_inside_name_the_record(here, capsys):
    with h5py.File("ran/record.h5", "r+") as file:
        file.attrs["world"] = file.attrs["world"].replace("width: 8.0", "width: -8.0")
    for command in ("run", "check", "sweep"):
        code, out, err = physim(command, "ran/record.h5", capture=capsys)
        assert code == 2
        assert "ran/record.h5:" in out + err
        assert "corridor.width" in out + err
    (here / "no.h5").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(100))
    code, _, err = physim("run", "no.h5", capture=capsys)
    assert (code, err.count("\n")) == (2, 1)
    assert err.startswith("no.h5:")


def test_the_folder_of_a_run_stands_for_its_record(here, capsys):
    for words in (("summary", "ran"), ("page", "ran"), ("plot", "ran", "--only", "modes"),
                  ("video", "ran", "ran/", "--at", 0.1), ("validate", "ran")):  # fmt: skip
        code, _, err = physim(*words, capture=capsys)
        assert code == 0, err
    assert {"page.html", "modes.png", "frame.png"} <= {one.name for one in (here / "ran").iterdir()}
    code, _, err = physim("summary", ".", capture=capsys)
    assert (code, err.startswith("record.h5: no such file")) == (2, True)


def test_a_world_of_the_folder_worlds_is_found_by_its_name(here, capsys):
    (here / "worlds").mkdir()
    (here / "worlds" / "pillars.yaml").write_text(SHORT, encoding="utf-8")
    for words in (("check", "pillars"), ("run", "pillars", "--no-video")):
        code, _, err = physim(*words, capture=capsys)
        assert code == 0, err


@pytest.mark.parametrize("from_python", [False, True])
def test_a_class_that_a_record_names_is_run_when_the_option_told_is_given(
    here, capsys, from_python
):
    (here / "its_own.py").write_text(OWN, encoding="utf-8")
    name = "its_own:Straight"
    if from_python:
        made = importlib.import_module("its_own").Straight()
        package.simulate(package.parse_world(SHORT), controller=made, path="own.h5").close()
    else:
        package.simulate(
            package.parse_world(SHORT, controller=name), controller=name, path="own.h5"
        ).close()
    for words in (("run", "own.h5", "--no-video", "-o", "o"), ("check", "own.h5"),
                  ("preview", "own.h5")):  # fmt: skip
        code, out, err = physim(*words, capture=capsys)
        assert code == 2
        assert f"--controller {name}" in out + err
        code, _, err = physim(*words, "--controller", name, capture=capsys)
        assert code == 0, err
    tried = ("check-controller", "constant", "--world", "own.h5", "--seconds", 0.1)
    assert physim(*tried, capture=capsys).code == 0
