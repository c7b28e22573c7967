"""What controllers tell of a decision: what was not declared or no record may hold is refused."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import physim
from physim import Column, Decision, Mode, Rule
from physim.errors import ControllerError
from tests.analysis.validation.runs import LANE
from tests.helpers import facts, inside

STANDARD_COLUMNS, Declared = inside("physim.parts", "STANDARD_COLUMNS", "Declared")


class Telling:
    modes = (Mode("going", "#112233", "goes"), Mode("waiting", "#445566"))
    rules = (Rule("ahead"),)
    columns = (Column("effort", "J"), *STANDARD_COLUMNS)

    def __init__(self, hold=0.1, **told) -> None:
        self.hold, self.told = hold, told

    def decide(self, observation, memory):
        return Decision(v=0.0, omega=0.0, hold=self.hold, **self.told)


def test_what_was_declared_is_recorded():
    told = {
        "mode": "waiting", "rule": Telling.rules[0], "considered": np.array([1]),
        "report": {
            "effort": np.float32(0.5), "target_y": None, "distance": True,
            "collision_time": np.array(2),
        },
    }  # fmt: skip
    world = physim.parse_world(LANE, overrides=["time.duration=0.1"])
    with physim.simulate(world, controller=Only(0, Telling(**told))) as record:
        assert record.declared == Declared(Telling.modes, Telling.rules, Telling.columns)
        row = record.updates[record.updates["robot"] == 0][0]
        assert record.modes[row["mode"]].name == "waiting"
        assert (row["rule"], row["considered"]) == (0, 1)
        assert record.considered[["step", "robot", "other"]].tolist() == [(0, 0, 1)]
        names = ("effort", "target_x", "target_y", "distance", "collision_time")
        values = [row[name] for name in names]
        assert np.array_equal(values, [0.5, np.nan, np.nan, 1.0, 2.0], equal_nan=True)
        other = record.updates[record.updates["robot"] == 1][0]
        assert (other["mode"], other["rule"], other["considered"]) == (-1, -1, 0)
        assert np.isnan(record.column("none such", absent=np.nan)).all()
        with pytest.raises(physim.RecordError, match=facts('"colision_time"', '"collision_time"?')):
            record.column("colision_time")


class Only:
    """Lets a controller speak for one robot; the others say as little as can be."""

    def __init__(self, index, inner) -> None:
        self.index, self.inner = index, inner
        self.modes, self.rules, self.columns = inner.modes, inner.rules, inner.columns

    def decide(self, observation, memory):
        if observation.index == self.index:
            return self.inner.decide(observation, memory)
        return Decision(0.0, 0.0, 0.1)


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        ({"mode": "waitng"}, ("mode", "'waitng'", "going", "waiting")),
        ({"mode": 1}, ("mode", "1", "going", "waiting")),
        ({"mode": Mode("going", "#000000")}, ("mode", "Mode", "going", "waiting")),
        ({"rule": "ahaed"}, ("rule", "'ahaed'", "ahead")),
        ({"considered": 1}, ("considered", "1", "list", "index")),
        ({"considered": [1.5]}, ("considered", "[1.5]", "list", "index")),
        ({"considered": [0, 9]}, ("considered", "[0, 9]", "0 to 1")),
        ({"considered": [1, 1]}, ("considered", "[1, 1]", "once")),
        ({"considered": [-1]}, ("considered", "[-1]", "0 to 1")),
        ({"considered": [1, 0]}, ("considered is [1, 0]", "itself", "others")),
        ({"report": None}, ("report", "NoneType", "mapping")),
        ({"report": {"efort": 1.0}}, ("report", "'efort'", "effort")),
        ({"report": {3: 1.0}}, ("report", "3", "effort")),
        ({"report": {"effort": "near"}}, ("report", "effort", "'near'", "number")),
        ({"report": {"effort": np.arange(9.0)}}, ("report", "effort", "array(", "number")),
        ({"hold": 10**5000}, ("hold", "int", "number")),
        ({"hold": 10**400}, ("hold", "number")),
    ],
)
def test_wrong_fields_are_named(answer, said):
    where = ("controller Telling", "slow", "0 s")
    with pytest.raises(ControllerError, match=facts(*where, *said)) as error:
        physim.simulate(physim.parse_world(LANE), controller=Telling(**answer))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("declared", "said"),
    [
        ({"modes": "safe"}, ("modes", "tuple", "Mode(...)")),
        ({"modes": (Rule("safe"),)}, ("modes", "tuple", "Mode(...)")),
        ({"modes": (Mode("Safe!", "#000000"),)}, ("modes", "'Safe!'", "letters", "digits", "_")),
        ({"modes": (Mode("a", "red"),)}, ("modes", '"a"', "'red'", "#rrggbb")),
        ({"rules": (Rule("a"), Rule("a"))}, ("rules", '"a"', "2 times")),
        ({"rules": (Rule("a", "x\x1b[2J"),)}, ("rules", '"a"', "plain text")),
        ({"columns": (Column("step"),)}, ("columns", '"step"')),
        ({"columns": (Column("distance", "cm"),)}, ("columns", '"distance"', "'cm'", "'m'")),
    ],
)
def test_declarations_that_cannot_be_are_refused(declared, said):
    with pytest.raises(ControllerError, match=facts(*said)):
        Declared.of(SimpleNamespace(**declared))


class Remembering:
    """Counts its own decisions for each robot, and tells the count by its command."""

    def decide(self, observation, memory):
        count = 1 if memory is None else memory[observation.name] + 1
        return Decision(v=0.1 * count, omega=0.0, hold=0.1, memory={observation.name: count})


def test_what_a_controller_remembers_comes_back_to_it():
    world = physim.parse_world(LANE, overrides=["time.duration=0.5"])
    rows = physim.simulate(world, controller=Remembering()).updates
    for robot in (0, 1):
        assert rows["nominal_v"][rows["robot"] == robot] == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5])
