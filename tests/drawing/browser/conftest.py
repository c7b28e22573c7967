from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import physim
from physim.drawing.page import write_page
from physim.record import Record
from tests.drawing.browser import driver
from tests.helpers.records import make_record


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Chromium; without it the test is skipped, in CI it fails."""
    if driver.executable() is None:
        if driver.is_needed():
            pytest.fail("no Chromium, which CI installs: apt-get install chromium")
        pytest.skip("no Chromium")
    with driver.chromium() as found:
        yield found


@pytest.fixture(scope="session")
def record(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Record]:
    """Three robots for 6 s, with two contacts; it must not be changed."""
    path = tmp_path_factory.mktemp("record") / "record.h5"
    made = make_record(path, 3, 6.0)
    yield made
    made.close()


@pytest.fixture(scope="session")
def page(record: Record, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of `record`."""
    return write_page([record], tmp_path_factory.mktemp("page") / "run.html")


@pytest.fixture(scope="session")
def ten() -> Record:
    """Ten robots from `ten_robots`, their first 2.5 s; it must not be changed."""
    world = physim.load_world("ten_robots")
    return physim.simulate(world.changed(time=world.time.model_copy(update={"duration": 2.5})))


@pytest.fixture(scope="session")
def page_of_ten(ten: Record, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of `ten`."""
    return write_page([ten], tmp_path_factory.mktemp("ten") / "run.html")


@pytest.fixture
def opened(browser: Any, page: Path) -> Iterator[Callable[..., driver.Seen]]:
    """Open a page, that of `record` unless told; all are closed, and must be without fault."""
    found: list[driver.Seen] = []

    def see(file: Path = page, **how: Any) -> driver.Seen:
        found.append(driver.Seen(browser, file, **how))
        return found[-1]

    yield see
    for seen in found:
        seen.close()
        assert seen.faults == []
        assert seen.outside() == []
