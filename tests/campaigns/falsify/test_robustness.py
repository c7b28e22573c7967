"""The signed swept clearance: its figures, its sign, and who it names."""

from __future__ import annotations

import pytest

import physim
from physim import SaveAt
from physim.analysis.metrics import contact_episodes, grazes
from tests.campaigns.falsify.worlds import five_robots, into_the_wall, judge, past_a_corner
from tests.helpers import inside

ROBOTS, WALL, judged = inside("physim.campaigns.falsify", "ROBOTS", "WALL", "judged")

FREE = {"step": 0.05, "duration": 3.0}


def test_without_contact_it_is_the_shortest_distance_of_the_summary() -> None:
    record = physim.simulate(five_robots(time=FREE))
    summary, found = physim.summarise(record), judged(record)
    distances = [
        summary.metrics[name] for name in ("shortest_distance", "shortest_boundary_distance")
    ]
    least = min(distances, key=lambda one: one.value)
    assert (found.failed, found.touched) == (False, None)
    assert found.clearance == least.value > 0.0
    assert found.time == least.time
    assert found.pair == tuple(summary.bodies[i] for i in least.bodies)


def test_a_contact_is_negative_by_its_depth() -> None:
    world = five_robots()
    record = physim.simulate(world)
    episodes, found = contact_episodes(record), judged(record)
    deepest = max(episodes, key=lambda one: one.depth)
    assert found.clearance == pytest.approx(-deepest.depth, abs=1e-9)
    assert found.pair == tuple(record.bodies[i].name for i in (deepest.a, deepest.b))
    assert found.touched == (ROBOTS, ("r2", "r4"), episodes[0].time, ("", ""))


def test_a_wall_counts_as_another_kind() -> None:
    found = judge(into_the_wall())
    assert found.touched is not None
    assert found.touched.kind == WALL
    assert found.touched.pair == ("a", "left wall")
    assert found.clearance is not None
    assert found.clearance < 0.0


def test_a_contact_between_two_samples_counts() -> None:
    record = physim.simulate(past_a_corner())
    (graze,) = grazes(record)
    assert not contact_episodes(record)
    assert record.clearance.min() > 0.0
    found = judged(record)
    assert found.clearance == -graze.depth < 0.0
    assert found.touched == (ROBOTS, ("stands", "passes"), graze.time, ("", ""))


def test_without_contact_between_samples_it_errs_to_the_high_side() -> None:
    """By at most half of what the two travel in a step: 7 mm here."""
    gap = 4e-4
    found = judge(past_a_corner(-gap))
    assert not found.failed
    assert found.clearance is not None
    assert 0.5 * gap < found.clearance <= gap + 0.5 * 1.4 * 0.01


def test_every_step_counts_whatever_is_recorded() -> None:
    world = five_robots()
    every, few = (
        judged(physim.simulate(world, save=SaveAt(every=step, tables=("contacts", "updates"))))
        for step in (1, 7)
    )
    assert every == few


@pytest.mark.parametrize(
    ("changes", "refused"),
    [
        ({"controller": {"type": "constant", "commands": [[9.0, 0.0]]}}, True),
        ({"controller": {"type": "tests.campaigns.falsify.test_robustness:Breaks"}}, False),
    ],
)
def test_what_cannot_be_run_has_no_clearance(changes: dict[str, object], refused: bool) -> None:
    found = judge(five_robots(**changes))
    assert (found.clearance, found.touched, found.refused) == (None, None, refused)
    assert found.reason


class Breaks:
    """A controller that raises in the middle of a run."""

    def decide(self, observation: physim.Observation, memory: object) -> physim.Decision:
        if observation.time > 0.5:
            raise ZeroDivisionError("no")
        return physim.Decision(v=0.0, omega=0.0, hold=0.1)
