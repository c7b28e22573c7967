"""Notebooks show worlds, records and summaries as small tables in which names are only names."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

import physim
from tests.helpers.records import make_record

NAME = "<img src=x onerror=alert(1)>"


@pytest.mark.parametrize("kind", ["record", "summary", "world"])
def test_a_notebook_shows_a_small_table(kind: str, tmp_path: Path) -> None:
    with make_record(tmp_path / "r.h5", 2, 2.0, name=NAME) as record:
        straight = physim.load_world("straight")
        shown: dict[str, Any] = {
            "record": record,
            "summary": physim.summarise(record),
            "world": straight.changed(name=NAME),
        }
        text = shown[kind]._repr_html_()
        contacts = record.contacts["phase"] == physim.Phase.BEGAN
    assert set(re.findall(r"<(\w+)", text)) == {"table", "tr", "th", "td"}
    assert "&lt;img src=x onerror=alert(1)&gt;" in text
    assert ">2<" in text or "2 robots" in text
    if kind == "record":
        assert f'contacts</th><td align="left">{contacts.sum()}<' in text
