"""``physim validate``: exit codes, bad input, seeds, coarse records, JSON."""

from __future__ import annotations

import json

import h5py
import pytest

from physim.cli import main
from tests.validation.runs import APART, LANE, REAR_END, lane

CARELESS = "tests.validation.runs:Careless"
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


def test_world_with_a_careless_controller(folder, capsys):
    code, out, _ = run(capsys, folder / "lane.yaml", "--controller", CARELESS)
    assert code == 1
    assert "Responsible is fast" in out
    assert CARELESS in out


def test_json(folder, capsys):
    target = folder / "found.json"
    code, _, _ = run(capsys, folder / "bad.h5", "--json", target, "--quiet")
    found = json.loads(target.read_text(encoding="utf-8"))
    assert found["exit_code"] == code == 1
    assert found["verdict"].startswith("contacts: ")
    first = found["contacts"][0]
    assert [found["run"]["bodies"][first[key]]["name"] for key in "ab"] == ["slow", "fast"]
    assert [side["responsible"] for side in first["sides"]] == [False, True]
    assert first["prediction"]["verdict"] == "same step"


def test_coarse_record_is_simulated_again(folder, capsys):
    path = folder / "coarse.h5"
    lane(REAR_END, path, **{"time.record_every": 7}).close()
    # Its samples are those of Careless, which the world inside cannot name.
    code, out, _ = run(capsys, path, "--controller", CARELESS)
    assert code == 1
    assert "simulated again, and those in it agree" in out
    code, _, err = run(capsys, path)
    assert code == 2
    assert "m away from its recorded sample" in err


def test_origin(folder, capsys):
    # Made by an object, so that the world inside is that of the file.
    assert run(capsys, folder / "good.h5", "--world", folder / "lane.yaml")[0] == 0
    code, _, err = run(capsys, folder / "good.h5", "--world", folder / "other.yaml")
    assert code == 2
    assert "corridor.width is 8.0 in the record, 9.0 in the world" in err
    one_line(err)


def test_seeds(folder, capsys):
    target = folder / "seeds.json"
    code, out, _ = run(
        capsys, folder / "any.yaml", "--seeds", "1:4", "--json", target, "--set",
        "time.duration=1.0",
    )  # fmt: skip
    found = json.loads(target.read_text(encoding="utf-8"))
    assert code == found["exit_code"] == (0 if found["contact_free"] == 3 else 1)
    assert [one["seed"] for one in found["seeds"]] == [1, 2, 3]
    assert f"{found['contact_free']} of 3 runs contact-free" in out
    assert "95 % Clopper-Pearson interval" in out


def test_seeds_of_a_world_without_anything_random(folder, capsys):
    code, out, _ = run(capsys, folder / "lane.yaml", "--controller", CARELESS, "--seeds", "1:9")
    assert code == 1
    assert out.startswith("Nothing in this world is random")
    assert "Clopper" not in out


def one_line(err):
    assert err.startswith("physim: ")
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda file: file.attrs.modify("version", 99), "record version 99"),
        (lambda file: file.__delitem__("contacts"), "dataset /contacts is missing"),
        (lambda file: [file[f"steps/{key}"].resize(100, axis=0) for key in
                       ("step", "pose", "clearance", "boundary_clearance")], "truncated"),
    ],
)  # fmt: skip
def test_bad_records(folder, capsys, change, told):
    code, out, err = run(capsys, copy_of(folder, "changed.h5", change))
    assert (code, out) == (2, "")
    assert told in err
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
