"""Tables of a record as data frames: the same values, with names."""

from __future__ import annotations

import sys

import numpy as np
import pytest

import physim
from physim.errors import PhysimError
from physim.world.file import parse_world
from tests.campaigns.samples import WORLD

TOUCHING = (
    WORLD.replace("duration: 1.0", "duration: 3.0")
    .replace("[6.0, 1.0, random]", "[6.0, 1.0, 0.0]")
    .replace("[3.0, -1.0, random]", "[6.0, -1.2, 1.5]")
)


class Ahead:
    """Goes where it heads, into whatever is there."""

    modes = (physim.Mode("going", "#0072b2"),)

    def decide(self, observation, memory):
        return physim.Decision(v=1.0, omega=0.0, hold=0.1, mode="going")


def test_tables_hold_the_values_of_the_record() -> None:
    record = physim.simulate(parse_world(TOUCHING), controller=Ahead())
    steps = record.to_pandas()
    assert len(steps) == record.samples * 2
    b = steps[steps["robot"] == "b"]
    assert np.array_equal(b[["x", "y", "heading"]].to_numpy(), record.pose[:, 1])
    assert np.array_equal(b["time"].to_numpy(), record.time)
    assert np.array_equal(b["clearance"].to_numpy(), record.clearance[:, 1])
    updates = record.to_pandas("updates")
    assert np.array_equal(updates["applied_v"].to_numpy(), record.updates["applied_v"])
    assert set(updates["robot"]) == {"a", "b"}
    assert set(updates["mode"]) == {"going"}
    contacts = record.to_pandas("contacts")
    assert np.array_equal(contacts["depth"].to_numpy(), record.contacts["depth"])
    assert {"began"} <= set(contacts["phase"]) <= {"began", "stays", "ended"}
    assert set(contacts["a"]) == {"a"}


def test_what_cannot_be_had_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    record = physim.simulate(parse_world(WORLD))
    with pytest.raises(PhysimError, match="steps, updates, contacts"):
        record.to_pandas("poses")
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(PhysimError, match="pip install pandas"):
        record.to_pandas()
