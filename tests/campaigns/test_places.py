"""Folders of campaigns come from strangers: no link leads out of them, no pipe holds a command."""

from __future__ import annotations

import json
import os
import resource
from pathlib import Path

import pytest

from physim.campaigns import Folder, Row
from physim.errors import PhysimError
from tests.campaigns.samples import read
from tests.helpers import inside

CAMPAIGN, FOLDER, Shards = inside("physim.campaigns", "CAMPAIGN", "FOLDER", "Shards")
UNTIL, read_until = inside("physim.campaigns", "UNTIL", "read_until")


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


@pytest.mark.parametrize("name", [f"{FOLDER}/zz.jsonl", CAMPAIGN, UNTIL])
def test_a_file_that_claims_gigabytes_is_refused_at_once(campaign: Path, name: str) -> None:
    with open(campaign / name, "wb") as file:
        file.truncate(2 * 10**9)  # sparse: nothing on the disk
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(PhysimError, match=Path(name).name):
        _read_all(campaign)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000  # [kB]


@pytest.mark.parametrize("name", [f"{FOLDER}/zz.jsonl", CAMPAIGN, UNTIL])
@pytest.mark.parametrize("text", ["[" * 200_000, "9" * 5000, '{"a": 1', "\udcff", "[]", "{}"])
def test_what_is_no_json_is_told_in_plain_words(campaign: Path, name: str, text: str) -> None:
    (campaign / name).write_bytes(text.encode("utf-8", "surrogateescape") + b"\n")
    with pytest.raises(PhysimError, match=Path(name).name) as caught:
        _read_all(campaign)
    assert "sys.set_int" not in str(caught.value)
    assert "recursion" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "tree"),
    [
        (CAMPAIGN, {"format": "physim-campaign", "version": 1, "cells": {}}),
        (CAMPAIGN, {"format": "physim-campaign", "version": 1, "cells": [{"world": 1}]}),
        (UNTIL, {"format": "physim-until", "version": 1, "goal": "0.1", "first_seed": -1}),
        (UNTIL, {"format": "physim-until", "version": 1, "goal": "0.1", "first_seed": True}),
        (UNTIL, {"format": "physim-until", "version": 1, "first_seed": 0}),
    ],
)
def test_what_a_file_lacks_is_named(campaign: Path, name: str, tree: dict[str, object]) -> None:
    (campaign / name).write_text(json.dumps(tree), encoding="utf-8")
    with pytest.raises(PhysimError, match=f"{name}.*(cells|world|first_seed|goal|width)"):
        _read_all(campaign)


def _read_all(campaign: Path) -> None:
    read(campaign)
    if (campaign / CAMPAIGN).exists():
        Folder(campaign).cells()
    read_until(campaign)
