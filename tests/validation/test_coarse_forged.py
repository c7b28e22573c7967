"""Forged coarse records: what the run simulated again has, whatever versions they name."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

import physim
from tests.forgeries.runs import LANE
from tests.validation.reports import states
from tests.validation.test_command import run


def made(folder: Path, controller: str, duration: float) -> Path:
    path = folder / f"{controller}.h5"
    overrides = [f"controller={{type: {controller}}}", f"time.duration={duration}"]
    world = physim.parse_world(LANE, overrides=[*overrides, "time.record_every=7"])
    physim.simulate(world, path=path).close()
    return path


@pytest.fixture(scope="module")
def free(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made(tmp_path_factory.mktemp("coarse"), "mode_switching", 30.0)


@pytest.fixture(scope="module")
def touching(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made(tmp_path_factory.mktemp("coarse"), "path_following", 12.0)


def of_other_versions(file: h5py.File) -> None:
    versions = json.loads(file.attrs["versions"])
    file.attrs["versions"] = json.dumps({**versions, "numpy": "0.0.1"})


def claimed_contact(file: h5py.File) -> None:
    """From which on nothing would be compared; it has ended, so that no contact is counted."""
    of_other_versions(file)
    with_contact(file, step=1, b=1)


def contact_with_a_wall(file: h5py.File) -> None:
    of_other_versions(file)
    with_contact(file, step=1, b=int(file["bodies/id"][-1]))


def with_contact(file: h5py.File, step: int, b: int) -> None:
    rows = file["contacts"]
    row = rows[:1] if len(rows) else rows.fillvalue.reshape(1)
    row["step"], row["a"], row["b"], row["nx"], row["phase"] = step, 0, b, 1.0, 2
    rows.resize((1,))
    rows[...] = row


def no_contacts(file: h5py.File) -> None:
    of_other_versions(file)
    file["contacts"].resize((0,))


def better(column: str) -> Callable[[h5py.File], None]:
    def edit(file: h5py.File) -> None:
        of_other_versions(file)
        rows = file["extremes"][()]
        rows[column] += 1.0
        file["extremes"][...] = rows

    return edit


def at_another_step(file: h5py.File) -> None:
    of_other_versions(file)
    rows = file["extremes"][()]
    rows["clearance_step"][0] = 500
    file["extremes"][...] = rows


def by_another_wall(file: h5py.File) -> None:
    of_other_versions(file)
    rows = file["extremes"][()]
    rows["boundary_other"][0] = 7 - rows["boundary_other"][0]
    file["extremes"][...] = rows


def farthest_of_others(file: h5py.File) -> None:
    of_other_versions(file)
    row = file["extremes_farthest"][()]
    row["a"], row["b"] = 0, 1 if row["b"] == 2 else 2
    file["extremes_farthest"][()] = row


def other_robots(file: h5py.File) -> None:
    file["considered_others"][-1] = 3 - file["considered_others"][-1]


def killed(edit: Callable[[h5py.File], None]) -> Callable[[h5py.File], None]:
    """Of the same versions, and marked as a run that was killed."""

    def both(file: h5py.File) -> None:
        versions = file.attrs["versions"]
        edit(file)
        file.attrs["versions"] = versions
        file.attrs.modify("ended", np.bytes_("running"))

    return both


def all_arrived(file: h5py.File) -> None:
    file["robots/arrived"][...] = 1


def nothing(file: h5py.File) -> None:
    pass


def forged(record: Path, edit: Callable[[h5py.File], None]) -> Path:
    path = record.with_name("forged.h5")
    shutil.copy(record, path)
    with h5py.File(path, "r+") as file:
        edit(file)
    return path


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (claimed_contact, ("/contacts, row 0", "there in the record", "not simulated again")),
        (contact_with_a_wall, ("/contacts, row 0", "there in the record", "not simulated again")),
        (better("clearance"), ("/extremes, row 0, clearance",)),
        (killed(better("clearance")), ("/extremes, row 0, clearance",)),
        (killed(better("boundary_clearance")), ("/extremes, row 0, boundary_clearance",)),
        (killed(all_arrived), ("/robots/arrived, row 0",)),
        (at_another_step, ("5.0000 s", "/extremes, row 0, clearance", "of these bodies")),
        (by_another_wall, ("/extremes, row 0, boundary_clearance", "of these bodies")),
        (farthest_of_others, ("/extremes_farthest, row 0, farthest", "of these bodies")),
        (other_robots, ("/considered_others, row", "in the record", "simulated again")),
    ],
)
def test_a_contact_free_run(free, capsys, edit, said) -> None:
    assert run(capsys, free)[0] == 0
    code, out, _ = run(capsys, forged(free, edit))
    assert code == 3
    assert states(out, *said)


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (no_contacts, ("/contacts", "not there in the record", "there simulated again")),
        (better("boundary_clearance"), ("/extremes, row 0, boundary_clearance",)),
    ],
)
def test_a_run_with_contacts(touching, capsys, edit, said) -> None:
    assert run(capsys, touching)[0] == 1
    code, out, _ = run(capsys, forged(touching, edit))
    assert code == 3
    assert states(out, *said)


def test_a_killed_run_whose_distances_are_not_those_of_its_samples(tmp_path, capsys) -> None:
    """A killed run may have noted steps after its last sample; these are simulated, too."""
    path = tmp_path / "lane.h5"
    physim.simulate(physim.parse_world(LANE), path=path).close()
    assert run(capsys, forged(path, killed(nothing)))[0] == 0
    for column in ("clearance", "boundary_clearance"):
        code, out, _ = run(capsys, forged(path, killed(better(column))))
        assert code == 3
        assert "smallest distance" in out


def worse(column: str, step: str, at: int) -> Callable[[h5py.File], None]:
    """A distance that is smaller than any, at a step."""

    def edit(file: h5py.File) -> None:
        rows = file["extremes"][()]
        rows[column][0], rows[step][0] = -0.5, at
        file["extremes"][...] = rows

    return edit


def test_a_run_with_contacts_by_other_versions_and_with_extremes_of_no_sample(
    touching, capsys
) -> None:
    def edit(file: h5py.File) -> None:
        of_other_versions(file)
        worse("clearance", "clearance_step", 20)(file)

    code, out, _ = run(capsys, forged(touching, edit))
    assert code == 3
    assert states(out, "/extremes, row 0, clearance", "-0.5")


def test_a_killed_run_with_extremes_of_no_sample(tmp_path, free, capsys) -> None:
    """Such a run would miss what its world expects."""
    path = tmp_path / "lane.h5"
    physim.simulate(physim.parse_world(LANE), path=path).close()
    for record in (path, free):
        for column, step in (
            ("clearance", "clearance_step"),
            ("boundary_clearance", "boundary_step"),
        ):
            code, out, _ = run(capsys, forged(record, killed(worse(column, step, 20))))
            assert code == 3
            assert "-0.5" in out
            for at in (10**6, 6000):
                code, out, _ = run(capsys, forged(record, killed(worse(column, step, at))))
                assert code == 3
                assert "-0.5" in out


def nearer_farthest(file: h5py.File) -> None:
    row = file["extremes_farthest"][()]
    row["farthest"] = 5.0
    file["extremes_farthest"][()] = row


def another_nearest(file: h5py.File) -> None:
    rows = file["extremes"][()]
    rows["clearance_other"][0] = 3 - rows["clearance_other"][0]
    file["extremes"][...] = rows


def a_decision_at_the_end(file: h5py.File) -> None:
    """It would be the shortest collision time of all."""
    rows = file["updates"]
    row = rows[-1:]
    row["step"], row["collision_time"] = file.attrs["steps_run"], 1e-4
    rows.resize(len(rows) + 1, axis=0)
    rows[-1:] = row


def a_command_at_the_end(file: h5py.File) -> None:
    rows = file["commands"]
    row = np.zeros(1, rows.dtype)
    row["step"] = file.attrs["steps_run"]
    rows.resize(len(rows) + 1, axis=0)
    rows[-1:] = row


def broken_off(file: h5py.File) -> None:
    file.attrs.modify("ended", np.bytes_("error"))


def nobody_arrived(file: h5py.File) -> None:
    file["robots/arrived"][...] = -1


@pytest.mark.parametrize("edit", [a_decision_at_the_end, a_command_at_the_end, broken_off])
def test_rows_at_the_end_of_a_coarse_record(free, capsys, edit) -> None:
    code, out, _ = run(capsys, forged(free, edit))
    assert code == 3
    assert states(out, "in the record", "simulated again")


def test_a_whole_run_that_is_called_broken_off(tmp_path, capsys) -> None:
    path = tmp_path / "lane.h5"
    physim.simulate(physim.parse_world(LANE), path=path).close()
    code, out, _ = run(capsys, forged(path, broken_off))
    assert code == 3
    assert states(out, "attribute ended", "error in the record", "finished")


def counted(file: h5py.File) -> None:
    file.attrs.modify("rejected_contacts", np.int64(7))


def test_a_killed_run_has_counted_nothing(tmp_path, capsys) -> None:
    path = tmp_path / "lane.h5"
    physim.simulate(physim.parse_world(LANE), path=path).close()
    code, out, _ = run(capsys, forged(path, killed(counted)))
    assert code == 3
    assert states(out, "rejected_contacts", "7 in the record")


@pytest.mark.parametrize(
    "edit", [nearer_farthest, another_nearest, nobody_arrived, a_decision_at_the_end]
)
def test_a_killed_coarse_run_is_held_to_what_it_had_noted(free, capsys, edit) -> None:
    code, out, _ = run(capsys, forged(free, killed(edit)))
    assert code == 3
    assert states(out, "in the record", "simulated again")


def test_a_killed_run_whose_robots_arrived_before_they_were_there(tmp_path, capsys) -> None:
    path = tmp_path / "lane.h5"
    steps = iter(range(301))
    physim.simulate(physim.parse_world(LANE), path=path, stop=lambda: next(steps) == 300).close()
    for edit in (nothing, all_arrived):
        code, out, _ = run(capsys, forged(path, killed(edit)))
        assert (code == 3) is (edit is all_arrived)
    assert states(out, "/robots/arrived, row 0", "1 in the record", "-1 by the poses")


@pytest.mark.parametrize("every", [1, 7])
def test_what_a_killed_run_had_noted_after_its_last_sample_is_simulated_too(
    tmp_path, capsys, every
) -> None:
    """Two come nearer to each other all the time; samples and tables end 5 steps early."""
    path = tmp_path / "cut.h5"
    world = physim.parse_world(LANE, overrides=["controller={type: path_following}",
                                                f"time.record_every={every}"])  # fmt: skip
    steps = iter(range(103))
    physim.simulate(world, path=path, stop=lambda: next(steps) == 102).close()
    with h5py.File(path, "r+") as file:
        file.attrs.modify("ended", np.bytes_("running"))
        kept = int(np.count_nonzero(file["steps/step"][()] <= 98))
        for dataset in file["steps"].values():
            dataset.resize(kept, axis=0)
    with physim.Record.load(path) as record:
        assert (record.steps_run, record.noted_until) == (98, 103)
    code, out, _ = run(capsys, path)
    assert code == 0
    assert states(out, "Simulated again", "to the bit")


def test_true_records_of_other_versions_agree_up_to_the_first_contact(
    free, touching, capsys
) -> None:
    assert run(capsys, forged(free, killed(nothing)))[0] == 0
    for record, code, said in ((free, 0, "the same within"), (touching, 1, "the first contact")):
        found, out, _ = run(capsys, forged(record, of_other_versions))
        assert found == code
        assert states(out, "other versions", said, within=400)
        assert "DISAGREEMENTS: none" in out
