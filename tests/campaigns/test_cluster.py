"""A Dask scheduler and two workers on this machine do the same runs as its own processes."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.campaigns.samples import rows_in, without_times
from tests.cli.commands import shell

GRID = (
    "sweep", "small.yaml", "--seeds", "0:4", "--controller", "awkward:Awkward",
    "--set", "controller.how=fine,raise,exit",
)  # fmt: skip


@pytest.fixture
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a scheduler with two workers, in a folder where there is no controller."""
    folder = tmp_path_factory.mktemp("cluster")
    file = folder / "scheduler.json"
    dask = [sys.executable, "-m"]
    common = ["--host", "127.0.0.1", "--no-dashboard", "--scheduler-file", str(file)]
    programs = [
        [*dask, "distributed.cli.dask_scheduler", "--port", "0", *common],
        *(
            [*dask, "distributed.cli.dask_worker", "--nthreads", "1", *common, *more]
            for more in ((), ("--no-nanny",))
        ),
    ]
    processes = []
    try:
        for program in programs:
            processes.append(
                subprocess.Popen(program, cwd=folder, stderr=(folder / "log").open("a"))
            )
            while not file.exists():
                assert processes[0].poll() is None, (folder / "log").read_text()
                time.sleep(0.1)
        yield json.loads(file.read_text())["address"]
    finally:
        for process in reversed(processes):
            process.terminate()
        for process in processes:
            try:
                process.wait(30)
            except subprocess.TimeoutExpired:
                process.kill()


def test_rows_are_those_of_the_local_run(here: Path, scheduler: str) -> None:
    far = shell(*GRID, "--scheduler", scheduler, "-o", "far", "--keep", "all", folder=here)
    assert far.code == 0, far.err
    near = shell(*GRID, "--workers", "2", "-o", "near", "--keep", "all", folder=here)
    assert near.code == 0, near.err
    assert far.out.replace("far", "near") == near.out
    rows = rows_in(here / "near")
    assert without_times(rows_in(here / "far")) == without_times(rows)
    assert [row.ended for row in rows] == ["killed"] * 4 + ["duration"] * 4 + ["error"] * 4
    kept = sorted(file.name for file in (here / "far/records").iterdir())
    assert kept == sorted(f"{row.run}.h5" for row in rows if row.ended == "duration")
