"""Standard columns and considered robots against plain oracles and a controller of one's own."""

from __future__ import annotations

from math import cos, inf, sin

import pytest

import physim
from physim import Decision
from physim.analysis.validation import report, validate
from tests.analysis.validation.runs import LANE, REAR_END, states
from tests.helpers import inside
from tests.oracles.collision_time import geometry_at, marched_time

STANDARD_COLUMNS = inside("physim.parts", "STANDARD_COLUMNS")

HORIZON = 2.0
STILL = (0.0, 0.0)
HERE = (0.0, 0.0, 0.0)


class Honest:
    """Drives as in REAR_END and reports what is so, by slow and obvious means.

    ``lie`` changes a report; ``straight``: collision times of velocity vectors that are kept.
    """

    columns = STANDARD_COLUMNS[2:5]

    def __init__(self, lie=lambda report: report, straight=False) -> None:
        self.lie, self.straight = lie, straight

    def decide(self, observation, memory):
        o, command = observation, REAR_END[observation.index]
        me, mine = tuple(o.pose), self.twist(o.pose, command)
        body = geometry_at(o.footprint, me)
        near = [body.distance(geometry_at(one.footprint, tuple(one.pose))) for one in o.others]
        times = [marched_time(o.footprint, me, mine, o.walls, HERE, STILL, HORIZON)]
        for one in o.others:
            its = self.twist(one.pose, (one.v, one.omega))
            there = tuple(one.pose)
            times.append(marched_time(o.footprint, me, mine, one.footprint, there, its, HORIZON))
        row = {
            "distance": min(near, default=inf),
            "boundary_distance": body.distance(geometry_at(o.walls, HERE)),
            "collision_time": min(times),
        }
        return Decision(
            *command, hold=0.2, considered=[one.index for one in o.others], report=self.lie(row)
        )

    def twist(self, pose, command):
        v, omega = command
        return (v * cos(pose[2]), v * sin(pose[2]), 0.0) if self.straight else (v, omega)


def judged(*arguments):
    """Validation of half a second before the two touch, and its report in one line."""
    world = physim.parse_world(
        LANE, overrides=["time.duration=1.4", "robots.1.pose=[4.6, -1.0, 0.1]"]
    )
    found = validate(physim.simulate(world, controller=Honest(*arguments)))
    return found, " ".join(report(found).split())


@pytest.mark.parametrize("straight", [False, True])
def test_what_is_so_agrees_with_slow_oracles(straight):
    found, text = judged(lambda row: row, straight)
    assert found.recomputed.mismatches == ()
    assert found.recomputed.columns == ("distance", "boundary_distance", "collision_time")
    assert states(text, "distance, boundary distance and collision time", "shapes")


def changed(column, change):
    def lie(row):
        return row | {column: change(row[column])}

    return lie


@pytest.mark.parametrize(
    ("column", "change"),
    [
        ("distance", lambda d: d + 1e-6),
        ("boundary_distance", lambda d: d - 1e-6),
        ("collision_time", lambda t: t + 1e-3),
        ("collision_time", lambda t: inf if t < 1.0 else t),
    ],
)
def test_what_a_controller_of_ones_own_reports_is_checked(column, change):
    found, text = judged(changed(column, change))
    assert found.code == 3
    assert {one.column for one in found.recomputed.mismatches} == {column}
    first = found.recomputed.mismatches[0]
    assert first.table == "/updates"
    assert f"/updates, row {first.row}, {column} is" in text
