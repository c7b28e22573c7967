"""A folder with a world and a controller, worker processes, and the same work in this process."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import pytest

from physim.campaigns import Processes
from physim.errors import PhysimError
from tests.campaigns.samples import write
from tests.helpers import inside

Job = inside("physim.campaigns", "Job")


@pytest.fixture(scope="module")
def two() -> Iterator[Processes]:
    made = Processes(2)
    yield made
    made.shutdown(cancel_futures=True)


@pytest.fixture
def in_process(monkeypatch: pytest.MonkeyPatch) -> Processes:
    """Every job is done at once, in this process: for whatever is no question of processes."""
    halted: list[Processes] = []

    def begin(self: Processes, job: Job) -> Future[Any]:
        done: Future[Any] = Future()
        try:
            done.set_result(job.do(lambda: self in halted))
        except OSError as error:
            done.set_exception(PhysimError(f"{job.note}: {error.strerror}"))
        except Exception as error:
            done.set_exception(error)
        return done

    monkeypatch.setattr(Processes, "begin", begin)
    monkeypatch.setattr(Processes, "halt", lambda self: halted.append(self))
    return Processes(2)


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    write(tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    for name in ("awkward", "helper"):  # those of another test's folder
        monkeypatch.delitem(sys.modules, name, raising=False)
    return tmp_path
