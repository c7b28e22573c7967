"""What is said of packages that register parts wrongly: class, settings, module, group, name."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from physim.errors import ControllerError
from tests.helpers import facts, inside
from tests.helpers.packages import install

FILTER, find_part, make_part = inside("physim.parts", "FILTER", "find_part", "make_part")

TEXT = """
from pydantic import BaseModel

class Needs:
    def __init__(self, settings):
        self.settings = settings
    def start(self, scene): ...
    def filter(self, scene, sensed, nominal, state): ...

class Bare:
    class Settings(BaseModel):
        gain: float = 1.0
    def start(self, scene): ...
    def filter(self, scene, sensed, nominal, state): ...

class Told:
    class Settings(BaseModel):
        every: float
    def __init__(self, settings):
        self.settings = settings
    def start(self, simulation): ...
    def after_step(self, step): ...
    def close(self, ended): ...
    def draw(self, record): ...

class Usual(Told):
    class Settings(BaseModel):
        every: float = 3.0
"""


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A package that registers much; the name of its module."""
    name = f"registers_{tmp_path.name.replace('-', '_')}"
    install(tmp_path, monkeypatch, name, TEXT, {
        "physim.filters": {"needs": "Needs", "bare": "Bare"},
        "physim.observers": {"told": "Told", "usual": "Usual"},
        "physim.plots": {"told": "Told", "usual": "Usual"},
        "physim.filter": {"forgotten": "Needs"},
    })  # fmt: skip
    return name


@pytest.fixture(autouse=True)
def _registered() -> None:
    """In place of the names that the other tests of this folder see: those that are installed."""


@pytest.mark.parametrize(
    ("name", "parts", "line"),
    [
        ("needs", ("class Needs", "no Settings", "Needs()"), 5),
        ("bare", ("class Bare", "has Settings", "Bare(settings)"), 10),
    ],
)
def test_a_class_that_does_not_go_with_its_settings(
    name: str, parts: tuple[str, ...], line: int, module: str
) -> None:
    with pytest.raises(ControllerError) as caught:
        make_part(FILTER, name, {})
    assert re.search(facts("filter", f'"{name}"', "cannot be made", *parts), str(caught.value))
    assert str(caught.value).endswith(f"{module}.py:{line})")


@pytest.mark.parametrize(
    ("name", "told"), [("told", '"told" is an observer'), ("haze_of_none", '"physim.filters"')]
)
def test_a_name_of_another_kind_or_of_none(name: str, told: str, module: str) -> None:
    with pytest.raises(ControllerError, match=told):
        find_part(FILTER, name)


def test_a_group_that_is_none_is_told(module: str) -> None:
    with pytest.raises(
        ControllerError, match=facts('"physim.filter"', "no group", '"physim.filters"')
    ):
        find_part(FILTER, "forgotten")
