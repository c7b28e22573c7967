"""Values of a record that no run writes: one line that says file, table, row, given, allowed."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from physim.cli import main
from physim.errors import RecordError
from physim.record import Record
from tests.cli.commands import SMALL
from tests.helpers import inside
from tests.helpers.records import make_record

LITTLE_PLACE = inside("physim.record", "LITTLE_PLACE")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("made") / "record.h5"
    make_record(path, seconds=4.0, world_text=SMALL).close()
    return path


def tampered(made: Path, folder: Path, path: str, row: Any, value: Any, column: str = "") -> Path:
    """Copy with one value changed; ``row`` is an index into the dataset."""
    target = folder / "tampered.h5"
    shutil.copyfile(made, target)
    with h5py.File(target, "r+") as file:
        rows = np.array(file[path][()])
        (rows[column] if column else rows)[row] = value
        file[path][...] = rows
    return target


def refused(record: Path, *parts: str) -> None:
    """Check that loading fails with one line that names the file, then has these parts in order."""
    with pytest.raises(RecordError) as raised:
        Record.load(record)
    in_order(str(raised.value), str(record), *parts)


def in_order(message: str, *parts: str) -> None:
    """Check that a message is one line with these parts, as whole words, one after the other."""
    assert "\n" not in message
    words = [rf"(?<!\w){re.escape(part)}(?!\w)" for part in parts]
    assert re.search(".*?".join(words), message), (message, parts)


@pytest.mark.parametrize(
    ("path", "column", "value", "allowed"),
    [
        ("/updates", "step", 10**8, "0 to 400"),
        ("/updates", "step", -1, "0 to 400"),
        ("/updates", "robot", 77, "0 to 2"),
        ("/updates", "robot", -3, "0 to 2"),
        ("/updates", "mode", 77, "-1 to 3"),
        ("/updates", "rule", 2, "-1 to 1"),
        ("/updates", "considered", 55, "0 to 2"),
        ("/considered", "robot", 3, "0 to 2"),
        ("/considered", "count", -1, "0 to 2"),
        ("/considered", "count", 3, "0 to 2"),
        ("/considered_others", "", 3, "0 to 2"),
        ("/considered", "step", 401, "0 to 400"),
        ("/updates", "next_step", -5, "to"),
        ("/contacts", "step", 401, "0 to 400"),
        ("/contacts", "a", 3, "0 to 2"),
        ("/contacts", "b", 99, "1 to 4"),
        ("/contacts", "b", 0, "1 to 4"),
        ("/contacts", "phase", 9, "0 to 2"),
        ("/contacts", "kind", 9, "0 to 1"),
        ("/false_contacts", "step", 401, "0 to 400"),
        ("/false_contacts", "a", -1, "0 to 2"),
        ("/false_contacts", "b", 5, "1 to 4"),
        ("/extremes", "clearance_other", 3, "-1 to 2"),
        ("/extremes", "boundary_step", 401, "-1 to 400"),
    ],
)
def test_values_out_of_range(
    made: Path, tmp_path: Path, path: str, column: str, value: int, allowed: str
) -> None:
    with Record.load(made) as record:
        row = min(2, len(record.read(path)) - 1)
    bad = tampered(made, tmp_path, path, row, value, column)
    refused(bad, path, f"row {row}", column, str(value), allowed)


@pytest.mark.parametrize("more", [-1, 1])
def test_other_than_as_many_considered_as_are_counted(
    made: Path, tmp_path: Path, more: int
) -> None:
    target = tmp_path / "tampered.h5"
    shutil.copyfile(made, target)
    with h5py.File(target, "r+") as file:
        others = file["/considered_others"]
        counted = len(others)
        others.resize(counted + more, axis=0)
    refused(target, "/considered_others", f"{counted + more} rows", "/considered", str(counted))


def test_a_robot_considered_twice_in_one_decision(made: Path, tmp_path: Path) -> None:
    """Robot 2 considers 0 and 1, decision after decision; each of them is told once a decision."""
    others = slice(3, 5)
    with h5py.File(made) as file:
        assert file["/considered_others"][others].tolist() == [0, 0], "of two decisions"
    bad = tampered(made, tmp_path, "/considered_others", 2, 0)
    refused(bad, "/considered_others", "row 2", "robot 2", "0", "step 0", "once")


def test_considered_robots_of_any_order(made: Path, tmp_path: Path) -> None:
    """Those of a decision need no order, and are given as they stand."""
    swapped = tampered(made, tmp_path, "/considered_others", [1, 2], [1, 0])
    with Record.load(swapped) as record:
        assert record.considered["other"][:3].tolist() == [0, 1, 0]
        assert record.considered["robot"][:3].tolist() == [1, 2, 2]


@pytest.mark.parametrize("command", ["summary", "plot", "video", "validate"])
@pytest.mark.parametrize(
    ("path", "row", "value", "column", "parts"),
    [
        ("/updates", 2, 77, "robot", ("row 2", "robot", "77", "0 to 2")),
        ("/walls/part_start", 1, 10**6, "", ("row 1", "1000000", "0 to")),
        ("/walls/body_start", 1, 50, "", ("row 1", "50", "0 to")),
        ("/paths/start", 1, 150, "", ("row 1", "150", "0 to")),
        ("/steps/pose", (70, 1, 0), np.nan, "", ("row 70", "x", "robot 1", "nan", "finite")),
        ("/steps/pose", (70, 1, 2), np.inf, "", ("row 70", "heading", "robot 1", "inf", "finite")),
    ],
)
def test_every_command_says_so_in_one_line(
    made: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], command: str,
    path: str, row: Any, value: Any, column: str, parts: tuple[str, ...],
) -> None:  # fmt: skip
    bad = tampered(made, tmp_path, path, row, value, column)
    assert main([command, str(bad)]) == 2
    _, err = capsys.readouterr()
    lines = [line for line in err.splitlines() if not line.startswith("compiling ")]
    in_order("\n".join(lines), str(bad), path, *parts)


@pytest.mark.parametrize("value", [-2, 401])
def test_arrivals_outside_the_run(made: Path, tmp_path: Path, value: int) -> None:
    bad = tampered(made, tmp_path, "/robots/arrived", 1, value)
    refused(bad, "/robots/arrived", "row 1", str(value), "-1 to 400")


@pytest.mark.parametrize(
    ("path", "value", "parts"),
    [
        ("/modes/colour", b"red", ("colour", '"safe"', "'red'")),
        ("/modes/name", b"<script>", ("name", "'<script>'", "letters")),
        ("/rules/words", b"\x1b[2J", ("words", '"follow"', "plain text")),
        ("/columns/unit", b"km", ('"target_x"', "unit", "'km'")),
    ],
)
def test_declarations_that_no_controller_makes(
    made: Path, tmp_path: Path, path: str, value: bytes, parts: tuple[str, ...]
) -> None:
    refused(tampered(made, tmp_path, path, 0, value), path.rpartition("/")[0], *parts)


@pytest.mark.parametrize("value", [3, -1])
def test_a_mode_is_of_danger_or_not(made: Path, tmp_path: Path, value: int) -> None:
    refused(
        tampered(made, tmp_path, "/modes/danger", 1, value), "/modes/danger", "row 1", str(value)
    )


@pytest.mark.parametrize("path", ["/robots/stop_station", "/robots/lead"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_lengths_that_are_no_numbers(made: Path, tmp_path: Path, path: str, value: float) -> None:
    refused(tampered(made, tmp_path, path, 1, value), path, "row 1", str(value), "finite")


@pytest.mark.parametrize(
    ("row", "kind", "allowed"),
    [(0, "obstacle", "robot"), (-1, "robot", "boundary or obstacle"), (-1, "wall", "obstacle")],
)
def test_bodies_of_another_kind(
    made: Path, tmp_path: Path, row: int, kind: str, allowed: str
) -> None:
    refused(tampered(made, tmp_path, "/bodies/kind", row, kind), "/bodies/kind", allowed)


@pytest.mark.parametrize(("column", "value"), [(0, 2e8), (1, -np.inf), (2, np.inf), (2, np.nan)])
def test_poses_where_no_robot_is(made: Path, tmp_path: Path, column: int, value: float) -> None:
    name = ("x", "y", "heading")[column]
    changed = tampered(made, tmp_path, "/steps/pose", (5, 1, column), value)
    with Record.load(changed) as record, pytest.raises(RecordError) as raised:
        record.pose  # noqa: B018
    in_order(str(raised.value), "/steps/pose", "row 5", f"{name} of robot 1", str(value), "1e+08")


@pytest.mark.parametrize("turn", [3.2, -1e7])
def test_turns_that_no_robot_makes_in_a_step(made: Path, tmp_path: Path, turn: float) -> None:
    """What looks between samples would go round and round for hours."""
    with Record.load(made) as record:
        before = record.pose[4, 1, 2]
    changed = tampered(made, tmp_path, "/steps/pose", (5, 1, 2), before + turn)
    with Record.load(changed) as record, pytest.raises(RecordError) as raised:
        record.pose  # noqa: B018
    in_order(str(raised.value), "/steps/pose", "row 5", "robot 1", "rad", "allowed", "3.142")


@pytest.mark.parametrize("value", [np.nan, 1.7e308, -1e9, -np.inf])
@pytest.mark.parametrize("path", ["/steps/clearance", "/steps/boundary_clearance"])
def test_distances_that_no_scene_has(made: Path, tmp_path: Path, path: str, value: float) -> None:
    changed = tampered(made, tmp_path, path, (5, 1), value)
    with Record.load(changed) as record, pytest.raises(RecordError) as raised:
        record.read(path)
    in_order(str(raised.value), path, "row 5", "robot 1", f"{value}", "3e+08")


@pytest.mark.parametrize(
    ("path", "column"),
    [("/extremes", "clearance"), ("/extremes", "boundary_clearance"),
     ("/extremes_farthest", "farthest")],
)  # fmt: skip
def test_extremes_that_no_scene_has(made: Path, tmp_path: Path, path: str, column: str) -> None:
    row = () if path == "/extremes_farthest" else 1
    refused(tampered(made, tmp_path, path, row, -1.7e308, column), path, column, "-1.7e+308")


@pytest.mark.parametrize(
    ("path", "column"),
    [("/extremes", "clearance_step"), ("/extremes", "boundary_other"),
     ("/extremes_farthest", "a"), ("/extremes_farthest", "b")],
)  # fmt: skip
def test_extremes_of_nobody_are_of_no_step(
    made: Path, tmp_path: Path, path: str, column: str
) -> None:
    row = () if path == "/extremes_farthest" else 1
    refused(tampered(made, tmp_path, path, row, -1, column), path, "-1", "both or neither")


@pytest.mark.parametrize(
    ("path", "when", "who", "value"),
    [("/extremes", "clearance_step", ("clearance_other",), np.inf),
     ("/extremes_farthest", "step", ("a", "b"), -np.inf)],
)  # fmt: skip
def test_a_distance_is_of_a_step_and_no_distance_of_none(
    made: Path, tmp_path: Path, path: str, when: str, who: tuple[str, ...], value: float
) -> None:
    column, row = path.rpartition("_")[2].strip("/"), () if "farthest" in path else 1
    column = "clearance" if column == "extremes" else column
    refused(tampered(made, tmp_path, path, row, value, column), path, column, "-1 is never")
    target = tampered(made, tmp_path, path, row, -1, when)
    with h5py.File(target, "r+") as file:
        rows = np.array(file[path])
        for name in who:
            rows[name][row] = -1
        file[path][...] = rows
    refused(target, path, column, "-1 is never")


def test_no_run_has_so_many_steps(made: Path, tmp_path: Path) -> None:
    target = tmp_path / "tampered.h5"
    shutil.copyfile(made, target)
    with h5py.File(target, "r+") as file:
        file["/steps/step"][...] = np.arange(401) * 1_000_000
        file.attrs["record_every"] = 1_000_000
        file.attrs["steps_run"] = file.attrs["steps_planned"] = 400_000_000
    refused(target, "400000000 steps", "at most 100000000")


@pytest.mark.parametrize("levels", [8, 3000])
def test_groups_in_one_another(levels: int, tmp_path: Path, made: Path) -> None:
    """Opening each by its path from the root costs the square of their number."""
    path = shutil.copy(made, tmp_path / "r.h5")
    with h5py.File(path, "r+", libver="latest") as file:
        inner = file.id
        for _ in range(levels + 1):
            inner = h5py.h5g.create(inner, b"a", gcpl=h5py.h5p.create(h5py.h5p.GROUP_CREATE))
    refused(path, "/a/a/a/a/a/a/a/a/a", "8 levels")


def test_one_dataset_in_many_places(tmp_path: Path, made: Path) -> None:
    path = shutil.copy(made, tmp_path / "r.h5")
    with h5py.File(path, "r+") as file:
        file["again"] = file["/bodies/name"]
    refused(path, "several places")


@pytest.mark.parametrize("group", ["new", "steps/new"])
def test_what_a_later_version_adds_is_passed_over(group: str, tmp_path: Path, made: Path) -> None:
    path = shutil.copy(made, tmp_path / "r.h5")
    with h5py.File(path, "r+") as file:
        file.create_group(group)["values"] = np.arange(3)
    Record.load(path).close()


def test_a_footprint_has_no_more_parts_than_a_polygon_may(made: Path, tmp_path: Path) -> None:
    path = shutil.copy(made, tmp_path / "r.h5")
    with h5py.File(path, "r+") as file:
        group = file["footprints"]
        corners = group["part_start"][1]
        ends = np.cumsum([2000, 2001, 1])
        for name, rows in (
            ("vertices", np.tile(group["vertices"][:corners], (ends[-1], 1))),
            ("part_start", corners * np.arange(ends[-1] + 1)),
            ("body_start", np.array([0, *ends])),
        ):
            kind = group[name].dtype
            del group[name]
            group[name] = rows.astype(kind)
    refused(path, "/footprints/body_start", "row 1", "2001 parts", "2000")


def test_places_are_packed_no_further_than_they_are_drawn(made: Path, tmp_path: Path) -> None:
    path = shutil.copy(made, tmp_path / "r.h5")
    for points, is_read in ((LITTLE_PLACE // 16, True), (LITTLE_PLACE // 16 + 1, False)):
        with h5py.File(path, "r+") as file:
            group = file["areas/safe"]
            del group["points"], group["start"]
            rows = np.tile([[1.0, 2.0], [3.0, 1.0]], (points // 2 + 1, 1))[:points]
            group.create_dataset("points", data=rows, compression="gzip")
            group["start"] = np.array([0, points])
        if is_read:
            Record.load(path).close()
        else:
            refused(path, "/areas/safe/points", "claims", "damaged")


def test_texts_that_are_all_the_same_long_one(made: Path, tmp_path: Path) -> None:
    """In the file it stands once; read, it takes 600 times as much."""
    target = tmp_path / "tampered.h5"
    shutil.copyfile(made, target)
    with h5py.File(target, "r+") as file:
        one = file.create_dataset("one", (1,), dtype=h5py.string_dtype())
        one[0] = "x" * 100_000
        file.flush()
        place = one.id.get_offset()
    with target.open("rb") as raw:
        raw.seek(place)
        where = raw.read(16)  # of the text in the file
    with h5py.File(target, "r+") as file:
        del file["one"], file["/modes/name"]
        names = file.create_dataset("/modes/name", (600,), h5py.string_dtype(), chunks=(600,))
        names.id.write_direct_chunk((0,), where * 600)
    refused(target, "/modes/name", "letters", "damaged")


def test_attributes_of_many_values(made: Path, tmp_path: Path) -> None:
    target = tmp_path / "tampered.h5"
    shutil.copyfile(made, target)
    with h5py.File(target, "r+") as file:
        file.attrs["given"] = ["[]"] * 5
    refused(target, "attribute given", "many values")


def test_steps_must_increase(made: Path, tmp_path: Path) -> None:
    bad = tampered(made, tmp_path, "/steps/step", slice(None), np.arange(401)[::-1])
    refused(bad, "/steps/step", "row 1", "399", "400", "increase")


def test_rows_out_of_order(made: Path, tmp_path: Path) -> None:
    """One contact is told later; all its other values are such as a run writes."""
    bad = tampered(made, tmp_path, "/false_contacts", slice(None), 5, "step")
    with h5py.File(bad, "r+") as file:
        rows = file["/false_contacts"]
        rows.resize(2, axis=0)
        rows[1] = rows[0]
        last = rows[1]
        last["step"] = 4
        rows[1] = last
    refused(bad, "/false_contacts", "row 1", "step 4", "step 5", "order")


def test_a_command_that_is_no_number(made: Path, tmp_path: Path) -> None:
    bad = tampered(made, tmp_path, "/updates", 4, np.nan, "applied_v")
    refused(bad, "/updates", "row 4", "applied_v", "nan", "finite")


@pytest.mark.parametrize(
    ("path", "column", "value", "most"),
    [
        ("/updates", "nominal_v", 1e155, "10000"),
        ("/updates", "applied_omega", -2e6, "10000"),
        ("/contacts", "x", 1e9, "1e+08"),
        ("/contacts", "nx", 1.5, "1"),
        ("/contacts", "depth", -1e300, "3e+08"),
        ("/false_contacts", "distance", 1e300, "3e+08"),
    ],
)
def test_a_number_that_is_too_large_for_any_run(
    made: Path, tmp_path: Path, path: str, column: str, value: float, most: str
) -> None:
    """A command of 1e155 m/s ended a validation in a traceback."""
    bad = tampered(made, tmp_path, path, 0, value, column)
    refused(bad, path, "row 0", column, f"{value:.6g}", "allowed", most)


@pytest.mark.parametrize(
    ("path", "columns", "who"),
    [
        ("/updates", ("robot",), "robot"),
        ("/considered", ("robot",), "robot"),
        ("/contacts", ("a", "b", "kind"), "a 0, b 1"),
    ],
)
def test_a_row_that_is_there_twice(
    made: Path, tmp_path: Path, path: str, columns: tuple[str, ...], who: str
) -> None:
    """Whatever else it says; the same bodies at another step are fine."""
    target = tmp_path / "twice.h5"
    shutil.copyfile(made, target)
    with h5py.File(target, "r+") as file:
        rows = file[path][()]
        for column in ("step", *columns):
            rows[column][1] = rows[column][0]
        file[path][...] = rows
    refused(target, path, "row 1", "step", who, "once")


def packed(made: Path, folder: Path, group: str, points: Any, start: Any) -> Path:
    """Copy with other points, and where each run of them starts."""
    target = folder / "tampered.h5"
    shutil.copyfile(made, target)
    with h5py.File(target, "r+") as file:
        for name, rows in (("points", np.array(points, float)), ("start", np.array(start))):
            del file[f"{group}/{name}"]
            file[f"{group}/{name}"] = rows
    return target


@pytest.mark.parametrize("number", [0, -3, 2**31 - 1])
def test_bodies_are_numbered_as_they_stand(made: Path, tmp_path: Path, number: int) -> None:
    refused(tampered(made, tmp_path, "/bodies/id", 2, number), "/bodies/id", "row 2", "2")


@pytest.mark.parametrize(
    ("group", "points", "start", "said"),
    [
        ("/paths", [[0, 0], [1, 0], [2, 0]], [0, 1, 2, 3], "1 points"),
        ("/paths", [[1, 1]] * 6, [0, 2, 4, 6], "length 0"),
        ("/reference", [[1, 1]], [0, 1], "1 points"),
        ("/areas/safe", [[0, 0], [1, 0], [1, 1]], [0, 0, 3], "0 points"),
        ("/areas/accessible", [[0, 0], [1, 0], [1, 1], [2, 2], [3, 3]], [0, 3, 5], "2 points"),
    ],
)
def test_lines_and_rings_that_enclose_nothing(
    made: Path, tmp_path: Path, group: str, points: Any, start: Any, said: str
) -> None:
    changed = packed(made, tmp_path, group, points, start)
    with pytest.raises(RecordError) as raised, Record.load(changed) as record:
        getattr(record, group.rpartition("/")[2])
    in_order(str(raised.value), f"{group}/start", "row", said)


def test_footprints_without_area(made: Path, tmp_path: Path) -> None:
    changed = tampered(made, tmp_path, "/footprints/vertices", slice(None), 0.0)
    with pytest.raises(RecordError) as raised, Record.load(changed) as record:
        record.shapes  # noqa: B018
    in_order(str(raised.value), "/footprints", "row 0", "without area")


def test_obstacles_of_two_corners(made: Path, tmp_path: Path) -> None:
    changed = tampered(made, tmp_path, "/bodies/kind", -1, "obstacle")
    with pytest.raises(RecordError) as raised, Record.load(changed) as record:
        record.walls  # noqa: B018
    in_order(str(raised.value), "/walls/part_start", "2 corners", "3")


@pytest.mark.parametrize("text", ["a: " + "[" * 100_000, "- " * 100_000])
def test_a_world_inside_that_nests_without_end(made: Path, tmp_path: Path, text: str) -> None:
    target = tmp_path / "deep.h5"
    shutil.copyfile(made, target)
    with h5py.File(target, "r+") as file:
        file.attrs["world"] = text
    run = subprocess.run(
        [sys.executable, "-m", "physim", "summary", target], capture_output=True, text=True
    )
    assert (run.returncode, run.stderr.count("\n")) == (2, 1), run.stderr
    in_order(run.stderr.strip(), str(target), "nested deeper")


@pytest.mark.parametrize("levels", [1, 9])
def test_a_world_inside_of_aliases(made: Path, tmp_path: Path, levels: int) -> None:
    """Nine lines of nine aliases stand for 9**10 values, as soon as a setting is told."""
    target = tmp_path / "aliases.h5"
    shutil.copyfile(made, target)
    lines = [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]\n" for k in range(1, levels + 1)]
    text = f"a0: &a0 x\n{''.join(lines)}controller: {{type: constant, gain: *a{levels}}}\n"
    with h5py.File(target, "r+") as file:
        file.attrs["world"] = text
    with Record.load(target) as record, pytest.raises(RecordError) as raised:
        record.world_settings  # noqa: B018
    in_order(str(raised.value), str(target), "the world inside cannot be read")
