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
def scheduler(cluster: tuple[str, subprocess.Popen[bytes]]) -> str:
    """Its address."""
    return cluster[0]


@pytest.fixture
def cluster(
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """A scheduler and two workers, in a folder where there is no controller: address, process."""
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
        yield json.loads(file.read_text())["address"], processes[0]
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


def test_a_scheduler_that_goes_is_told_on_one_line_and_nothing_is_lost(
    here: Path, cluster: tuple[str, subprocess.Popen[bytes]]
) -> None:
    address, process = cluster
    command = [sys.executable, "-m", "physim", "sweep", "small.yaml", "--seeds", "0:20000"]
    sweep = subprocess.Popen(
        [*command, "--scheduler", address, "-o", "far", "--quiet"], cwd=here,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    while not rows_in(here / "far"):
        assert sweep.poll() is None
        time.sleep(0.2)
    process.kill()
    out, err = sweep.communicate(timeout=120)
    assert (sweep.returncode, out) == (2, "")
    (line,) = err.splitlines()
    assert "cluster" in line
    assert rows_in(here / "far")
