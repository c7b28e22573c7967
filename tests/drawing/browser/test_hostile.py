"""Names and data from a hostile hand: nothing of them runs, and what is broken is told."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from urllib.parse import quote

import h5py
import pytest

from physim.drawing.page import page, write_page
from physim.record import Record
from tests.drawing.browser.driver import Seen
from tests.helpers.records import make_record, told

Opened = Callable[..., Seen]
HACK = "window.hacked = 1"
BLOCK = '<script type="text/plain" class="run">'
NAMES = (
    f"</script><script>{HACK}</script>",
    f"<img src=x onerror='{HACK}'>\"><svg onload={HACK}>",
    f"' onmouseover='{HACK}' x='{{{{runs}}}} \\u003c/script>",
)


@pytest.fixture
def hostile(tmp_path: Path) -> Path:
    """A page whose robots, world, modes and rules have names that are markup."""
    file = tmp_path / "hostile.h5"
    make_record(file, 3, 2.0, name=f"<!--<script>{HACK}</script>").close()
    with h5py.File(file, "r+") as record:
        for k, name in enumerate(NAMES):
            told("bodies", None, k, name=name)(record)
        told("bodies", None, 3, name=f"-->]]></style><script>{HACK}</script>")(record)
        told("declared", "modes", 0, words=NAMES[0])(record)
        told("declared", "rules", 0, words=NAMES[1])(record)
        told("declared", "columns", 5, words=NAMES[1])(record)
    with Record.load(file) as record:
        return write_page([record, record], tmp_path / "hostile.html")


def test_names_that_are_markup_are_only_names(opened: Opened, hostile: Path) -> None:
    seen = opened(hostile, hash=f"#t=1&robot={quote(NAMES[1])}&x=<script>{HACK}</script>")
    assert seen.ask("physim.robot") == 1
    for robot in range(3):
        seen.ask(f"physim.go({{robot: {robot}, time: 1}})")
        seen.settle()
        assert NAMES[robot] in seen.text("#why h2")
    seen.ask("physim.go({contact: 0})")
    seen.settle()
    seen.page.hover("#why")
    assert seen.ask("window.hacked") is None
    assert seen.page.locator("img, svg, iframe").count() == 0
    assert seen.page.locator("script").count() == 5
    assert NAMES[0] in seen.page.locator(".tables").inner_text()


def test_a_frame_in_a_notebook_is_shut_in(opened: Opened, hostile: Path, tmp_path: Path) -> None:
    with make_record(None, 2, 1.0, name=NAMES[1]) as record:
        frame = page(record)._repr_html_()
    file = tmp_path / "notebook.html"
    file.write_text(f"<p>{frame}</p><script>window.physim = null</script>", encoding="utf-8")
    seen = opened(file)
    seen.page.wait_for_timeout(300)
    assert seen.ask("window.hacked") is None
    assert seen.page.frame_locator("iframe").locator("#clock").inner_text() == "0.00 s"


def test_a_script_that_was_put_in_does_not_run(opened: Opened, page: Path, tmp_path: Path) -> None:
    """The policy of the page allows its own script alone."""
    text = page.read_text(encoding="utf-8")
    file = tmp_path / "changed.html"
    bad = f"<script>{HACK}</script><img src=x onerror='{HACK}'><link rel=stylesheet href=//a.b>"
    file.write_text(text.replace("</main>", f"</main>{bad}"), encoding="utf-8")
    seen = opened(file)
    assert seen.ask("window.hacked") is None
    assert seen.faults
    seen.faults.clear()
    seen.requests.clear()


@pytest.mark.parametrize("how", ["cut", "no text", "no gzip"])
def test_data_that_are_broken_are_told(
    opened: Opened, page: Path, tmp_path: Path, how: str
) -> None:
    text = page.read_text(encoding="utf-8")
    begin = text.index(BLOCK) + len(BLOCK)
    end = text.index("</script>", begin)
    data = text[begin:end]
    broken = {"cut": data[: len(data) // 2], "no text": "%%%", "no gzip": "AAAA" * 40}[how]
    file = tmp_path / "broken.html"
    file.write_text(text[:begin] + broken + text[end:], encoding="utf-8")
    seen = opened(file)
    told = seen.text("#state")
    assert "cannot be shown" in told
    assert not seen.page.locator("#app").is_visible()
    assert "shortest distance" in seen.text(".tables")
