"""``physim validate``: exit codes, bad input, seeds, coarse records, JSON."""

from __future__ import annotations

import json
import signal

import h5py
import pytest

import physim
from physim.analysis.validation import validate
from physim.cli import main
from tests.cli.commands import started
from tests.forgeries.parts import Ramp
from tests.helpers import inside
from tests.validation.reports import states
from tests.validation.runs import APART, LANE, REAR_END, edited, lane

rerun, Rate = inside("physim.analysis.validation", "rerun", "Rate")

CARELESS = "tests.validation.runs:Careless"
IDLE = "tests.validation.runs:Idle"
ANY_HEADING = LANE.replace("[4.6, -1.0, 0.0]", "[4.6, -1.0, random]")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Records and worlds on disk."""
    where = tmp_path_factory.mktemp("validate")
    (where / "lane.yaml").write_text(LANE, encoding="utf-8")
    (where / "any.yaml").write_text(ANY_HEADING, encoding="utf-8")
    (where / "other.yaml").write_text(LANE.replace("width: 8.0", "width: 9.0"), encoding="utf-8")
    lane(REAR_END, where / "bad.h5").close()
    lane(APART, where / "good.h5").close()
    return where


def copy_of(folder, name, change):
    """Copy of a record with something in the file changed."""
    path = folder / name
    path.write_bytes((folder / "good.h5").read_bytes())
    with h5py.File(path, "r+") as file:
        change(file)
    return path


def run(capsys, *arguments):
    code = main(["validate", *map(str, arguments)])
    out, err = capsys.readouterr()
    return code, out, err


def test_record_with_and_without_contact(folder, capsys):
    code, out, _ = run(capsys, folder / "good.h5")
    assert (code, out.splitlines()[-1]) == (0, "verdict: contact-free")
    code, out, _ = run(capsys, folder / "bad.h5")
    assert code == 1
    assert out.splitlines()[-1].startswith("verdict: contacts: ")


def test_a_page_leads_to_the_moment_of_each_finding(folder, capsys):
    page = folder / "found.html"
    code, out, _ = run(capsys, folder / "bad.h5", "--page", page)
    text = page.read_text(encoding="utf-8")
    section = text[text.index('id="validation"') :]
    with physim.Record.load(folder / "bad.h5") as record:
        found = validate(record)
    assert code == found.code == 1
    assert out.splitlines()[-1].removeprefix("verdict: ") in section
    assert found.contacts
    for number, one in enumerate(found.contacts, 1):
        assert f'href="#t={one.time:.3f}&amp;contact={number}"' in section
    assert run(capsys, folder / "good.h5", "--page", page, "--quiet")[0] == 2
    assert page.read_text(encoding="utf-8") == text


def test_the_page_of_a_world_that_was_just_run(folder, capsys):
    page = folder / "run.html"
    assert run(capsys, folder / "lane.yaml", "--controller", CARELESS, "--page", page)[0] == 1
    assert 'id="validation"' in page.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("more", "said"),
    [(("--page", "x.pdf"), (".html",)), (("--page", "x.html", "--seeds", "1:3"), ("--page",)),
     (("--page", "no/x.html"), ("no/x.html",))],
)  # fmt: skip
def test_pages_that_cannot_be_written_are_refused(folder, capsys, more, said):
    code, out, err = run(capsys, folder / "any.yaml", *more)
    assert (code, out) == (2, "")
    assert states(err, *said)


def test_world_with_a_careless_controller(folder, capsys):
    code, out, _ = run(capsys, folder / "lane.yaml", "--controller", CARELESS)
    assert code == 1
    assert "Responsible is" not in out  # a rule of priority it does not have
    assert states(out, "at most 3 s", "step 0.01 s", "whole duration")
    assert CARELESS in out


def test_json(folder, capsys):
    target = folder / "found.json"
    code, _, _ = run(capsys, folder / "bad.h5", "--json", target, "--quiet")
    found = json.loads(target.read_text(encoding="utf-8"))
    assert found["exit_code"] == code == 1
    assert found["verdict"].startswith("contacts: ")
    first = found["contacts"][0]
    assert [found["run"]["bodies"][first[key]]["name"] for key in "ab"] == ["slow", "fast"]
    assert [side["responsible"] for side in first["sides"]] == [False, False]
    assert first["prediction"]["verdict"] == "same step"


@pytest.mark.parametrize("more", [(), ("--quiet",)])
def test_json_on_standard_output_stands_alone(folder, capsys, more):
    code, out, err = run(capsys, folder / "bad.h5", "--json", "-", *more)
    assert json.loads(out)["exit_code"] == code == 1
    assert err.splitlines()[-1].startswith("verdict: contacts: ")
    assert not (folder / "-").exists()


def test_coarse_record_is_simulated_again(folder, capsys):
    path = folder / "coarse.h5"
    lane(REAR_END, path, **{"time.record_every": 7}).close()
    # It drove as Careless does, which the world inside cannot name.
    code, out, _ = run(capsys, path, "--controller", CARELESS)
    assert code == 1
    assert states(out, "Simulated again", "to the bit", "3.00 s")
    code, out, err = run(capsys, path)
    assert (code, out) == (2, "")
    assert "--controller tests.validation.runs:Drivers" in err
    one_line(err)
    code, out, _ = run(capsys, path, "--controller", "path_following")
    assert code == 3
    assert states(out, "/modes/name", "another run", "0 rows in the record", "2")


def test_a_coarse_record_without_its_contacts(folder, capsys):
    with lane(REAR_END, **{"time.record_every": 7}) as record:
        edited(record, folder / "fewer.h5", lambda rows: rows[:-1]).close()
    code, out, _ = run(capsys, folder / "fewer.h5", "--controller", CARELESS)
    assert code == 3
    assert states(out, "/contacts, row ", "another run", "not there in the record")


def test_origin(folder, capsys):
    # Made by an object, so that the world inside is that of the file.
    assert run(capsys, folder / "good.h5", "--world", folder / "lane.yaml")[0] == 0
    code, _, err = run(capsys, folder / "good.h5", "--world", folder / "other.yaml")
    assert code == 2
    assert states(err, "corridor.width", "8.0 in the record", "9.0 in the world")
    one_line(err)


def test_simulated_again_it_is_the_same_run(folder, capsys):
    mine = from_a_class(folder, "again.h5")
    code, out, _ = run(capsys, mine, "--rerun", "--controller", CARELESS)
    with physim.Record.load(mine) as record:
        assert states(out, record.digest(), "same run", "to the bit")
    assert code == 1
    code, out, err = run(capsys, mine, "--rerun")
    assert (code, out) == (2, "")
    assert f"--controller {CARELESS}" in err
    one_line(err)


def test_another_run_is_told_by_its_first_difference(folder, capsys):
    path = from_a_class(folder, "other.h5", **{"robots.0.mass": 90.0})
    with h5py.File(path, "r+") as file:
        file.attrs["world"] = file.attrs["world"].replace("mass: 90.0", "mass: 900.0")
    assert run(capsys, path, "--quiet")[0] == 1  # no check of the record alone sees a mass
    code, out, _ = run(capsys, path, "--quiet", "--rerun", "--controller", CARELESS)
    assert code == 3
    assert states(out, "/contacts, row 0", "another run", "impulse")


def test_a_run_of_other_versions_is_held_up_to_its_first_contact(folder, capsys):
    path = from_a_class(folder, "older.h5")
    with h5py.File(path, "r+") as file:
        file.attrs["versions"] = json.dumps({"physim": "0.0.9"})
        rows = file["/contacts"][()]
        rows["impulse"] *= 2.0  # behind the first contact: not compared
        file["/contacts"][...] = rows
    code, out, _ = run(capsys, path, "--rerun", "--controller", CARELESS)
    assert code == 1
    assert states(out, "physim 0.0.9", "same within 1e-09", "first contact")
    with h5py.File(path, "r+") as file:
        file["/steps/pose"][...] += 1e-8
    assert run(capsys, path, "--rerun", "--controller", CARELESS)[0] == 3


def test_parts_from_python_cannot_be_given_again_here(folder, capsys):
    world = physim.load_world(folder / "lane.yaml")
    physim.simulate(world, filters=[Ramp()], path=folder / "ramp.h5").close()
    for more in (["--rerun"], ["--seeds", "1:3"]):
        code, out, err = run(capsys, folder / "ramp.h5", *more)
        assert (code, out) == (2, "")
        assert states(err, "tests.forgeries.parts:Ramp", "filter", "Python")
        one_line(err)
    with physim.Record.load(folder / "ramp.h5") as record:
        assert rerun(record, filters=[Ramp()]).same_digest
        other = rerun(record, filters=[Ramp(0.01)])
        assert other.difference is not None
        assert (other.difference.table, other.difference.step) == ("/updates", 0)


def test_intervals_are_rounded_outward():
    """Exactly it is 55.498 to 99.747 %."""
    assert "55.4% to 99.8%" in Rate(9, 10).words("finished")
    assert "69.1% to 100.0%" in Rate(10, 10).words("finished")


def test_robots_that_never_move_are_not_as_expected(folder, capsys):
    (folder / "any_expects.yaml").write_text(
        ANY_HEADING + "expect: {finished: true}\n", encoding="utf-8"
    )
    target = folder / "idle.json"
    code, out, _ = run(
        capsys, folder / "any_expects.yaml", "--seeds", "1:6", "--controller", IDLE, "--set",
        "time.duration=1.0", "--json", target,
    )  # fmt: skip
    assert code == 1
    assert states(out, "5 of 5", "contact-free", "100.0%", within=30)
    assert states(out, "0 of 5", "finished", "0.0%", "95 % Clopper-Pearson", "0.0% to 52.2%")
    assert states(out, "1, 2, 3, 4, 5", "not as expected", "finished", within=60)
    assert states(out, "verdict: contact-free", "not as expected", "finished", within=50)
    found = json.loads(target.read_text(encoding="utf-8"))
    assert (found["exit_code"], found["finished"], found["contact_free"]) == (1, 0, 5)
    assert [one["missed"] for one in found["seeds"]] == [["finished"]] * 5


def test_seeds(folder, capsys):
    target = folder / "seeds.json"
    code, out, _ = run(
        capsys, folder / "any.yaml", "--seeds", "1:4", "--json", target, "--set",
        "time.duration=1.0",
    )  # fmt: skip
    found = json.loads(target.read_text(encoding="utf-8"))
    assert code == found["exit_code"] == (0 if found["contact_free"] == 3 else 1)
    assert [one["seed"] for one in found["seeds"]] == [1, 2, 3]
    assert states(out, f"{found['contact_free']} of 3", "contact-free", "95 % Clopper-Pearson")


def test_every_seed_is_run(folder, capsys):
    """And each of them as it would be run alone."""
    target = folder / "every.json"
    changes = ["time.duration=0.5", "robots.1.pose=[6.2, -1.3, random]"]
    short = [word for change in changes for word in ("--set", change)]
    run(capsys, folder / "any.yaml", "--seeds", "4:7", "--json", target, "--force", *short)
    written = json.loads(target.read_text(encoding="utf-8"))["seeds"]
    world = physim.load_world(folder / "any.yaml", overrides=changes)
    alone = [validate(physim.simulate(world, seed=seed)).near_misses for seed in (4, 5, 6)]
    assert [one["nearest"] for one in written] == [near.distances[0].value for near in alone]
    assert len({one["nearest"] for one in written}) == 3


def test_seeds_of_a_world_without_anything_random(folder, capsys):
    code, out, _ = run(capsys, folder / "lane.yaml", "--controller", CARELESS, "--seeds", "1:9")
    assert code == 1
    assert states(out.splitlines()[0], "Nothing", "random")
    assert "Clopper" not in out


def one_line(err):
    assert not err.startswith("physim: ")
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda file: file.attrs.modify("version", "99.1"), ("version", "'99.1'")),
        (lambda file: file.__delitem__("contacts"), ("/contacts", "missing")),
        (lambda file: [file[f"steps/{key}"].resize(100, axis=0) for key in
                       ("step", "pose", "clearance", "boundary_clearance")], ("truncated",)),
    ],
)  # fmt: skip
def test_bad_records(folder, capsys, change, expected):
    code, out, err = run(capsys, copy_of(folder, "changed.h5", change))
    assert (code, out) == (2, "")
    assert states(err, *expected)
    one_line(err)


def test_file_that_breaks_off(folder, capsys):
    whole = (folder / "good.h5").read_bytes()
    (folder / "half.h5").write_bytes(whole[: len(whole) // 2])
    code, _, err = run(capsys, folder / "half.h5")
    assert code == 2
    assert "truncated" in err
    one_line(err)


@pytest.mark.parametrize(
    "arguments",
    [
        ["nothing.h5"],
        ["nothing_such"],
        ["good.h5", "--seed", "3"],
        ["good.h5", "--set", "seed=3"],
        ["lane.yaml", "--world", "other.yaml"],
        ["good.h5", "--json", "no/such/folder/x.json"],
    ],
)
def test_bad_arguments(folder, capsys, monkeypatch, arguments):
    monkeypatch.chdir(folder)
    code, _, err = run(capsys, *arguments)
    assert code == 2
    one_line(err)


def from_a_class(folder, name, **changes):
    """A record whose world names the class that it was run with, as the command line does."""
    overrides = [f"{key}={value}" for key, value in changes.items()]
    world = physim.load_world(folder / "lane.yaml", overrides=overrides, controller=CARELESS)
    physim.simulate(world, controller=CARELESS, path=folder / name, overwrite=True).close()
    return folder / name


def test_a_record_tells_its_world_without_the_code_of_its_controller(folder, tmp_path):
    path = tmp_path / "record.h5"
    path.write_bytes(from_a_class(folder, "mine.h5").read_bytes())
    with h5py.File(path, "r+") as file:
        text = file.attrs["world"].replace(CARELESS, "nowhere.to_be_found:Evil")
        file.attrs["world"] = text
    with physim.Record.load(path) as record:
        assert record.world.controller.type == "nowhere.to_be_found:Evil"
        assert record.world.robots[1].name == "fast"
    # A world from a file may still not name a class.
    with pytest.raises(physim.WorldError, match="names a class"):
        physim.parse_world(text)


def test_a_record_of_a_class_needs_no_code_unless_it_is_simulated_again(folder, capsys):
    fine = from_a_class(folder, "fine.h5")
    code, out, _ = run(capsys, fine)
    assert code == 1
    assert CARELESS in out
    coarse = from_a_class(folder, "coarse_class.h5", **{"time.record_every": 5})
    code, out, err = run(capsys, coarse)
    assert (code, out) == (2, "")
    assert f"--controller {CARELESS}" in err
    one_line(err)
    assert run(capsys, coarse, "--controller", CARELESS)[0] == 1


def test_ctrl_c_keeps_the_seeds_so_far(folder):
    target = folder / "interrupted.json"
    target.unlink(missing_ok=True)
    process = started("validate", "any.yaml", "--seeds", "1:100000", "--json", target.name,
                      "--set", "time.duration=1.0", folder=folder)  # fmt: skip
    try:
        lines = [process.stdout.readline() for _ in range(3)]
        assert all(line.startswith("seed ") for line in lines), lines
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 130
    assert err.count("\n") == 1
    found = json.loads(target.read_text(encoding="utf-8"))
    assert (found["interrupted"], found["exit_code"], found["seeds_asked"]) == (True, 130, 99999)
    seeds = [one["seed"] for one in found["seeds"]]
    assert seeds == list(range(1, found["runs"] + 1))
    assert len(seeds) >= 3
    assert states(out, f"of {found['runs']} runs", "contact-free")
    assert states(out, f"{99999 - found['runs']} of 99999", "interrupted", "not run")
