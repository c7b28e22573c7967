"""Controllers and parts of the how-to pages, installed with no line of physim changed, do as told.

Each is run by its page's own command. What it did is read from its record, and held against the
same run without it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import physim
from physim import Record
from tests.helpers import inside
from tests.helpers.extending import blocks, entry_points, install, of

pytestmark = pytest.mark.deep

KINDS, METRIC, PLOT = inside("physim.parts", "KINDS", "METRIC", "PLOT")
find_world = inside("physim.world.file", "find_world")

BIN = Path(sys.executable).parent
EVERY_KIND = (*KINDS, METRIC, PLOT)


def run(text: str, folder: Path, **more: str) -> subprocess.CompletedProcess[str]:
    """Run a block of shell in a folder that has the examples installed beside it."""
    path = f"{BIN}{os.pathsep}{os.environ['PATH']}"
    env = {**os.environ, "PATH": path, "PYTHONPATH": str(folder.parent / "installed"), **more}
    return subprocess.run(
        ["bash", "-euo", "pipefail", "-c", text], cwd=folder, env=env, capture_output=True,
        text=True,
    )  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which every command of these pages was run, and its output compared."""
    base = tmp_path_factory.mktemp("extending")
    install(base / "installed")
    here = base / "work"
    here.mkdir()
    out = ""
    for block in blocks():
        if block.language == "sh":
            done = run(block.text, here)
            assert done.returncode == 0, f"{block.text}\n{done.stdout}\n{done.stderr}"
            out = done.stdout
        elif block.language == "text":
            missing = [line for line in block.text.splitlines() if line not in out.splitlines()]
            assert missing == [], f"{block.page}\n{out}"
    return here


@pytest.fixture(scope="module")
def plain() -> Record:
    """The run that all examples change, without any of them."""
    return physim.simulate(physim.load_world("straight"))


def test_list_shows_each_with_its_first_line(folder: Path) -> None:
    done = run("physim list", folder)
    found = {
        line.split(maxsplit=1)[0]: line for line in done.stdout.splitlines() if line[:1] == " "
    }
    for kind in EVERY_KIND:
        for name in entry_points()[kind.group]:
            assert found[name].rstrip().endswith(".")
    again = json.loads(run("physim list --json", folder).stdout)
    assert list(again["filters"]) == ["ramp"]
    assert list(again["observers"]) == ["nearest"]
    assert "cautious" not in run("physim list", folder, PYTHONPATH="").stdout


def test_keys_of_the_page_go_into_a_world(folder: Path) -> None:
    base = find_world("straight").read_text(encoding="utf-8")
    schema = json.loads(run("physim schema", folder).stdout)
    filters = schema["$defs"]["filters"]
    assert filters["properties"]["type"]["enum"] == ["ramp"]
    assert "[m/s²]" in json.dumps(filters, ensure_ascii=False)
    for block in of("yaml"):
        (folder / "w.yaml").write_text(base + block.text, encoding="utf-8")
        done = run("physim check w.yaml", folder)
        assert (done.returncode, "no errors, no warnings" in done.stdout) == (0, True), done.stdout
    (folder / "w.yaml").write_text(base + "filters: [{type: ramp, acelleration: 1.0}]\n")
    done = run("physim check w.yaml", folder)
    assert done.returncode == 2
    assert 'unknown key; allowed: type, acceleration; did you mean "acceleration"?' in done.stdout


def test_controller_waits_and_tells_why(folder: Path) -> None:
    with Record.load(folder / "waiting" / "record.h5") as record:
        names = [mode.name for mode in record.modes]
        assert names == ["going", "waiting"]
        rows = record.updates
        near = rows["nearest"] < 3.0
        assert 50 < near.sum() < len(rows)
        assert ((rows["mode"] == names.index("waiting")) == near).all()
        rule = np.array([one.name for one in record.declared.rules])[rows["rule"]]
        assert ((rule == "give_way") == near).all()
        assert (rows["nominal_v"][near] == 0.0).all()
        assert rows["nominal_v"][~near & (rule == "steer")].min() == pytest.approx(0.6)
        assert set(rows["waited"][rule == "steer"].tolist()) == {0.0}
        mine = rows[rows["robot"] == 1]
        grown = np.flatnonzero(mine["waited"][1:] > 0.0)
        before = mine["waited"][grown]
        assert np.allclose(mine["waited"][1:][grown], before + 0.1)
        assert record.column("nearest")[near].min() > 1.0
        assert record.ended == "finished"


def test_one_for_all_waits_as_its_columns_tell(folder: Path) -> None:
    with Record.load(folder / "convoy" / "record.h5") as record:
        rows = record.updates
        waiting = rows["mode"] == 1
        assert 20 < waiting.sum() < len(rows)
        assert ((rows["waited"] > 0.0) == waiting).all()
        assert (rows["nominal_v"][waiting] == 0.0).all()
        assert (rows["considered"][waiting] == 1).all()


def test_the_papers_controller_inside_another_stands_where_it_would_back(folder: Path) -> None:
    with Record.load(folder / "patient" / "record.h5") as record:
        rules = np.array([one.name for one in record.declared.rules])[record.updates["rule"]]
        assert set(rules) > {"patience", "path_following"}
        assert record.updates["nominal_v"].min() == 0.0
        assert record.updates["nominal_v"][rules == "patience"].max() == 0.0


def test_robots_of_two_controllers_go_as_each_would(folder: Path) -> None:
    with Record.load(folder / "team" / "record.h5") as record:
        names = [part.name for part, _ in record.setup.controllers]
        assert names == ["mode_switching", "path_following"]
        rules = np.array([rule.name for rule in record.declared.rules])[record.updates["rule"]]
        assert set(rules[record.updates["robot"] == 1]) == {"path_following_2", "stop"}
        assert "path_following_2" not in rules[record.updates["robot"] == 0]


def test_sense_stage_misleads_each_observer_differently(folder: Path, plain: Record) -> None:
    with Record.load(folder / "hazy" / "record.h5") as record:
        assert record.digest() != plain.digest()
        both = min(len(record.pose), len(plain.pose))
        apart = np.abs(record.pose[:both] - plain.pose[:both]).max()
        assert 1e-3 < apart < 0.5
        names = (record.world.sensing.stages[0].type, len(record.commands))
        assert names == ("haze", 0)


def test_filter_bounds_every_change_of_speed(folder: Path, plain: Record) -> None:
    with Record.load(folder / "ramped" / "record.h5") as record:
        steps = len(record.pose) - 1
        nominal = record.commands_over("nominal", 0, steps)
        filtered = record.commands_over("filtered", 0, steps)
        most = 1.0 * record.dt + 1e-12
        assert np.abs(np.diff(nominal[..., 0], axis=0)).max() > 10.0 * most
        assert np.abs(np.diff(filtered[..., 0], axis=0, prepend=0.0)).max() <= most
        assert (filtered[..., 1] == nominal[..., 1]).all()
        assert (filtered == record.commands_over("applied", 0, steps)).all()
        rows = record.commands
        assert len(rows) == (filtered != nominal).any(axis=2).sum()
        assert len(plain.commands) == 0
        assert record.ended == plain.ended == "finished"
        assert len(record.pose) > len(plain.pose)


def test_disturbance_moves_the_bodies_by_its_gains(folder: Path, plain: Record) -> None:
    with Record.load(folder / "uneven" / "record.h5") as record:
        steps = len(record.pose) - 1
        filtered = record.commands_over("filtered", 0, steps)
        applied = record.commands_over("applied", 0, steps)
        gains = applied.sum(axis=0) / filtered.sum(axis=0)
        assert np.allclose(applied, filtered * gains, atol=1e-12)
        assert (np.abs(gains - 1.0) <= 0.2).all()
        assert len(np.unique(gains.round(6))) == gains.size
        moved = np.hypot(*np.diff(record.pose[..., :2], axis=0).T).T
        assert np.allclose(moved, np.abs(applied[..., 0]) * record.dt, rtol=1e-3)
        assert (record.commands["nominal_v"] == record.commands["filtered_v"]).all()
        assert record.digest() != plain.digest()


def test_observer_looks_on_and_changes_nothing(folder: Path, plain: Record) -> None:
    with Record.load(folder / "watched" / "record.h5") as record:
        assert record.digest() == plain.digest()
    (block,) = (b for b in of("sh") if "--observer" in b.text)
    without = run(block.text.replace("--observer nearest", "").replace("watched", "alone"), folder)
    assert without.returncode == 0
    assert "apart" not in without.stdout
    by_class = block.text.replace("nearest", "nearest:Nearest").replace("watched", "by_class")
    assert "end of the run: finished" in run(by_class, folder).stdout


def test_metric_stands_in_the_summary(folder: Path) -> None:
    def stops(name: str) -> int:
        given = json.loads((folder / name / "summary.json").read_text())["metrics"]["stops"]
        assert given["unit"] == "-"
        return int(given["value"])

    with Record.load(folder / "waiting" / "record.h5") as record:
        for i in range(record.robots):
            told = record.updates["applied_v"][record.updates["robot"] == i].tolist()
            pairs = zip(told, told[1:], strict=False)
            stops_of = sum(before != 0.0 and after == 0.0 for before, after in pairs)
            assert stops_of >= (1, 50)[i]
    assert stops("waiting") > 50
    assert stops("hazy") == 2  # each robot at its stop station
    without = run("physim summary waiting/record.h5 --json", folder, PYTHONPATH="")
    assert "stops" not in json.loads(without.stdout)["metrics"]
