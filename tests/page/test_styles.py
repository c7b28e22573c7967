"""Pages of runs, campaigns and the reproduction have one set of colours and common styles."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from physim.drawing import palette
from physim.drawing.page import page
from tests.helpers import inside
from tests.helpers.records import make_record

sheet = inside("physim.campaigns.report", "page")
ASSETS, asset, DARK, LIGHT = inside("physim.drawing.page", "ASSETS", "asset", "DARK", "LIGHT")
custom_properties = inside("physim.drawing.page", "custom_properties")
hexed = inside("physim.drawing", "hexed")
html = inside("physim.reproduction", "html")

USED = re.compile(r"var\(--([a-z]+)\)")
OWN = {"mode"}
"""set by scripts"""


def made(kind: str, folder: Path) -> str:
    if kind == "campaign":
        return sheet("title", "<p>text</p>")
    if kind == "reproduction":
        return html("# title", "title", folder)
    with make_record(None, 2, 1.0) as record:
        return page(record).html


@pytest.mark.parametrize("kind", ["campaign", "reproduction", "run"])
def test_all_pages_begin_with_the_same_styles(kind: str, tmp_path: Path) -> None:
    text = made(kind, tmp_path)
    (css,) = re.findall("<style>(.*?)</style>", text, re.DOTALL)
    assert css.startswith(custom_properties() + asset("common.css"))
    assert css.count("prefers-color-scheme") == 1
    assert set(USED.findall(css)) <= set(LIGHT) | OWN


def test_no_style_sheet_has_a_colour_of_its_own_where_the_palette_has_one() -> None:
    known = {hexed(colour) for colour in (*LIGHT.values(), *DARK.values())}
    for file in ASSETS.glob("*.css"):
        found = set(re.findall("#[0-9a-f]{6}", file.read_text(encoding="utf-8")))
        assert not found & known, file.name
    assert LIGHT["contact"] == DARK["contact"] == palette.CONTACT
