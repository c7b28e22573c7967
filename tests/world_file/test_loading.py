from __future__ import annotations

import os
from pathlib import Path

import pytest

from physim.errors import Fault, WorldError
from physim.world.file import load_world, located, parse_world, read_world
from tests.worlds_by_hand import STRAIGHT


def refusal(path, **options) -> str:
    with pytest.raises(WorldError) as caught:
        load_world(path, **options)
    return str(caught.value)


def changed(old: str, new: str) -> str:
    assert old in STRAIGHT
    return STRAIGHT.replace(old, new, 1)


def message(text: str, **options) -> str:
    with pytest.raises(WorldError) as caught:
        parse_world(text, "w.yaml", **options)
    return str(caught.value)


def test_a_world_by_hand_loads(tmp_path):
    path = tmp_path / "straight.yaml"
    path.write_text(STRAIGHT)
    world = load_world(path)
    assert [robot.name for robot in world.robots] == ["r1", "r2"]
    assert world.robots[1].pose == (3.0, -1.0, "random")
    assert world.robots[1].path.offset == -1.0
    assert world.controller.settings["look_ahead"] == 2.0
    assert parse_world(world.to_yaml()) == world


def test_files_that_cannot_be_read_say_why(tmp_path):
    (tmp_path / "straight.yaml").write_text(STRAIGHT)
    assert "no such file; did you mean straight.yaml?" in refusal(tmp_path / "strait.yaml")
    assert "world files there: straight.yaml" in refusal(tmp_path / "zzz")
    assert "there is no folder" in refusal(tmp_path / "no" / "w.yaml")
    assert "is a folder" in refusal(tmp_path)
    assert "cannot be read" in refusal("a\0b")
    os.mkfifo(tmp_path / "pipe.yaml")
    assert "not a regular file" in refusal(tmp_path / "pipe.yaml")
    with (tmp_path / "large.yaml").open("wb") as file:
        file.truncate(100_000_000)
    assert "100.0 MB is too large" in refusal(tmp_path / "large.yaml")
    latin = tmp_path / "latin.yaml"
    latin.write_bytes(b"name: a\ndescription: caf\xe9\n")
    assert refusal(latin) == f"{latin}:2:17: byte 0xe9 is not UTF-8; save the file as UTF-8"
    assert "not UTF-8" in refusal(_written(tmp_path / "u16.yaml", STRAIGHT.encode("utf-16")))


def _written(path: Path, data: bytes) -> Path:
    path.write_bytes(data)
    return path


def test_all_faults_come_at_once_in_the_order_of_the_file():
    text = changed("seed: 3", "sead: 3").replace("duration: 30.0", "duration: 1e3")
    text = text.replace("look_ahead", "look_ahed").replace("width: 8.0", 'width: "8"')
    assert message(text).splitlines() == [
        "w.yaml:3:1: sead: unknown key; allowed: name, description, seed, time, corridor, "
        "boundaries, reference_path, start, robots, formation, controller, sensing, filters, "
        'disturbances, arrival, obstacles, expect, physics; did you mean "seed"?',
        "w.yaml:4:30: time.duration: 1e3 is a text to many YAML readers; write 1.0e+3 or 1000",
        "w.yaml:5:50: corridor.width: must be: [m] full width: one number, or one per point of "
        'the centreline; given "8", which is a text; write the number without quotes',
        "w.yaml:16:36: controller.look_ahed: unknown key; allowed: look_ahead, omegas; "
        'did you mean "look_ahead"?',
    ]


def test_missing_keys_are_told_where_they_should_stand():
    assert message(changed("step: 0.01, ", "")).startswith(
        "w.yaml:4:1: time.step: missing; needed: [s] one physics step"
    )
    assert message(changed("  - name: r1\n    footprint", "  - footprint")).startswith(
        "w.yaml:7:5: robots[0].name: missing"
    )


def test_many_faults_are_counted():
    junk = f"path: [{', '.join(['1'] * 60)}]"
    text = changed("path: {offset: -1.0}", junk)
    text = text.replace("path: [[0.0, 1.0], [30.0, 1.0]]", junk)
    lines = message(text).splitlines()
    assert len(lines) == 100
    assert lines[-1].endswith("more faults follow; correct these first")


def test_controller_settings_are_those_of_the_controller():
    assert 'look_ahead: must be a number; given "far"' in message(changed("2.0}", "far}"))
    assert "w.yaml:16:48: controller.look_ahead: must be greater than 0" in message(
        changed("look_ahead: 2.0", "look_ahead: -2.0")
    )
    assert 'no controller is called "mode_swiching"' in message(
        changed("mode_switching", "mode_swiching")
    )
    assert "controller.look_ahead: unknown key" in message(changed("mode_switching", "plain"))
    assert parse_world(changed("look_ahead: 2.0", "omegas: [1, 2]")).controller.settings[
        "omegas"
    ] == (1, 2)


def test_a_world_cannot_name_a_class():
    text = changed("mode_switching", "os:system")
    assert "give it on the command line by --controller" in message(text)


def test_the_command_line_may_name_another_controller():
    assert parse_world(STRAIGHT, controller="plain").controller.settings == {}
    assert parse_world(STRAIGHT, controller="mode_switching") == parse_world(STRAIGHT)
    name = "tests.world_file.parts_for_tests:Switching"
    world = parse_world(STRAIGHT, controller=name, overrides=["controller.look_ahead=3.0"])
    assert world.controller.type == name
    assert world.controller.settings == {"look_ahead": 3.0}
    assert "--controller: no controller" in message(STRAIGHT, controller="no")


def test_later_faults_find_their_place(tmp_path):
    path = tmp_path / "w.yaml"
    path.write_text(STRAIGHT)
    _, document = read_world(path)
    error = located([Fault(("robots", 1, "pose"), "is outside")], document)
    assert str(error) == f"{path}:13:11: robots[1].pose: is outside"
    assert str(located([Fault((), "is bad")], None)) == "is bad"


def test_a_long_list_of_no_points_is_one_fault():
    text = changed("path: {offset: -1.0}", f"path: [{', '.join(['a'] * 500)}]")
    assert message(text).splitlines() == [
        "w.yaml:14:11: robots[1].path: must be points [x, y] of two numbers each; "
        "given a list of 500"
    ]


@pytest.mark.parametrize("given", ["2e0", ".nan", "1_000", "010", "yes"])
@pytest.mark.parametrize("key", ["look_ahead: {}", "omegas: [1.0, {}]"])
def test_settings_that_cannot_be_read_are_told_once(given, key):
    (line,) = message(changed("look_ahead: 2.0", key.format(given))).splitlines()
    assert line.startswith("w.yaml:16:")
    assert "settings cannot be read" not in line


def test_settings_beside_one_that_cannot_be_read_are_judged():
    lines = message(changed("look_ahead: 2.0", "look_ahead: 2e0, omega: 1")).splitlines()
    assert len(lines) == 2
    assert "unknown key" in lines[1]
