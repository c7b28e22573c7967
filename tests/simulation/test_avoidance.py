"""Worlds that claim to show avoidance: it acts in them, and without it they end in contacts."""

from __future__ import annotations

import json

import pytest

from benchmarks import avoidance
from physim import simulate
from physim.record import Record
from physim.world.file import load_world

LONG_ENOUGH = {
    "ten_robots": 70.0,
    "crowded_start": 60.0,
    "three_robots": 200.0,
    "nonconvex": 160.0,
    "random_road": 200.0,
    "sliding_door": 60.0,
    "cars": 60.0,
    "noisy_ten_robots": 70.0,
    "lossy_ten_robots": 70.0,
}
"""[s] of simulated time in which every arm has shown what it does"""


def runs(world: str, *overrides: str) -> list[Record]:
    loaded = load_world(world, overrides=(f"time.duration={LONG_ENOUGH[world]}", *overrides))
    return [simulate(loaded, seed=seed) for seed in (0, 1, 2)]


def shortened(record: Record) -> int:
    """How many decisions (14) brings forward to beta times a collision time."""
    settings = record.world.controller.settings
    beta, longest = settings.get("beta", 0.1), settings.get("longest_interval", 0.2)
    held = (record.updates["next_step"] - record.updates["step"]) * record.dt
    wanted = beta * record.column("collision_time")
    early = (held < longest - 1.5 * record.dt) & (wanted < longest)
    return int((abs(held[early] - wanted[early]) <= record.dt).sum())


@pytest.mark.parametrize(
    "world",
    [
        pytest.param(name, marks=() if name == "crowded_start" else pytest.mark.deep)
        for name in sorted({*avoidance.SHOWS_AVOIDANCE} - {*avoidance.HARD})
    ],
)
def test_avoidance_acts_where_it_is_claimed_and_without_it_they_end_in_contacts(
    world: str,
) -> None:
    records = runs(world)
    found = [avoidance.measure(record) for record in records]
    assert all(one["contacts"] == 0.0 for one in found)
    assert sum(one["by_distance"] for one in found) > 0.0, "(12) decides"
    assert sum(one["by_time"] for one in found) > 0.0, "(13) decides"
    without = [avoidance.measure(record) for record in runs(world, avoidance.WITHOUT)]
    assert sum(one["contacts"] > 0.0 for one in without) >= 1
    assert all(one["by_distance"] == one["by_time"] == 0.0 for one in without)
    if world in ("ten_robots", "crowded_start", "three_robots"):
        assert sum(map(shortened, records)) > 0
        assert sum(map(shortened, runs(world, "controller.event_triggered=false"))) == 0


def test_every_claim_holds_by_the_rates_of_the_gallery() -> None:
    assert avoidance.broken_claims(json.loads(avoidance.RATES.read_text("utf-8"))) == []
    for free, bare, broken in ((95, 50, 0), (94, 50, 1), (95, 51, 1)):
        rates = {"seeds": 100, "with": {"contact_free": free}, "without": {"contact_free": bare}}
        assert len(avoidance.broken_claims({"nonconvex": rates})) == broken
