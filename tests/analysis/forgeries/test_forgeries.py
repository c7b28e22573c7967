"""Every forgery is found by its words, and true records are not doubted."""

from __future__ import annotations

from pathlib import Path

import pytest

import physim
from tests.analysis.forgeries.edits import FORGERIES
from tests.analysis.forgeries.runs import RUNS, UNUSUAL
from tests.analysis.forgeries.trial import doubted, tried

ROOT = Path(__file__).parents[3]
WORLDS = ("straight", "crossing", "merging", "narrowing", "nonconvex", "u_turn", "doorway")
FAST = {
    "nobody ever near", "a distance 1 mm larger", "one rule", "a considered robot left out",
    "a decision that nobody announced", "beyond the limits", "what was applied",
    "a pose 1 mm aside", "robots swapped", "a clearance", "no contacts", "depths",
    "another friction in the world", "cut short and called finished", "arrived earlier",
    "another seed", "a wall", "other thresholds in the world", "a missing sample",
    "filtered commands beyond the limits",
}  # fmt: skip
"""of different kinds; the others are deep"""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The records by name, each made when it is first asked for."""
    folder = tmp_path_factory.mktemp("forgeries")

    class Made(dict):
        def __missing__(self, name):
            self[name] = folder / f"{name}.h5"
            RUNS[name](self[name])
            return self[name]

    return Made()


def test_the_page_says_how_many_there_are():
    names = [forgery.name for forgery in FORGERIES]
    assert len(set(names)) == len(names)
    assert set(names) > FAST
    page = (ROOT / "docs/explanation/validation.md").read_text(encoding="utf-8")
    assert f"edit records in {len(FORGERIES)} ways" in page


@pytest.mark.parametrize(
    "forgery",
    [
        pytest.param(one, id=one.name, marks=[] if one.name in FAST else pytest.mark.deep)
        for one in FORGERIES
    ],
)
def test_a_forgery_is_found_by_its_words(made, tmp_path, forgery):
    assert tried(forgery, made, tmp_path) == ""


@pytest.mark.parametrize("name", RUNS)
def test_a_true_record_is_not_doubted(made, name):
    assert doubted(made[name]) == ""


def test_simulated_again_it_is_the_same_to_the_bit(made):
    assert doubted(made["touching"]) == ""


@pytest.mark.parametrize("name", UNUSUAL)
def test_an_unusual_record_is_not_doubted(tmp_path, name):
    UNUSUAL[name](tmp_path / "record.h5")
    assert doubted(tmp_path / "record.h5") == ""


@pytest.mark.deep
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("world", WORLDS)
def test_runs_of_shipped_worlds_are_not_doubted(tmp_path, world, seed):
    path = tmp_path / "shipped.h5"
    physim.simulate(physim.load_world(world), seed=seed, path=path).close()
    assert doubted(path) == ""
