"""The file itself: one, whole, self-contained, with its tables; scripts that are modules each."""

from __future__ import annotations

import html
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import physim
from physim.contacts import Kind, Phase
from physim.drawing.page import MOST_RUNS, page, write_page
from physim.errors import PhysimError
from physim.record import Record
from tests.analysis.metrics.histories import history
from tests.helpers import inside
from tests.helpers.records import make_record

Timeline = inside("physim.drawing", "Timeline")
moments, script = inside("physim.drawing.page", "moments", "script")


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Record:
    return make_record(tmp_path_factory.mktemp("record") / "r.h5", 3, 3.0)


MARKUP = "<img src=x onerror=alert(1)>"


class Links(HTMLParser):
    """Whatever a page could load: values of attributes that name places."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        names = ("src", "href", "srcset", "action", "data", "poster", "srcdoc")
        self.found += [value or "" for name, value in attrs if name in names]


def test_a_page_names_nothing_outside_of_itself(record: Record) -> None:
    text = page(record).html
    assert all(link.startswith(("#", "data:")) for link in Links(text).found)
    assert "http://" not in script()
    assert "https://" not in script()
    assert not re.search(r"\b(fetch|XMLHttpRequest|WebSocket|eval|innerHTML|import)\b", script())
    policy = re.search(r'Security-Policy" content="([^"]*)"', text)
    assert policy is not None
    said = html.unescape(policy[1])
    assert said.startswith("default-src 'none'; script-src 'sha256-")
    assert "unsafe" not in said


def test_without_scripts_it_says_what_was_measured(record: Record) -> None:
    text = page(record).html
    for label in ("contacts", "shortest distance", "made with"):
        assert f">{label}</th>" in text
    assert text.count('href="#t=') == 2
    assert "<noscript>" in text


def test_the_same_record_makes_the_same_page_and_a_notebook_shuts_it_in(record: Record) -> None:
    assert page(record).html == page(record).html
    frame = page(record)._repr_html_()
    assert frame.startswith("<iframe srcdoc=")
    assert 'sandbox="allow-scripts"' in frame
    assert "<script" not in frame


def test_several_runs_are_told_apart(record: Record, tmp_path: Path) -> None:
    with make_record(tmp_path / "again.h5", 3, 2.0) as again:
        text = page(record, again).html
    labels = re.search(r'id="labels">(\[.*?\])</script>', text)
    assert labels is not None
    assert len(set(re.findall('"([^"]*)"', labels[1]))) == 2
    with make_record(tmp_path / "other.h5", 3, 2.0, name="other") as other:
        text = page(record, other).html
    assert 'id="labels">["made up", "other"]</script>' in text  # no more than tells them apart


def test_too_many_and_none_are_refused(record: Record) -> None:
    with pytest.raises(PhysimError, match=str(MOST_RUNS)):
        page(*[record] * (MOST_RUNS + 1))
    with pytest.raises(PhysimError, match="given 0"):
        page()


def test_of_a_page_that_cannot_be_written_nothing_is_left(record: Record, tmp_path: Path) -> None:
    folder = tmp_path / "run.html"
    folder.mkdir()
    with pytest.raises(PhysimError, match=r"run\.html"):
        write_page([record], folder)
    assert list(tmp_path.iterdir()) == [folder]
    inside = tmp_path / "file"
    inside.write_text("mine")
    with pytest.raises(PhysimError, match=r"file/run\.html: .*Not a directory"):
        write_page([record], inside / "run.html")


def test_no_name_ends_the_element_that_holds_it(tmp_path: Path) -> None:
    with (
        make_record(tmp_path / "a.h5", 2, 1.0, name="</script><b>") as a,
        make_record(tmp_path / "b.h5", 2, 1.0, name="b") as b,
    ):
        text = page(a, b).html
    assert "</script><b>" not in text
    assert "<b>" not in text


@pytest.mark.parametrize("kind", ["record", "summary", "world"])
def test_a_notebook_shows_a_small_table(kind: str, tmp_path: Path) -> None:
    with make_record(tmp_path / "r.h5", 2, 2.0, name=MARKUP) as record:
        straight = physim.load_world("straight")
        shown: dict[str, Any] = {
            "record": record,
            "summary": physim.summarise(record),
            "world": straight.changed(name=MARKUP),
        }
        text = shown[kind]._repr_html_()
        contacts = record.contacts["phase"] == physim.Phase.BEGAN
    assert set(re.findall(r"<(\w+)", text)) == {"table", "tr", "th", "td"}
    assert "&lt;img src=x onerror=alert(1)&gt;" in text
    assert ">2<" in text or "2 robots" in text
    if kind == "record":
        assert f'contacts</th><td align="left">{contacts.sum()}<' in text


def test_the_deepest_contact_is_looked_at_where_it_is_deepest() -> None:
    """Not where it began."""
    rows = [{"robot": 0}, {"robot": 1}]
    contacts = [
        (20, 0, 1, Phase.BEGAN, 0.001),
        (21, 0, 1, Phase.ENDED, -0.1),
        (40, 0, 1, Phase.BEGAN, 0.002),
        (41, 0, 1, Phase.STAYS, 0.005),
        (42, 0, 1, Phase.STAYS, 0.003),
        (43, 0, 1, Phase.ENDED, -0.1),
    ]
    record = history(rows, contacts, pose=np.zeros((101, 2, 3)))
    found = {one["label"]: one for one in moments(Timeline(record), physim.summarise(record))}
    deepest = found["deepest contact"]
    assert deepest["time"] == pytest.approx(41 * record.dt)
    assert deepest["contact"] == 1
    assert deepest["words"].startswith(("5 mm", "5.00 mm", "0.005"))


def test_a_graze_is_a_moment_that_leads_to_it() -> None:
    both = 0, 1, Phase.BEGAN, 0.001, 0.0
    contacts = [(20, *both, Kind.PHYSICAL), (40, *both, Kind.SWEPT)]
    record = history([{"robot": 0}, {"robot": 1}], contacts, pose=np.zeros((101, 2, 3)))
    *_, graze = moments(Timeline(record), physim.summarise(record))
    assert graze["label"] == f"{record.names[0]} and {record.names[1]} grazed"
    assert graze["contact"] == 1
