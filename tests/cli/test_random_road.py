"""Roads drawn by the seed, from the command line: preview, check, run, validate, new."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from physim import simulate
from physim.record import Record
from physim.world.file import load_world
from tests.cli.commands import physim, tree
from tests.helpers import facts, inside

lay_out = inside("physim.world.layout", "lay_out")

WORLD = """\
name: drawn
seed: 3
time: {step: 0.02, duration: 1.0}  # [s]
corridor:
  random: {length: 80.0, width: [5.0, 8.0], clutter: 12.0, passage: 2.5}
robots:
  - {name: a, footprint: {length: 1.2, width: 0.8}, pose: [6.0, 0.0, random], path: {offset: 0.3}}
  - {name: b, footprint: {length: 1.2, width: 0.8}, pose: [3.0, 0.0, random], path: {offset: -0.3}}
"""


@pytest.fixture(autouse=True)
def _folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "w.yaml").write_text(WORLD)


def test_a_run_can_be_simulated_again_from_its_record(capsys) -> None:
    arguments = ("run", "w.yaml", "--seed", 5, "-o", "out", "--no-video", "--quiet")
    assert physim(*arguments, capture=capsys).code == 0
    with Record.load("out/record.h5") as record:
        assert record.seed == 5
        drawn = lay_out(load_world("w.yaml"), 5)
        assert record.world == load_world("w.yaml", overrides=["seed=5"])
        assert len(record.bodies) == 2 + 4 + len(drawn.obstacles)
    again = physim("validate", "out/record.h5", "--rerun", "--json", "v.json", capture=capsys)
    assert again.code == 0, again.out
    assert json.loads(Path("v.json").read_text())["rerun"]["same_digest"] is True


def test_validate_draws_a_road_for_every_seed(capsys) -> None:
    done = physim("validate", "w.yaml", "--seeds", "0:3", capture=capsys)
    assert done.code == 0
    assert "Nothing in this world is random" not in done.out
    assert re.search(facts("3 of 3"), done.out)
    for seed in range(2):
        assert physim("run", "w.yaml", "--seed", seed, "-o", f"o{seed}", "--no-video",
                      capture=capsys).code == 0  # fmt: skip
    with Record.load("o0/record.h5") as one, Record.load("o1/record.h5") as other:
        assert not np.array_equal(one.reference, other.reference)


def test_check_and_preview_are_of_the_seed(tmp_path, capsys) -> None:
    done = physim("check", "w.yaml", "--seed", 9, capture=capsys)
    assert done.code == 0
    assert re.search(facts("road drawn by seed 9", "80.0 m", "2.5 m"), done.out)
    assert physim("preview", "w.yaml", "--seed", 9, "-o", "9.svg", capture=capsys).code == 0
    assert physim("preview", "w.yaml", "-o", "3.svg", capture=capsys).code == 0
    one, other = ((tmp_path / f"{n}.svg").read_text() for n in (9, 3))
    assert one != other


def test_new_writes_out_the_road_of_a_seed(tmp_path, capsys) -> None:
    done = physim("new", "--from", "w.yaml", "--seed", 7, capture=capsys)
    assert (done.code, done.err) == (0, "")
    assert "drawn_7.yaml" in tree(tmp_path)
    text = (tmp_path / "drawn_7.yaml").read_text()
    head = text.partition("name:")[0]
    assert "physim new drawn_7 --from w.yaml --seed 7" in head
    assert "seed 7" in head
    plain, drawn = load_world("drawn_7.yaml"), load_world("w.yaml", overrides=["seed=7"])
    assert not plain.is_road_random
    assert (plain.name, plain.seed, len(plain.obstacles)) == ("drawn_7", 7, 6)
    assert plain.robots == drawn.robots
    with simulate(plain) as one, simulate(drawn) as other:
        assert np.array_equal(one.pose, other.pose)
        assert np.array_equal(one.updates, other.updates)
    assert physim("check", "drawn_7.yaml", capture=capsys).code == 0
    assert physim("new", "my road", "--from", "w.yaml", "-o", "o.yaml", capture=capsys).code == 0
    assert (load_world("o.yaml").name, load_world("o.yaml").seed) == ("my road", 3)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--from", "straight"], ("straight.yaml", "no corridor.random")),
        (["--from", "w.yaml", "--template", "bend"], ("--template", "--from")),
        (["--from", "w.yaml", "--robots", "3"], ("--robots", "--from")),
        (["--from", "w.yaml", "--project", "p"], ("--project", "--from")),
        (["--from", "w.yaml", "-o", "w.yaml"], ("w.yaml", "is the input")),
        (["--from", "w.yaml", "--seed", "-1"], ("--seed", "-1")),
        (["--from", "w.yam"], ("w.yam", "no such file")),
        (["a", "--seed", "3"], ("--seed", "--from")),
        (["--from", "bad.yaml"], ("bad.yaml:5:69", "corridor.random.passage", "9.5 m")),
    ],
)
def test_what_new_cannot_write_out_is_refused(tmp_path, capsys, arguments, said) -> None:
    (tmp_path / "bad.yaml").write_text(WORLD.replace("passage: 2.5", "passage: 9.5"))
    before = tree(tmp_path)
    done = physim("new", *arguments, capture=capsys)
    assert done.code == 2
    assert len(done.err.splitlines()) == 1
    assert re.search(facts(*said), done.err)
    assert tree(tmp_path) == before


def test_keys_of_the_road_can_be_set(capsys) -> None:
    key = "corridor.random.clutter"
    done = physim("check", "w.yaml", "--set", f"{key}=0.0", capture=capsys)
    assert re.search(facts("0 obstacles"), done.out)
    done = physim("check", "w.yaml", "--set", f"{key}=99.0", capture=capsys)
    assert done.code == 2
    assert re.search(facts(f"--set {key}", "at most 50"), done.out)
