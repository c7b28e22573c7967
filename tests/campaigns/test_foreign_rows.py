"""Rows that are of no run of their campaign are refused, wherever they come from."""

from __future__ import annotations

import json
import os
import resource
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from physim.campaigns import Folder, Row, read
from physim.errors import PhysimError
from tests.campaigns.samples import specs
from tests.cli.commands import physim
from tests.helpers import check_error, facts, inside

UNTIL, read_until = inside("physim.campaigns", "UNTIL", "read_until")
FINISHED, CAMPAIGN = inside("physim.campaigns", "FINISHED", "CAMPAIGN")
row_without_run = inside("physim.campaigns", "row_without_run")

WORLD, SEED = "other", 7


@pytest.fixture
def campaign(tmp_path: Path) -> Path:
    """Rows of three seeds, none of which was run."""
    folder = tmp_path / "campaign"
    place = Folder(folder)
    place.open(specs(1))
    place.rows.write([row_without_run(one, FINISHED, "") for one in specs(3)])
    assert len(read(folder)) == 3
    return folder


def put(folder: Path, row: Row) -> str:
    """A row in a shard of its own, behind an empty run of the campaign; its place."""
    good = json.dumps(asdict(row_without_run(specs(1)[0], FINISHED, "")))
    file = folder / "rows/9-2-x-1.jsonl"
    file.write_text(f"{good}\n{json.dumps(asdict(row))}\n", encoding="utf-8")
    return f"{file}:2"


CHANGES: dict[str, Callable[[Row], Row]] = {
    "world": lambda row: replace(row, world=WORLD),
    "controller": lambda row: replace(row, controller="path_following"),
    "settings": lambda row: replace(row, settings="time.step=0.1"),
    "seed": lambda row: replace(row, seed=SEED),
    "run": lambda row: replace(row, run="f" * 20),
    "physim": lambda row: replace(row, physim="0.0.1"),
    "engine": lambda row: replace(row, engine="pymunk 1.0"),
    "world_hash": lambda row: replace(row, world_hash="0" * 12),
}


@pytest.mark.parametrize("column", CHANGES)
def test_a_changed_column_is_told_with_its_line(campaign: Path, column: str) -> None:
    changed = CHANGES[column](row_without_run(specs(4)[3], FINISHED, ""))
    place = put(campaign, changed)
    with pytest.raises(PhysimError, match=facts(place, CAMPAIGN)):
        read(campaign)


def test_a_row_behind_which_the_true_one_stands_is_refused_too(campaign: Path) -> None:
    """That of another seed was passed over, as a run that has two rows."""
    run = specs(3)[2]
    place = put(campaign, replace(row_without_run(run, FINISHED, ""), seed=SEED))
    file = Path(place.removesuffix(":2"))
    first = file.rename(file.with_name("0-2-x-1.jsonl"))
    with pytest.raises(PhysimError, match=facts(str(first), CAMPAIGN, str(SEED))):
        read(campaign)


def test_of_a_run_with_several_rows_the_last_that_did_not_fail_counts(campaign: Path) -> None:
    run = specs(3)[2]
    for name, row in (
        ("7-2-x-1", replace(row_without_run(run, FINISHED, ""), contacts=1)),
        ("8-2-x-1", replace(row_without_run(run, FINISHED, ""), contacts=2)),
        ("9-2-x-1", row_without_run(run, "timeout", "too long")),
    ):
        place = Path(put(campaign, row).removesuffix(":2"))
        place.rename(campaign / f"rows/{name}.jsonl")
    assert read(campaign)[2].contacts == 2


def test_a_changed_world_is_told(campaign: Path) -> None:
    (file,) = (campaign / "worlds").iterdir()
    file.write_text(file.read_text().replace("1.8", "1.7"))
    with pytest.raises(PhysimError, match=facts(str(file), "changed")):
        read(campaign)


@pytest.mark.parametrize(
    "change",
    [
        lambda cells: cells * 2,
        lambda cells: [{**cells[0], "world_hash": "../../outside"}],
        lambda cells: [{**cells[0], "world_hash": ""}],
        lambda cells: {},
        lambda cells: [3],
    ],
)
def test_cells_that_are_none_are_told(campaign: Path, change: Callable[[object], object]) -> None:
    file = campaign / CAMPAIGN
    tree = json.loads(file.read_text())
    file.write_text(json.dumps({**tree, "cells": change(tree["cells"])}))
    with pytest.raises(PhysimError, match=facts(str(file), "cells")):
        read(campaign)


@pytest.mark.parametrize(
    "command", [("report",), ("compare", "--by", "controller"), ("replay",)], ids=lambda c: c[0]
)
def test_commands_refuse_them(
    campaign: Path, command: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    place = put(campaign, CHANGES["seed"](row_without_run(specs(4)[3], FINISHED, "")))
    name, *more = command
    target = f"{campaign}:0" if name == "replay" else str(campaign)
    done = physim(name, target, *more, capture=capsys)
    assert done.code == 2
    check_error(done.err, place, CAMPAIGN)
    assert not (campaign / "report.html").exists()


# no link leads out of a folder, no pipe holds a command, no file fills the memory
@pytest.mark.parametrize("place", ["campaign.json", "stills/a.png", "rows/z.jsonl", "videos"])
@pytest.mark.parametrize("what", ["link", "pipe"])
def test_links_and_pipes_are_refused(campaign: Path, place: str, what: str) -> None:
    (campaign / place).parent.mkdir(exist_ok=True)
    (campaign / place).unlink(missing_ok=True)
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


@pytest.mark.parametrize("name", ["rows/zz.jsonl", CAMPAIGN, UNTIL])
def test_a_file_that_claims_gigabytes_is_refused_at_once(campaign: Path, name: str) -> None:
    with open(campaign / name, "wb") as file:
        file.truncate(2 * 10**9)  # sparse: nothing on the disk
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(PhysimError, match=Path(name).name):
        _read_all(campaign)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000  # [kB]


@pytest.mark.parametrize("name", ["rows/zz.jsonl", CAMPAIGN, UNTIL])
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
    Folder(campaign).cells()
    read_until(campaign)
