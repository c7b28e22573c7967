from __future__ import annotations

import os

import pytest
import yaml
from hypothesis import given

from physim.world import World
from physim.world.file import read_document
from tests.helpers import examples
from tests.world.strategies import worlds
from tests.world.test_model import values


def read(text: str) -> World:
    return World(**read_document(text).values)


@examples(25, deep=200)
@given(worlds())
def test_text_reads_back_equal(world):
    assert read(world.to_yaml()) == world


@examples(25, deep=100)
@given(worlds())
def test_other_readers_take_the_text_alike(world):
    assert World(**yaml.safe_load(world.to_yaml())) == world


@pytest.mark.parametrize(
    "name",
    ["yes", "No", "on", "OFF", "true", "False", "null", "y", "N", "nan", "inf", "1e5", "0x1f", "~",
     "1_000", "12:30:00", "2001-01-01", "a: b", "- a", "#a", "'a'", '"a"', "=", "<<", "*a", "&a"],
)  # fmt: skip
def test_a_name_that_looks_like_something_else_stays_a_name(name):
    """For this reader and for others, some of which take yes and no for truth values."""
    text = World(**values(name=name)).to_yaml()
    assert read(text).name == name
    assert yaml.safe_load(text)["name"] == name


def test_text_has_units_and_short_lines():
    line = [[float(k), 0.25 * k] for k in range(300)]
    world = World(**values(reference_path=line))
    text = world.to_yaml()
    assert "  step: 0.01  # [s]\n" in text
    assert max(len(row) for row in text.splitlines()) <= 100
    assert read(text) == world


def test_save_is_whole_or_nothing(tmp_path):
    world = World(**values())
    path = tmp_path / "a.yaml"
    world.save(path)
    assert read(path.read_text()) == world
    world.changed(seed=5).save(str(path))
    assert read(path.read_text()).seed == 5
    assert os.listdir(tmp_path) == ["a.yaml"]
