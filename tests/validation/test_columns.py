"""Standard columns and considered robots against plain oracles and a controller of one's own."""

from __future__ import annotations

from math import cos, inf, nan, sin

import numpy as np
import pytest

import physim
from physim import Decision
from physim.analysis.validation import report, validate
from physim.geometry import signed_distance
from tests.helpers import inside
from tests.helpers.packages import install
from tests.oracles.collision_time import geometry_at, marched_time
from tests.oracles.priority import considered
from tests.validation.reports import states
from tests.validation.runs import LANE, REAR_END

wrongly_considered = inside("physim.analysis.validation", "wrongly_considered")
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
    assert states(
        text, "Honest", "given from Python", within=40
    )  # so modes and rules are not decided again


def changed(column, change):
    def lie(row):
        return row | {column: change(row[column])}

    return lie


@pytest.mark.parametrize(
    ("column", "change"),
    [
        ("distance", lambda d: d + 1e-6),
        ("distance", lambda d: inf),
        ("boundary_distance", lambda d: d - 1e-6),
        ("collision_time", lambda t: t + 1e-3),
        ("collision_time", lambda t: 0.5 * t),
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


class Ramming:
    """Drives into the one ahead and reports the distance; ``told`` gets it with its sign."""

    columns = STANDARD_COLUMNS[2:3]

    def __init__(self, told) -> None:
        self.told = told

    def decide(self, observation, memory):
        o = observation
        others = [one.index for one in o.others]
        mine = o.footprint + np.array(o.pose)[:2]  # both head along x all the time
        gaps = [signed_distance(mine, x.footprint + np.array(x.pose)[:2]) for x in o.others]
        gap = min(gaps, default=inf)
        return Decision(
            0.6 * o.index, 0.0, hold=0.2, considered=others,
            report={"distance": self.told(gap, o.time)},
        )  # fmt: skip


@pytest.mark.parametrize(
    ("told", "agrees"),
    [
        (lambda gap, time: gap, True),
        (lambda gap, time: max(gap, 0.0), True),
        (lambda gap, time: max(gap, 0.0) if round(time / 0.2) % 2 else gap, False),
        (lambda gap, time: max(gap, 0.0) + 1e-6 * (gap < 0.0), False),
    ],
)
def test_overlaps_are_told_with_their_sign_or_as_0_all_through(told, agrees):
    """(11) is 0 there; in a record that tells depths a 0 is wrong."""
    world = physim.parse_world(LANE, overrides=["time.duration=3.0", "robots.1.pose=[5.497, 0, 0]"])
    record = physim.simulate(world, controller=Ramming(told))
    assert len(physim.summarise(record).contacts.episodes) == 1
    found = validate(record)
    assert {one.column for one in found.recomputed.mismatches} == (
        set() if agrees else {"distance"}
    )
    assert found.code == (1 if agrees else 3)


PLANNER = """
from math import hypot
from physim import Column, Decision
from pydantic import BaseModel

class Planner:
    class Settings(BaseModel):
        horizon: float = 0.5
        collision_motion: str = "translation"

    columns = (Column("collision_time", "s"),)

    def __init__(self, settings):
        self.settings = settings

    def decide(self, o, memory):
        from physim.geometry import collision_time
        v = 0.6 * o.index
        times = [
            collision_time(o.footprint, o.pose, (v, 0.0), x.footprint, x.pose, (x.v, x.omega))
            for x in o.others
        ]
        others = [x.index for x in o.others]
        return Decision(v, 0.0, hold=0.2, considered=others,
                        report={"collision_time": min(times, default=float("inf"))})
"""


def test_the_horizon_of_a_registered_controller_is_its_own_affair(tmp_path, monkeypatch):
    """Such as that of its plan, while its collision times look farther."""
    install(tmp_path, monkeypatch, "plans", PLANNER, {"physim.controllers": {"plans": "Planner"}})
    world = physim.parse_world(
        LANE, controller="plans", overrides=["time.duration=2.0", "robots.1.pose=[4.5, 0, 0]"]
    )
    record = physim.simulate(world)
    times = record.column("collision_time")
    assert (np.isfinite(times) & (times > 1.0)).any(), "beyond the horizon of the plan"
    found = validate(record)
    assert found.recomputed.mismatches == ()


def test_what_is_left_out_is_not_told():
    found, _ = judged(changed("collision_time", lambda t: nan))
    assert found.code == 0


def test_the_rule_of_priority_against_a_plain_one():
    rng = np.random.default_rng(5)
    robots, reach = 6, 4.0
    for _ in range(200):
        pose = rng.uniform(-3.0, 3.0, (1, robots, 3))
        station = np.round(rng.uniform(-4.0, 4.0, (1, robots)), 1)  # some are equal
        i = int(rng.integers(robots))
        others = [(j, pose[0, j], station[0, j]) for j in range(robots) if j != i]
        right = considered(i, pose[0, i], station[0, i], others, reach)

        def judge(listed, i=i, pose=pose, station=station):
            start, end = np.array([0]), np.array([len(listed)])
            listed = np.array(listed, dtype=np.int64)
            at, who = np.array([0]), np.array([i])
            return int(wrongly_considered(at, who, listed, start, end, pose, station, reach)[0])

        assert judge(right) == -1
        for j in set(range(robots)) - {i}:
            without = [k for k in right if k != j]
            wrong = without if j in right else sorted([*right, j])
            close = abs(station[0, j] - station[0, i] - reach) < 1e-9
            assert judge(wrong) == (-1 if close else j)
