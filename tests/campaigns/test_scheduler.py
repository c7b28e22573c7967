"""Dask: its workers do the same runs as processes here; what is no scheduler is told, soon."""

from __future__ import annotations

import json
import re
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from physim.errors import PhysimError
from tests.campaigns.samples import rows_in, without_times
from tests.cli.commands import physim, shell, tree
from tests.helpers import check_error, facts, inside

executor, versions = inside("physim.campaigns", "executor", "versions")

GRID = (
    "sweep", "small.yaml", "--seeds", "0:4", "--controller", "awkward:Awkward",
    "--set", "controller.how=fine,raise,exit",
)  # fmt: skip


@pytest.fixture
def silent() -> Iterator[str]:
    """Address of somebody who takes connections and says nothing."""
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen(20)
        yield f"tcp://127.0.0.1:{server.getsockname()[1]}"


@pytest.mark.parametrize("address", ["http://127.0.0.1:80", "tcp://127.0.0.1:99999", "", "silent"])
def test_what_is_no_scheduler_is_told_and_nothing_is_written(
    here: Path, silent: str, address: str, capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.setattr("physim.campaigns.cluster.CONNECT_SECONDS", 1)
    before = tree(here)
    given = silent if address == "silent" else address
    done = physim("sweep", "small.yaml", "--scheduler", given, capture=capsys)
    assert (done.code, done.out) == (2, "")
    if address == "silent":
        check_error(done.err, f"--scheduler {given}:", "1 s")
    else:
        check_error(done.err, f"--scheduler {given!r}:", "HOST:PORT")
    assert tree(here) == before


def test_workers_of_another_version_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of two workers the second would do other runs than this."""
    ours = list(versions())

    def client(*_: object, **more: object) -> Any:
        made: Any = nullcontext(SimpleNamespace())
        made.wait_for_workers = lambda *_, **more: None
        made.run = lambda ask: {"tcp://a:1": ours, "tcp://b:2": ["0.0.1", ours[1]]}
        return made

    async def scheduler(_: str) -> str:
        return "Scheduler"

    monkeypatch.setattr("physim.campaigns.cluster._kind", scheduler)
    monkeypatch.setattr("distributed.Client", client)
    told = facts("tcp://b:2", "0.0.1", ours[0])
    with pytest.raises(PhysimError, match=told), executor(scheduler="tcp://a:1"):
        raise AssertionError("it was taken")


@pytest.fixture
def cluster(
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """A scheduler and two workers, in a folder where there is no controller: address, process."""
    folder = tmp_path_factory.mktemp("cluster")
    file = folder / "scheduler.json"
    common = ["--host", "127.0.0.1", "--no-dashboard", "--scheduler-file", str(file)]
    worker = ["distributed.cli.dask_worker", "--nthreads", "1"]
    programs = [["distributed.cli.dask_scheduler", "--port", "0"], worker, [*worker, "--no-nanny"]]
    processes: list[subprocess.Popen[bytes]] = []
    try:
        for program in programs:
            command = [sys.executable, "-m", *program, *common]
            log = (folder / "log").open("a")
            processes.append(subprocess.Popen(command, cwd=folder, stderr=log))
            while not file.exists():
                assert processes[0].poll() is None, (folder / "log").read_text()
                time.sleep(0.1)
        yield json.loads(file.read_text())["address"], processes[0]
    finally:
        for process in reversed(processes):
            process.terminate()
        for process in processes:
            try:
                process.wait(30)
            except subprocess.TimeoutExpired:
                process.kill()


def nameless(text: str) -> str:
    """Text without the folder in which a worker has the controller."""
    return re.sub(r"/\S+/awkward.py", "awkward.py", text)


@pytest.mark.deep
def test_rows_are_those_of_the_local_run(
    here: Path, cluster: tuple[str, subprocess.Popen[bytes]]
) -> None:
    far = shell(*GRID, "--scheduler", cluster[0], "-o", "far", "--keep", "all", folder=here)
    assert far.code == 0, far.err
    near = shell(*GRID, "--workers", "2", "-o", "near", "--keep", "all", folder=here)
    assert near.code == 0, near.err
    assert nameless(far.out.replace("far", "near")) == nameless(near.out)
    rows = rows_in(here / "near")
    there, here_ = (without_times(one) for one in (rows_in(here / "far"), rows))
    assert nameless(json.dumps(there)) == nameless(json.dumps(here_))
    assert [row.ended for row in rows] == ["killed"] * 4 + ["duration"] * 4 + ["error"] * 4
    kept = sorted(file.name for file in (here / "far/records").iterdir())
    assert kept == sorted(f"{row.run}.h5" for row in rows if row.ended == "duration")
