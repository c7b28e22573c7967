"""``physim import`` as a user's shell sees it."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import get_args

import pytest

from physim.authoring.importing import FORMATS, Options, import_world
from physim.world.file import load_world
from tests.authoring.importing.plans import SAMPLES, svg
from tests.cli.commands import physim
from tests.helpers import check_error, facts, inside

schema_text = inside("physim.world.file", "schema_text")


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for file in SAMPLES.iterdir():
        shutil.copy(file, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", ["track.csv", "office.wkt"])
def test_samples(name: str, here: Path, capture: pytest.CaptureFixture[str]) -> None:
    done = physim("import", name, "-o", "w.yaml", "--robot", "fit", capture=capture)
    assert (done.code, done.err) == (0, "")
    assert done.out.startswith(f"{name}: ")
    assert "\nwritten: w.yaml, world.schema.json\n" in done.out
    assert done.out.endswith(
        "\nnext: physim check w.yaml, physim preview w.yaml, physim run w.yaml\n"
    )
    assert (here / "world.schema.json").read_text() == schema_text()
    assert "dropped or repaired:" in done.out
    text = (here / "w.yaml").read_text()
    first, second, *_ = text.splitlines()
    assert first == "# yaml-language-server: $schema=world.schema.json"
    assert second.startswith(f"# Imported from {name}: ")
    for told in done.out.splitlines()[1:3]:
        assert told.split(";")[0].strip()[:60] in text.replace("\n#   ", " ")
    world = load_world(here / "w.yaml")
    assert world.name == Path(name).stem
    assert world.to_yaml() == import_world(str(here / name), Options(robot="fit")).world.to_yaml()


WITHOUT = """
import sys
sys.modules["lxml"] = sys.modules["svgelements"] = None
from physim.cli import main
sys.exit(main(["import", sys.argv[1], "-o", "w.yaml", "--robot", "fit", "--quiet"]))
"""


def test_only_drawings_need_the_extra(here: Path) -> None:
    (here / "plan.svg").write_text(svg(""))
    for name, code in (("plan.svg", 2), ("track.csv", 0), ("office.yaml", 0)):
        (here / "w.yaml").unlink(missing_ok=True)
        done = subprocess.run(
            [sys.executable, "-c", WITHOUT, name], capture_output=True, text=True, cwd=here
        )
        assert (done.returncode, (here / "w.yaml").exists()) == (code, code == 0), done.stderr
        wanted = 'an SVG drawing needs an extra: pip install "physim[import]"\n' if code else ""
        assert done.stderr == wanted


@pytest.fixture
def capture(capsys: pytest.CaptureFixture[str]) -> pytest.CaptureFixture[str]:
    return capsys


def test_existing_files_need_force(here: Path, capture: pytest.CaptureFixture[str]) -> None:
    (here / "w.yaml").write_text("mine")
    done = physim("import", "track.csv", "-o", "w.yaml", capture=capture)
    assert done.code == 2
    check_error(done.err, "w.yaml:", "exists", "--force", "-o")
    assert (here / "w.yaml").read_text() == "mine"
    assert physim("import", "track.csv", "-o", "w.yaml", "--force", "--quiet", capture=capture) == (
        0, "", "",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("arguments", "place", "parts"),
    [
        (["office.yaml", "-o", "office.yaml", "--force"], "office.yaml:", ("input", "-o")),
        (["track.csv", "-o", "no/w.yaml"], "no/w.yaml:", ("no folder no",)),
        (["track.csv", "-o", "w.txt"], "w.txt:", (".yaml",)),
        (["nothing.csv", "-o", "w.yaml"], "nothing.csv:", ("no such file",)),
        (["track.csv", "-o", "w.yaml", "--format", "svg"], "track.csv:1:", ("not valid XML",)),
        (
            ["track.csv", "-o", "w.yaml", "--robots", "0"],
            "--robots 0:",
            ("whole number", "from 1 to 10000"),
        ),
        (["track.csv", "-o", "w.yaml", "--robot", "1"], "--robot 1:", ("LENGTH,WIDTH", "[m]")),
        (["track.csv", "-o", "w.yaml", "--from", "1;2"], "--from 1;2:", ("X,Y", "[m]")),
        (
            ["track.csv", "-o", "w.yaml", "--scale", "nan"],
            "--scale nan:",
            ("number", "greater than 0"),
        ),
        (["track.csv"], "physim import:", ("-o/--output", "missing")),
    ],
)
def test_bad_input_writes_nothing(
    arguments: list[str],
    place: str,
    parts: tuple[str, ...],
    here: Path,
    capture: pytest.CaptureFixture[str],
) -> None:
    before = sorted(p.name for p in here.iterdir())
    done = physim("import", *arguments, capture=capture)
    assert done.code == 2
    assert done.out == ""
    check_error(done.err, place, *parts)
    assert sorted(p.name for p in here.iterdir()) == before


def test_names_from_outside_are_only_names(here: Path, capture: pytest.CaptureFixture[str]) -> None:
    """Quotes, HTML, colons and line breaks in names of files and robots."""
    walls = '<path id="boundary" d="M 0,0 24,0 24,14 0,14 Z"/>'
    names = ["a: b", "no", "../../x", "&lt;b&gt;&quot;", "1e3", "tab&#9;tab", "- x", "#", "ü"]
    robots = "".join(
        f'<rect x="{1 + 2.4 * k}" y="6" width="1.8" height="1" inkscape:label="robot {name}"/>'
        for k, name in enumerate(names)
    )
    source = here / 'o"d: #d <b>.svg'
    source.write_text(svg(walls + robots + '<path id="path" d="M 1,6.5 H 22"/>'))
    done = physim("import", source, "-o", "w.yaml", "--scale", "1", capture=capture)
    assert (done.code, done.err) == (0, "")
    world = load_world(here / "w.yaml")
    assert world.name == 'o"d: #d <b>'
    assert [robot.name for robot in world.robots][:5] == ["a: b", "no", "../../x", '<b>"', "1e3"]
    assert len(world.robots) == len(names)


def test_what_the_check_says_of_the_world_is_told(
    here: Path, capture: pytest.CaptureFixture[str]
) -> None:
    """A robot drawn at the end of the path, where it has arrived before it moves."""
    (here / "d.svg").write_text(
        svg(
            '<path id="boundary" d="M 0,0 24,0 24,14 0,14 Z"/><path id="path" d="M 3,7 H 18"/>'
            '<rect id="robot" x="19" y="6.5" width="1.8" height="1"/>'
        )
    )
    done = physim("import", "d.svg", "-o", "w.yaml", "--scale", "1", capture=capture)
    assert (done.code, done.err) == (0, "")
    _, told = done.out.split("\ntried for ")
    warning = told.splitlines()[1].removeprefix("warning: ")
    assert warning.startswith("w.yaml:")
    assert re.search(facts("15.00 m", "at or past", "stop station"), warning)
    checked = physim("check", "w.yaml", capture=capture)
    assert warning in checked.out
    physim("import", "hall.svg", "-o", "v.yaml", "--scale", "0.1", "--quiet", capture=capture)
    assert "no warnings" in physim("check", "v.yaml", capture=capture).out
    done = physim("import", "hall.svg", "-o", "u.yaml", "--scale", "0.1", capture=capture)
    assert "u.yaml: no errors, no warnings" in done.out


def test_formats_of_the_command_line_are_those_of_the_import() -> None:
    OFFERED = get_args(inside("physim.cli", "Format"))

    assert tuple(FORMATS) == OFFERED


HALL = """
<rect id="boundary" width="30" height="18"/><path id="path_a" d="M 3 2 H 15"/>
<rect id="robot_a" x="2.5" y="1.6" width="1.2" height="0.8"/>
"""
BLOCKED = """
<path id="path_b" d="M 25 15 V 2 H 4"/><rect id="robot_b" x="24.6" y="13" width="0.8" height="1.2"/>
"""


@pytest.mark.parametrize(
    ("shapes", "says"),
    [
        (HALL, "all robots arrive; no contact"),
        (HALL + BLOCKED, "1 of 2 robots does not arrive"),  # a stands in its way
    ],
)
def test_the_world_made_is_driven_once(
    shapes: str, says: str, here: Path, capture: pytest.CaptureFixture[str]
) -> None:
    (here / "d.svg").write_text(svg(shapes))
    done = physim(
        "import", "d.svg", "-o", "w.yaml", "--scale", "1", "--no-formation", capture=capture
    )
    assert done.code == 0
    line = next(one for one in done.out.splitlines() if one.startswith("tried for "))
    assert says in line, done.out
    again = ("import", "d.svg", "-o", "w.yaml", "--scale", "1", "--force")
    assert "tried" not in physim(*again, "--no-run", capture=capture).out
    assert "tried" not in physim(*again, "--quiet", capture=capture).out
