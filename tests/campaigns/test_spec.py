"""What a run is: the same everywhere, another where anything that decides it is another."""

from __future__ import annotations

import json
import pickle
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

import physim
from physim.analysis.summary import table_rows
from physim.campaigns import run_one, spec_of
from physim.errors import PhysimError
from physim.units import amount
from physim.world.file import parse_world
from tests.campaigns.samples import WORLD
from tests.helpers import inside
from tests.helpers.unpacking import unpack

COLUMNS, make_grid = inside("physim.campaigns", "COLUMNS", "make_grid")
simulation_of, modules_of = inside("physim.campaigns", "simulation_of", "modules_of")
CONTROLLER = inside("physim.parts", "CONTROLLER")
record_run = inside("physim.simulation", "record_run")
run_data = inside("physim.drawing.page", "run_data")
json_of_validation = inside("physim.analysis.validation", "json_of_validation")


def test_what_makes_another_run(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (spec,) = make_grid(["small.yaml"], range(1, 2), (), ["awkward:Awkward"])
    others = [
        replace(spec, seed=2),
        replace(spec, text=spec.text.replace("1.8", "1.9")),
        replace(spec, controller="awkward:Other"),
        replace(spec, sources=(spec.sources[0]._replace(text="x"), *spec.sources[1:])),
        replace(spec, sources=spec.sources[:1]),
    ]
    key = spec.key
    for name, value in (("engine", lambda: "y"), ("__version__", "y")):
        with monkeypatch.context() as changed:
            changed.setattr(f"physim.campaigns.spec.{name}", value)
            assert spec.key != key
    assert len({one.key for one in [spec, *others]}) == len(others) + 1
    assert replace(spec, limit=1.0, world="called otherwise").key == spec.key
    elsewhere = tuple(one._replace(file="/elsewhere.py") for one in spec.sources)
    assert replace(spec, sources=elsewhere).key == spec.key
    assert len(spec.key) == 20
    assert int(spec.key, 16) >= 0


def test_the_seed_of_the_world_is_no_part_of_it() -> None:
    one, other = parse_world(WORLD), parse_world(WORLD.replace("seed: 1", "seed: 5"))
    assert spec_of(one, 3) == spec_of(other, 3)


@pytest.mark.parametrize("given", [
    {"seed": -1}, {"seed": 1.5}, {"seed": True}, {"seed": "4"}, {"seed": 2**63},
    {"settings": 5}, {"settings": "\udc00"}, {"name": 3}, {"limit": -1.0}, {"limit": float("nan")},
    {"limit": 1e10}, {"limit": True}, {"limit": np.complex64(1)}, {"limit": np.timedelta64(5, "s")},
])  # fmt: skip
def test_what_no_row_could_hold_is_refused(given: dict[str, Any]) -> None:
    """It would lock the folder that it is written to."""
    world = parse_world(WORLD)
    with pytest.raises(PhysimError, match=next(iter(given)).replace("name", "world")):
        spec_of(world, **{"seed": 0, **given})
    assert spec_of(world, 0, limit=float("inf")).limit == float("inf")
    assert spec_of(world, cast("int", np.int64(3))) == spec_of(world, 3)
    assert type(spec_of(world, cast("int", np.int64(3))).seed) is int


@pytest.mark.deep
def test_a_seed_runs_though_the_first_one_does_not() -> None:
    """Robots in a tight place: not every seed finds room for them."""
    tight = parse_world(TIGHT)
    assert run_one(spec_of(tight, 2)).ended == "duration"
    failed = run_one(spec_of(tight, 0))
    assert (failed.ended, "could be placed" in failed.reason) == ("error", True)


TIGHT = """\
name: tight
time: {step: 0.02, duration: 0.2}  # [s]
corridor: {centreline: [[0, 0], [20, 0]], width: 8.0}  # [m]
robots:
  - count: 4
    footprint: {length: 1.8, width: 1.0}  # [m]
    path: {offset: 0.0}
    start: {region: [[1, -3], [3.8, -3], [3.8, 3], [1, 3]], min_gap: 0.1}
"""


def test_a_run_of_a_spec_is_that_of_its_world() -> None:
    world = parse_world(WORLD)
    spec = pickle.loads(pickle.dumps(spec_of(world, 3)))
    direct = physim.simulate(world, seed=3)
    assert record_run(simulation_of(spec)).digest() == direct.digest()
    row, found = run_one(spec), physim.summarise(direct)
    assert row.decisions == found.value("decisions")
    assert (row.ended, row.seconds, row.robots) == ("duration", 1.0, 2)


TOUCHING = """\
name: touching
seed: 1
time: {step: 0.02, duration: 3.0}
expect: {contacts: 0, min_distance: 0.05, min_boundary_distance: 0.05}
corridor: {centreline: [[0, 0], [20, 0]], width: 8.0}
controller: {type: constant, commands: [[1.0, 0.0], [1.0, 0.0], [1.0, 0.0]]}
robots:
  - {name: a, footprint: {length: 1.8, width: 1.0}, pose: [6.0, 0.0, 0.0], path: {offset: 0.0}}
  - {name: b, footprint: {length: 1.8, width: 1.0}, pose: [10.0, 0.0, 3.14], path: {offset: 0.0}}
  - {name: c, footprint: {length: 1.8, width: 1.0}, pose: [3.0, 2.5, 1.57], path: {offset: 0.0}}
"""


def test_one_name_has_one_value_in_all_that_is_said_of_a_run() -> None:
    """Summary, its table, the row of a sweep, validation and page."""
    world = parse_world(TOUCHING)
    row = run_one(spec_of(world, 1))
    record = physim.simulate(world)
    summary, validation = physim.summarise(record), physim.validate(record)
    told, found = json.loads(summary.to_json()), json.loads(json_of_validation(validation))
    metrics = {name: one["value"] for name, one in told["metrics"].items()}
    alike = metrics.keys() & set(COLUMNS)
    assert alike >= {"contacts", "contacts_between_robots", "contacts_with_boundaries", "grazes",
                     "shortest_distance", "shortest_boundary_distance", "closing_speed",
                     "energy_lost", "impulse", "first_contact", "deepest_contact", "decisions",
                     "deviation_peak", "messages"}  # fmt: skip
    assert {name: getattr(row, name) for name in alike} == {name: metrics[name] for name in alike}
    assert row.least_distance == min(row.shortest_distance, row.shortest_boundary_distance)
    assert row.contacts == len(told["contacts"]) == len(found["contacts"]) == 2
    assert (row.not_arrived, row.closing_speed) == ("a, b, c", pytest.approx(2.0, abs=1e-3))
    assert not row.contact_free

    assert max(one["severity"]["closing"] for one in found["contacts"]) == row.closing_speed
    assert found["contacts"][0]["time"] == row.first_contact
    expected = {one["key"]: one["got"] for one in found["expectations"]}
    assert expected == {
        "contacts": row.contacts + row.grazes,
        "min_distance": row.shortest_distance,
        "min_boundary_distance": row.shortest_boundary_distance,
    }
    assert told["expectations"] == found["expectations"]
    for rows in (dict(table_rows(summary)).values(), [summary._repr_html_()]):
        for value in (row.shortest_distance, row.shortest_boundary_distance):
            assert any(amount(value, "m", 4) in text for text in rows)
    header, _ = unpack(run_data(record, summary))
    times = {one["label"]: one["time"] for one in header["moments"]}
    assert times["shortest distance"] == told["metrics"]["shortest_distance"]["time_s"]
    assert times["first contact"] == row.first_contact
    (contacts,) = [text for label, text in table_rows(summary) if label == "contacts"]
    assert contacts.startswith("2 (1 between robots, 1 with boundaries)")


def test_sources_of_a_package_with_relative_imports(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "my_packet" / "deep"
    folder.mkdir(parents=True)
    (folder.parent / "__init__.py").write_text("")
    (folder.parent / "speeds.py").write_text("FAST = 1.0\n")
    (folder / "__init__.py").write_text("")
    (folder / "one.py").write_text(
        "from ..speeds import FAST\nimport math\n\n\nclass One:\n"
        "    def decide(self, observation, memory):\n        return None\n"
    )
    monkeypatch.chdir(tmp_path)
    found = modules_of([(CONTROLLER, "my_packet.deep.one:One")])
    assert [one.module for one in found] == [
        "my_packet", "my_packet.deep", "my_packet.deep.one", "my_packet.speeds",
    ]  # fmt: skip
    assert modules_of([(CONTROLLER, "mode_switching")]) == ()


@pytest.mark.parametrize(
    ("how", "text"),
    [("raise", "ValueError: as it was told"), ("leave", "away")],
)
def test_a_run_that_raises_is_a_row_that_says_where(here: Path, how: str, text: str) -> None:
    grid = make_grid(["small.yaml"], None, [f"controller.how={how}"], ["awkward:Awkward"])
    row = run_one(*grid)
    assert row.ended == "error"
    assert text in row.reason
    assert "awkward.py" in row.reason
    assert "\n" not in row.reason
    assert row.contacts is None
