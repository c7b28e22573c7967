"""Names of files, worlds and robots: labels only, whatever stands in them.

They neither escape the output folder nor break what is printed or written.
"""

from __future__ import annotations

import json

import pytest

from physim.cli import main
from physim.errors import WorldError
from physim.world.file import parse_world
from tests.world.worlds import CORRIDOR, changed, check, lines

NAMES = [
    "two words", 'it\'s "quoted"', "<b>bold</b>&amp;<script>alert(1)</script>", "../../etc/passwd",
    "/tmp/x", "C:\\x", "=1+1,b; c", "$\\frac{", "_hidden", "%s %(x)s {0} {x}", "[red]rich[/red]",
    "-o", "..", ".", "~", "#", "né 机器人 🤖", "x" * 100,
]  # fmt: skip


def quoted(name: str) -> str:
    return json.dumps(name, ensure_ascii=False)


@pytest.mark.parametrize("name", NAMES)
def test_any_printable_name_is_a_label(tmp_path, name):
    text = changed(CORRIDOR, ("name: corridor", f"name: {quoted(name)}"))
    found = check(tmp_path, changed(text, ("name: a", f"name: {quoted(name)}")))
    assert lines(found) == ([], [])
    assert found.clearance[0].robot == name
    assert found.layout is not None
    stem = found.layout.world.stem
    assert stem not in ("", ".", "..")
    assert "/" not in stem
    assert "\\" not in stem


@pytest.mark.parametrize("name", ["a\nb", "a\tb", "a\rb", "a\x1b[31mb", "a\u202eb", "a\u200bb", ""])
def test_names_hold_no_control_characters(name):
    text = changed(CORRIDOR, ("name: a", f"name: {json.dumps(name)}"))
    with pytest.raises(WorldError) as caught:
        parse_world(text)
    assert len(caught.value.faults) == 1
    assert str(caught.value).isprintable()
    assert "must not" in str(caught.value)


def test_a_run_of_such_names_stays_in_its_folder(tmp_path, monkeypatch, capsys):
    """Record, video, summary and verdict of a world whose names would lead out or break lines."""
    (tmp_path / "work").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    text = changed(CORRIDOR, ("duration: 60.0", "duration: 0.2"))
    text = changed(text, ("name: corridor", f"name: {quoted('../../x <b> $')}"))
    text = changed(text, ("name: a", f"name: {quoted('../../etc/x <script>')}"))
    text = changed(text, ("name: b", f"name: {quoted('=1+1,[red]é$_{')}"))
    world = 'it\'s a "world" <b>.yaml'
    (tmp_path / "work" / world).write_text(text, encoding="utf-8")
    assert main(["run", world, "--quiet"]) == 0
    (folder,) = (tmp_path / "work" / "runs").iterdir()
    record = str(folder / "record.h5")
    assert main(["summary", record]) == 0
    assert main(["validate", record, "--json", "v.json"]) == 0
    out = capsys.readouterr().out
    assert "../../etc/x <script>" in out
    assert "=1+1,[red]é$_{" in out
    json.loads((tmp_path / "work" / "v.json").read_text(encoding="utf-8"))
    json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    files = {str(p.relative_to(tmp_path / "work")) for p in tmp_path.rglob("*") if p.is_file()}
    made = {f"runs/{folder.name}/{n}" for n in ("record.h5", "video.mp4", "summary.json")}
    assert files == made | {world, "v.json"}
