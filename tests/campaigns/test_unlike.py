"""Two campaigns are compared by names: what else differs between them is told."""

from __future__ import annotations

import json
from pathlib import Path
from unittest.mock import Mock

import pytest

from physim.campaigns import Folder, read, run_one, spec_of
from physim.errors import PhysimError
from physim.world.file import parse_world
from tests.campaigns.samples import WORLD
from tests.cli.commands import physim
from tests.helpers import inside

between, compare, Cell = inside("physim.campaigns", "between", "compare", "Cell")
Outcomes, with_unlike = inside("physim.campaigns", "Outcomes", "with_unlike")
remake = inside("physim.campaigns.report", "remake")

Capture = pytest.CaptureFixture[str]


def swept(folder: str, capsys: Capture, *arguments: str, text: str = WORLD) -> None:
    Path("small.yaml").write_text(text)
    done = physim(
        "sweep", "small.yaml", "--seeds", "0:3", "--quiet", "-o", folder, *arguments, capture=capsys
    )
    assert done.code == 0, done.err


def unlike(a: str, b: str, capsys: Capture) -> list[str]:
    done = physim("compare", a, b, "--json", "-", capture=capsys)
    assert done.code == 0, done.err
    (one,) = json.loads(done.out)["comparisons"]
    told: list[str] = one["unlike"]
    said = physim("compare", a, b, "-o", "page.html", "--force", capture=capsys).out
    assert said.count("note:") == len(told) == Path("page.html").read_text().count("Note:")
    return told


pytestmark = pytest.mark.usefixtures("here", "in_process")


def test_a_world_that_was_changed_between_two_campaigns_is_told(capsys: Capture) -> None:
    longer = WORLD.replace("duration: 1.0", "duration: 1.4").replace("width: 8.0", "width: 7.0")
    swept("a", capsys, "--controller", "mode_switching")
    swept("b", capsys, "--controller", "path_following", text=longer)
    swept("c", capsys, "--controller", "path_following")
    (told,) = unlike("a", "b", capsys)
    assert "time.duration 1.0 in A, 1.4 in B" in told
    assert "corridor.width 8.0 in A, 7.0 in B" in told
    assert "controller" not in told
    assert unlike("a", "c", capsys) == []
    assert unlike("b", "b", capsys) == []


def test_what_the_settings_give_is_no_news(capsys: Capture) -> None:
    swept("a", capsys, "--set", "time.duration=0.8", "--set", "robots[0].path.offset=0.9")
    swept("b", capsys)
    assert unlike("a", "b", capsys) == []


def test_a_controller_that_was_changed_between_two_campaigns_is_told(capsys: Capture) -> None:
    swept("a", capsys, "--controller", "awkward:Awkward")
    Path("helper.py").write_text("SPEED = 0.6\n")
    swept("b", capsys, "--controller", "awkward:Awkward")
    (told,) = unlike("a", "b", capsys)
    assert "source of awkward:Awkward" in told


def test_another_version_is_told(capsys: Capture) -> None:
    """The rows of the older one are made up: runs of another version are refused otherwise."""
    swept("a", capsys)
    folder = Folder("a")
    (cell,) = folder.cells()
    older = Mock(wraps=folder, cells=lambda: [{**cell, "physim": "0.0.9", "engine": "pymunk 6.0"}])
    outcomes = Outcomes(read("a"))
    (one,) = with_unlike(compare(between(outcomes, outcomes, ("a", "b"))), older, folder)
    assert one.unlike == (
        f"A was run by physim 0.0.9, B by physim {cell['physim']}",
        f"A was run by pymunk 6.0, B by {cell['engine']}",
    )


@pytest.mark.parametrize("text", ["5", "{name: w, name: v}"])
def test_what_is_no_world_is_refused(capsys: Capture, text: str) -> None:
    """A campaign of a stranger: its world's file may hold anything, under the right name."""
    swept("a", capsys)
    swept("b", capsys, text=WORLD.replace("width: 8.0", "width: 7.0"))
    (file,) = Path("b/worlds").iterdir()
    file.write_text(text)
    done = physim("compare", "a", "b", capture=capsys)
    assert (done.code, str(file) in done.err) == (2, True), done.err


def test_words_alone_are_no_news_and_long_values_are_cut(capsys: Capture) -> None:
    robot = WORLD.replace("- name: a", f"- name: {'w' * 60}")
    swept("a", capsys)
    swept("b", capsys, text=f"{WORLD}description: second\n")
    swept("c", capsys, text=robot)
    assert unlike("a", "b", capsys) == []
    (told,) = unlike("a", "c", capsys)
    assert f"robots.0.name a in A, {'w' * 39}… in B" in told


LEARNED = """
from pathlib import Path

import physim
from pydantic import BaseModel


class Layer(BaseModel):
    weights: Path = Path("net.txt")


class Weights(BaseModel):
    layers: list[Layer] = [Layer()]


class Learned:
    Settings = Weights

    def __init__(self, settings):
        self.v = float(settings.layers[0].weights.read_text())

    def decide(self, observation, memory):
        return physim.Decision(self.v, 0.0, 0.1)
"""


@pytest.mark.parametrize("given", [(), ("--set", 'controller.layers=[{"weights": "net.txt"}]')])
def test_a_file_that_settings_name_is_part_of_what_a_run_is(
    capsys: Capture, monkeypatch: pytest.MonkeyPatch, given: tuple[str, ...]
) -> None:
    """A network that is trained again is another: no cell holds runs of both.

    Whether the world names it, or the settings do by their defaults.
    """
    monkeypatch.syspath_prepend(Path.cwd())
    Path("learned.py").write_text(LEARNED)
    given = ("--controller", "learned:Learned", *given)
    Path("net.txt").write_text("0.5")
    swept("a", capsys, *given)
    swept("a", capsys, *given)
    Path("net.txt").write_text("0.6")
    done = physim("sweep", "small.yaml", "--seeds", "0:4", "-o", "a", *given, capture=capsys)
    assert done.code == 2
    assert "a file they name" in done.err
    done = physim("replay", "a:0", "--controller", "learned:Learned", capture=capsys)
    assert "would not be the same again" in done.err
    swept("b", capsys, *given)
    (told,) = unlike("a", "b", capsys)
    assert "learned:Learned was changed" in told
    Path("other.txt").write_text("0.7")
    other = ("--set", 'controller.layers=[{"weights": "other.txt"}]')
    swept("c", capsys, *given[:2], *other)
    (told,) = unlike("b", "c", capsys)
    assert "is not known" in told  # what is compared is the file


def test_a_file_that_is_changed_during_a_sweep_makes_no_rows_of_two(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.syspath_prepend(Path.cwd())
    Path("learned.py").write_text(LEARNED)
    Path("net.txt").write_text("0.5")
    world = parse_world(WORLD, controller="learned:Learned")
    runs = [spec_of(world, seed) for seed in range(2)]
    assert run_one(runs[0]).reason == ""
    Path("net.txt").write_text("0.6")
    row = run_one(runs[1])
    assert row.ended == "error"
    assert "net.txt, which its settings name, was changed" in str(row.reason)
    Path("net.txt").unlink()
    assert "was changed" not in str(run_one(runs[1]).reason)


def test_a_run_made_again_for_its_picture_is_the_run_of_its_row(capsys: Capture) -> None:
    """Not so of a controller that draws numbers of its own, or reads a file that was changed."""
    swept("a", capsys)
    row = Outcomes(read("a")).row(0)
    remake(Path("a"), row).close()
    nearer = {**row, "shortest_distance": row["shortest_distance"] - 0.1}
    with pytest.raises(PhysimError, match="another run: shortest_distance"):
        remake(Path("a"), nearer)
