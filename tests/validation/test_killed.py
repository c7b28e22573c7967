"""Runs that were killed: judged as far as they were recorded, whenever it was."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from physim import simulate
from physim.errors import RecordError
from physim.record import Record, RecordWriter
from physim.world import World
from physim.world.file import load_world
from tests.helpers import inside
from tests.record.test_crash_safe import Journal

compare_runs, run_again = inside("physim.analysis.validation", "compare_runs", "run_again")
simulation_again = inside("physim.analysis.validation", "simulation_again")
shipped_folder = inside("physim.world.file", "shipped_folder")

DURATION = 1.0
"""[s] of the runs"""


def three_robots(every: int) -> World:
    world = load_world(shipped_folder() / "three_robots.yaml")
    time = world.time.model_copy(update={"duration": DURATION, "record_every": every})
    return world.changed(time=time)


@pytest.mark.parametrize("every", [1, 7])
def test_a_run_killed_between_any_two_writes_is_not_said_to_disagree(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, every: int
) -> None:
    """Extremes and arrivals go to the disk before the index, one after the other."""
    defaults = {**(RecordWriter.__init__.__kwdefaults__ or {}), "flush_every_s": 0.0}
    with monkeypatch.context() as patched:
        patched.setattr(RecordWriter.__init__, "__kwdefaults__", defaults)
        journal = Journal(patched)
        simulate(three_robots(every), seed=3, path=tmp_path / "r.h5")
    again: dict[tuple[str, int, bool], Record] = {}
    judged = ahead = 0
    for number, (_, image) in enumerate(journal.images()):
        path = tmp_path / f"{number}.h5"
        path.write_bytes(image)
        with Record.load(path) as record:
            if not record.samples:
                continue
            last = record.noted_until
            has_decided = any(
                (rows["step"] == last).any() for rows in (record.updates, record.commands)
            )
            key = (record.ended, last, has_decided)
            if key not in again:
                again[key] = run_again(record, simulation_again(record))
            assert compare_runs(record, again[key]).difference is None, number
            judged += 1
            ahead += last > record.steps_run
    assert judged > 20
    assert ahead > 0, "no kill between the extremes and the index"


def test_extremes_of_a_killed_run_are_not_those_of_any_moment(tmp_path: Path) -> None:
    """They stood at the last sample or later: not before it, and not at another distance."""
    path = tmp_path / "r.h5"
    simulate(three_robots(1), seed=3, path=path)
    for column, value, when in (("clearance", 0.9, 20), ("clearance", 2.0, 100)):
        with h5py.File(path, "r+") as file:
            file.attrs.modify("ended", np.array(b"running", dtype="S16"))
            rows = file["/extremes"][:]
            rows[column][1] = value
            rows["clearance_step"][1] = when
            file["/extremes"][...] = rows
        with Record.load(path) as record:
            again = run_again(record, simulation_again(record))
            found = compare_runs(record, again).difference
        assert found is not None
        assert found.table == "/extremes"


@pytest.mark.parametrize("every", [1, 7, 60])
def test_a_run_without_its_last_sample_is_truncated(tmp_path: Path, every: int) -> None:
    """Figures at its end would be those of a moment before."""
    path = tmp_path / "r.h5"
    simulate(three_robots(every), seed=3, path=path)
    with h5py.File(path, "r+") as file:
        for name in ("pose", "clearance", "boundary_clearance", "step"):
            dataset = file[f"/steps/{name}"]
            dataset.resize(len(dataset) - 1, axis=0)
    with pytest.raises(RecordError, match="truncated"):
        Record.load(path)


def test_an_extreme_of_a_killed_run_is_the_least_of_all_before_it(tmp_path: Path) -> None:
    """True at its step, exceeded before the last sample: it stood at no moment after that."""
    fine, path = simulate(three_robots(1), seed=3), tmp_path / "r.h5"
    simulate(three_robots(60), seed=3, path=path)
    distance = fine.read("/steps/boundary_clearance")
    with h5py.File(path, "r+") as file:
        file.attrs.modify("ended", np.array(b"running", dtype="S16"))
        for name in ("pose", "clearance", "boundary_clearance", "step"):
            file[f"/steps/{name}"].resize(2, axis=0)  # those of steps 0 and 60
        rows = file["/extremes"][:]
        robot = int(np.argmax(rows["boundary_step"]))
        assert rows["boundary_step"][robot] > 60, "nearer still after the last sample"
        stood = int(np.argmin(distance[:61, robot]))
        for step, is_true in ((stood, True), (20, False)):
            assert (step == stood) == is_true
            rows["boundary_clearance"][robot], rows["boundary_step"][robot] = (
                distance[step, robot], step,
            )  # fmt: skip
            file["/extremes"][...] = rows
            file.flush()
            copy = tmp_path / f"{step}.h5"
            copy.write_bytes(path.read_bytes())
            with Record.load(copy) as record:
                again = run_again(record, simulation_again(record))
                assert (compare_runs(record, again).difference is None) == is_true, step
