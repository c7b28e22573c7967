"""``physim preview``: pictures, refusals, and --watch as a process of its own."""

from __future__ import annotations

import re
import signal
import subprocess
import time
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.cli.commands import SMALL, physim, shell, started
from tests.helpers import facts

PNG = b"\x89PNG\r\n\x1a\n"
END = b"IEND\xaeB`\x82"


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "small.yaml").write_text(SMALL)
    return tmp_path


def test_a_picture_is_named_after_the_file(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    done = physim("preview", "small.yaml", capture=capsys)
    assert (done.code, done.out, done.err) == (0, "small.png\n", "")
    assert (here / "small.png").read_bytes().startswith(PNG)
    assert sorted(file.name for file in here.iterdir()) == ["small.png", "small.yaml"]


@pytest.mark.parametrize(
    ("world", "picture"),
    [("...yaml", "world.png"), ("..yaml", "world.png"), ("a\nb.yaml", r"a\u000ab.png")],
)
def test_a_picture_has_a_name_in_one_line(
    here: Path, capsys: pytest.CaptureFixture[str], world: str, picture: str
) -> None:
    (here / "small.yaml").rename(here / world)
    done = physim("preview", world, capture=capsys)
    assert (done.code, done.out, done.err) == (0, f"{picture}\n", "")
    assert sorted(file.name for file in here.iterdir()) == sorted((world, picture))


def test_svg_seed_and_overrides(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    done = physim(
        "preview", "three_robots", "-o", "deep/a.svg", "--seed", 5, "--set", "name=other",
        capture=capsys,
    )  # fmt: skip
    assert done.code == 0, done.err
    text = (here / "deep/a.svg").read_text(encoding="utf-8")
    ElementTree.fromstring(text)
    assert ">other</text>" in text
    assert "seed 5</text>" in text


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("small.yaml",), ("small.png:", "exists", "--force")),
        (("small.yaml", "-o", "a.pdf"), ("a.pdf:", ".png", ".svg")),
        (("small.yaml", "-o", "."), (".:", "a folder")),
        (("small.yaml", "-o", "small.yaml/a.png"), ("small.yaml/a.png:", "cannot be written")),
        (("smal.yaml", "-o", "a.png"), ("smal.yaml:", "small.yaml")),
        (("nothing", "-o", "a.png"), ("nothing:", "shipped world")),
        (
            ("small.yaml", "-o", "a.png", "--set", "corridor.width=0.5"),
            ("robots[0].pose", "inside"),
        ),
        (("small.yaml", "-o", "a.png", "--set", "robots.0.pose=[1]"), ("--set robots.0.pose:",)),
    ],
)
def test_what_is_wrong_is_told_and_nothing_is_written(
    here: Path,
    capsys: pytest.CaptureFixture[str],
    arguments: tuple[str, ...],
    said: tuple[str, ...],
) -> None:
    (here / "small.png").write_text("mine")
    done = physim("preview", *arguments, capture=capsys)
    assert done.code == 2
    assert re.search(facts(*said), done.err), done.err
    assert "Traceback" not in done.err
    assert (here / "small.png").read_text() == "mine"
    assert sorted(file.name for file in here.iterdir()) == ["small.png", "small.yaml"]


def test_faults_have_their_places(here: Path) -> None:
    (here / "bad.yaml").write_text(SMALL.replace("width: 8.0", "widht: 8.0"))
    done = shell("preview", "bad.yaml", folder=here)
    assert done.code == 2
    assert done.err.startswith("bad.yaml:4:")
    assert '"width"' in done.err


def until(found: Callable[[], bool], process: subprocess.Popen[str]) -> None:
    """Wait for something that a running process does; fails when it ends without, or in 60 s."""
    for _ in range(1200):
        if found():
            return
        assert process.poll() is None, process.communicate()
        time.sleep(0.05)
    raise AssertionError("nothing came")


@pytest.fixture
def watching(here: Path) -> Iterator[subprocess.Popen[str]]:
    process = started("preview", "small.yaml", "--watch", folder=here)
    try:
        until((here / "small.png").exists, process)
        yield process
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate()


def test_watch_draws_again_on_every_save(here: Path, watching: subprocess.Popen[str]) -> None:
    picture = here / "small.png"

    def whole_and_not(before: bytes) -> bool:
        now = picture.read_bytes()
        assert now.startswith(PNG)
        assert now.endswith(END)  # never half a picture
        return now != before

    first = picture.read_bytes()
    assert first.endswith(END)
    half = SMALL[: len(SMALL) // 2]
    (here / "small.yaml").write_text(half)  # an editor that is not done yet
    time.sleep(1.5)
    assert picture.read_bytes() == first
    (here / "small.yaml").write_text(SMALL.replace("width: 8.0", "width: 10.0"))
    until(lambda: whole_and_not(first), watching)
    second = picture.read_bytes()
    new = here / "new.yaml"  # an editor that writes beside and renames
    new.write_text(SMALL.replace("width: 8.0", "width: 12.0"))
    new.replace(here / "small.yaml")
    until(lambda: whole_and_not(second), watching)
    third = picture.read_bytes()
    (here / "small.yaml").unlink()
    time.sleep(1.0)
    assert watching.poll() is None
    (here / "small.yaml").write_text(SMALL)
    until(lambda: whole_and_not(third), watching)
    assert picture.read_bytes() == first
    watching.send_signal(signal.SIGINT)
    out, err = watching.communicate(timeout=60)
    assert watching.returncode == 130
    assert out.count("small.png drawn") == 4
    assert "small.yaml:" in err
    assert "stays as it is" in err
    assert err.endswith("interrupted\n")
    assert "Traceback" not in err
    assert sorted(file.name for file in here.iterdir()) == ["small.png", "small.yaml"]


def test_watch_tells_what_check_finds(here: Path) -> None:
    (here / "small.yaml").write_text(SMALL.replace("1.0, 0.0]", "1.0, 3.0]"))
    process = started("preview", "small.yaml", "--watch", folder=here)
    try:
        until((here / "small.png").exists, process)
        assert process.stderr is not None
        told = process.stderr.readline()
        assert told.startswith("warning: small.yaml:8:22: robots[0].pose[2]: ")
        assert "172 degrees" in told
    finally:
        process.kill()
        process.communicate()


def test_watch_begins_with_a_faulty_world(here: Path) -> None:
    (here / "small.yaml").write_text(SMALL.replace("width: 8.0", "width: -8.0"))
    process = started("preview", "small.yaml", "--watch", folder=here)
    try:
        assert process.stderr is not None
        assert process.stderr.readline().startswith("small.yaml:4:")
        assert not (here / "small.png").exists()
        (here / "small.yaml").write_text(SMALL)
        until((here / "small.png").exists, process)
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
        assert process.returncode == 130
    finally:
        if process.poll() is None:
            process.kill()
            process.communicate()
