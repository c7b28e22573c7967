"""A row again: the same record bit for bit, or a refusal that says what differs."""

from __future__ import annotations

import resource
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from physim.campaigns import RunSpec
from physim.record import Record
from tests.campaigns.samples import rows_in
from tests.cli.commands import physim
from tests.helpers import inside

simulation_of = inside("physim.campaigns", "simulation_of")
record_run = inside("physim.simulation", "record_run")

SWEEP = (
    "sweep", "small.yaml", "--seeds", "0:2", "--controller", "awkward:Awkward", "--workers", "1",
    "--set", "controller.how=fine,raise", "--keep", "all", "-o", "out",
)  # fmt: skip

ROOM = 40_000
"""[bytes] for a file: the start of a record has room, the whole has not"""


@pytest.fixture
def swept(here: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    done = physim(*SWEEP, capture=capsys)
    assert done.code == 0, done.err
    return here


def again(*arguments: str, capture: pytest.CaptureFixture[str]):
    return physim("replay", *arguments, "--controller", "awkward:Awkward", capture=capture)


def test_the_same_record_and_its_video(swept: Path, capsys: pytest.CaptureFixture[str]) -> None:
    row = rows_in(swept / "out")[1]
    done = again("out:1", "-o", "again", capture=capsys)
    assert done.code == 0, done.err
    with (
        Record.load(swept / "again/record.h5") as made,
        Record.load(swept / "out" / row.record) as kept,
    ):
        assert made.digest() == kept.digest() == row.digest
    assert (swept / "again/video.mp4").stat().st_size > 1000
    done = again(f"out:{row.run[:12]}", "-o", "b", "--no-video", capture=capsys)
    assert done.code == 0
    with Record.load(swept / "b/record.h5") as made:
        assert made.digest() == row.digest


def test_a_run_that_failed_has_a_record_so_far(
    swept: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    done = again("out:2", "-o", "again", "--no-video", capture=capsys)
    assert done.code == 0
    assert "as it was told" in done.err
    with Record.load(swept / "again/record.h5") as made:
        assert made.ended == "error"
        assert made.samples > 5


def test_a_row_that_was_changed_is_found_out(
    swept: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for file in (swept / "out/rows").iterdir():
        lines = file.read_text()
        row = rows_in(swept / "out")[0]
        file.write_text(lines.replace(row.digest, "0" * 64))
    done = again("out:0", "-o", "again", "--no-video", capture=capsys)
    assert done.code == 3
    assert "NOT THE SAME" in done.err


def test_what_would_not_be_the_same_is_refused(
    swept: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    done = physim("replay", "out:0", capture=capsys)
    assert done.code == 2
    assert "--controller awkward:Awkward" in done.err
    with monkeypatch.context() as patched:
        patched.setattr("physim.campaigns.replay.__version__", "9.9")
        done = again("out:0", capture=capsys)
    assert done.code == 2
    assert "9.9" in done.err
    helper = (swept / "helper.py").read_text()
    (swept / "helper.py").write_text(helper + "# changed\n")
    done = again("out:0", capture=capsys)
    assert done.code == 2
    assert "source of awkward:Awkward" in done.err
    (swept / "helper.py").write_text(helper)
    (world,) = {row.world_hash for row in rows_in(swept / "out") if "fine" in row.settings}
    file = swept / f"out/worlds/{world}.yaml"
    file.write_text(file.read_text().replace("1.8", "1.7"))
    done = again("out:0", capture=capsys)
    assert done.code == 2
    assert "was changed" in done.err
    assert not (swept / "runs").exists()


@pytest.mark.parametrize(
    ("which", "text"),
    [
        ("out", "DIR:ROW"),
        (":1", "DIR:ROW"),
        ("nowhere:0", "no campaign"),
        ("out/results.parquet:0", "a campaign is a folder"),
        ("out:4", "0 to 3"),
        ("out:", "digits"),
        ("out:zz", "no run"),
    ],
)
def test_rows_that_are_not_there(
    swept: Path, capsys: pytest.CaptureFixture[str], which: str, text: str
) -> None:
    done = physim("replay", which, capture=capsys)
    assert done.code == 2
    assert text in done.err
    assert len(done.err.strip().splitlines()) == 1


def test_no_row_says_where_outside_its_folder_a_record_goes() -> None:
    from physim.cli.replay import usual_folder

    for world in ("../../out", "/tmp/out", "a\0b", "..", "two words"):
        folder = usual_folder(world, 3, "0123456789abcdef0123")
        assert folder.parent == Path("runs")
        assert folder.name.replace("-", "").replace("_", "").isalnum()


def test_a_run_that_breaks_off_here_is_told_so_and_no_figures(
    swept: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def killed(spec: RunSpec, path: Path, stop: object) -> str:
        record_run(simulation_of(spec), path=path, stop=lambda: True).close()
        return "its process was killed"

    monkeypatch.setattr("physim.campaigns.replay.replay", killed)
    done = again("out:1", "-o", "again", "--no-video", capture=capsys)
    assert (done.code, done.err.count("\n")) == (3, 1), done.err
    assert "its process was killed" in done.err


@pytest.mark.parametrize("row", [0, 2])
def test_a_disk_that_fills_says_nothing_of_the_run(
    swept: Path, capsys: pytest.CaptureFixture[str], row: int
) -> None:
    """Neither of one that ended well nor of one that failed there."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (ROOM, limits[1]))
    try:
        done = again(f"out:{row}", "-o", "again", "--no-video", capture=capsys)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert (done.code, done.err) == (2, "again/record.h5: cannot be written: File too large\n")


def test_a_report_says_how_runs_of_a_controller_of_ones_own_are_drawn(
    swept: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for record in Path("out/records").iterdir():
        record.unlink()
    assert physim("report", "out", "--quiet", capture=capsys).code == 0
    page = Path("out/report.html")
    assert "physim report out --controller awkward:Awkward" in page.read_text(encoding="utf-8")
    given = ("report", "out", "--quiet", "--controller", "awkward:Awkward")
    assert physim(*given, capture=capsys).code == 0
    assert "physim report out --controller" not in page.read_text(encoding="utf-8")
    assert any(Path("out/stills").iterdir())


def test_an_interrupt_before_the_first_step_is_one(
    swept: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    @contextmanager
    def interrupted() -> Iterator[Callable[[], bool]]:
        yield lambda: True

    monkeypatch.setattr("physim.cli.replay.interrupts", interrupted)
    done = again("out:0", "-o", "again", capture=capsys)
    assert not (swept / "again/record.h5").exists()
    assert done.code == 130
    assert "interrupted" in done.err
    assert "nothing was recorded" not in done.err
