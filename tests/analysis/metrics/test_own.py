"""Metrics that packages register: found by entry point, told like physim's own."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from physim.analysis.metrics import DEFINITIONS, Figures, definition, measure
from physim.analysis.summary import summarise, table
from physim.errors import PhysimError
from physim.record import Record
from tests.helpers import facts
from tests.helpers.packages import install
from tests.helpers.records import make_record

TEXT = '''
import numpy as np
from physim.metrics import Each, Moment  # as the documentation says

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

class Unitless(Nothing):
    unit = None

class Unmade(Nothing):
    def __init__(self):
        raise ValueError("no")

class Given:
    """Whatever is written into the file beside."""
    unit = "m"

    def measure(self, record):
        from physim.metrics import Each, Moment, Place
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


@pytest.mark.parametrize(
    ("name", "one", "parts"),
    [
        ("unitless", "Unitless", ("Unitless.unit", "text")),
        ("unmade", "Unmade", ('"unmade"', "ValueError: no")),
        ("mute", "Mute", ("class Mute", "no method measure")),
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
    found, faults = Figures(record).metrics()
    assert "latest" in found
    assert set(found) >= {"contacts", "decisions"}
    assert len(faults) == 1
    assert re.search(facts("metric", *parts), faults[0])
    assert "\n" not in faults[0]
    with pytest.raises(PhysimError) as caught:
        measure(record)
    assert str(caught.value) == faults[0]
    assert measure(record, ["decisions"])
    assert summarise(record).metric_faults == faults
    if name not in DEFINITIONS:
        with pytest.raises(PhysimError):
            measure(record, [name])


@pytest.mark.parametrize(
    ("answer", "parts"),
    [
        ("Moment(3.0, 100, 1.0, 99)", ["body 99", "allowed: 0"]),
        ("Moment(3.0, 100, inf, 0)", ["time inf", "finite"]),
        ("Moment(3.0, 10**6, 1.0, 0)", ["step 1000000", "allowed: 0"]),
        ("Place(3.0, 1.0, 3)", ["robot 3", "allowed: 0 to 2"]),
        ("Place('far', 1.0, 0)", ["value 'far'", "finite"]),
        ("Each(1.0, (1.0, 2.0))", ["2 robots", "the record has 3"]),
        ("Each(1.0, (1.0, 2.0, inf))", ["robots[2]", "inf", "finite", "None"]),
        ("nan", ["nan", "finite"]),
        ("np.no_such_thing", ["AttributeError"]),
        ("'far'", ["str", "number"]),
        ("10**5000", ["int", "finite"]),
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
