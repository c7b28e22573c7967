"""A row again: the same record bit for bit, or a refusal that says what differs."""

from __future__ import annotations

from pathlib import Path

import pytest

from physim.record import Record
from tests.campaigns.samples import rows_in
from tests.cli.commands import physim

pytestmark = pytest.mark.usefixtures("in_process")

SWEEP = (
    "sweep", "small.yaml", "--seeds", "0:2", "--controller", "awkward:Awkward", "--workers", "1",
    "--set", "controller.how=fine,raise", "--keep", "all", "-o", "out",
)  # fmt: skip


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
        ("out/results.csv:0", "a campaign is a folder"),
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
