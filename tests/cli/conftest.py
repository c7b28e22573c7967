"""Kernels are compiled before any command runs, so that none says that it compiles."""

from __future__ import annotations

from pathlib import Path

import pytest

from physim import build_scene
from physim.world.file import parse_world
from tests.cli.commands import SMALL
from tests.helpers import inside

warm_up = inside("physim.simulation", "warm_up")


@pytest.fixture(scope="session", autouse=True)
def _warm() -> None:
    warm_up(build_scene(parse_world(SMALL)))


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory with one small world, from which modules are imported."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "small.yaml").write_text(SMALL)
    return tmp_path
