"""Findings of a validation in a page: all are told, names are only names."""

from __future__ import annotations

import html
import re
from pathlib import Path

import h5py
import pytest

import physim
from physim.errors import PhysimError
from physim.record import Record
from tests.analysis.validation.runs import APART, REAR_END, lane
from tests.helpers import inside
from tests.helpers.records import told

findings_section = inside("physim.drawing.page", "findings_section")

NAME = "</pre></table><img src=x onerror='hacked()'>&\"#t=1"


@pytest.fixture(scope="module")
def renamed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A record with a contact; its first robot has a name that is markup, unlike in its world."""
    file = tmp_path_factory.mktemp("renamed") / "r.h5"
    lane(REAR_END, file).close()
    with h5py.File(file, "r+") as record:
        told("bodies", None, 0, name=NAME)(record)
    return file


def test_findings_are_all_told_and_names_in_them_are_only_names(renamed: Path) -> None:
    with Record.load(renamed) as record:
        found = physim.validate(record)
        section = findings_section(found, physim.summarise(record))
        with pytest.raises(PhysimError, match="one record; given 2"):
            physim.page(record, record, validation=found)
    assert "img" not in re.findall(r"<(\w+)", section)
    assert not re.search(r"<[^>]* (on\w+|style)=", section)
    assert all(link.startswith("#t=") for link in re.findall('href="([^"]*)"', section))
    words = html.unescape(re.sub("<[^>]*>", "", section))
    assert words.count(NAME) >= 2
    assert found.code == 3  # the world inside has another name
    assert found.verdict in words
    assert all(one.what in words for one in found.origin)
    assert found.contacts
    for number, contact in enumerate(found.contacts, 1):
        assert f"#t={contact.time:.3f}&amp;contact={number}" in section


def test_a_validation_is_of_the_run_that_is_shown(tmp_path: Path) -> None:
    """Else the page of a run without contacts tells of some; wherever the record lies."""
    hit = lane(REAR_END, tmp_path / "hit.h5")
    free = lane(APART, tmp_path / "free.h5")
    with hit, free:
        found = physim.validate(hit)
        for other in (
            free,
            physim.simulate(physim.load_world("straight", overrides=["time.duration=1"])),
        ):
            with pytest.raises(PhysimError, match="of another run"):
                physim.page(other, validation=found)
        hit.save(tmp_path / "copy.h5")
        with Record.load(tmp_path / "copy.h5") as copy:
            assert str(found.verdict) in physim.page(copy, validation=found).html
