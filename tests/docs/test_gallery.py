"""The gallery shows every shipped world, with the rates that were measured and no other numbers."""

from __future__ import annotations

import json
import re
import runpy
from pathlib import Path
from types import SimpleNamespace

import PIL.Image
import pytest

from benchmarks.avoidance import RATES, SHOWS_AVOIDANCE
from benchmarks.gallery import SHOTS, SIZE_OF_BOTH, WIDTH
from tests.helpers import inside

SHIPPED = inside("physim.world", "shipped_worlds")()

GALLERY = Path(__file__).parents[2] / "docs/gallery"
PAGE = (GALLERY / "index.md").read_text(encoding="utf-8")
MARK = re.compile(r"<!-- generated: gallery (\w+) -->")


@pytest.fixture
def hooks() -> SimpleNamespace:
    pytest.importorskip("griffe", reason="needs physim[docs]")
    return SimpleNamespace(**runpy.run_path(str(GALLERY.parent / "hooks.py")))


def test_every_shipped_world_has_a_card_a_still_a_film_and_rates() -> None:
    assert sorted(MARK.findall(PAGE)) == sorted(SHIPPED)
    assert set(json.loads(RATES.read_text(encoding="utf-8"))) == set(SHOTS) == set(SHIPPED)
    for name in SHIPPED:
        assert PIL.Image.open(GALLERY / f"{name}.webp").width == WIDTH
        film = (GALLERY / f"{name}.mp4").read_bytes()
        assert len(film) <= SIZE_OF_BOTH, name
        assert film.index(b"moov") < film.index(b"mdat"), name  # plays before all of it is there
    assert sum(file.stat().st_size for file in GALLERY.iterdir()) < 0.233e6 * len(SHIPPED)


def test_worlds_stand_where_their_rates_put_them(hooks: SimpleNamespace) -> None:
    rates = json.loads(RATES.read_text(encoding="utf-8"))
    sections = [set(MARK.findall(text)) for text in PAGE.split("\n## ")[1:]]
    kinds = [{n for n in rates if hooks.verdict(rates[n]) == one} for one in hooks.VERDICTS]
    assert sections == kinds
    assert kinds[0] == set(SHOWS_AVOIDANCE)


def test_every_number_is_of_the_rates(
    hooks: SimpleNamespace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    by_hand = re.sub(r"`[^`]*`|\]\([^)]*\)|95&nbsp;% interval", "", PAGE)
    assert re.findall(r"\d", by_hand) == []
    other = {"contact_free": 61, "finished": 62, "by_distance": 0.0312, "by_time": 0.041}
    other |= {"shortest_distance": 0.63, "least_distance": -0.64}
    bare = {"contact_free": 7, "finished": 66, "deepest_contact": 0.0671, "time_in_contact": 68.5}
    made_up = {"version": "0.9", "seeds": 97, "with": other, "without": bare}
    (tmp_path / "rates.json").write_text(json.dumps(dict.fromkeys(SHIPPED, made_up)))
    monkeypatch.setitem(hooks.gallery.__globals__, "RATES", tmp_path / "rates.json")
    for name, description in SHIPPED.items():
        card = hooks.gallery(name)
        assert hooks.prose(description) in card
        assert f"physim run {name}\n" in card
        text = card.split("```")[-1]
        for figure in ("61 of 97", "62 of 97", "7 of 97", "66 of 97", "7.2 %", "0.63 m", "−0.64 m"):
            assert figure in text
        assert "(52.5–72.5 %)" in text  # 61 of 97, from a table of exact intervals
        assert {"67.1", "68.5"} < set(re.findall(r"[\d.]*\d", text))
    table = hooks.gallery()
    assert table.count("61 and 7 of 97") == len(SHIPPED)
    assert all(hooks.prose(description) in table for description in SHIPPED.values())
    assert "physim 0.9." in table


def test_a_world_without_avoidance_has_one_arm(hooks: SimpleNamespace) -> None:
    card = hooks.gallery("jam")
    assert "| with avoidance |" not in card
    assert re.search(r"contact-free \| 0 of \d+<br>", card)
