"""Which contacts were due to a disturbance: the run without it shows it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import physim
from physim.analysis.validation import report, validate
from tests.analysis.validation.runs import Drivers
from tests.helpers import said
from tests.helpers.stages import Changes

WORLD = """\
name: lane
seed: 1
time: {step: 0.01, duration: 4.0}
corridor: {centreline: [[0, 0], [30, 0]], width: 8.0}
robots:
  - {name: slow, footprint: {length: 1.8, width: 1.0}, pose: [8.0, 0.0, 0.0], path: {offset: 0.0}}
  - {name: fast, footprint: {length: 1.8, width: 1.0}, pose: [4.6, 0.0, 0.0], path: {offset: 0.0}}
  - {name: aside, footprint: {length: 1.8, width: 1.0}, pose: [9, 2.5, 0.0], path: {offset: 2.5}}
controller: {type: constant, commands: [[0.5, 0.0], [1.4, 0.0], [1.0, 0.0]]}
disturbances: [{type: actuation, omega: {bias: 0.4}, robots: [aside]}]
"""
"""One robot runs into another whatever happens; a third turns into the wall by its bias alone."""
PAIRS = {("slow", "fast"), ("aside", "left wall")}


def world(**changes: Any) -> physim.World:
    return physim.parse_world(WORLD).changed(**changes)


def told(found: physim.analysis.validation.Validation) -> dict[tuple[str, str], float | None]:
    assert found.undisturbed is not None
    return {(found.names[one.a], found.names[one.b]): one.time for one in found.undisturbed.pairs}


def test_each_pair_is_told_whether_it_touches_without_the_disturbance(tmp_path: Path) -> None:
    (tmp_path / "lane.yaml").write_text(WORLD)
    record = physim.simulate(world(), path=tmp_path / "record.h5")
    found = validate(record)
    pairs, (first,) = told(found), [one for one in found.contacts if one.b == 1]
    assert pairs.keys() == PAIRS
    assert pairs["aside", "left wall"] is None
    assert pairs["slow", "fast"] == first.time
    record.close()
    for given in ("lane.yaml", "record.h5"):
        done = said("validate", str(tmp_path / given), "--json", str(tmp_path / f"{given}.json"))
        assert done.code == 1
        out = " ".join(done.out.split())
        assert "Due to actuation: contacts of aside with left wall." in out
        assert f"touch, too: slow with fast (first at {first.time:.2f} s)." in out
        values = json.loads((tmp_path / f"{given}.json").read_text())["undisturbed"]
        assert values["without"] == ["actuation"]
        assert [one["time"] for one in values["pairs"]] == [*pairs.values()]
    page = tmp_path / "found.html"
    said("validate", str(tmp_path / "record.h5"), "--page", str(page))
    assert "without them these two do not touch" in page.read_text()
    done = said("validate", str(tmp_path / "record.h5"), "--no-rerun")
    assert "due to actuation is not known: not asked for" in " ".join(done.out.split())


def test_without_disturbances_or_contacts_nothing_is_told() -> None:
    assert validate(physim.simulate(world(disturbances=[]))).undisturbed is None
    apart = {"type": "constant", "commands": [[1.0, 0.0]] * 3}
    free = world(controller=apart, time={"duration": 0.5})
    assert validate(physim.simulate(free)).undisturbed is None


def test_one_of_no_strength_is_never_to_blame() -> None:
    off = world(disturbances=[{"type": "actuation", "omega": {"bias": 0.0}}])
    pairs = told(validate(physim.simulate(off)))
    assert list(pairs) == [("slow", "fast")]
    assert pairs["slow", "fast"] is not None


def test_those_from_python_are_left_out_and_others_from_there_are_missed() -> None:
    turned = Changes(lambda commands: commands + [[0.0, 0.0], [0.0, 0.0], [0.0, 0.4]])
    calm = world(disturbances=[])
    pairs = told(validate(physim.simulate(calm, disturbances=[turned])))
    assert pairs.keys() == PAIRS
    assert pairs["aside", "left wall"] is None
    given: Any
    for given, missed in (
        ({"filters": [Changes(lambda commands: commands)]}, "filter"),
        ({"controller": Drivers((0.5, 0.0), (1.4, 0.0), (1.0, 0.0))}, "controller"),
    ):
        found = validate(physim.simulate(calm, disturbances=[turned], **given))
        assert len(found.contacts) >= 2
        assert found.undisturbed is not None
        assert found.undisturbed.pairs == ()
        assert missed in found.undisturbed.why_not
        assert "is not known: " in report(found)


def test_sensing_stages_are_left_out_too() -> None:
    late = world(sensing={"stages": [{"type": "delay", "seconds": 0.5}]})
    found = validate(physim.simulate(late))
    assert told(found).keys() == PAIRS
    assert found.undisturbed is not None
    assert found.undisturbed.without == ("delay", "actuation")


def test_a_run_that_went_on_from_a_state_goes_on_without() -> None:
    simulation = physim.Simulation(world())
    simulation.step(steps=100)
    record = physim.record_run(simulation)
    assert record.begun_at == 100
    pairs = told(validate(record))
    assert pairs.keys() == PAIRS
    late = pairs["aside", "left wall"]  # towards which it had turned by then
    assert late is not None
    assert late > 1.69
