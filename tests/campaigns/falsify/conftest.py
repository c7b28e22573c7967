"""Kernels are compiled before any command runs, so that none says that it compiles."""

from __future__ import annotations

import pytest

from physim import build_scene
from physim.world.file import parse_world
from tests.cli.commands import SMALL
from tests.helpers import inside

warm_up = inside("physim.simulation", "warm_up")


@pytest.fixture(scope="session", autouse=True)
def _warm() -> None:
    warm_up(build_scene(parse_world(SMALL)))
