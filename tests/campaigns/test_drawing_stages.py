"""A stage that draws by the seed makes runs of several seeds differ, in any world."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from tests.campaigns.samples import FIXED, rows_in
from tests.cli.commands import physim
from tests.helpers.packages import install

pytestmark = pytest.mark.usefixtures("in_process")

TEXT = '''
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
    install(package, monkeypatch, "drawn_gains", TEXT, {"physim.disturbances": {"gains": "Gains"}})
    monkeypatch.setenv("PYTHONPATH", str(package))
    (here / "drawn.yaml").write_text(FIXED + "disturbances: [{type: gains}]\n")
    return here


def test_a_sweep_runs_every_seed(drawn: Path, capsys: pytest.CaptureFixture[str]) -> None:
    done = physim("sweep", "drawn.yaml", "--seeds", "1:4", "-o", "out", capture=capsys)
    assert done.code == 0, done.err
    rows = rows_in(drawn / "out")
    assert [row.seed for row in rows] == [1, 2, 3]
    assert len({row.shortest_distance for row in rows}) == 3
    assert "gains" in done.err  # whether it draws is not known


def test_rows_of_two_codes_of_a_stage_are_not_mixed(
    drawn: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As for a controller; other rows would stand in one cell and be taken for one sample."""
    assert physim("sweep", "drawn.yaml", "--seeds", "1:3", "-o", "out", capture=capsys).code == 0
    (module,) = (drawn / "package").glob("*.py")
    module.write_text(TEXT.replace("0.5, 1.0", "0.9, 1.0"))
    again = physim("sweep", "drawn.yaml", "--seeds", "1:5", "-o", "out", capture=capsys)
    assert again.code == 2
    assert "stage" in again.err
    assert len(rows_in(drawn / "out")) == 2
    replayed = physim("replay", "out:0", "-o", "again", capture=capsys)
    assert replayed.code == 2
    assert "source of gains" in replayed.err
    module.write_text(TEXT)
    done = physim("sweep", "drawn.yaml", "--seeds", "1:4", "-o", "out", capture=capsys)
    assert done.code == 0, done.err
    assert len(rows_in(drawn / "out")) == 3


def test_a_stage_that_was_changed_is_told_though_the_controllers_differ(
    drawn: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its effect would be taken for that of the controllers."""
    (module,) = (drawn / "package").glob("*.py")
    sweep = ("sweep", "drawn.yaml", "--seeds", "1:3", "--controller")
    assert physim(*sweep, "constant", "-o", "a", capture=capsys).code == 0
    assert physim(*sweep, "path_following", "-o", "same", capture=capsys).code == 0
    module.write_text(TEXT.replace("0.5, 1.0", "0.9, 1.0"))
    assert physim(*sweep, "path_following", "-o", "b", capture=capsys).code == 0
    told = {}
    for other in ("same", "b"):
        done = physim("compare", "a", other, "--json", "-", capture=capsys)
        told[other] = json.loads(done.out)["comparisons"][0]["unlike"]
    assert told["same"] == []
    assert "source of gains was changed" in told["b"][0]
