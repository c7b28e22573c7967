"""A controller that fails with a known probability: its intervals hold it, its goal is decided."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from physim.campaigns import Folder, Row, read, run_one, spec_of
from physim.campaigns.until import Decided
from physim.world.file import parse_world
from tests.helpers import inside

Outcomes, Until = inside("physim.campaigns", "Outcomes", "Until")
report_of = inside("physim.campaigns.report", "report_of")
read_goal = inside("physim.statistics", "read_goal")

RATE = 0.8
"""Share of runs that go well: of start headings, which are uniform on the circle"""
SEEDS = range(400)
WORLD = """\
name: circle
seed: 0
time: {step: 0.05, duration: 0.1}  # [s]
corridor: {centreline: [[0, 0], [20, 0]], width: 8.0}  # [m]
robots:
  - {name: a, footprint: {length: 1.0, width: 1.0}, pose: [6.0, 0.0, random], path: {offset: 0.0}}
"""
CONTROLLER = """\
from physim import Decision


class Fails:
    def decide(self, observation, memory):
        if abs(observation.pose[2]) > BOUND:
            raise RuntimeError("as it should")
        return Decision(0.0, 0.0, hold=0.1)
"""


@pytest.fixture(scope="module")
def rows(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Row]]:
    folder = tmp_path_factory.mktemp("known")
    source = CONTROLLER.replace("BOUND", repr(RATE * math.pi))
    (folder / "fails_by_heading.py").write_text(source, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(folder))
        world = parse_world(WORLD, controller="fails_by_heading:Fails")
        cell = spec_of(world, 0, name="circle")
        place = Folder(folder / "campaign")
        place.open([cell])
        made = [run_one(replace(cell, seed=seed)) for seed in SEEDS]
    place.shards.write(made)
    return place.path, made


def test_the_interval_holds_the_rate(rows: tuple[Path, list[Row]]) -> None:
    folder, made = rows
    assert {row.ended for row in made} == {"duration", "error"}
    outcomes = Outcomes(read(folder))
    for goal in (None, read_goal("contact_free > 0.99")):
        (cell,) = report_of(outcomes, "known", goal, 0).cells
        free = cell.rates[1]
        assert free.low <= RATE <= free.high
        assert free.low > 0.0
        assert cell.failed == sum(row.ended == "error" for row in made)


def test_the_goal_is_decided_as_it_is(rows: tuple[Path, list[Row]], tmp_path: Path) -> None:
    _, made = rows
    for text, holds in (("contact_free > 0.65", True), ("contact_free > 0.95", False)):
        label = made[0].world, made[0].settings, made[0].controller
        decided = Decided(tmp_path, Until(read_goal(text), 0), [label])
        taken = next(k for k in range(1, len(made) + 1) if decided(made[:k]))
        assert taken < len(made)
        assert decided.watches[label].decision.holds is holds
