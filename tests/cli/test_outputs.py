"""What may be written and read: nothing that exists, no input, no link, pipe or device."""

from __future__ import annotations

import os
import re
import signal
from pathlib import Path

import pytest

from physim import parse_world, simulate
from physim.analysis.crashtest import crash_test
from physim.files import write_text
from tests.cli.commands import SMALL, physim, tree
from tests.helpers import check_error
from tests.helpers.records import make_record

TRACK = "x_m,y_m,w_tr_right_m,w_tr_left_m\n0,0,4,4\n20,0,4,4\n40,0,4,4\n"


@pytest.fixture
def here(here: Path) -> Path:
    """The working directory with a record and a track, too."""
    (here / "track.csv").write_text(TRACK)
    make_record(here / "record.h5", seconds=1.0).close()
    return here


WRITES = {
    "validate": (["validate", "record.h5", "--json", "OUT"], "out.json", "--json"),
    "crashtest": (["crashtest", "--cases", "5", "--json", "OUT"], "out.json", "--json"),
    "video": (["video", "record.h5", "-o", "OUT"], "out.mp4", "-o"),
    "preview": (["preview", "small.yaml", "-o", "OUT"], "out.svg", "-o"),
    "import": (["import", "track.csv", "-o", "OUT"], "out.yaml", "-o"),
    "new": (["new", "a", "-o", "OUT"], "out.yaml", "-o"),
    "schema": (["schema", "-o", "OUT"], "out.json", "-o"),
    "plot": (["plot", "record.h5", "--only", "modes"], "modes.png", "-o"),
}
"""By command: arguments with the place of the file, a name for it, and the option that names it."""


def written(name: str) -> list[str]:
    arguments, out, _ = WRITES[name]
    return [out if word == "OUT" else word for word in arguments]


@pytest.mark.parametrize("name", WRITES)
def test_a_file_that_exists_is_kept_without_force(name: str, here: Path, capsys) -> None:
    _, out, option = WRITES[name]
    (here / out).write_text("mine")
    before = tree(here)
    done = physim(*written(name), capture=capsys)
    another = "folder" if name == "plot" else "file"
    assert (done.code, done.out) == (2, "")
    check_error(done.err, f"{out}:", "exists", "--force", f"{option} for another {another}")
    assert tree(here) == before


@pytest.mark.parametrize("name", ["validate"])
def test_with_force_it_is_written_over(name: str, here: Path, capsys) -> None:
    crash_test(11)
    _, out, _ = WRITES[name]
    (here / out).write_text("mine")
    simulate(parse_world(SMALL), path=here / "record.h5", overwrite=True).close()
    assert physim(*written(name), "--force", "--quiet", capture=capsys).code in (0, 1, 3)
    assert (here / out).read_text().startswith("{\n")


@pytest.mark.parametrize("name", WRITES)
def test_no_link_or_pipe_is_written_over(name: str, here: Path, capsys) -> None:
    _, out, _ = WRITES[name]
    (here / "other").write_text("mine")
    for kind in ("pipe", "link", "link to nothing"):
        if kind == "pipe":
            os.mkfifo(here / out)
        else:
            (here / out).symlink_to(here / ("other" if kind == "link" else "nothing"))
        before = tree(here)
        done = physim(*written(name), "--force", capture=capsys)
        assert (done.code, done.out) == (2, "")
        what = "a named pipe" if kind == "pipe" else "a link"
        check_error(done.err, f"{out}:", "not a regular file", what)
        assert tree(here) == before
        (here / out).unlink()


@pytest.mark.parametrize("path", ["dot", "link", "hard link"])
@pytest.mark.parametrize(
    ("arguments", "option"),
    [
        (["validate", "IN", "--json", "OUT"], "--json"),
        (["validate", "other.h5", "--world", "IN", "--json", "OUT"], "--json"),
        (["video", "IN", "-o", "OUT"], "-o"),
        (["preview", "IN", "-o", "OUT"], "-o"),
        (["import", "IN", "-o", "OUT"], "-o"),
    ],
)
def test_what_is_read_is_never_written_over(
    arguments: list[str], option: str, path: str, here: Path, capsys
) -> None:
    name = {"preview": "in.svg", "video": "in.mp4", "import": "in.yaml"}.get(arguments[0], "in.h5")
    given = here / name
    given.write_text(SMALL)
    out = {"same": name, "dot": f"./x/../{name}", "link": f"link-{name}", "hard link": f"2{name}"}
    (here / "x").mkdir()
    if path == "link":
        (here / f"link-{name}").symlink_to(given)
    if path == "hard link":
        (here / f"2{name}").hardlink_to(given)
    before = tree(here)
    words = [{"IN": name, "OUT": out[path]}.get(word, word) for word in arguments]
    done = physim(*words, "--force", capture=capsys)
    assert (done.code, done.out) == (2, "")
    check_error(done.err, f"{Path(out[path])}:", "input", f"{option} takes another file")
    assert tree(here) == before


def test_a_run_does_not_take_away_its_own_world(here: Path, capsys) -> None:
    (here / "out").mkdir()
    (here / "out/summary.json").write_text(SMALL)
    done = physim("run", "out/summary.json", "-o", "out", "--force", capture=capsys)
    assert (done.code, done.out) == (2, "")
    check_error(done.err, "out/summary.json:", "an input")
    assert (here / "out/summary.json").read_text() == SMALL


READS = (
    ["check", "PIPE"],
    ["run", "PIPE"],
    ["preview", "PIPE", "-o", "a.png"],
    ["validate", "PIPE"],
    ["summary", "PIPE"],
    ["video", "PIPE", "-o", "a.mp4"],
    ["plot", "PIPE", "-o", "."],
    ["import", "PIPE", "-o", "a.yaml"],
)


@pytest.mark.parametrize("arguments", READS, ids=lambda words: words[0])
def test_a_pipe_is_refused_as_input_and_nothing_hangs(
    arguments: list[str], here: Path, capsys
) -> None:
    os.mkfifo(here / "pipe.h5")
    words = ["pipe.h5" if word == "PIPE" else word for word in arguments]
    signal.signal(signal.SIGALRM, lambda *_: pytest.fail("it hangs"))
    signal.alarm(60)
    done = physim(*words, capture=capsys)
    signal.alarm(0)
    assert done.code == 2
    told = done.out if words[0] == "check" else done.err
    assert re.search("pipe.h5: is no(t a regular)? file", told)


def test_worlds_of_an_earlier_crash_test_alone_are_removed_by_force(here: Path, capsys) -> None:
    crash_test(11)
    (here / "crashtest-0").mkdir()
    for name in ("case-000001.yaml", "notes.txt", "case-study.yaml", "case-12.yaml"):
        (here / "crashtest-0" / name).write_text("mine")
    before = tree(here)
    done = physim("crashtest", "--cases", 5, capture=capsys)
    assert (done.code, done.out) == (2, "")
    check_error(done.err, "crashtest-0:", "case-000001.yaml", "--force", "-o")
    assert tree(here) == before
    assert physim("crashtest", "--cases", 5, "--force", "--quiet", capture=capsys).code == 0
    assert set(before) - set(tree(here)) == {"crashtest-0/case-000001.yaml"}


def test_no_schema_is_written_over_the_source(here: Path, capsys) -> None:
    source = here / "world.schema.json"
    source.write_text('{"type": "Polygon", "coordinates": [[[0, 0], [30, 0], [30, 20], [0, 0]]]}')
    before = tree(here)
    arguments = ("--format", "geojson", "--scale", "1", "-o", "out.yaml", "--force")
    done = physim("import", source.name, *arguments, capture=capsys)
    assert done.code == 2
    check_error(done.err, "world.schema.json:", "input")
    assert tree(here) == before


BOTH = {
    "validate": (["validate", "record.h5"], "--page", "./both.html", "both.html"),
    "page below": (["validate", "record.h5"], "--page", "both.html", "there/../both.html"),
    "falsify": (["falsify", "small.yaml", "--budget", "2"], "-o", "found", "found/worst.yaml"),
}


@pytest.mark.parametrize("name", BOTH)
def test_two_outputs_of_a_command_are_two_files(name: str, here: Path, capsys) -> None:
    """The one that was written last was all there was, and both were told as written."""
    arguments, option, output, json = BOTH[name]
    (here / "there").mkdir()
    (here / "found").mkdir()
    before = tree(here)
    done = physim(*arguments, option, output, "--json", json, capture=capsys)
    assert done.code == 2
    check_error(done.err, f"{json}:", "--json", "another file")
    assert tree(here) == before


@pytest.mark.parametrize("kind", ["pipe", "folder", "link to nothing"])
def test_a_schema_that_is_no_file_is_left_alone(kind: str, here: Path, capsys) -> None:
    schema = here / "world.schema.json"
    if kind == "pipe":
        os.mkfifo(schema)
    elif kind == "folder":
        schema.mkdir()
    else:
        schema.symlink_to("nothing")
    done = physim("new", "a", "--force", capture=capsys)
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith("world.schema.json: is ")
    assert not (here / "a.yaml").exists()
    done = physim("new", "a", capture=capsys)
    assert done.code == 0
    assert "world.schema.json: kept" in done.out
    assert schema.is_fifo() or schema.is_dir() or schema.is_symlink()


def test_of_an_interrupted_text_nothing_is_left(here: Path, monkeypatch) -> None:
    def interrupted(self: Path, target: Path) -> Path:
        raise KeyboardInterrupt

    before = tree(here)
    monkeypatch.setattr(Path, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_text(here / "new.txt", "text")
    assert tree(here) == before
