from __future__ import annotations

import gzip
import os

import pytest

from physim.errors import WorldError
from physim.world.file import load_world, parse_world
from tests.helpers import STRAIGHT, check_error, facts


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
    os.mkfifo(tmp_path / "pipe.yaml")
    (tmp_path / "dangling.yaml").symlink_to(tmp_path / "nowhere")
    (tmp_path / "loop.yaml").symlink_to(tmp_path / "loop.yaml")
    with (tmp_path / "large.yaml").open("wb") as file:
        file.truncate(100_000_000)
    for name, data in {
        "plan.svg": b"x",
        "latin.yaml": b"name: a\ndescription: caf\xe9\n",
        "u16.yaml": STRAIGHT.encode("utf-16"),
        "packed.yaml": gzip.compress(STRAIGHT.encode()),
    }.items():
        (tmp_path / name).write_bytes(data)
    for name, *parts in (
        ("strait.yaml", "no such file", '"straight.yaml"'),
        ("plans.yaml", "no such file"),
        ("no/w.yaml", "no such file"),
        ("", "a folder"),
        ("pipe.yaml", "regular file"),
        ("dangling.yaml", "no such file"),
        ("loop.yaml", "cannot be read", "symbolic links"),
        ("x" * 300 + ".yaml", "cannot be read", "too long"),
        ("plan.svg", "no world file", "physim import"),
        ("large.yaml", "100.0 MB", "5 MB"),
        ("latin.yaml:2:17:", "0xe9", "UTF-8"),
        ("u16.yaml:1:1:", "0xff", "UTF-8"),
        ("packed.yaml", "gzip", "unpack"),
    ):
        told = refusal(tmp_path / name.partition(":")[0])
        check_error(f"{told}\n", str(tmp_path / name), *parts)
        assert "plan.svg" not in told or name == "plan.svg", "a drawing is no world"
    assert "cannot be read" in refusal("a\0b")
    assert "regular file" in refusal("/dev/zero")


def test_all_faults_come_at_once_in_the_order_of_the_file():
    text = changed("seed: 3", "sead: 3").replace("duration: 30.0", "duration: -1")
    text = text.replace("width: 8.0", 'width: "8"')
    keys = (
        "name, description, seed, time, corridor, boundaries, reference_path, start, robots, "
        "formation, controller, sensing, filters, disturbances, arrival, obstacles, movers, "
        "expect, physics"
    )
    expected = [
        ("w.yaml:3:1: sead:", "unknown", f"allowed: {keys};", '"seed"'),
        ("w.yaml:4:30: time.duration:", "greater than 0", "given -1"),
        ("w.yaml:5:50: corridor.width:", "[m]", "one number", "one per point", '"8"', "quotes"),
    ]
    for line, (place, *parts) in zip(message(text).splitlines(), expected, strict=True):
        check_error(f"{line}\n", place, *parts)


def test_each_stage_is_told_where_the_one_before_is_sound():
    """Text, values, what lies between them, parts, geometry."""
    text = changed("seed: 3", "sead: 3").replace("duration: 30.0", "duration: 1e3")
    text = text.replace("look_ahead", "look_ahed").replace("step: 0.01", "step: 0.07")
    for place, word, mended in (
        ("w.yaml:4:30: time.duration:", "1.0e+3", ("1e3", "30.0")),
        ("w.yaml:3:1: sead:", "unknown", ("sead", "seed")),
        ("w.yaml:4:30: time.duration:", "whole number of steps", ("0.07", "0.01")),
        ("w.yaml:16:36: controller.look_ahed:", '"look_ahead"', ("look_ahed", "look_ahead")),
    ):
        check_error(f"{message(text)}\n", place, word)
        text = text.replace(*mended)
    assert parse_world(text) == parse_world(STRAIGHT)


def test_controller_settings_are_those_of_the_controller():
    setting = "controller.look_ahead:"
    for old, new, place, *parts in (
        ("2.0}", "far}", f"w.yaml:16:48: {setting}", "number", '"far"'),
        ("2.0}", "-2.0}", f"w.yaml:16:48: {setting}", "greater than 0", "given -2.0"),
        ("mode_switching", "mode_swiching", "w.yaml:16:20: controller.type:",
         '"mode_swiching"', '"mode_switching"'),
        ("mode_switching", "plain", f"w.yaml:16:27: {setting}", "unknown"),
    ):  # fmt: skip
        check_error(f"{message(changed(old, new))}\n", place, *parts)
    assert parse_world(changed("look_ahead: 2.0", "omegas: [1, 2]")).controller.settings[
        "omegas"
    ] == (1, 2)


def test_the_command_line_may_name_another_controller():
    assert parse_world(STRAIGHT, controller="plain").controller.settings == {}
    assert parse_world(STRAIGHT, controller="mode_switching") == parse_world(STRAIGHT)
    name = "tests.world.file.parts_for_tests:Switching"
    world = parse_world(STRAIGHT, controller=name, overrides=["controller.look_ahead=3.0"])
    assert world.controller.type == name
    assert world.controller.settings == {"look_ahead": 3.0}
    assert "--controller: no controller" in message(STRAIGHT, controller="no")


def test_settings_are_not_carried_to_another_controller_in_silence(tmp_path):
    path = tmp_path / "w.yaml"
    path.write_text(STRAIGHT)
    with pytest.warns(UserWarning, match=facts("w.yaml:16:", "look_ahead", "mode_switching")):
        world = load_world(path, controller="plain")
    assert world.controller.settings == {}


def test_settings_without_a_type_are_for_whatever_runs():
    text = changed("type: mode_switching, ", "")
    name = "tests.world.file.parts_for_tests:Switching"
    world = parse_world(text, controller=name)
    assert (world.controller.type, world.controller.settings) == (name, {"look_ahead": 2.0})
    check_error(
        f"{message(text, controller='plain')}\n", "w.yaml:16:", "controller.look_ahead", "Plain"
    )
