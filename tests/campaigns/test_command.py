"""``physim sweep`` as a user types it: killed, interrupted, twice at once, with bad input."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd
import pytest

from physim.campaigns import Folder
from tests.campaigns.samples import lines_on_disk, rows_in, without_times
from tests.cli.commands import Done, physim, shell, started, tree
from tests.helpers import check_error, facts, inside

make_grid = inside("physim.campaigns", "make_grid")


def begun(folder: Path, process: subprocess.Popen[str], rows: int) -> None:
    """Wait until a sweep has some rows on disk."""
    while len(rows_in(folder)) < rows:
        if process.poll() is not None:
            raise AssertionError(process.communicate()[1])
        time.sleep(0.02)


def as_json(done: Done) -> dict[str, object]:
    assert done.code == 0, done.err
    found: dict[str, object] = json.loads(done.out)
    return found


COMMAND = ("sweep", "small.yaml", "--seeds", "0:90", "-o", "out", "--workers", "2", "--json")


@pytest.mark.deep
def test_killed_half_way_it_goes_on_and_repeats_nothing(here: Path) -> None:
    process = started(*COMMAND, folder=here)
    try:
        begun(here / "out", process, 20)
    finally:
        process.kill()
        process.communicate()
    kept = rows_in(here / "out")
    assert 20 <= len(kept) < 90
    found = as_json(shell(*COMMAND, folder=here))
    assert (found["there_before"], found["run_now"]) == (len(kept), 90 - len(kept))
    done = shell(*COMMAND[:5], "other", *COMMAND[6:], folder=here)
    assert as_json(done)["run_now"] == 90
    assert without_times(rows_in(here / "out")) == without_times(rows_in(here / "other"))
    assert lines_on_disk(here / "out") == 90
    assert [row for row in rows_in(here / "out") if row in kept] == kept


def most_memory(process: subprocess.Popen[str]) -> int:
    """[kB] that a process had at most."""
    status = Path(f"/proc/{process.pid}/status").read_text(encoding="ascii")
    return int(status.partition("VmHWM:")[2].split()[0])


@pytest.mark.deep
@pytest.mark.parametrize("more", [(), ("--quiet",)])
def test_interrupted_it_says_how_to_go_on(here: Path, more: tuple[str, ...]) -> None:
    wanted = ("sweep", "small.yaml", "--seeds", "0:9000000", "--yes", "-o", "out", *more)
    process = started(*wanted, folder=here)
    begun(here / "out", process, 3)
    assert most_memory(process) < 400_000  # nine million keys would take a gigabyte
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=300)
    assert process.returncode == 130
    assert len(err.splitlines()) == 1
    kept = len(rows_in(here / "out"))
    assert re.search(facts(f"{kept:,}", f"{9_000_000 - kept:,}", "the same command goes on"), err)
    assert out == "" if more else f"{kept} runs" in out
    assert (here / "out/results.csv").exists()


WITHOUT_PYARROW = """
import sys

sys.modules["pyarrow"] = None
from physim.cli import main

sys.exit(main(sys.argv[1:]))
"""


def test_without_pyarrow_all_works_but_parquet(here: Path) -> None:
    def done(*arguments: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-c", WITHOUT_PYARROW, *arguments]
        return subprocess.run(command, capture_output=True, text=True)

    sweep = ("sweep", "small.yaml", "--seeds", "0:3", "--controller", "constant,path_following",
             "-o", "out", "--workers", "1")  # fmt: skip
    refused = done(*sweep, "--parquet")
    assert refused.returncode == 2
    check_error(refused.stderr, "--parquet", "physim[study]")
    assert not (here / "out").exists()
    for command in (sweep, ("report", "out", "--no-pictures"),
                    ("compare", "out", "--by", "controller"),
                    ("replay", "out:0", "--no-video")):  # fmt: skip
        one = done(*command)
        assert one.returncode == 0, one.stderr
    assert len((here / "out/results.csv").read_text().splitlines()) == 7


@pytest.mark.usefixtures("in_process")
def test_parquet_is_written_where_it_is_asked_for(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ("sweep", "small.yaml", "--seeds", "0:3", "-o", "out")
    assert physim(*command, "--parquet", capture=capsys).code == 0
    assert pd.read_parquet(here / "out/results.parquet")["seed"].tolist() == [0, 1, 2]
    assert pd.read_csv(here / "out/results.csv")["seed"].tolist() == [0, 1, 2]


def test_two_sweeps_in_one_folder_are_refused(here: Path) -> None:
    folder = Folder("out")
    folder.open(make_grid(["small.yaml"], range(90)).cells, None, (1, 1))
    done = shell(*COMMAND, folder=here)
    assert done.code == 2
    check_error(done.err, "out:", "another sweep", "--shard")
    folder.close()


@pytest.mark.deep
def test_two_sweeps_in_one_folder_may_each_have_a_part(here: Path) -> None:
    here_ = Folder("out")
    here_.open(make_grid(["small.yaml"], range(90)).cells, None, (1, 2))
    for more in ((), ("--shard", "1/2"), ("--shard", "1/3")):
        done = shell(*COMMAND, *more, folder=here)
        assert done.code == 2
        check_error(done.err, "out:", "another sweep", "--shard")
    assert as_json(shell(*COMMAND, "--shard", "2/2", folder=here))["run_now"] == 45
    here_.close()
    assert as_json(shell(*COMMAND, folder=here))["run_now"] == 45


@pytest.mark.usefixtures("in_process")
def test_what_another_wrote_is_read_strictly_before_any_run(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ("sweep", "small.yaml", "--seeds", "0:3", "-o", "out")
    assert physim(*command, capture=capsys).code == 0
    (file,) = (here / "out/rows").iterdir()
    whole = file.read_text()
    file.write_text(whole[:-40])
    done = physim(*command, capture=capsys)
    assert done.code == 0
    assert "(2 were there before)" in done.out
    assert [row.seed for row in rows_in(here / "out")] == [0, 1, 2]
    lines = whole.splitlines()
    poisoned = json.dumps({**json.loads(lines[1]), "shortest_distance": float("nan")})
    file.write_text("\n".join([lines[0], poisoned]) + "\n")
    for one in ((*command[:3], "0:30", *command[4:]), ("report", "out"), ("replay", "out:0")):
        done = physim(*one, capture=capsys)
        assert (done.code, done.out) == (2, "")
        check_error(done.err, f"out/rows/{file.name}:2:", "shortest_distance", "nan")
    assert lines_on_disk(here / "out") == 3


@pytest.mark.usefixtures("in_process")
def test_shards_come_together(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for part in ("1/2", "2/2"):
        done = physim("sweep", "small.yaml", "--seeds", "0:5", "--shard", part, capture=capsys)
        assert done.code == 0
    assert [row.seed for row in rows_in(here / "sweeps/small")] == list(range(5))


@pytest.mark.usefixtures("in_process")
def test_a_name_leads_nowhere(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    before = tree(here)
    (here / "a/b").mkdir(parents=True)
    monkeypatch.chdir(here / "a/b")
    wanted = ("sweep", "../../fixed.yaml", "--set", "name=../../x,/x,..", "--keep", "all")
    assert physim(*wanted, capture=capsys).code == 0
    assert len(rows_in(here / "a/b/sweeps/fixed")) == 3
    assert {
        name: what for name, what in tree(here).items() if name.partition("/")[0] != "a"
    } == before


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("small.yaml", "--seeds", "0:2", "--set", "time.stop=1"), "stop"),
        (("small.yaml", "--seeds", "2:2"), "A below B"),
        (("small.yaml", "--seeds", "0:1000001"), "--yes"),
        (("small.yaml", "--shard", "3/2"), "I of N"),
        (("small.yaml", "--controller", "constant,"), "comma"),
        (("small.yaml", "--workers", "2", "--scheduler", "tcp://127.0.0.1:1"), "--scheduler"),
        (("small.yaml", "-o", "small.yaml"), "is a file"),
        (("small.yaml", "-o", "."), "no campaign"),
        (("small.yaml", "--limit", "0"), "--limit"),
    ],
)
def test_bad_input_is_one_message_and_nothing_is_written(
    here: Path, capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], text: str
) -> None:
    before = tree(here)
    done = physim("sweep", *arguments, capture=capsys)
    assert done.code == 2
    assert text in done.err
    assert len(done.err.strip().splitlines()) == 1
    assert tree(here) == before
