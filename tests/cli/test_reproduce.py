"""``physim reproduce``: one figure from end to end, bad input, Ctrl-C."""

from __future__ import annotations

import signal
import time
from pathlib import Path

import pytest

from tests.cli.commands import physim, started
from tests.helpers import inside

Report = inside("physim.reproduction", "Report")

QUICK = ("reproduce", "--quick", "--no-video")
PAGES = ("REPRODUCTION.md", "reproduction.html", "reproduction.json")


def contents(folder: Path) -> dict[str, bytes]:
    files = (*folder.glob("*.*"), *folder.glob("figures/*"))
    return {str(file.relative_to(folder)): file.read_bytes() for file in files if file.is_file()}


def test_one_figure(tmp_path: Path, capsys) -> None:
    out = tmp_path / "a folder & more"
    given = (*QUICK, "--figure", "1", "--workers", "1", "-o", out)
    done = physim(*given, capture=capsys)
    assert (done.code, done.err) == (0, "")
    assert "3 claims: " in done.out
    assert f"written to {out}/: " in done.out
    first = contents(out)
    pictures = {f"figures/1-{name}.png" for name in ("trajectories", "deviation", "speeds")}
    assert set(first) == {*PAGES, *pictures}
    report = Report.from_json((out / PAGES[2]).read_text())
    assert [section.key for section in report.sections] == ["1"]
    assert not report.interrupted
    assert report.command == "physim reproduce --figure 1 --quick"
    assert all(row.met.endswith(" of 5") for row in report.rows)
    assert (out / PAGES[1]).read_text().count("data:image/png;base64,") == 3
    assert (out / "single_robot/record.h5").exists()
    again = physim(*given, capture=capsys)
    assert again.code == 2
    assert "is not empty; use --force" in again.err
    assert contents(out) == first
    for name in ("1-old.png", "logo.png", "1-Mine.png", "2024-tracks.png"):
        (out / "figures" / name).write_text("mine")  # but the first no pictures of a reproduction
    assert physim(*given, "--force", capture=capsys).code == 0
    mine = {f"figures/{name}": b"mine" for name in ("logo.png", "1-Mine.png", "2024-tracks.png")}
    assert contents(out) == first | mine


@pytest.mark.deep
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupted_with_what_is_done(number: signal.Signals, tmp_path: Path) -> None:
    process = started("reproduce", "--no-video", "--figure", "1", "-o", "out", folder=tmp_path)
    try:
        while process.poll() is None and not list(tmp_path.glob("out/figures/*.png")):
            time.sleep(0.02)
        process.send_signal(number)
        out, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 130, (out, err)
    assert "Traceback" not in err
    report = Report.from_json((tmp_path / "out" / PAGES[2]).read_text())
    assert report.interrupted
    assert report.sections[0].missing
    assert "It was interrupted" in (tmp_path / "out" / PAGES[0]).read_text()
    assert not list(tmp_path.rglob("*.part"))
