"""Edits that break a rule on purpose: each has its place, and the program tells who noticed."""

from __future__ import annotations

import ast
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.sabotage import runner, table
from tests.sabotage.__main__ import main
from tests.sabotage.anchors import BadAnchorError, Sources
from tests.sabotage.edit import ROOMS, Edit
from tests.sabotage.edits import EDITS
from tests.sabotage.kernels import Imports
from tests.sabotage.runner import sabotage

ROOT = Path(__file__).parents[1]


def test_every_edit_has_its_place_once() -> None:
    sources, lost = Sources(ROOT), []
    for edit in EDITS:
        try:
            sources.place_of(edit)
        except BadAnchorError as error:
            lost.append(str(error))
    assert lost == [], "\n".join(lost)
    assert len({edit[:5] for edit in EDITS}) == len(EDITS) >= 60
    rooms = {edit.room for edit in EDITS}
    assert set(ROOMS) - {"controllers"} <= rooms <= set(ROOMS)


def test_every_edit_names_a_test_of_its_room() -> None:
    known: dict[str, set[str]] = {}
    for edit in EDITS:
        file, _, name = edit.notices.partition("::")
        if file not in known:
            tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
            known[file] = {one.name for one in tree.body if isinstance(one, ast.FunctionDef)}
        assert name in known[file], edit.notices
        assert any(f"{file}/".startswith(f"{path}/") for path in ROOMS[edit.room]), edit.notices


def test_the_table_is_that_of_the_edits() -> None:
    """Made by ``python -m tests.sabotage --table``."""
    assert (ROOT / table.PAGE).read_text(encoding="utf-8") == table.page(EDITS)


# Anchors

ONE = Edit("basics", "physim/a.py", "House.room", "width * height", "width", "two sides", "")
TEXT = """\
class House:
    def room(self, width, height):
        return (
            width
            * height
        )

    def floor(self, width, height):
        return width * height
"""


def sources(root: Path, **files: str) -> Sources:
    for name, text in files.items():
        (root / "physim").mkdir(exist_ok=True)
        (root / "physim" / f"{name}.py").write_text(text, encoding="utf-8")
    return Sources(root)


@pytest.mark.parametrize("name", ["a", "moved_elsewhere"])
def test_an_edit_is_found_by_its_function_wherever_it_stands(tmp_path: Path, name: str) -> None:
    place = sources(tmp_path, other="room = 1\n", **{name: TEXT}).place_of(ONE)
    assert place.file == Path(f"physim/{name}.py")
    assert place.text.count("height") == TEXT.count("height") - 1
    assert "return width * height" in place.text  # that of the other function


@pytest.mark.parametrize(
    ("edit", "told"),
    [
        (ONE._replace(function="House.hall"), "has this name"),
        (ONE._replace(old="width + height"), "is there 0 times"),
        (ONE._replace(function="House"), "is there 2 times"),
        (ONE._replace(new="width +"), "no Python"),
        (ONE._replace(new="width\n            * height"), "changes nothing"),
    ],
)
def test_an_edit_without_a_place_of_its_own_is_refused(
    tmp_path: Path, edit: Edit, told: str
) -> None:
    with pytest.raises(BadAnchorError, match=told) as caught:
        sources(tmp_path, a=TEXT).place_of(edit)
    assert "\n" not in str(caught.value)


def test_a_fragment_in_two_functions_of_one_name_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadAnchorError, match="is there 2 times"):
        sources(tmp_path, a=TEXT, b=TEXT).place_of(ONE)


# The program


@pytest.mark.parametrize(
    "given",
    [[], ["--room", "cellar"], ["--all", "--room", "geometry"], ["--all", "--jobs", "0"]],
)
def test_bad_arguments_end_with_2(given: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(given)
    assert ended.value.code == 2
    assert capsys.readouterr().out == ""


def test_a_bad_anchor_ends_with_2(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("tests.sabotage.__main__.EDITS", (ONE,))
    assert main(["--room", "basics"]) == 2
    assert capsys.readouterr().err.startswith("basics: House.room (last seen in physim/a.py): ")


SMALL = ("tests/test_errors.py",)
PLURAL = Edit(
    "small", "physim/errors.py", "plural", "if count == 1", "if count < 2", "none is many",
    "tests/test_errors.py::test_plural",
)  # fmt: skip


def test_edits_are_made_in_copies_and_told_by_who_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runner, "ROOMS", {"small": SMALL})
    before = (ROOT / "physim/errors.py").read_bytes()
    harmless = PLURAL._replace(old="``1 robot``", new="``one robot``")
    lost = PLURAL._replace(new="if True", notices="tests/test_errors.py::test_that_is_gone")
    with sabotage(ROOT, 2) as work:
        found = {one.edit: one.noticed for one in work.edits([PLURAL, harmless, lost])}
        folder = work.base.parent
        assert sorted(folder.glob("edit-*")) == []
    assert not folder.exists()
    noticed = f"{PLURAL.notices}[given0-0 robots]"
    assert found == {PLURAL: noticed, lost: noticed, harmless: None}
    assert (ROOT / "physim/errors.py").read_bytes() == before


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_leaves_nothing_behind(tmp_path: Path, number: int) -> None:
    command = [sys.executable, "-m", "tests.sabotage", "--room", "basics"]
    process = subprocess.Popen(
        command, cwd=ROOT, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "TMPDIR": str(tmp_path)},
    )  # fmt: skip
    try:
        while not list(tmp_path.glob("*/unedited/tests")):
            assert process.poll() is None
            time.sleep(0.05)
        process.send_signal(number)
        _, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert (process.returncode, err.splitlines()[-1]) == (130, "interrupted")
    assert list(tmp_path.iterdir()) == []


def test_compiled_code_is_kept_where_no_import_leads_to_the_edit() -> None:
    imports = Imports(ROOT)
    reached = imports.all_of(Path("physim/geometry/collision.py"))
    assert {Path("physim/tolerances.py"), Path("physim/geometry/shapes.py")} < reached
    assert not {file for file in reached if file.parts[1] in ("cli", "record", "video")}
    assert Path("physim/geometry/collision.py") in imports.all_of(Path("controllers/avoidance.py"))
