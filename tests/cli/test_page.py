"""``physim page``: one file is written, whole or not at all; bad input is told in a line."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.commands import physim
from tests.helpers import check_error
from tests.helpers.records import make_record


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory with two records, half a record, and a file that is none."""
    monkeypatch.chdir(tmp_path)
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        make_record(tmp_path / name / "record.h5", 2, 2.0, contacts=False).close()
    whole = (tmp_path / "a/record.h5").read_bytes()
    (tmp_path / "half.h5").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "text.h5").write_text("no record")
    return tmp_path


def test_a_page_is_written_beside_the_record(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    done = physim("page", "a/record.h5", capture=capsys)
    assert (done.code, done.out, done.err) == (0, "a/page.html\n", "")
    text = (here / "a/page.html").read_text(encoding="utf-8")
    assert text.startswith("<!DOCTYPE html>")
    assert text.count('type="text/plain" class="run"') == 1
    assert {file.name for file in (here / "a").iterdir()} == {"record.h5", "page.html"}


def test_several_records_go_into_one_page(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    done = physim("page", "a/record.h5", "b/record.h5", "-o", "both.html", "--quiet",
                  capture=capsys)  # fmt: skip
    assert (done.code, done.out) == (0, "")
    assert (here / "both.html").read_text(encoding="utf-8").count('class="run">') == 3


BAD = {
    ("none.h5",): ("none.h5:",),
    ("half.h5",): ("half.h5:",),
    ("text.h5",): ("text.h5:",),
    ("a/record.h5", "half.h5"): ("half.h5:",),
    (".",): ("record.h5:", "no such file"),
    ("a/record.h5", "-o", "a/record.h5"): ("a/record.h5:", ".html"),
    ("a/record.h5", "-o", "run.pdf"): ("run.pdf:", ".html"),
    ("a/record.h5", "-o", "no/run.html"): ("no/run.html:", "folder no"),
    ("a/record.h5", "-o", "there.html"): ("there.html:", "--force"),
    ("a/record.h5",) * 7: ("a/record.h5:", "6"),
    (): ("physim page:", "RECORD", "missing"),
}


@pytest.mark.parametrize("given", BAD)
def test_bad_input_is_told_and_nothing_is_written(
    here: Path, given: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "there.html").write_text("mine")
    before = sorted(here.rglob("*"))
    done = physim("page", *given, capture=capsys)
    assert (done.code, done.out) == (2, "")
    check_error(done.err, *BAD[given])
    assert sorted(here.rglob("*")) == before
    assert (here / "there.html").read_text() == "mine"
