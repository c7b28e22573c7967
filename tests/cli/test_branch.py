"""`physim branch`: a run goes on from a moment of another, with something changed."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest

import physim
from physim import Record, SaveAt
from tests.helpers import said

QUICK = ("--no-video", "--quiet")
TOUCHING = ("three_robots", "--controller", "path_following", "--set", "time.duration=2")
"""Robots touch from 0.83 s to 1.42 s."""
BUSY = """
name: busy
seed: 3
time: {step: 0.01, duration: 9.0}
boundaries: [[[0, 0], [20, 0], [20, 6], [0, 6], [0, 0]]]
reference_path: [[1.5, 3.0], [18.0, 3.0]]
robots:
  - {name: r1, footprint: {length: 1.0, width: 0.6}, pose: [2.0, 3.0, 0.0], path: {offset: 0.0}}
  - {name: r2, footprint: {length: 1.0, width: 0.6}, pose: [4.0, 3.0, 0.0], path: {offset: 0.0}}
movers:
  - name: cart
    footprint: {length: 1.0, width: 1.0}
    waypoints: [[9.0, 1.0], [9.0, 5.0]]
    speed: 0.5
    repeat: to_and_fro
obstacles: [{corners: [[11.0, 2.7], [11.6, 2.7], [11.6, 3.3], [11.0, 3.3]], mass: 20.0}]
controller: {type: path_following}
disturbances: [{type: actuation, v: {noise: 0.1}, omega: {noise: 0.2}, delay: 3}]
"""
"""A cart pushes a robot from 4.16 s on, a robot a box from 8.36 s on."""
DRIVES = """
from physim import Decision


class Counts:
    def decide(self, observation, memory):
        count = memory or 0
        return Decision(v=0.5 + 0.01 * (count % 7), omega=0.0, hold=0.07, memory=count + 1)


class Stands:
    def decide(self, observation, memory):
        return Decision(v=0.0, omega=0.0, hold=0.1, memory=[object()])
"""


@pytest.fixture(autouse=True)
def _in_a_folder(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)


def made(*run: str, out: str = "whole") -> Path:
    assert said("run", *run, "-o", out, *QUICK).code in (0, 1)
    return Path(out, "record.h5")


def branched(record: Path, *options: str, out: str = "branch") -> Record:
    done = said("branch", str(record), *options, "-o", out, *QUICK)
    assert done.code in (0, 1), done.err
    return Record.load(out)


def check_same(branch: Record, whole: Record) -> None:
    """The branch is the end of the original, bit for bit, contacts under way included."""
    first, at = np.searchsorted(whole.steps, branch.begun_at), branch.begun_at
    assert (branch.ended, branch.steps_run) == (whole.ended, whole.steps_run)
    for name in ("steps", "moving_pose", "clearance", "boundary_clearance", "course"):
        np.testing.assert_array_equal(getattr(branch, name), getattr(whole, name)[first:])
    for name in ("updates", "contacts", "considered"):
        rows = getattr(whole, name)
        rows = rows[rows["step"] >= at]
        if name == "contacts":  # what ended in the step before is not of the branch
            rows = rows[(rows["step"] > at) | (rows["phase"] != physim.Phase.ENDED)]
        assert getattr(branch, name).tobytes() == rows.tobytes(), name
    assert (branch.origin.digest, branch.origin.changed) == (whole.digest(), {})


@pytest.mark.parametrize(
    ("run", "times"),
    [
        (TOUCHING, ("0", "0.82", "0.83", "1.07", "1.42", "1.99")),
        (("jam", "--set", "time.duration=12"), ("9.37",)),
        (("three_robots", "--set", "time.duration=4", "--set", "time.record_every=7"), ("1.3",)),
        pytest.param(("crossing",), ("7.7", "21.05", "33.33"), marks=pytest.mark.deep),
        pytest.param(("random_road", "--seed", "5"), ("12.34", "40.01"), marks=pytest.mark.deep),
    ],
)
def test_without_changes_it_is_the_original_from_any_step(run, times) -> None:
    with Record.load(made(*run)) as whole:
        for k, at in enumerate(times):
            with branched(whole.path, "--at", at, out=f"branch{k}") as branch:
                assert branch.begun == pytest.approx(float(at))
                if whole.record_every == 1:
                    check_same(branch, whole)
                else:
                    mine, theirs = (one.pose[one.steps % 7 == 0] for one in (branch, whole))
                    np.testing.assert_array_equal(mine, theirs[-len(mine) :])


def test_movers_boxes_and_disturbances_go_on_and_may_end() -> None:
    Path("busy.yaml").write_text(BUSY)
    with Record.load(made("busy.yaml")) as whole:
        assert {int(one) for one in whole.contacts["b"]} >= {2, 3}
        for k, at in enumerate(("4.18", "5.7", "8.5")):
            with branched(whole.path, "--at", at, out=f"same{k}") as branch:
                assert len(branch.contacts[branch.contacts["step"] == branch.begun_at])
                check_same(branch, whole)
        calm = ("--at", "5", "--set", "disturbances=[]")
        with branched(whole.path, *calm, out="calm") as branch:
            assert branch.origin.changed == {"disturbances.0.type": ("actuation", "none")}
            np.testing.assert_array_equal(branch.moving_pose[:, 2], whole.moving_pose[500:, 2])
            assert not len(branch.commands[branch.commands["step"] > 510])
            assert (branch.pose[-1] != whole.pose[-1]).all()
    refused = said("branch", "whole", "--at", "5", "--set", "movers.0.speed=0.1")
    assert (refused.code, "movers.0.speed is 0.5" in refused.err) == (2, True)


def test_states_are_kept_and_change_no_digest() -> None:
    """What they are for is time alone: without them a run is simulated again from its start."""
    path = made("ten_robots", "--set", "time.duration=40")
    with Record.load(path) as kept, physim.simulate(kept.world, path="plain.h5") as plain:
        assert kept.states["step"].tolist() == [1666, 3332]
        assert not len(plain.states)
        assert kept.digest() == plain.digest()
        assert plain.path.stat().st_size < path.stat().st_size < 1.05 * plain.path.stat().st_size
        with (
            branched(path, "--at", "39.5", out="a") as a,
            branched(plain.path, "--at", "39.5", out="b") as b,
        ):
            check_same(a, kept)
            assert a.digest() == b.digest()


def test_what_is_changed_is_changed_from_that_step_on_only() -> None:
    path = made("three_robots", "--set", "time.duration=3")
    change = ("--set", "robots.1.controller.type=path_following", "--set", "controller.horizon=6")
    with Record.load(path) as whole, branched(path, "--at", "1.5", *change) as branch:
        assert branch.begun_at == 150
        np.testing.assert_array_equal(branch.pose[0], whole.pose[150])
        assert (branch.pose[1:] != whole.pose[151:]).any()
        assert branch.world.controller.settings["horizon"] == 6
        assert branch.origin.digest == whole.digest()
        assert branch.origin.changed == {
            "robots.1.controller.type": ("none", "path_following"),
            "controller.horizon": ("4.5", "6"),
        }
        words = "from 1.5 s on; changed: controller.horizon from 4.5 to 6, robots.1.controller.type"
        told = re.escape(f"branch of record {whole.digest()[:12]} {words}")
    for command in (("summary", "branch"), ("validate", "branch")):
        done = said(*command)
        assert re.search(told, " ".join(done.out.split())), done.out
    assert "the same run, bit for bit" in " ".join(done.out.split())
    tree = json.loads(Path("branch/summary.json").read_text())
    assert (tree["branch_of"]["time_s"], len(tree["branch_of"]["changed"])) == (1.5, 2)
    # a branch of a branch knows where it comes from, too
    with Record.load("branch") as before, branched(before.path, "--at", "2", out="again") as after:
        assert after.origin.digest == before.digest()
        check_same(after, before)


def test_film_and_page_show_both_and_where_they_part() -> None:
    path = made("three_robots", "--set", "time.duration=3")
    done = said("branch", str(path), "--at", "2", "--controller", "path_following", "-o", "branch")
    parted = re.search(r"part: from (\S+) s on \((r\d) first\), up to (\S+) m apart", done.out)
    assert parted, done.out
    for name in ("record.h5", "summary.json", "video.mp4", "both.mp4", "both.html"):
        assert Path("branch", name).stat().st_size > 1000
    page = Path("branch/both.html").read_text()
    told = "original, and branch from 2 s on: controller path_following instead of mode_switching"
    assert told in page
    assert f"parts from {parted[1]} s on ({parted[2]} first)" in page
    assert '["original", "branch at 2 s"]' in page
    with Record.load(path) as whole, Record.load("branch") as branch, Record.load(path) as twin:
        assert 2.0 < float(parted[1]) < 2.2
        last = np.hypot(*(branch.pose[-1] - whole.pose[-1])[:, :2].T).max()
        assert float(parted[3]) == pytest.approx(last, abs=0.006)
        beside, other = (
            physim.video.frame_at(whole, 2.9, beside=one).astype(int) for one in (branch, twin)
        )
        alike = physim.video.frame_at(twin, 2.9, beside=whole).astype(int)
        assert (other == alike).all()
        assert (beside[:62] != other[:62]).any()  # the titles


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--at", "2.5"), "--at 2.5: is outside the run, which goes from 0 to 2 s"),
        (("--at", "1.234"), "--at 1.234: is between two steps of 0.01 s; nearest: 1.23"),
        (("--at", "2"), "--at 2: nothing is left of the run from there on"),
        (("--at", "-1"), "--at"),
        ((), "--at"),
        (("--at", "1", "--set", "physics.friction=0.9"), "physics.friction is"),
        (("--at", "1", "--set", "robots.0.limits.v=3"), "robots.0.limits.v is"),
        (("--at", "1", "--set", "seed=4"), "seed is"),
        (("--at", "1", "--set", "time.duration=0.5"), "nothing is left"),
        (("--at", "1", "--set", "controler.horizon=3"), "controller"),
        (("--at", "1", "--controller", "path_folowing"), "path_following"),
        (("--at", "1", "--original", "constant"), "--original constant: the controller of"),
        (("--at", "1", "-o", "whole"), "is an input"),
        (("--at", "1", "-o", "full"), "--force"),
    ],
)
def test_bad_input_is_one_line(options: tuple[str, ...], told: str) -> None:
    record = made(*TOUCHING)
    Path("full").mkdir()
    Path("full/summary.json").touch()
    done = said("branch", str(record), *options)
    assert (done.code, done.out) == (2, "")
    assert told in done.err
    assert len(done.err.strip().splitlines()) == 1
    assert record.exists()
    assert not Path("runs").exists()


def test_a_branch_may_last_longer_than_its_original() -> None:
    record = made(*TOUCHING)
    with branched(record, "--at", "2", "--set", "time.duration=3") as branch:
        assert (branch.begun, branch.steps_run) == (2.0, 300)


def test_a_class_of_one_s_own_runs_where_it_is_named_alone(monkeypatch, tmp_path) -> None:
    Path("drives.py").write_text(DRIVES)
    monkeypatch.syspath_prepend(str(tmp_path))
    path = made("straight", "--set", "time.duration=3", "--controller", "drives:Counts")
    refused = said("branch", str(path), "--at", "1.5", "--controller", "drives:Stands")
    assert (refused.code, "give --original drives:Counts" in refused.err) == (2, True)
    with Record.load(path) as whole:
        for k, option in enumerate(("--controller", "--original")):
            with branched(path, "--at", "1.5", option, "drives:Counts", out=f"b{k}") as branch:
                check_same(branch, whole)
    both = ("--original", "drives:Counts", "--controller", "drives:Stands")
    with branched(path, "--at", "1.5", *both, out="stands") as branch:
        assert branch.setup.controller.name == "drives:Stands"
        assert (branch.pose[-1] == branch.pose[-2]).all()


def test_what_no_file_can_keep_is_simulated_from_the_start(monkeypatch, tmp_path) -> None:
    Path("drives.py").write_text(DRIVES)
    monkeypatch.syspath_prepend(str(tmp_path))
    path = made("straight", "--controller", "drives:Stands")
    with Record.load(path) as whole:
        assert not len(whole.states)
        with branched(path, "--at", "39", "--controller", "drives:Stands") as branch:
            check_same(branch, whole)


def test_a_controller_from_python_keeps_its_memory(monkeypatch, tmp_path) -> None:
    Path("drives.py").write_text(DRIVES)
    monkeypatch.syspath_prepend(str(tmp_path))
    import drives

    world = physim.load_world("straight", overrides=["time.duration=3"])
    with physim.simulate(world, controller=drives.Counts(), path="python.h5") as whole:
        named = ("--at", "1.5", "--controller", "drives:Counts")
        with branched(whole.path, *named) as branch:
            check_same(branch, whole)
        with branched(whole.path, *named, "--set", "expect=null", out="other") as branch:
            np.testing.assert_array_equal(branch.pose, whole.pose[150:])


def test_a_record_that_is_not_simulated_alike_is_refused() -> None:
    path = made("straight", "--set", "time.duration=2")
    shutil.copy(path, "forged.h5")
    with h5py.File("forged.h5", "r+") as file:
        file["/steps/pose"][100, 1, 0] += 1e-9
    done = said("branch", "forged.h5", "--at", "1")
    assert (done.code, "r2 is not where it was at 1 s" in done.err) == (2, True)
    with Record.load(path) as record:
        physim.simulate(record.world, save=SaveAt(every=30), path="coarse.h5").close()
    assert said("branch", "coarse.h5", "--at", "1", "-o", "out", *QUICK).code in (0, 1)
