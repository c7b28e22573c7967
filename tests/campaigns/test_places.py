"""Folders of campaigns come from strangers: no link leads out of them, no pipe holds a command."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from physim.campaigns.folder import Folder
from physim.campaigns.rows import FOLDER, Row, Shards, read
from physim.errors import PhysimError


@pytest.fixture
def campaign(tmp_path: Path) -> Path:
    folder = tmp_path / "campaign"
    (folder / FOLDER).mkdir(parents=True)
    (folder / "stills").mkdir()
    row = Row(run="0" * 20, world="w", seed=1, physim="1", engine="e", ended="finished")
    Shards(folder).write([row])
    assert read(folder).num_rows == 1
    return folder


@pytest.mark.parametrize("place", ["campaign.json", "stills/a.png", "rows/z.jsonl", "records"])
@pytest.mark.parametrize("what", ["link", "pipe"])
def test_links_and_pipes_are_refused(campaign: Path, place: str, what: str) -> None:
    if what == "pipe":
        os.mkfifo(campaign / place)
    else:
        outside = campaign.parent / "outside"
        outside.mkdir()
        (campaign / place).symlink_to(outside)
    with pytest.raises(PhysimError, match=f"is a {what}"):
        Folder(campaign)
    with pytest.raises(PhysimError, match=f"is a {what}"):
        read(campaign)


@pytest.mark.parametrize("line", ["[" * 200_000, '{"run": "0"}', '{"seed": 1e99}', "null"])
def test_what_is_no_row_is_refused(campaign: Path, line: str) -> None:
    (campaign / FOLDER / "zz.jsonl").write_text(line + "\n", encoding="utf-8")
    with pytest.raises(PhysimError, match=r"zz\.jsonl"):
        read(campaign)
