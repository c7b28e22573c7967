"""``physim new``: what it writes runs, and what it cannot write it refuses."""

from __future__ import annotations

import re
import shlex
import stat

import pytest

from physim.record import Record
from physim.world.file import load_world
from tests.cli.commands import physim, shell, tree
from tests.helpers import facts, inside

schema_text = inside("physim.world.file", "schema_text")


@pytest.fixture(autouse=True)
def _folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_writes_a_world_and_the_schema_beside_it(tmp_path, capsys) -> None:
    done = physim("new", "my_corridor", capture=capsys)
    assert (done.code, done.err) == (0, "")
    written, following = done.out.splitlines()
    assert re.search(facts("my_corridor.yaml", "world.schema.json"), written)
    commands = [f"physim {command} my_corridor.yaml" for command in ("check", "preview", "run")]
    assert re.search(facts(*commands), following)
    assert list(tree(tmp_path)) == ["my_corridor.yaml", "world.schema.json"]
    world = load_world("my_corridor.yaml")
    assert (world.name, len(world.robots)) == ("my_corridor", 3)
    assert (tmp_path / "world.schema.json").read_text() == schema_text()


def test_template_robots_and_place_are_chosen(tmp_path, capsys) -> None:
    (tmp_path / "w").mkdir()
    place = "w/one two.yaml"
    done = physim("new", "--template", "doorway", "--robots", 5, "-o", place, capture=capsys)
    assert "physim run 'w/one two.yaml'" in done.out
    world = load_world(place)
    assert (world.name, len(world.robots)) == ("one two", 5)
    assert list(tree(tmp_path)) == ["w", "w/one two.yaml", "w/world.schema.json"]
    assert physim("new", "other", "-o", "w/b.yaml", capture=capsys).code == 0
    assert load_world("w/b.yaml").name == "other"


def test_a_schema_that_is_there_is_kept(tmp_path, capsys) -> None:
    (tmp_path / "world.schema.json").write_text("{}")
    written, kept, _ = physim("new", "a", capture=capsys).out.splitlines()
    assert "a.yaml" in written
    assert "world.schema.json" not in written
    assert re.search(facts("world.schema.json", "kept", "differs", "--force"), kept)
    assert (tmp_path / "world.schema.json").read_text() == "{}"
    assert physim("new", "a", "--force", capture=capsys).code == 0
    assert (tmp_path / "world.schema.json").read_text() == schema_text()


@pytest.mark.parametrize(
    ("name", "file", "inside"),
    [
        ("my_door.yaml", "my_door.yaml", "my_door"),
        ('a "b": [c] #1', "a_b_c_1.yaml", 'a "b": [c] #1'),
        ("коридор 2", "коридор_2.yaml", "коридор 2"),
        ("yes", "yes.yaml", "yes"),
        ("<b>x</b>".replace("/", ""), "b_x_b.yaml", "<b>x<b>"),
    ],
)
def test_names_are_safe_in_files_and_whole_in_worlds(tmp_path, capsys, name, file, inside) -> None:
    assert physim("new", name, capture=capsys).code == 0
    assert file in tree(tmp_path)
    assert load_world(tmp_path / file).name == inside


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([""], ('"":', "cannot name", "letters and digits", "my_corridor")),
        (["  "], ("cannot name",)),
        ([".."], ('"..":', "cannot name")),
        ([".hidden"], ('".hidden":', "cannot name")),
        (["a\nb"], (r'"a\u000ab":', "cannot name")),
        (["a/b"], ('"a/b":', "is a path", "-o")),
        (["../b"], ('"../b":', "cannot name")),
        (["a\\b"], ("is a path",)),
        (["x" * 101], ("at most 100", "given 101")),
        ([], ("physim new:", "NAME", "missing", "physim new my_corridor")),
        (["a", "--robots", "0"], ("--robots 0:", "corridor", "1 to 22")),
        (["a", "--robots", "11", "--template", "doorway"], ("--robots 11:", "doorway", "1 to 9")),
        (["a", "--template", "bent"], ("--template bent:", "corridor", "doorway", '"bend"')),
        (["a", "-o", "no/a.yaml"], ("no/a.yaml:", "no folder no")),
        (["a", "-o", "."], ("is a folder", "-o")),
        (["a", "-o", "world.schema.json"], ("world.schema.json", "the schema")),
        (["a", "-o", "b", "--project", "c"], ("-o", "--project", "one of them")),
        (["taken"], ("taken.yaml:", "exists", "--force", "-o")),
        (["--project", "full"], ("full:", "not empty", "--force")),
        (["--project", "taken.yaml"], ("taken.yaml:", "is a file", "--project", "a folder")),
        (["--project", "taken.yaml/x"], ("taken.yaml/x", "Not a directory")),
        (["--project", "a\x1bb"], (r"a\u001bb", "cannot be shown", "my_study")),
        (["--project", "a\nb"], (r"a\u000ab", "in one line")),
        (["--project", "loop"], ("loop",)),
        (["a/b", "--project", "new"], ('"a/b":', "is a path")),
        (["--project", "new", "--robots", "99"], ("--robots 99:", "1 to 22")),
    ],
)  # fmt: skip
def test_bad_wishes_are_refused_on_one_line_and_nothing_is_written(
    tmp_path, capsys, arguments, said
) -> None:
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine").write_text("mine")
    (tmp_path / "taken.yaml").write_text("mine")
    (tmp_path / "loop").symlink_to("loop")
    before = tree(tmp_path)
    done = physim("new", *arguments, capture=capsys)
    assert (done.code, done.out) == (2, "")
    assert re.search(facts(*said), done.err), done.err
    assert done.err.count("\n") == 1
    assert tree(tmp_path) == before


def test_force_writes_over_its_own_files_alone(tmp_path, capsys) -> None:
    assert physim("new", "--project", "p", capture=capsys).code == 0
    (tmp_path / "p" / "notes.txt").write_text("mine")
    (tmp_path / "p" / "controllers" / "cautious.py").write_text("changed")
    assert physim("new", "--project", "p", capture=capsys).code == 2
    assert physim("new", "--project", "p", "--force", capture=capsys).code == 0
    files = tree(tmp_path / "p")
    assert files["notes.txt"] == b"mine"
    assert b"class Cautious" in files["controllers/cautious.py"]


def test_files_are_as_open_as_any_other(tmp_path, capsys) -> None:
    assert physim("new", "a", capture=capsys).code == 0
    (tmp_path / "other").write_text("")
    modes = {stat.S_IMODE(path.stat().st_mode) for path in tmp_path.iterdir()}
    assert len(modes) == 1


def test_the_commands_of_a_projects_readme_run(tmp_path) -> None:
    done = shell("new", "--project", "my study", "--template", "bend", folder=tmp_path)
    assert done.code == 0, done.err
    project = tmp_path / "my study"
    assert re.search(facts("my study/", "README.md"), done.out)
    readme = (project / "README.md").read_text()
    assert readme.startswith("# my study\n")
    (block,) = re.findall(r"```sh\n(.*?)```", readme, flags=re.DOTALL)
    commands = [shlex.split(line) for line in block.splitlines()]
    assert len(commands) == 3
    before = set(tree(project))
    for command in commands:
        assert command[0] == "physim"
        done = shell(*command[1:], folder=project)
        assert done.code == 0, done.out + done.err
    made = {name for name in set(tree(project)) - before if "__pycache__" not in name}
    assert {"runs/bend/video.mp4", "runs/cautious/video.mp4", "media/bend.png"} <= made
    with Record.load(project / "runs/cautious/record.h5") as record:
        assert "controllers.cautious:Cautious" in record.world_text
    example = (project / "controllers" / "cautious.py").read_text()
    body = example.split("    def decide")[1].splitlines()
    assert len(body) <= 15
