"""Simulated again: records whose code is at hand, coarse ones, and runs that were cut or killed."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import h5py
import numpy as np
import pytest

import physim
from tests.analysis.forgeries.parts import Ramp
from tests.analysis.forgeries.runs import LANE
from tests.analysis.forgeries.tools import attribute, cells, column, together
from tests.analysis.validation import runs
from tests.analysis.validation.runs import states
from tests.helpers import Said, inside, said

rerun = inside("physim.analysis.validation", "rerun")

CARELESS = f"{runs.__name__}:Careless"
Change = Callable[[h5py.File], None]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Two coarse records, without a contact and with many, and a fine one."""
    folder, found = tmp_path_factory.mktemp("again"), {}
    for name, *changes in (
        ("free", "time.record_every=7"),
        (
            "touching",
            "controller={type: path_following}",
            "time.duration=12",
            "time.record_every=7",
        ),
        ("fine",),
    ):
        found[name] = folder / f"{name}.h5"
        physim.simulate(physim.parse_world(LANE, overrides=changes), path=found[name]).close()
    return found


def forged(record: Path, change: Change) -> Said:
    """What validation says of a changed copy."""
    path = record.with_name("forged.h5")
    shutil.copy(record, path)
    with h5py.File(path, "r+") as file:
        change(file)
    return said("validate", str(path))


def of_other_versions(file: h5py.File) -> None:
    versions = json.loads(file.attrs["versions"])
    file.attrs["versions"] = json.dumps({**versions, "numpy": "0.0.1"})


def claimed_contact(file: h5py.File) -> None:
    """From which on nothing would be compared; it has ended, so that no contact is counted."""
    of_other_versions(file)
    row = file["contacts"].fillvalue.reshape(1)
    row["step"], row["b"], row["nx"], row["phase"] = 1, 1, 1.0, 2
    file["contacts"].resize((1,))
    file["contacts"][...] = row


def no_contacts(file: h5py.File) -> None:
    of_other_versions(file)
    file["contacts"].resize((0,))


def better(distance: str) -> Change:
    return together(of_other_versions, column("/extremes", distance, lambda d: d + 1.0))


def killed(change: Change = lambda file: None) -> Change:
    """Of the same versions, and marked as a run that was killed."""

    def both(file: h5py.File) -> None:
        versions = file.attrs["versions"]
        change(file)
        file.attrs["versions"] = versions
        attribute("ended", "running")(file)

    return both


def worse(file: h5py.File) -> None:
    """A distance that is smaller than any, at a step."""
    for name, value in (("clearance", -0.5), ("clearance_step", 20)):
        column("/extremes", name, value, 0)(file)


def one_more(table: str, **values: float) -> Change:
    """A row at the end of the run."""

    def change(file: h5py.File) -> None:
        rows = file[table]
        row = rows[-1:] if len(rows) else rows.fillvalue.reshape(1)
        row["step"] = file.attrs["steps_run"]
        for name, value in values.items():
            row[name] = value
        rows.resize(len(rows) + 1, axis=0)
        rows[-1:] = row

    return change


deep = pytest.mark.deep
OTHER = ("in the record", "simulated again")
EARLIER = together(of_other_versions, column("/extremes", "clearance_step", 500, 0))
FARTHER = cells("/extremes_farthest", "farthest", 5.0)
FORGED = [
    ("free", claimed_contact, ("/contacts, row 0", "there in the record", "not simulated again")),
    ("free", better("clearance"), ("smallest distance", "in the record", "by the shapes")),
    ("free", killed(better("boundary_clearance")), ("smallest distance", "by the shapes")),
    ("free", killed(cells("/robots/arrived", ..., 1)), ("/robots/arrived, row 0",)),
    ("free", one_more("updates", collision_time=1e-4), OTHER),
    ("touching", no_contacts, ("/contacts", "not there in the record", "there simulated again")),
    ("fine", killed(better("clearance")), ("smallest distance",)),
    ("fine", killed(attribute("rejected_contacts", np.int64(7))),
     ("rejected_contacts", "7 in the record")),
    ("free", EARLIER, ("smallest distance", "at this sample", "the shapes are")),
    ("free", cells("/considered_others", -1, lambda i: 3 - i), ("/considered_others, row", *OTHER)),
    ("free", killed(FARTHER), ("largest distance", "5 m")),
    ("free", killed(worse), ("-0.5",)),
    ("fine", killed(worse), ("-0.5",)),
    ("fine", attribute("ended", "error"), ("attribute ended", "error in the record", "finished")),
]  # fmt: skip
FAST = 8


@pytest.mark.parametrize(
    ("name", "change", "words"),
    [pytest.param(*row, marks=[deep] * (k >= FAST)) for k, row in enumerate(FORGED)],
)
def test_what_the_run_simulated_again_has_not_is_told(made, name, change, words) -> None:
    code, out, _ = forged(made[name], change)
    assert code == 3
    assert states(out, *words)


def test_true_records_agree_as_far_as_they_can_be_compared(made) -> None:
    """Of other versions: up to the first contact."""
    for name in made:
        found = forged(made[name], killed())
        assert found.code in (0, 1)
        assert "DISAGREEMENTS: none" in found.out
    for name, code, words in (("free", 0, "the same within"), ("touching", 1, "the first contact")):
        found = forged(made[name], of_other_versions)
        assert found.code == code
        assert states(found.out, "other versions", words, within=400)
        assert "DISAGREEMENTS: none" in found.out


@pytest.mark.parametrize("every", [1, pytest.param(7, marks=deep)])
def test_what_a_killed_run_had_noted_after_its_last_sample_is_simulated_too(
    tmp_path: Path, every: int
) -> None:
    """Two come nearer to each other all the time; samples and tables end 5 steps early."""
    path = tmp_path / "cut.h5"
    changes = ["controller={type: path_following}", f"time.record_every={every}"]
    steps = iter(range(103))
    physim.simulate(
        physim.parse_world(LANE, overrides=changes), path=path, stop=lambda: next(steps) == 102
    ).close()
    with h5py.File(path, "r+") as file:
        attribute("ended", "running")(file)
        kept = int(np.count_nonzero(file["steps/step"][()] <= 98))
        for dataset in file["steps"].values():
            dataset.resize(kept, axis=0)
    with physim.Record.load(path) as record:
        assert (record.steps_run, record.noted_until) == (98, 103)
    code, out, _ = said("validate", str(path))
    assert (code, "DISAGREEMENTS: none" in out) == (1, True)  # not finished
    assert states(out, "Simulated again", "bit for bit")


@pytest.fixture
def careless(tmp_path: Path) -> Iterator[Callable[..., Path]]:
    """Makes a record whose world names the class that it was run with."""

    def make(name: str, stop: int | None = None, **changes: object) -> Path:
        overrides = [f"{key}={value}" for key, value in changes.items()]
        world = physim.parse_world(runs.LANE, overrides=overrides, controller=CARELESS)
        steps = iter(range(1, 10**6))
        physim.simulate(
            world, controller=CARELESS, path=tmp_path / name, overwrite=True,
            stop=lambda: next(steps) == stop,
        ).close()  # fmt: skip
        return tmp_path / name

    return make


def test_simulated_again_it_is_the_same_run_or_told_by_its_first_difference(careless) -> None:
    path = careless("again.h5", **{"robots.0.mass": 90.0})
    told = said("validate", str(path), "--controller", CARELESS)
    with physim.Record.load(path) as record:
        assert states(told.out, record.digest(), "same run", "bit for bit")
    assert told.code == 1
    with h5py.File(path, "r+") as file:
        file.attrs["world"] = file.attrs["world"].replace("mass: 90.0", "mass: 900.0")
    assert said("validate", str(path)).code == 1  # no check of the record alone sees a mass
    told = said("validate", str(path), "--controller", CARELESS)
    assert told.code == 3
    assert states(told.out, "/contacts, row 0", "another run", "impulse")


def test_those_in_a_hurry_leave_it_out(made) -> None:
    found = forged(made["fine"], lambda file: None)
    assert states(found.out, "Simulated again", "bit for bit")
    hurried = said("validate", str(made["fine"]), "--no-rerun")
    assert (hurried.code, "Simulated again" in hurried.out) == (0, False)
    assert states(hurried.out, "NOT CHECKED", "simulated again", "not asked for", within=200)
    code, out, err = said("validate", str(made["free"]), "--no-rerun")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert states(err, "one step in 7", "physim validate simulates such a run again")


def test_code_is_needed_for_what_is_simulated_again_alone(careless) -> None:
    fine, coarse = careless("fine.h5"), careless("coarse.h5", **{"time.record_every": 5})
    told = said("validate", str(fine)).out
    assert states(told, "simulated again", f"--controller {CARELESS}", within=400)
    code, out, err = said("validate", str(coarse))
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert f"--controller {CARELESS}" in err
    assert said("validate", str(coarse), "--controller", CARELESS).code == 1
    other = said("validate", str(coarse), "--controller", "path_following")
    assert other.code == 3
    assert states(other.out, "/modes/name", "another run", "0 rows in the record", "2")


def test_parts_from_python_cannot_be_given_again_here(tmp_path: Path) -> None:
    path = str(tmp_path / "ramp.h5")
    physim.simulate(physim.parse_world(runs.LANE), filters=[Ramp()], path=path).close()
    told = said("validate", path).out
    assert states(told, f"{Ramp.__module__}:Ramp", "filter", "Python", within=400)
    with physim.Record.load(path) as record:
        assert rerun(record, filters=[Ramp()]).same_digest
        other = rerun(record, filters=[Ramp(0.01)]).difference
        assert (other.step, other.what.startswith("/updates, row 0, ")) == (0, True)


@pytest.mark.parametrize(
    ("ended", "words"),
    [
        ("interrupted", ("1.00 s of at most 3 s", "step 0.01 s", "INTERRUPTED")),
        ("running", ("1.00 s of at most 3 s", "step 0.01 s", "KILLED")),
    ],
)
def test_a_coarse_record_that_breaks_off_is_judged_up_to_there(careless, ended, words):
    path = careless("stopped.h5", 100, **{"time.record_every": 7})
    with h5py.File(path, "r+") as file:
        attribute("ended", ended)(file)
    target = path.with_suffix(".json")
    told = said("validate", str(path), "--controller", CARELESS, "--json", str(target))
    assert told.code == 0
    assert states(told.out, *words)
    written = json.loads(target.read_text(encoding="utf-8"))["run"]
    assert (written["ended"], written["samples"]) == (ended, 101)


def test_what_was_sensed_is_held_against_the_run_simulated_again(tmp_path: Path) -> None:
    path = tmp_path / "sensed.h5"
    narrow = "sensing.stages=[{type: field_of_view, angle: 3.0}]"
    world = physim.parse_world(LANE, overrides=["time.duration=1", "expect=null", narrow])
    with physim.simulate(world, path=path, save=physim.SaveAt(sensed=True)) as record:
        unseen = record.sensed[np.isnan(record.sensed["x"])]
        assert len(unseen)  # formation neighbours beside it
        assert np.isfinite(unseen["reference_station"]).all()
    assert said("validate", str(path)).code == 0

    def shift(file: h5py.File) -> None:
        rows = file["/sensed"][()]
        rows["age"][3] += 0.01
        file["/sensed"][...] = rows

    done = forged(path, shift)
    assert done.code == 3
    assert "/sensed, row 3, age is 0.01 in the record" in " ".join(done.out.split())
