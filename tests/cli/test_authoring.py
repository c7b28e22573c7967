"""``new``, ``check`` and ``preview``: worlds, roads drawn by the seed, pictures."""

from __future__ import annotations

import json
import re
import shlex
import signal
import stat
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from physim import simulate
from physim.record import Record
from physim.world.file import load_world
from tests.cli.commands import SMALL, physim, shell, started, tree
from tests.helpers import facts, inside

lay_out = inside("physim.world.layout", "lay_out")
schema_text = inside("physim.world.file", "schema_text")

PNG, END = b"\x89PNG\r\n\x1a\n", b"IEND\xaeB`\x82"
DRAWN = """\
name: drawn
seed: 3
time: {step: 0.02, duration: 1.0}  # [s]
corridor:
  random: {length: 80.0, width: [5.0, 8.0], clutter: 12.0, passage: 2.5}
robots:
  - {name: a, footprint: {length: 1.2, width: 0.8}, pose: [6.0, 0.0, random], path: {offset: 0.3}}
  - {name: b, footprint: {length: 1.2, width: 0.8}, pose: [3.0, 0.0, random], path: {offset: -0.3}}
"""


def test_new_writes_a_world_and_the_schema_beside_it(here: Path, capsys) -> None:
    done = physim("new", "my_corridor", capture=capsys)
    assert (done.code, done.err) == (0, "")
    written, following = done.out.splitlines()
    assert re.search(facts("my_corridor.yaml", "world.schema.json"), written)
    commands = [f"physim {command} my_corridor.yaml" for command in ("check", "preview", "run")]
    assert re.search(facts(*commands), following)
    assert list(tree(here)) == ["my_corridor.yaml", "small.yaml", "world.schema.json"]
    assert len({stat.S_IMODE(path.stat().st_mode) for path in here.iterdir()}) == 1
    world = load_world("my_corridor.yaml")
    assert (world.name, world.robot_count) == ("my_corridor", 2)
    schema = here / "world.schema.json"
    assert schema.read_text() == schema_text()
    schema.write_text("{}")  # one that is there is kept
    written, kept, _ = physim("new", "a", capture=capsys).out.splitlines()
    assert "world.schema.json" not in written
    assert re.search(facts("world.schema.json", "kept", "differs", "--force"), kept)
    assert schema.read_text() == "{}"
    assert physim("new", "a", "--force", capture=capsys).code == 0
    assert schema.read_text() == schema_text()


def test_world_robots_and_place_are_chosen(here: Path, capsys) -> None:
    (here / "w").mkdir()
    place = "w/one two.yaml"
    done = physim("new", "--like", "hundred_robots", "--robots", 5, "-o", place, capture=capsys)
    assert "physim run 'w/one two.yaml'" in done.out
    world = load_world(place)
    assert (world.name, world.robot_count) == ("one two", 5)
    assert list(tree(here / "w")) == ["one two.yaml", "world.schema.json"]


@pytest.mark.parametrize(
    ("name", "file", "inside"),
    [
        ("my_door.yaml", "my_door.yaml", "my_door"),
        ('a "b": [c] #1', "a_b_c_1.yaml", 'a "b": [c] #1'),
        ("коридор 2", "коридор_2.yaml", "коридор 2"),
        ("yes", "yes.yaml", "yes"),
        ("<b>x<b>", "b_x_b.yaml", "<b>x<b>"),
    ],
)
def test_names_are_safe_in_files_and_whole_in_worlds(
    here: Path, capsys, name: str, file: str, inside: str
) -> None:
    assert physim("new", name, capture=capsys).code == 0
    assert load_world(here / file).name == inside


def test_rates_say_what_they_are_drawn_over_or_that_nothing_is_random(here: Path, capsys) -> None:
    (here / "w.yaml").write_text(SMALL.replace("1.0, 0.0]\n", "1.0, random]\n"), "utf-8")
    over = ", which draw the headings"
    short = ("--seeds", "0:2", "--workers", 1, "--set", "time.duration=0.1")
    swept = physim("sweep", "w.yaml", *short, "-o", "rows", capture=capsys)
    assert over in swept.out, swept.err
    said = physim("report", "rows", "--no-pictures", "--json", "r.json", capture=capsys)
    assert over in said.out
    assert over in (here / "rows/report.html").read_text(encoding="utf-8")
    cell = json.loads((here / "r.json").read_text("utf-8"))["cells"][0]
    assert cell["draws"] == "the headings"
    code, out, err = physim("sweep", "small.yaml", *short, "-o", "fixed", capture=capsys)
    assert code == 0, err
    assert "random]" in out + err
    assert "start: {region:" in out + err


def test_force_writes_over_the_files_of_a_project_alone(here: Path, capsys) -> None:
    assert physim("new", "--project", "p", capture=capsys).code == 0
    (here / "p" / "notes.txt").write_text("mine")
    (here / "p" / "controllers" / "mine.py").write_text("changed")
    assert physim("new", "--project", "p", capture=capsys).code == 2
    assert physim("new", 'a "b": [c] #1', "--project", "p", "--force", capture=capsys).code == 0
    assert load_world(here / "p/worlds/a_b_c_1.yaml").name == 'a "b": [c] #1'
    files = tree(here / "p")
    assert files["notes.txt"] == b"mine"
    assert b"class Mine" in files["controllers/mine.py"]


@pytest.mark.deep
def test_the_commands_of_a_projects_readme_run(tmp_path: Path) -> None:
    done = shell("new", "--project", "my study", folder=tmp_path)
    assert done.code == 0, done.err
    project = tmp_path / "my study"
    readme = (project / "README.md").read_text()
    assert len(readme.splitlines()) <= 40
    blocks = re.findall(r"```sh\n(.*?)```", readme, flags=re.DOTALL)
    lines = "".join(blocks).replace("\\\n", "")
    commands = [shlex.split(line)[1:] for line in lines.splitlines()]
    names = ["check", "preview", "run", "sweep", "report", "compare"]
    assert [command[0] for command in commands] == names
    before = set(tree(project))
    for command in commands:
        done = shell(*command, folder=project)
        assert done.code == 0, done.out + done.err
    assert re.search("no difference shown|is better in", done.out)
    assert re.search(facts("mode_switching", "controllers.mine:Mine", "20 seeds"), done.out)
    made = {name for name in set(tree(project)) - before if "__pycache__" not in name}
    assert {"my_study.png", "runs/mine/page.html", "sweeps/first/report.html"} <= made
    with Record.load(project / "runs/mine/record.h5") as record:
        assert "controllers.mine:Mine" in record.world_text


def test_a_run_on_a_drawn_road_can_be_simulated_again_from_its_record(here: Path, capsys) -> None:
    (here / "w.yaml").write_text(DRAWN)
    arguments = ("run", "w.yaml", "--seed", 5, "-o", "out", "--no-video", "--quiet")
    assert physim(*arguments, capture=capsys).code == 0
    with Record.load("out/record.h5") as record:
        assert record.seed == 5
        drawn = lay_out(load_world("w.yaml"), 5)
        assert record.world == load_world("w.yaml", overrides=["seed=5"])
        assert len(record.bodies) == 2 + 4 + len(drawn.obstacles)
    again = physim("validate", "out/record.h5", "--json", "v.json", capture=capsys)
    assert again.code == 0, again.out
    assert json.loads(Path("v.json").read_text())["rerun"]["same_digest"] is True


def test_check_and_preview_are_of_the_seed_and_the_keys_set(here: Path, capsys) -> None:
    (here / "w.yaml").write_text(DRAWN)
    done = physim("check", "w.yaml", "--seed", 9, capture=capsys)
    assert done.code == 0
    assert re.search(facts("road drawn by seed 9", "80.0 m", "2.5 m"), done.out)
    assert physim("preview", "w.yaml", "--seed", 9, "-o", "9.svg", capture=capsys).code == 0
    assert physim("preview", "w.yaml", "-o", "3.svg", capture=capsys).code == 0
    one, other = ((here / f"{n}.svg").read_text() for n in (9, 3))
    assert one != other
    key = "corridor.random.clutter"
    done = physim("check", "w.yaml", "--set", f"{key}=99.0", capture=capsys)
    assert done.code == 2
    assert re.search(facts(f"--set {key}", "at most 50"), done.out)


def test_new_writes_out_the_road_of_a_seed(here: Path, capsys) -> None:
    (here / "w.yaml").write_text(DRAWN)
    done = physim("new", "drawn_7", "--like", "w.yaml", "--seed", 7, capture=capsys)
    assert (done.code, done.err) == (0, "")
    head = (here / "drawn_7.yaml").read_text().partition("name:")[0]
    assert "physim new drawn_7 --like w.yaml --seed 7" in head
    plain, drawn = load_world("drawn_7.yaml"), load_world("w.yaml", overrides=["seed=7"])
    assert not plain.is_road_random
    assert (plain.name, plain.seed, len(plain.obstacles)) == ("drawn_7", 7, 6)
    assert plain.robots == drawn.robots
    with simulate(plain) as one, simulate(drawn) as other:
        assert np.array_equal(one.pose, other.pose)
        assert np.array_equal(one.updates, other.updates)
    assert physim("check", "drawn_7.yaml", capture=capsys).code == 0


@pytest.mark.parametrize(
    ("world", "picture"),
    [("w.yaml", "w.png"), ("...yaml", "world.png"), ("a\nb.yaml", r"a\u000ab.png")],
)
def test_a_picture_is_named_after_the_file_in_one_line(
    here: Path, capsys, world: str, picture: str
) -> None:
    (here / "small.yaml").rename(here / world)
    assert physim("preview", world, capture=capsys) == (0, f"{picture}\n", "")
    assert (here / picture).read_bytes().startswith(PNG)
    assert sorted(file.name for file in here.iterdir()) == sorted((world, picture))


def until(found: Callable[[], bool], process: subprocess.Popen[str]) -> None:
    """Wait for something that a running process does; fails when it ends without, or in 60 s."""
    for _ in range(1200):
        if found():
            return
        assert process.poll() is None, process.communicate()
        time.sleep(0.05)
    raise AssertionError("nothing came")


@pytest.mark.deep
def test_watch_draws_again_on_every_save(here: Path) -> None:
    """It begins with a faulty world, tells what check finds, and never leaves half a picture."""
    picture, world = here / "small.png", here / "small.yaml"

    def whole_and_not(before: bytes) -> bool:
        now = picture.read_bytes()
        assert now.startswith(PNG)
        assert now.endswith(END)
        return now != before

    world.write_text(SMALL.replace("width: 8.0", "width: -8.0"))
    process = started("preview", "small.yaml", "--watch", folder=here)
    try:
        assert process.stderr is not None
        assert process.stderr.readline().startswith("small.yaml:4:")
        assert not picture.exists()
        world.write_text(SMALL)
        until(picture.exists, process)
        first = picture.read_bytes()
        world.write_text(SMALL[: len(SMALL) // 2])  # an editor that is not done yet
        time.sleep(1.5)
        assert picture.read_bytes() == first
        new = here / "new.yaml"  # an editor that writes beside and renames
        new.write_text(SMALL.replace("width: 8.0", "width: 12.0"))
        new.replace(world)
        until(lambda: whole_and_not(first), process)
        second = picture.read_bytes()
        world.unlink()
        time.sleep(1.0)
        assert process.poll() is None
        world.write_text(SMALL.replace("1.0, 0.0]", "1.0, 3.0]"))
        until(lambda: whole_and_not(second), process)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 130
    assert out.count("small.png drawn") == 3
    assert "stays as it is" in err
    assert "warning: small.yaml:8:22: robots[0].pose[2]: " in err
    assert err.endswith("interrupted\n")
    assert "Traceback" not in err
    assert sorted(file.name for file in here.iterdir()) == ["small.png", "small.yaml"]
