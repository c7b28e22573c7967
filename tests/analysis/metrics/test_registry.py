"""Named metrics: what each is, which are absent, and how they are asked for."""

from __future__ import annotations

import math

import pytest

from physim.analysis.metrics import DEFINITIONS, measure
from physim.errors import PhysimError
from tests.analysis.metrics.histories import history
from tests.helpers import facts
from tests.helpers.records import make_record

UNITS = {
    "-", "m", "s", "1/s", "1/min", "m/s", "rad/s", "m/s^2", "rad/s^2", "m^2", "J", "N s",
}  # fmt: skip
OF_SEVERAL = {"shortest_distance", "farthest_distance", "contacts_between_robots"}
OF_MOVERS = {"contacts_with_movers"}
OF_A_FORMATION = {name for name in DEFINITIONS if name.startswith("formation_")}
OF_A_FINISH = {"time_to_finish", "stop_distance"}
OF_A_LOG = {"seen_collision_time"}
OF_CONTACTS = {"first_contact", "deepest_contact", "closing_speed", "energy_lost", "impulse"}


def test_every_metric_is_defined() -> None:
    for name, one in DEFINITIONS.items():
        assert one.name == name
        assert one.unit in UNITS
        assert len(one.meaning) > 10
        assert one.source == "-" or one.source.startswith(("(", "Fig", "Section"))


def test_all_are_measured_where_all_have_a_meaning() -> None:
    with make_record(seconds=12.0) as record:  # its world tells no masses
        found = measure(record)
    without = {*OF_A_FINISH, *OF_MOVERS, *OF_A_LOG, "energy_lost"}
    assert list(found) == [name for name in DEFINITIONS if name not in without]
    for metric in found.values():
        assert math.isfinite(metric.value)
        assert metric.robots is None or len(metric.robots) == 3


def test_one_robot_has_no_metric_of_several() -> None:
    with make_record(robots=1, seconds=12.0) as record:
        found = set(measure(record))
    missing = set(DEFINITIONS) - found
    without = OF_A_FORMATION | OF_CONTACTS | OF_SEVERAL | OF_MOVERS | OF_A_FINISH | OF_A_LOG
    assert missing == without
    with make_record(seconds=12.0, world_text="name: x\n") as record:  # without a formation
        assert not OF_A_FORMATION & set(measure(record))


def test_an_empty_record_has_counts_only() -> None:
    found = measure(history(steps_run=0))
    assert {name: metric.value for name, metric in found.items() if "width" not in name} == {
        "simulated_time": 0.0,
        "finished": False,
        "contacts": 0,
        "contacts_between_robots": 0,
        "contacts_with_boundaries": 0,
        "decisions": 0,
        "grazes": 0,
        "messages": 0,
        "filtered_steps": 0,
        "disturbed_steps": 0,
    }


def test_names_are_checked() -> None:
    with make_record(seconds=1.0) as record:
        assert list(measure(record, ["contacts", "decisions"])) == ["contacts", "decisions"]
        with pytest.raises(PhysimError, match=facts("metric", '"contact"', '"contacts"')):
            measure(record, ["contact"])
