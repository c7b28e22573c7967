"""The forgeries, and some of the true records; ``python -m tests.forgeries`` tries all of these."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.forgeries.edits import FORGERIES
from tests.forgeries.runs import UNUSUAL, make_runs
from tests.forgeries.trial import doubted, tried

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return make_runs(tmp_path_factory.mktemp("forgeries"))


def test_there_are_enough_of_them():
    names = [forgery.name for forgery in FORGERIES]
    assert len(set(names)) == len(names) >= 40


def test_the_page_lists_all_of_them():
    page = (ROOT / "docs" / "VALIDATION.md").read_text(encoding="utf-8")
    assert f"edits records in {len(FORGERIES)} ways" in page
    for run in ("free", "touching", "staged"):
        listed = re.search(rf"^\| {run} \| (\d+) \| (.*) \|$", page, re.M)
        assert listed is not None
        names = [forgery.name for forgery in FORGERIES if forgery.run == run]
        assert int(listed[1]) == len(names)
        assert sorted(listed[2].split("; ")) == sorted(names)


@pytest.mark.parametrize("forgery", FORGERIES, ids=lambda forgery: forgery.name)
def test_a_forgery_is_found_by_its_words(made, tmp_path, forgery):
    assert tried(forgery, made, tmp_path) == ""


@pytest.mark.parametrize("name", ["free", "touching", "staged"])
def test_a_true_record_is_not_doubted(made, name):
    assert doubted(made[name]) == ""


def test_simulated_again_it_is_the_same_to_the_bit(made):
    assert doubted(made["touching"], "--rerun") == ""


@pytest.mark.parametrize("name", UNUSUAL)
def test_an_unusual_record_is_not_doubted(tmp_path, name):
    UNUSUAL[name](tmp_path / "record.h5")
    assert doubted(tmp_path / "record.h5") == ""
