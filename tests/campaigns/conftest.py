"""Two worker processes for all tests of a file, and a folder with a world and a controller."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from physim.campaigns import Processes
from tests.campaigns.samples import write
from tests.helpers import inside

Carried = inside("physim.campaigns", "Carried")


@pytest.fixture(scope="module")
def two() -> Iterator[Processes]:
    made = Processes(2)
    yield made
    made.shutdown(cancel_futures=True)


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    write(tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    for name in ("awkward", "helper"):  # those of another test's folder
        monkeypatch.delitem(sys.modules, name, raising=False)
    leave_out_carried()
    yield tmp_path
    leave_out_carried()


def leave_out_carried() -> None:
    """In place: what a package that a test imports has put there must stay."""
    sys.meta_path[:] = [one for one in sys.meta_path if not isinstance(one, Carried)]
