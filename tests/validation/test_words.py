"""What a report says of a robot: by its command, and by all that its controller reported."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import pytest

import physim
from physim import PAPER_MODES, Decision
from physim.analysis.validation import report, validate
from tests.helpers import inside
from tests.validation.reports import states
from tests.validation.runs import LANE, REAR_END

describe_cause = inside("physim.analysis.validation", "describe_cause")
describe_responsibility = inside("physim.analysis.validation", "describe_responsibility")
length, short = inside("physim.analysis.validation", "length", "short")
AT_STOP, SAFE, STANDARD_COLUMNS = inside("physim.parts", "AT_STOP", "SAFE", "STANDARD_COLUMNS")


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


def test_a_command_that_kept_clear_of_what_was_known_is_not_blamed():
    """Of crowded_start with seed 97: r1 decides in the same step as r3, which avoids it."""
    world = physim.load_world("crowded_start", overrides=["time.duration=15", "expect=null"])
    with physim.simulate(world, seed=97) as record:
        found = validate(record)
        (one,) = found.contacts
        avoiding, other = (
            next(s for s in one.sides if s.responsible is who) for who in (True, False)
        )
        assert avoiding.mode.danger
        assert avoiding.decided == other.decided
        assert "by the paper's rule of priority" in describe_responsibility(one, found.names)
        said = describe_cause(one, found.names)
        assert states(said, "r3", "reported no collision", "r1", "in the same step")
        for decided, words in ((avoiding.decided - 0.2, "held"), (avoiding.decided + 0.1, "after")):
            sides = tuple(
                replace(side, decided=decided) if side is other else side for side in one.sides
            )
            assert words in describe_cause(replace(one, sides=sides), found.names)
        sides = tuple(
            replace(side, reported_time=1.5) if side is avoiding else side for side in one.sides
        )
        said = describe_cause(replace(one, sides=sides), found.names)
        assert states(said, "no command that kept it clear of r1")
