"""Pages of `physim report` as they are shown: nothing is cut off, no interval is torn apart."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.campaigns.tables import failed, hit, row, table
from tests.drawing.browser.driver import DESKTOP, PHONE
from tests.helpers import inside

Outcomes = inside("physim.campaigns", "Outcomes")
report_of, Shown = inside("physim.campaigns.report", "report_of", "Shown")
report_page = inside("physim.campaigns.report", "report_page")

TORN = """[...document.querySelectorAll('td small')].flatMap(small =>
  [...small.childNodes].filter(one => one.nodeType === 3 && one.data.startsWith('[')
    && one.data.includes('%') && !small.closest('.dense')).map(one => {
    const range = document.createRange(); range.selectNodeContents(one);
    return range.getClientRects().length; })).filter(lines => lines > 1).length"""
CUT = """[document.documentElement, ...document.querySelectorAll('.wide')]
  .filter(one => one.scrollWidth > one.clientWidth).length"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [DESKTOP, PHONE])
def test_a_report_fits(browser: Any, tmp_path: Path, size: tuple[int, int], scheme: str) -> None:
    more = {"formation_error": 1.3, "seconds": 250.0}
    rows = [row(k, updates=14_150 + 7 * k, messages=39_500 + k, **more) for k in range(40)]
    rows += [hit(seed, controller="path_following") for seed in range(40)]
    one = report_of(Outcomes(table([*rows, failed(50)])), "yard")
    shown = [Shown("physim replay yard:0123456789abcdef0123") for _ in one.pictured]
    file = tmp_path / "report.html"
    file.write_text(report_page(one, shown))
    context = browser.new_context(
        viewport={"width": size[0], "height": size[1]}, color_scheme=scheme, offline=True
    )
    page, faults = context.new_page(), []
    page.on("console", lambda said: faults.append(said.text))
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.goto(file.as_uri())
    assert (page.evaluate(CUT), page.evaluate(TORN), faults) == (0, 0, [])
    context.close()
