"""``physim summary``: the metrics of a record, and what they are."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from physim.analysis.metrics import DEFINITIONS, measure
from physim.record import Record
from tests.cli.commands import physim
from tests.helpers.records import make_record


def test_definitions_tell_every_metric(capsys: pytest.CaptureFixture[str]) -> None:
    done = physim("summary", "--definitions", capture=capsys)
    assert (done.code, done.err) == (0, "")
    lines = done.out.splitlines()
    assert [line.split()[0] for line in lines if line[0] != " "] == list(DEFINITIONS)
    assert max(len(line) for line in lines) <= 100
    told = json.loads(physim("summary", "--definitions", "--json", capture=capsys).out)
    assert told["shortest_collision_time"]["unit"] == "s"
    assert list(told) == list(DEFINITIONS)


def test_json_holds_every_metric_of_the_record(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    make_record(tmp_path / "r.h5", robots=1, seconds=12.0).close()
    told = json.loads(physim("summary", tmp_path / "r.h5", "--json", capture=capsys).out)
    with Record.load(tmp_path / "r.h5") as record:
        found = measure(record)
    assert {name: one["value"] for name, one in told["metrics"].items()} == {
        name: one.value for name, one in found.items()
    }
    assert "formation_error_peak" not in told["metrics"]
    assert told["metrics"]["contacts"] == {"value": 0, "unit": "-"}


@pytest.mark.parametrize("arguments", [(), ("--json",), ("--definitions", "r.h5")])
def test_a_record_or_the_definitions(
    arguments: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    done = physim("summary", *arguments, capture=capsys)
    assert (done.code, done.out) == (2, "")
    assert done.err.count("\n") == 1
    assert "--definitions" in done.err
