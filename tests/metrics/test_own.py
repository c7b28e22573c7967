"""Metrics that packages register: found by entry point, told like physim's own."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from physim.analysis.metrics import DEFINITIONS, definition, measure, measured
from physim.analysis.summary import summarise, table
from physim.errors import PhysimError
from physim.record import Record
from tests.cli.commands import physim
from tests.helpers import facts
from tests.helpers.packages import install
from tests.helpers.records import make_record

TEXT = '''
import numpy as np
from physim.analysis.metrics import Each, Moment

class Still:
    """Decisions to stand still. More lines follow.

    They are not shown.
    """
    unit = "-"

    def measure(self, record):
        return (record.updates["applied_v"] == 0.0).sum()

class Latest:
    unit, definition, source = "s", "when the last decision was made, by whom", "(14)"

    def measure(self, record):
        row = record.updates[-1]
        return Moment(float(row["step"]) * record.dt, int(row["step"]),
                      float(row["step"]) * record.dt, int(row["robot"]))

class Nothing:
    unit, definition = "m", "has no meaning here"

    def measure(self, record):
        return None

class Broken:
    unit, definition = "m", "fails"

    def measure(self, record):
        return record.no_such_thing

class Huge:
    unit, definition = "m", "a number without end"

    def measure(self, record):
        return 10**5000

class Words:
    unit, definition = "m", "gives words"

    def measure(self, record):
        return "far"

class Unitless:
    definition = "has no unit"

    def measure(self, record):
        return 1

class Unmade:
    unit, definition = "m", "cannot be made"

    def __init__(self):
        raise ValueError("no")

    def measure(self, record):
        return 1

class Given:
    """Whatever is written into the file beside."""
    unit = "m"

    def measure(self, record):
        from physim.analysis.metrics import Each, Moment, Place
        from math import inf, nan
        from pathlib import Path
        text = Path(__file__).with_name("answer.txt").read_text()
        return eval(text, {"Each": Each, "Moment": Moment, "Place": Place, "np": np,
                           "inf": inf, "nan": nan})

class Mute:
    unit = "m"
'''


@pytest.fixture(scope="module")
def record() -> Iterator[Record]:
    with make_record(seconds=2.0) as made:
        yield made


def registered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, **classes: str) -> None:
    name = f"own_metrics_{tmp_path.name.replace('-', '_')}"
    install(tmp_path, monkeypatch, name, TEXT, {"physim.metrics": classes})


def test_they_are_measured_like_physim_s_own(
    record: Record, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    registered(tmp_path, monkeypatch, still="Still", latest="Latest", nothing="Nothing")
    found = measure(record)
    assert set(found) - set(DEFINITIONS) == {"still", "latest"}
    assert found["still"].value == int((record.updates["applied_v"] == 0.0).sum())
    assert type(found["still"].value) is int
    assert (found["still"].unit, definition("still").source) == ("-", "-")
    assert definition("still").meaning.startswith("Decisions to stand still")
    assert found["latest"].bodies == (int(record.updates["robot"][-1]),)
    assert list(measure(record, ["latest", "decisions"])) == ["latest", "decisions"]
    assert definition("latest").source == "(14)"
    summary = summarise(record)
    assert summary.metric_faults == ()
    assert json.loads(summary.to_json())["metrics"]["latest"]["bodies"] == ["r3"]
    rows = dict(line.split("  ", 1) for line in table(summary).splitlines())
    assert (
        rows["latest"].strip()
        == f"{found['latest'].value:.4g} s (r3 at {found['latest'].time:.2f} s)"
    )


def test_definitions_list_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    registered(tmp_path, monkeypatch, latest="Latest", broken="Unmade")
    done = physim("summary", "--definitions", capture=capsys)
    assert done.code == 0
    assert "when the last decision was made, by whom [(14)]" in done.out
    assert done.err.count("\n") == 1
    told = json.loads(physim("summary", "--definitions", "--json", capture=capsys).out)
    assert told["latest"] == {
        "unit": "s", "meaning": "when the last decision was made, by whom", "source": "(14)",
    }  # fmt: skip
    assert "broken" not in told


@pytest.mark.parametrize(
    ("name", "one", "parts"),
    [
        ("broken", "Broken", ('"broken"', "AttributeError")),
        ("words", "Words", ('"words"', "str", "number")),
        ("huge", "Huge", ('"huge"', "int", "finite number")),
        ("unitless", "Unitless", ("Unitless.unit", "text")),
        ("unmade", "Unmade", ('"unmade"', "ValueError: no")),
        ("mute", "Mute", ("class Mute", "no method measure")),
        ("absent", "Absent", ('"absent"', "no class", "Absent")),
        ("contacts", "Still", ('"contacts"', "physim")),
        ("Loud!", "Still", ("'Loud!'", "small letters")),
    ],
)
def test_what_fails_is_told_in_one_line_and_the_rest_is_had(
    name: str,
    one: str,
    parts: tuple[str, ...],
    record: Record,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    registered(tmp_path, monkeypatch, **{name: one, "latest": "Latest"})
    found, faults = measured(record)
    assert "latest" in found
    assert set(found) >= {"contacts", "decisions"}
    assert len(faults) == 1
    assert re.search(facts("metric", *parts), faults[0])
    assert "\n" not in faults[0]
    with pytest.raises(PhysimError) as caught:
        measure(record)
    assert str(caught.value) == faults[0]
    assert measure(record, ["decisions"])
    summary = summarise(record)
    assert summary.metric_faults == faults
    assert [line for line in table(summary).splitlines() if line.startswith("WARNING")] == [
        line for line in table(summary).splitlines() if line.endswith(faults[0])
    ]
    if name not in DEFINITIONS:
        with pytest.raises(PhysimError):
            measure(record, [name])


@pytest.mark.parametrize(
    ("answer", "parts"),
    [
        ("Moment(3.0, 100, 1.0, 99)", ["body 99", "allowed: 0"]),
        ("Moment(3.0, 100, 1.0, 0, -1)", ["body -1", "allowed: 0"]),
        ("Moment(3.0, 100, 1.0, 'r1')", ["body 'r1'", "allowed: 0"]),
        ("Moment(nan, 100, 1.0, 0)", ["value nan", "finite"]),
        ("Moment(3.0, 100, inf, 0)", ["time inf", "finite"]),
        ("Moment(3.0, 10**6, 1.0, 0)", ["step 1000000", "allowed: 0"]),
        ("Place(3.0, 1.0, 3)", ["robot 3", "allowed: 0 to 2"]),
        ("Place(3.0, nan, 0)", ["station nan", "finite"]),
        ("Place('far', 1.0, 0)", ["value 'far'", "finite"]),
        ("Each(1.0, (1.0, 2.0))", ["2 robots", "the record has 3"]),
        ("Each(1.0, (1.0, 2.0, inf))", ["robots[2]", "inf", "finite", "None"]),
        ("Each(1.0, 2.0)", ["robots", "float", "tuple"]),
        ("nan", ["nan", "finite"]),
        ("np.float64('inf')", ["inf", "finite"]),
    ],
)
def test_answers_that_mean_nothing_are_told_and_the_summary_is_whole(
    answer: str, parts: list[str], record: Record, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "answer.txt").write_text(answer)
    registered(tmp_path, monkeypatch, given="Given")
    summary = summarise(record)
    (fault,) = summary.metric_faults
    assert fault.startswith('metric "given" ')
    assert re.search(facts(*parts), fault)
    assert "given" not in summary.metrics
    assert json.loads(summary.to_json())["metric_faults"] == [fault]
    assert table(summary).count("WARNING") == 1


@pytest.mark.parametrize(
    ("answer", "value"),
    [
        ("Moment(np.float64(3.0), np.int64(2), np.float32(1.0), np.int64(2), 0)", 3.0),
        ("Place(np.float64(3.0), 1, np.int64(2))", 3.0),
        ("Each(np.float64(3.0), np.array([1.0, 2.0, 3.0]))", 3.0),
        ("Each(3, [1.0, None, 3])", 3),
    ],
)
def test_numbers_of_numpy_become_plain_ones(
    answer: str, value: float, record: Record, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "answer.txt").write_text(answer)
    registered(tmp_path, monkeypatch, given="Given")
    summary = summarise(record)
    assert summary.metric_faults == ()
    assert json.loads(summary.to_json())["metrics"]["given"]["value"] == value


def test_one_of_a_shipped_name_is_told_in_the_list(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    registered(tmp_path, monkeypatch, contacts="Still", still="Still")
    lines = [line.split(maxsplit=1) for line in physim("list", capture=capsys).out.splitlines()]
    told = {line[0]: line[1] for line in lines if len(line) == 2}
    assert re.search(facts('"contacts"', "physim"), told["contacts"])
    assert told["still"] == "Decisions to stand still. More lines follow."


def test_what_a_metric_returns_is_imported_as_the_documentation_says() -> None:
    from physim import metrics
    from physim.metrics import Each, Moment, Place

    assert metrics.measure is measure
    assert (metrics.Each, metrics.Moment, metrics.Place) == (Each, Moment, Place)
