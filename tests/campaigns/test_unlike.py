"""Two campaigns are compared by names: what else differs between them is told."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from unittest.mock import Mock

import pytest

from physim.campaigns import Folder, read
from physim.errors import PhysimError
from tests.campaigns.samples import FIXED, WORLD, rows_in
from tests.cli.commands import physim
from tests.helpers import inside
from tests.helpers.packages import install

between, compare = inside("physim.campaigns", "between", "compare")
Outcomes, with_unlike = inside("physim.campaigns", "Outcomes", "with_unlike")
record_of = inside("physim.campaigns.report", "record_of")

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
    changed = cell.model_copy(update={"physim": "0.0.9", "engine": "pymunk 6.0"})
    older = Mock(wraps=folder, cells=lambda: [changed])
    outcomes = Outcomes(read("a"))
    (one,) = with_unlike(compare(between(outcomes, outcomes, ("a", "b"))), older, folder)
    assert one.unlike == (
        f"A was run by physim 0.0.9, B by physim {cell.physim}",
        f"A was run by pymunk 6.0, B by {cell.engine}",
    )


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
    assert "learned:Learned" in told


def test_a_run_made_again_for_its_picture_is_the_run_of_its_row(capsys: Capture) -> None:
    """Not so of a controller that draws numbers of its own, or reads a file that was changed."""
    swept("a", capsys)
    row = read("a")[0]
    record_of(Path("a"), row).close()
    nearer = replace(row, shortest_distance=row.shortest_distance - 0.1)
    with pytest.raises(PhysimError, match="another run: shortest_distance"):
        record_of(Path("a"), nearer)


# a stage that draws by the seed makes runs of several seeds differ, in any world
GAINS = '''
from physim.randomness import stream

class Gains:
    """Every robot is slower by a share of its own."""

    def start(self, scene):
        return [[stream(scene.seed, "gains", i).uniform(0.5, 1.0)] for i in range(scene.robots)]

    def disturb(self, scene, truth, filtered, state):
        return filtered * state, state
'''


@pytest.fixture
def drawn(here: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A world in which nothing is random but one disturbance."""
    package = here / "package"
    package.mkdir()
    monkeypatch.delitem(sys.modules, "drawn_gains", raising=False)  # of another test's folder
    install(package, monkeypatch, "drawn_gains", GAINS, {"physim.disturbances": {"gains": "Gains"}})
    monkeypatch.setenv("PYTHONPATH", str(package))
    (here / "drawn.yaml").write_text(FIXED + "disturbances: [{type: gains}]\n")
    return here


def test_every_seed_is_run_and_rows_of_two_codes_of_a_stage_are_not_mixed(
    drawn: Path, capsys: Capture
) -> None:
    """As for a controller; other rows would stand in one cell and be taken for one sample."""
    sweep = ("sweep", "drawn.yaml", "-o", "out", "--seeds")
    done = physim(*sweep, "1:4", capture=capsys)
    assert done.code == 0, done.err
    assert "gains" in done.err  # whether it draws is not known
    rows = rows_in(drawn / "out")
    assert [row.seed for row in rows] == [1, 2, 3]
    assert len({row.shortest_distance for row in rows}) == 3
    (module,) = (drawn / "package").glob("*.py")
    module.write_text(GAINS.replace("0.5, 1.0", "0.9, 1.0"))
    again = physim(*sweep, "1:6", capture=capsys)
    replayed = physim("replay", "out:0", "-o", "again", capture=capsys)
    assert (again.code, replayed.code) == (2, 2)
    assert "stage" in again.err
    assert "source of gains" in replayed.err
    module.write_text(GAINS)
    assert physim(*sweep, "1:5", capture=capsys).code == 0
    assert len(rows_in(drawn / "out")) == 4
