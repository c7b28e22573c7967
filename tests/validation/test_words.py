"""What a report says of a robot: by its command, and by all that its controller reported."""

from __future__ import annotations

from math import inf

import pytest

import physim
from physim import Decision
from physim.analysis.validation import report, validate
from physim.analysis.validation.wording import length, short
from physim.parts.declarations import AT_STOP, PAPER_MODES, SAFE, STANDARD_COLUMNS
from tests.validation.reports import states
from tests.validation.runs import LANE, REAR_END


class Saying:
    """Drives as in REAR_END; the fast one, which comes from behind, tells the same each time."""

    modes = PAPER_MODES
    columns = STANDARD_COLUMNS

    def __init__(self, mode=None, considered=(), **reported) -> None:
        self.reported = ((SAFE, (), {}), (mode, considered, reported))

    def decide(self, observation, memory):
        v, omega = REAR_END[observation.index]
        mode, considered, reported = self.reported[observation.index]
        return Decision(
            v=v, omega=omega, hold=0.1, mode=mode, considered=considered, report=reported
        )  # fmt: skip


def words(mode=None, **reported):
    record = physim.simulate(physim.parse_world(LANE), controller=Saying(mode, **reported))
    return " ".join(report(validate(record)).split())


def test_a_robot_that_says_it_has_arrived_and_drives_on():
    text = words(AT_STOP, distance=0.5, collision_time=0.1, considered=(0,))
    assert states(text, "fast said", "arrived", "command", "to move", within=60)
    assert states(text, "mode arrived", "v 1.400 m/s", within=30)
    assert "standing" not in text
    assert "stood" not in text


@pytest.mark.parametrize(
    ("reported", "said"),
    [
        ({}, ("no distance", "no collision time")),
        (
            {"boundary_distance": 0.37},
            ("0 robots", "nearest boundary 0.37 m", "no collision time"),
        ),
        (
            {"distance": inf, "considered": (0,)},
            ("1 robot", "infinitely far", "no collision time"),
        ),
        (
            {"distance": inf, "collision_time": inf},
            ("0 robots", "nearest of them none", "collision time none"),
        ),
        (
            {"distance": 1e308, "considered": (0,), "collision_time": 1e308},
            ("1 robot", "nearest of them 1e+308 m", "collision time 1e+308 s"),
        ),
        (
            {"distance": -inf, "boundary_distance": inf, "collision_time": -3.0},
            ("0 robots", "nearest of them -inf m", "nearest boundary none", "time -3.000 s"),
        ),
    ],
)
def test_all_that_a_controller_reported_is_told(reported, said):
    text = words(**reported)
    start = text.index("omega 0.200 rad/s; ")
    decision = text[start : text.index(". ", start)]
    assert states(decision, *said)
    assert ("considered" in decision) == bool(reported)
    assert ("boundary" in decision) == ("boundary_distance" in reported)


def test_huge_values_are_short():
    assert [length(x) for x in (1e308, -1e308, 999_999.0, 0.5)] == [
        "1e+308 m", "-1e+308 m", "999999.00 m", "0.50 m",
    ]  # fmt: skip
    assert [short(x) for x in (1e308, inf, 12.0)] == ["1e+308 s", "inf s", "12.000 s"]
