"""The site builds without a warning, and every command and block of code on its pages runs.

A page's blocks of sh, python and yaml run in order in one empty folder, as a reader would try them;
a line ``cd FOLDER`` holds for later blocks, too. One with a title (``yaml title="world.yaml"``) is
a file. ``text`` is what the block before prints, line by line, apart from lines with "…". A command
whose comment says "exits with 1" does. A block below a line ``<!-- not run: why -->`` is not run.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.helpers import extending, inside

COMMANDS, app_of = inside("physim.cli", "COMMANDS", "app_of")

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", *sorted(DOCS.rglob("*.md"))]
RUN_HERE = [page for page in PAGES if page not in extending.INSTALLED]
"""All but the pages whose blocks another test runs, as an installed distribution"""
FENCE = re.compile(
    r"^(?P<indent> *)```(?P<language>\w+)(?: title=\"(?P<title>[^\"]+)\")?\n"
    r"(?P<text>.*?)^(?P=indent)```$",
    re.DOTALL | re.MULTILINE,
)
SKIPPED = re.compile(r"<!-- (not run: [^\n]+|main job|tests) -->\n *$")
EXIT = re.compile(r"# .*\bexits with (\d+)")


class Block(NamedTuple):
    """A fenced block of a page."""

    language: str
    title: str | None
    text: str
    skipped: bool


def blocks(page: Path) -> list[Block]:
    """Every fenced block with a language, in order."""
    text, found = page.read_text(encoding="utf-8"), []
    for one in FENCE.finditer(text):
        body = re.sub(rf"^{one['indent']}", "", one["text"], flags=re.MULTILINE)
        skipped = SKIPPED.search(text[: one.start()]) is not None
        found.append(Block(one["language"], one["title"], body, skipped))
    return found


def commands(page: Path) -> list[list[str]]:
    """Arguments of every line of a page's blocks of sh that calls ``physim``."""
    found = []
    for block in blocks(page):
        if block.language == "sh":
            for line in re.findall(r"^(?:\S+/)?physim .*", block.text.replace("\\\n", " "), re.M):
                for part in re.split(r"\s(?:&&|\|\||\||;)\s", line):
                    words = shlex.split(part, comments=True)
                    if words and words[0].endswith("physim"):
                        found.append(words[1:])
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_command_and_option_of_a_page_exists(page: Path) -> None:
    told = commands(page)
    inline = re.findall(r"`physim ([a-z][^`]*)`", page.read_text(encoding="utf-8"))
    told += [shlex.split(one) for one in inline if not re.search("…|\\.\\.\\.", one)]
    for words in told:
        if words[0].startswith("-"):
            continue
        assert words[0] in COMMANDS, words
        app = app_of(words[0])
        options = {name for one in app.assemble_argument_collection() for name in one.names}
        given = {word.partition("=")[0] for word in words if re.match(r"--?[a-zA-Z]", word)}
        assert given <= options | {"--help", "-h"}, words
        if words in commands(page):
            app.parse_args(words[1:], exit_on_error=False, print_error=False)


def test_every_kind_of_part_has_an_example() -> None:
    """In the how-to pages; the examples themselves run in the deep tier."""
    kinds = inside("physim.parts", "KINDS", "METRIC", "PLOT")
    given = extending.entry_points()
    assert {kind.group for kind in (*kinds[0], *kinds[1:])} == set(given)
    files = {f"{target.split(':')[0]}.py" for names in given.values() for target in names.values()}
    assert {block.title for block in extending.of("python")} == files
    run = "".join(block.text for block in (*extending.of("sh"), *extending.of("text")))
    assert all(name in run for names in given.values() for name in names)


def test_the_site_builds_without_a_warning(tmp_path: Path) -> None:
    pytest.importorskip("material", reason="needs physim[docs]")
    command = [sys.executable, "-m", "mkdocs", "build", "--site-dir", str(tmp_path)]
    env = {**os.environ, "NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(command, cwd=ROOT, env=env, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    pages = [page for page in tmp_path.rglob("*.html") if page.name != "404.html"]
    assert len(pages) >= len(PAGES) - 1
    for page in pages:
        loaded = re.findall(
            r"<(?:script|link|img|video)[^>]+(?:src|href)=\"?(https?:[^\" >]+)", page.read_text()
        )
        assert loaded == [], page  # nothing is loaded from elsewhere


@pytest.mark.deep(each=True)
@pytest.mark.parametrize(
    "page",
    RUN_HERE,
    ids=lambda page: str(page.relative_to(ROOT)),
)  # fmt: skip
def test_every_block_of_a_page_does_what_it_says(page: Path, tmp_path: Path) -> None:
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    env = {**os.environ, "PATH": path, "PYTHONPATH": "."}
    printed, folder = "", tmp_path
    for block in blocks(page):
        if block.title is not None:
            (folder / block.title).parent.mkdir(parents=True, exist_ok=True)
            (folder / block.title).write_text(block.text, encoding="utf-8")
        elif block.language == "text" and not block.skipped:
            lines = [line.rstrip() for line in block.text.splitlines() if "…" not in line]
            missing = [line for line in lines if line not in map(str.rstrip, printed.splitlines())]
            assert missing == [], printed
        elif block.language in ("sh", "python") and not block.skipped:
            shell = ["bash", "-uo", "pipefail", "-c", checked(block.text)]
            command = shell if block.language == "sh" else [sys.executable, "-c", block.text]
            done = subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True)
            folder = folder.joinpath(*re.findall(r"^cd (\S+)$", block.text, re.MULTILINE))
            printed = done.stdout + done.stderr
            assert done.returncode == 0, f"{block.text}\n{printed}"
            assert "Traceback" not in printed


@pytest.mark.deep
def test_every_notebook_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MPLBACKEND", "Agg")
    for book in DOCS.rglob("*.ipynb"):
        cells = json.loads(book.read_text("utf-8"))["cells"]
        code = "\n".join("".join(one["source"]) for one in cells if one["cell_type"] == "code")
        done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True)
        assert done.returncode == 0, done.stderr
        shown = [t for one in cells for o in one.get("outputs", ()) for t in o.get("text", ())]
        assert "".join(shown) == done.stdout.decode()  # what the page shows is what it prints


def checked(text: str) -> str:
    """A block of shell in which every command must end with 0, or with what its comment says."""
    lines = []
    for line in text.replace("\\\n", " ").splitlines():
        code = EXIT.search(line)
        command = line[: code.start()] if code else line
        if command.strip() and not command.lstrip().startswith("#"):
            wanted = code[1] if code else "0"
            lines.append(
                f'{command}\n[ $? -eq {wanted} ] || {{ echo "ended with another code"; exit 1; }}'
            )
    return "\n".join(lines)
