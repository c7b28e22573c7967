"""``physim validate``: exit codes, bad input, pages and JSON."""

from __future__ import annotations

import json
import re
from pathlib import Path

import h5py
import pytest

import physim
import physim.campaigns
from physim.analysis.validation import validate
from tests.analysis.validation import runs
from tests.analysis.validation.runs import APART, LANE, REAR_END, lane, states
from tests.helpers import said

CARELESS, IDLE = (f"{runs.__name__}:{name}" for name in ("Careless", "Idle"))
ANY_HEADING = LANE.replace("[4.6, -1.0, 0.0]", "[4.6, -1.0, random]")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Records and worlds on disk."""
    where = tmp_path_factory.mktemp("validate")
    (where / "lane.yaml").write_text(LANE, encoding="utf-8")
    (where / "any.yaml").write_text(ANY_HEADING + "expect: {finished: true}\n", encoding="utf-8")
    (where / "other.yaml").write_text(LANE.replace("width: 8.0", "width: 9.0"), encoding="utf-8")
    lane(REAR_END, where / "bad.h5").close()
    lane(APART, where / "good.h5").close()
    return where


@pytest.fixture
def run(folder, monkeypatch):
    """Runs the command in the folder."""
    monkeypatch.chdir(folder)
    return lambda *arguments: said("validate", *arguments)


def test_record_with_and_without_contact(run):
    code, out, _ = run("good.h5")
    assert (code, out.splitlines()[-1]) == (0, "verdict: contact-free")
    code, out, _ = run("bad.h5")
    assert code == 1
    assert out.splitlines()[-1].startswith("verdict: contacts: ")


def test_world_with_a_careless_controller(run):
    code, out, _ = run("lane.yaml", "--controller", CARELESS, "--page", "run.html")
    assert code == 1
    assert "Responsible:" not in out  # a rule of priority it does not have
    assert states(out, "at most 3 s", "step 0.01 s", "whole duration")
    assert CARELESS in out
    assert 'id="validation"' in Path("run.html").read_text(encoding="utf-8")


def test_json(run, folder):
    code, _, _ = run("bad.h5", "--json", "found.json", "--quiet")
    found = json.loads((folder / "found.json").read_text(encoding="utf-8"))
    assert found["exit_code"] == code == 1
    assert found["verdict"].startswith("contacts: ")
    first = found["contacts"][0]
    assert [found["run"]["bodies"][first[key]]["name"] for key in "ab"] == ["slow", "fast"]
    assert [side["responsible"] for side in first["sides"]] == [False, False]
    assert first["prediction"]["verdict"] == "agrees"
    code, out, err = run("bad.h5", "--json", "-")  # it stands alone
    assert json.loads(out) == found
    assert err.splitlines()[-1].startswith("verdict: contacts: ")


def test_origin(run):
    # Made by an object, so that the world inside is that of the file.
    assert run("good.h5", "--world", "lane.yaml").code == 0
    code, _, err = run("good.h5", "--world", "other.yaml")
    assert (code, err.count("\n")) == (2, 1)
    assert states(err, "corridor.width", "8.0 in the record", "9.0 in the world")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("nothing.h5", ("nothing.h5",)),
        ("nothing_such", ("nothing_such",)),
        ("good.h5 --seed 3", ("--seed",)),
        ("good.h5 --set seed=3", ("--set",)),
        ("lane.yaml --world other.yaml", ("--world",)),
        ("good.h5 --json no/such/folder/x.json", ("no/such/folder",)),
        ("any.yaml --page x.pdf", (".html",)),
        ("any.yaml --page no/x.html", ("no/x.html",)),
    ],
)
def test_bad_arguments(run, arguments, words):
    code, out, err = run(*arguments.split())
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert not err.startswith("physim: ")
    assert states(err, *words)


def test_a_record_tells_its_world_without_the_code_of_its_controller(tmp_path):
    world = physim.parse_world(LANE, controller=CARELESS)
    physim.simulate(world, controller=CARELESS, path=tmp_path / "mine.h5").close()
    with h5py.File(tmp_path / "mine.h5", "r+") as file:
        text = file.attrs["world"].replace(CARELESS, "nowhere.to_be_found:Evil")
        file.attrs["world"] = text
    with physim.Record.load(tmp_path / "mine.h5") as record:
        assert record.world.controller.type == "nowhere.to_be_found:Evil"
        assert validate(record).code == 1
    # A world from a file may still not name a class.
    with pytest.raises(physim.WorldError, match="names a class"):
        physim.parse_world(text)


def test_a_run_that_broke_off_is_not_contact_free(folder, monkeypatch):
    monkeypatch.chdir(folder)
    monkeypatch.syspath_prepend(str(folder))
    for name, until in (("late", 0.4), ("soon", -1.0)):
        (folder / f"{name}.py").write_text(
            "import physim\n\n\nclass Gone:\n    def decide(self, seen, memory):\n"
            f"        if seen.time > {until}:\n            raise ValueError('gone')\n"
            "        return physim.Decision(v=0.0, omega=0.0, hold=0.1)\n"
        )
        own = ("--controller", f"{name}:Gone")
        assert said("run", "lane.yaml", *own, "-o", name, "--no-video").code == 2
        code, out, _ = said("validate", name, *own, "--quiet", "--json", f"{name}.json")
        assert code == json.loads((folder / f"{name}.json").read_text())["exit_code"] == 1
        told = r"verdict: broke off with an error at (0\.\d\d) s; no contact until then$"
        found = re.search(told, out)
        assert found, out
        assert (float(found[1]) > 0.4) == (name == "late")
        assert ("decisions made again: the run made no decision" in out) == (name == "soon")


def test_of_many_runs_each_has_its_verdict(folder, monkeypatch):
    """Robots that never move are contact-free, and not as expected."""
    monkeypatch.chdir(folder)
    done = said(
        "sweep", "any.yaml", "--seeds", "1:4", "--controller", IDLE, "--set", "time.duration=1.0",
        "--workers", "1", "--validate",
    )  # fmt: skip
    assert done.code == 0, done.err
    assert "agree in every run" in done.out
    rows = physim.campaigns.read(folder / "sweeps/any")
    verdict = "contact-free; not as expected: finished"
    assert [(one.verdict, one.unexplained) for one in rows] == [(verdict, 0)] * 3


def test_of_runs_that_break_off_none_is_said_to_agree(folder, monkeypatch):
    monkeypatch.chdir(folder)
    (folder / "fails.py").write_text(
        "class Own:\n    def decide(self, observation, memory):\n        1 / 0\n"
    )
    for others, told in (((), "no run came to its end"), ((IDLE,), "agree in 3 of 6 runs")):
        done = said(
            "sweep", "any.yaml", "--seeds", "1:4", "--controller", ",".join(("fails:Own", *others)),
            "--set", "time.duration=1.0", "--workers", "1", "--validate", "-o", f"of{len(others)}",
        )  # fmt: skip
        assert told in done.out, done.out + done.err
