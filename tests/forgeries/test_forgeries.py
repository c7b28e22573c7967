"""The forgeries, and some of the true records; ``python -m tests.forgeries`` tries all of these."""

from __future__ import annotations

import pytest

from tests.forgeries.edits import FORGERIES
from tests.forgeries.runs import UNUSUAL, make_runs
from tests.forgeries.trial import doubted, tried


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return make_runs(tmp_path_factory.mktemp("forgeries"))


def test_there_are_enough_of_them():
    names = [forgery.name for forgery in FORGERIES]
    assert len(set(names)) == len(names) >= 40


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
