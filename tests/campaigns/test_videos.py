"""``physim report --videos`` for real: the films are there, whole, and the page leads to them."""

from __future__ import annotations

from pathlib import Path

import av
import pytest

from physim.cli import main
from tests.campaigns.real import campaign
from tests.campaigns.test_report import Elements


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two runs of 1 s, reported with videos, by a page elsewhere."""
    made = tmp_path_factory.mktemp("campaign") / "runs"
    campaign(made, range(2), ("mode_switching",))
    made.with_name("pages").mkdir()
    page = made.with_name("pages") / "r.html"
    assert main(["report", str(made), "--videos", "--quiet", "-o", str(page)]) == 0
    return made


def films(page: Path) -> list[Path]:
    attributes = Elements(page.read_text()).attributes
    return [(page.parent / value).resolve() for name, value in attributes if name == "href"]


def test_the_page_leads_to_a_film_of_every_run(folder: Path) -> None:
    linked = films(folder.with_name("pages") / "r.html")
    assert sorted(linked) == sorted((folder / "videos").resolve().iterdir())
    assert len(linked) == 2
    for film in linked:
        with av.open(str(film)) as opened:
            (video,) = opened.streams.video
            shown = sum(1 for _ in opened.decode(video))
            assert shown == video.frames
            assert shown / float(video.average_rate or 1) >= 1.0  # the run, and its last picture


def test_what_is_there_is_not_made_again(folder: Path) -> None:
    """A later page, without being asked for videos, links to those that there are."""
    before = {film: film.stat().st_mtime_ns for film in (folder / "videos").iterdir()}
    assert main(["report", str(folder), "--quiet"]) == 0
    assert sorted(films(folder / "report.html")) == sorted(film.resolve() for film in before)
    assert {film: film.stat().st_mtime_ns for film in (folder / "videos").iterdir()} == before
