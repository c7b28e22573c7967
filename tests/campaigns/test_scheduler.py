"""Schedulers that are none: one message, soon, and nothing left that goes on."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import ClassVar

import pytest

from physim.campaigns import executors
from physim.errors import PhysimError
from tests.cli.commands import shell, tree
from tests.helpers import check_error, facts


@pytest.fixture
def silent() -> Iterator[str]:
    """Address of somebody who takes connections and says nothing."""
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen(20)
        yield f"tcp://127.0.0.1:{server.getsockname()[1]}"


def check(here: Path, address: str, place: str, *said: str) -> None:
    before = tree(here)
    done = shell("sweep", "small.yaml", "--scheduler", address, folder=here)
    assert (done.code, done.out) == (2, "")
    check_error(done.err, place, *said)
    assert tree(here) == before


@pytest.mark.parametrize("address", ["foo", "http://127.0.0.1:80", "tcp://127.0.0.1:99999", ""])
def test_what_is_no_address_is_told(here: Path, address: str) -> None:
    check(here, address, f"--scheduler {address!r}:", "HOST:PORT")


def test_nobody_is_there(here: Path) -> None:
    check(here, "tcp://127.0.0.1:1", "--scheduler tcp://127.0.0.1:1:")


def test_no_answer_in_time(here: Path, silent: str) -> None:
    check(here, silent, f"--scheduler {silent}:", "5 s")


def test_what_is_no_scheduler_is_told(silent: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """As the address of a worker."""

    async def kind(address: str) -> str:
        return "Worker"

    def taken(*_: object, **more: object) -> None:
        raise AssertionError("it was taken")

    monkeypatch.setattr(executors, "_kind", kind)
    monkeypatch.setattr("distributed.Client", taken)
    with (
        pytest.raises(PhysimError, match=facts(silent, "Worker", "scheduler")),
        executors.executor(scheduler=silent),
    ):
        raise AssertionError("it was taken")


def test_a_notebook_can_ask(silent: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its event loop runs already, in the thread that asks."""

    async def kind(address: str) -> str:
        return "Scheduler"

    async def cell() -> None:
        executors._check_scheduler(silent)

    monkeypatch.setattr(executors, "_kind", kind)
    with ThreadPoolExecutor(1) as aside:  # browser tests leave a loop in this thread
        aside.submit(asyncio.run, cell()).result()


def test_workers_of_another_version_are_refused() -> None:
    """Of two workers the second would do other runs than this machine."""
    same = executors.versions()

    class Client:
        found: ClassVar = {"tcp://a:1": list(same), "tcp://b:2": ["0.0.1", same[1]]}

        def run(self, ask: Callable[[], tuple[str, str]]) -> dict[str, list[str]]:
            assert ask() == same
            return self.found

    with pytest.raises(PhysimError, match=facts("tcp://b:2", "0.0.1", same[0])):
        executors._check_versions("tcp://s:3", Client())
    Client.found = {"tcp://a:1": list(same)}
    executors._check_versions("tcp://s:3", Client())
