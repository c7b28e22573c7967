"""Kernels are compiled before any command runs, so that none says that it compiles."""

from __future__ import annotations

import pytest

from physim.simulation.run import warm_up
from physim.world.file import parse_world
from physim.world.layout.scene_builder import build_scene
from tests.cli.commands import SMALL


@pytest.fixture(scope="session", autouse=True)
def _warm() -> None:
    warm_up(build_scene(parse_world(SMALL)))
