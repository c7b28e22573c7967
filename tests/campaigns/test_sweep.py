"""Sweeps: each run counts once, whatever is killed, and rows are the same whoever did the runs."""

from __future__ import annotations

import multiprocessing
import os
import signal
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from physim.campaigns import Processes, run_one, spec_of, sweep
from physim.errors import PhysimError
from physim.record import Record
from physim.world.file import parse_world
from tests.campaigns.samples import WORLD, lines_on_disk, rows_in, specs, without_times
from tests.helpers import inside

make_grid, Tally = inside("physim.campaigns", "make_grid", "Tally")


def test_rows_are_those_of_the_runs(two: Processes, tmp_path: Path) -> None:
    tally = sweep(specs(6), tmp_path / "out", two)
    assert (tally.asked, tally.done, tally.before, tally.failed) == (6, 6, 0, 0)
    expected = [run_one(spec) for spec in specs(6)]
    assert without_times(rows_in(tmp_path / "out")) == without_times(expected)
    assert len({row.shortest_distance for row in expected}) == 6


def test_what_has_a_row_is_not_run_again(in_process: Processes, tmp_path: Path) -> None:
    sweep(specs(3), tmp_path / "out", in_process)
    tally = sweep(specs(5), tmp_path / "out", in_process)
    assert (tally.before, tally.done, tally.known) == (3, 2, 5)
    assert lines_on_disk(tmp_path / "out") == 5


@pytest.mark.deep
def test_failed_runs_are_rows_with_their_reasons(two: Processes, here: Path) -> None:
    axes = ["controller.how=fine,raise,exit,kill"]
    grid = make_grid(["small.yaml"], range(2), axes, ["awkward:Awkward"])
    tally = sweep(grid, here / "out", two)
    found = {(row.settings.partition("=")[2], row.seed): row for row in rows_in(here / "out")}
    assert (tally.known, tally.failed) == (8, 6)
    for seed in range(2):
        assert found["fine", seed].ended == "duration"
        assert found["raise", seed].ended == "error"
        assert "as it was told" in found["raise", seed].reason
        assert found["exit", seed].ended == found["kill", seed].ended == "killed"
        assert "exit code 7" in found["exit", seed].reason
        assert "SIGKILL" in found["kill", seed].reason
    again = sweep(grid, here / "out", two)
    assert again.done == 0
    retried = sweep(grid, here / "out", two, retry=True)
    assert (retried.before, retried.done, retried.failed) == (2, 6, 6)


@pytest.mark.deep
def test_runs_beyond_their_limit_are_rows(two: Processes, here: Path) -> None:
    axes = ["controller.how=hang,native"]
    grid = make_grid(["small.yaml"], None, axes, ["awkward:Awkward"], limit=2.0)
    sweep(grid, here / "out", two)
    found = rows_in(here / "out")
    assert [row.ended for row in found] == ["timeout", "timeout"]
    assert all("2 s" in row.reason for row in found)


def test_a_worker_killed_from_outside_is_a_row_and_nothing_else_is_lost(
    two: Processes, tmp_path: Path
) -> None:
    killed: list[int] = []

    def kill(tally: Tally) -> None:
        if tally.done and not killed:
            killed.append(multiprocessing.active_children()[0].pid or 0)
            os.kill(killed[0], signal.SIGKILL)

    tally = sweep(specs(12), tmp_path / "out", two, progress=kill)
    rows = rows_in(tmp_path / "out")
    assert killed
    assert [row.seed for row in rows] == list(range(12))
    assert tally.failed == sum(row.ended == "killed" for row in rows) <= 1
    fine = [row for row in rows if not row.failed]
    expected = [run_one(spec) for spec in specs(12)]
    assert without_times(fine) == without_times(expected[row.seed] for row in fine)


def test_a_stopped_sweep_keeps_what_was_finished_and_goes_on(
    in_process: Processes, tmp_path: Path
) -> None:
    seen: list[int] = []
    tally = sweep(
        specs(12), tmp_path / "out", in_process, stop=lambda: len(seen) > 0,
        progress=lambda now: seen.append(now.done) if now.done >= 5 else None,
    )  # fmt: skip
    assert tally.interrupted
    kept = len(rows_in(tmp_path / "out"))
    assert 5 <= kept == tally.done < 12
    assert (tmp_path / "out/results.csv").exists()
    rest = sweep(specs(12), tmp_path / "out", Processes(2))
    assert (rest.before, rest.done) == (kept, 12 - kept)
    assert lines_on_disk(tmp_path / "out") == 12


def test_it_is_decided_in_the_order_of_seeds(in_process: Processes, tmp_path: Path) -> None:
    asked: list[object] = []

    def decided(came: object) -> bool:
        asked.append(came)
        return len(asked) == 4

    tally = sweep(specs(30), tmp_path / "out", in_process, decided=decided)
    assert asked == [run_one(spec).came for spec in specs(4)]
    assert not tally.interrupted
    assert {0, 1, 2, 3} <= {row.seed for row in rows_in(tmp_path / "out")}
    assert tally.done < 30


def test_records_are_kept_as_they_would_be_made_again(
    in_process: Processes, tmp_path: Path
) -> None:
    touching = WORLD.replace("pose: [3.0, -1.0, random]", "pose: [3.0, 1.0, random]").replace(
        "duration: 1.0", "duration: 4.0"
    )
    wanted = specs(6, touching)
    sweep(wanted, tmp_path / "failed", in_process, keep="failed")
    rows = rows_in(tmp_path / "failed")
    free = [row for row in rows if row.contact_free]
    assert {bool(row.record) for row in free} <= {False}
    sweep(wanted, tmp_path / "all", in_process, keep="all")
    for row, spec in zip(rows_in(tmp_path / "all"), wanted, strict=True):
        assert row.record == f"records/{spec.key}.h5"
        with Record.load(tmp_path / "all" / row.record) as record:
            assert record.digest() == row.digest
            assert record.seed == row.seed
    kept = {file.stem for file in (tmp_path / "failed/records").iterdir()}
    assert kept == {row.run for row in rows if not row.contact_free}


def test_the_folder_of_another_campaign_is_refused(in_process: Processes, tmp_path: Path) -> None:
    out = tmp_path / "out"
    sweep(specs(1), out, in_process)
    with pytest.raises(PhysimError, match="the world was changed"):
        sweep(specs(1, WORLD.replace("1.8", "1.7")), out, in_process)
    with pytest.raises(PhysimError, match="another campaign"):
        sweep(specs(1, WORLD.replace("name: small", "name: other")), out, in_process)
    (tmp_path / "full").mkdir()
    (tmp_path / "full/thesis.tex").write_text("")
    with pytest.raises(PhysimError, match="not empty"):
        sweep(specs(1), tmp_path / "full", in_process)
    (tmp_path / "file").write_text("")
    with pytest.raises(PhysimError, match="is a file"):
        sweep(specs(1), tmp_path / "file", in_process)
    assert lines_on_disk(out) == 1


def test_worlds_that_cannot_be_told_apart_are_refused_before_a_run(
    in_process: Processes, tmp_path: Path
) -> None:
    """Their rows would be in one cell, which no reader takes."""
    world = parse_world(WORLD)
    gains = [world.changed(arrival={"tolerance": far}) for far in (0.1, 0.2)]
    asked = [[spec_of(one, 0) for one in gains], [spec_of(world, 0, name=name) for name in "ab"]]
    for some, told in zip(asked, ("are called", "the same world"), strict=True):
        with pytest.raises(PhysimError, match=told):
            sweep(some, tmp_path / "campaign", in_process)
        assert not (tmp_path / "campaign").exists()
    named = (spec_of(one, 0, settings=f"far={k}") for k, one in enumerate(gains))
    assert sweep(named, tmp_path / "campaign", in_process).done == 2


def test_one_run_asked_for_twice_is_done_once(in_process: Processes, tmp_path: Path) -> None:
    (run,) = specs(1)
    work = sweep([run, run, replace(run, limit=float("inf"))], tmp_path / "campaign", in_process)
    assert (work.done, work.failed) == (1, 0)
    endless = replace(run, seed=1, limit=float("inf"))
    work = sweep([run, endless], tmp_path / "campaign", in_process)
    assert (work.done, work.failed) == (1, 0)


@pytest.mark.parametrize(("given", "told"), [
    ({"specs": 5}, "list of what spec_of"), ({"specs": [parse_world(WORLD)]}, "spec_of"),
    ({"executor": None}, "executor = None"), ({"keep": "yes"}, "allowed: none, failed, all"),
])  # fmt: skip
def test_what_is_no_sweep_is_refused_before_a_run(
    in_process: Processes, tmp_path: Path, given: dict[str, Any], told: str
) -> None:
    asked = {"specs": specs(1), "folder": tmp_path / "campaign", "executor": in_process, **given}
    with pytest.raises((TypeError, ValueError), match=told):
        sweep(**asked)
    assert not (tmp_path / "campaign").exists()


@pytest.mark.parametrize("workers", [0, -1, None, "2", 1.5, True])
def test_no_processes_would_wait_for_ever(workers: Any) -> None:
    with pytest.raises(ValueError, match="workers ="):
        Processes(workers)
