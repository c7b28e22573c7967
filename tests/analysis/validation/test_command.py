"""``physim validate``: exit codes, bad input, pages, JSON and seeds."""

from __future__ import annotations

import json
import signal
from pathlib import Path

import h5py
import pytest

import physim
from physim.analysis.validation import validate
from tests.analysis.validation import runs
from tests.analysis.validation.runs import APART, LANE, REAR_END, lane, states
from tests.campaigns.samples import WORLD
from tests.cli.commands import shell, started
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
        ("any.yaml --page x.html --seeds 1:3", ("--page",)),
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


# Seeds


def test_robots_that_never_move_are_not_as_expected(run, folder):
    code, out, _ = run(
        "any.yaml", "--seeds", "1:6", "--controller", IDLE, "--set", "time.duration=1.0",
        "--json", "idle.json", "--workers", "1",
    )  # fmt: skip
    assert code == 1
    assert states(out, "contact-free", "5 of 5", "100.0 %", within=60)
    assert states(out, "finished", "0 of 5", "0.0 %", "52.2 %", within=60)
    found = json.loads((folder / "idle.json").read_text(encoding="utf-8"))
    assert (found["exit_code"], found["runs"]) == (1, 5)
    verdict = "contact-free; not as expected: finished"
    assert out.count(verdict) == 5
    assert [(one["seed"], one["verdict"], one["unexplained"]) for one in found["seeds"]] == [
        (seed, verdict, 0) for seed in range(1, 6)
    ]


def test_every_seed_is_run_as_it_would_be_alone(run, folder):
    changes = ["time.duration=0.5", "robots.1.pose=[6.2, -1.3, random]"]
    short = [word for change in changes for word in ("--set", change)]
    run("any.yaml", "--seeds", "4:7", "--json", "every.json", "--workers", "1", *short)
    written = json.loads((folder / "every.json").read_text(encoding="utf-8"))["seeds"]
    world = physim.load_world(folder / "any.yaml", overrides=changes)
    alone = [physim.summarise(physim.simulate(world, seed=seed)) for seed in (4, 5, 6)]
    nearest = [one.value("shortest_distance") for one in alone]
    assert [one["shortest_distance"] for one in written] == nearest
    assert len(set(nearest)) == 3


def test_seeds_of_a_world_without_anything_random(run):
    code, out, _ = run("lane.yaml", "--controller", CARELESS, "--seeds", "1:9")
    assert code == 1
    assert states(out.splitlines()[0], "Nothing", "random")
    assert "Clopper" not in out


@pytest.mark.deep
def test_ctrl_c_keeps_the_seeds_so_far(folder):
    target = folder / "interrupted.json"
    process = started("validate", "any.yaml", "--seeds", "1:100000", "--json", target.name,
                      "--verbose", "--set", "time.duration=1.0", folder=folder)  # fmt: skip
    try:
        lines = [process.stdout.readline() for _ in range(3)]
        assert all(line.startswith("seed ") for line in lines), lines
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 130
    assert err.count("\n") == 1
    found = json.loads(target.read_text(encoding="utf-8"))
    assert found["exit_code"] == 130
    seeds = [one["seed"] for one in found["seeds"]]
    assert len(set(seeds)) == len(seeds) == found["runs"] >= 3
    assert f"after {found['runs']} of 99999 seeds" in err


FAILING = """\
import os

from physim import Decision


class Leaves:
    def decide(self, observation, memory):
        if observation.time == 0.0 and observation.pose[2] > 2.0:
            self.fail()
        return Decision(v=0.5, omega=0.0, hold=0.1)

    def fail(self):
        os._exit(0)


class Raises(Leaves):
    def fail(self):
        raise ValueError("as it was told")
"""


@pytest.mark.deep
@pytest.mark.parametrize(
    ("name", "words"), [("Leaves", "a worker process was killed"), ("Raises", "as it was told")]
)
def test_seeds_that_fail_are_told_beside_the_others(tmp_path, name, words):
    (tmp_path / "small.yaml").write_text(WORLD, encoding="utf-8")
    (tmp_path / "sometimes.py").write_text(FAILING, encoding="utf-8")
    done = shell(
        "validate", "small.yaml", "--seeds", "1:40", "--controller", f"sometimes:{name}",
        "--workers", "2", "--json", "study.json", folder=tmp_path,
    )  # fmt: skip
    assert done.code == 2
    found = json.loads((tmp_path / "study.json").read_text(encoding="utf-8"))
    failed = [one["seed"] for one in found["seeds"] if one["ended"] in ("error", "killed")]
    assert 0 < len(failed) < len(found["seeds"]) == 39
    assert done.err.startswith(f"seed {failed[0]}: ")
    assert words in done.err
