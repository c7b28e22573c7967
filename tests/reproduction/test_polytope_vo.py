"""The second paper: its worlds are the published ones, trials are judged, verdicts can fail."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest

from physim import simulate
from tests.cli.commands import physim
from tests.helpers import inside

Arm, Outcome, Runs = inside("physim.reproduction", "Arm", "Outcome", "Runs")
make_plan, papers = inside("physim.reproduction", "make_plan", "papers")
drawn, measure_trial = inside("physim.reproduction.studies", "drawn", "measure_trial")

STUDIES = {study.name: study for study in papers()["polytope_vo"].studies()}


def run_of(study: str, arm: int, seed: int = 0) -> Mapping[str, float]:
    with simulate(STUDIES[study].arms[arm].load(seed), seed=seed) as record:
        return dict(measure_trial(record))


def test_a_polygon_takes_the_gap_in_the_reported_steps_and_a_disc_stands_where_reported() -> None:
    gap = run_of("turnaround", 0)
    assert (gap["solved"], gap["collision"], gap["deadlock"]) == (1.0, 0.0, 0.0)
    assert gap["steps"] == pytest.approx(65, abs=1)
    assert gap["way"] == pytest.approx(7.71, abs=0.03)
    disc = run_of("corridor", 2)
    assert (disc["solved"], disc["collision"], disc["deadlock"]) == (0.0, 0.0, 1.0)
    assert (disc["x"], disc["y"]) == pytest.approx((0.95, 5.15), abs=0.05)
    assert math.isnan(disc["steps"])


def test_everyone_has_a_goal_of_his_own_far_away_and_all_methods_the_same() -> None:
    for seed in range(200):
        pairs = drawn(seed)
        assert sorted(a for a, _ in pairs) == sorted(b for _, b in pairs) == list(range(8))
        assert all(abs(a - b) in (3, 4, 5) for a, b in pairs)
    assert len({tuple(drawn(seed)) for seed in range(50)}) > 40
    six = STUDIES["random"].arms[:6]
    assert len({arm.text(7) for arm in six}) == 1
    assert len({arm.overrides for arm in six}) == 6


def test_starts_are_moved_a_little_but_for_seed_0() -> None:
    def starts(seed: int) -> list[tuple[float, float]]:
        world = STUDIES["eight"].arms[0].load(seed)
        return [robot.pose[:2] for robot in world.robots]

    whole = [
        (5 + 4 * math.cos(k * math.pi / 4), 5 + 4 * math.sin(k * math.pi / 4)) for k in range(8)
    ]
    assert all(math.dist(a, b) < 1e-9 for a, b in zip(starts(0), whole, strict=True))
    moved = [math.dist(a, b) for a, b in zip(starts(3), whole, strict=True)]
    assert all(1e-6 < one <= 0.0015 for one in moved)


def trial(steps: float = 100.0, way: float = 8.0, **end: float) -> Mapping[str, float]:
    solved = not end.get("collision") and not end.get("deadlock")
    return {
        "solved": float(solved), "collision": 0.0, "deadlock": 0.0, "x": 0.95, "y": 5.15,
        "steps": steps if solved else math.nan, "way": way if solved else math.nan, **end,
    }  # fmt: skip


STUCK, HIT = trial(deadlock=1.0), trial(collision=1.0)
Arms = Sequence[Sequence[Mapping[str, float]]]


def random(polygon: Sequence[Mapping[str, float]], disc: Sequence[Mapping[str, float]]) -> Arms:
    return [*[polygon] * 3, *[disc] * 3] * 2


VERDICTS: list[tuple[str, Arms, str]] = [
    ("eight", [[trial(s)] * 10 for s in (129, 114, 131, 1, 103, 1)], "met, met, met, met"),
    ("eight", [[trial(90)] + [trial(150)] * 9] * 6, "partly met, partly met"),
    ("eight", [[STUCK] * 10] * 6, "not met, not met, not met, not met"),
    ("eight", [[STUCK] + [trial(129)] * 2 + [HIT] * 7] * 6, "partly met, not met"),
    ("corridor", [[trial(98, 7.16)] * 5] * 2 + [[STUCK] * 5, [trial()] * 5], "met, met, met, met"),
    ("corridor", [[STUCK] * 5] * 2 + [[trial()] * 5, [STUCK] * 5], "no, no, not met, not met"),
    ("corridor", [[trial(98, 9.0)] * 5] * 2 + [[{**STUCK, "x": 3.0}]] * 2, "partly met, -, partly"),
    ("turnaround", [[trial(65, 7.71)] * 5, [trial(182, 11.15)] * 5], "met, met"),
    ("turnaround", [[STUCK] * 5, [trial(65, 7.7)] * 5], "not met, partly met"),
    ("random", random([trial()] * 100, [trial(way=9.0)] * 100), "met, met, met, met, met, met"),
    ("random", random([trial()] * 100, [STUCK] * 50 + [trial(way=9)] * 50), "-, no, -, no, met, "
     "met, met, met"),
    ("random", random([HIT] * 50 + [trial(way=9)] * 50, [trial()] * 100), "not met, met, not met, "
     "met, not met, not met, not met, not met"),
]  # fmt: skip
"""What each claim comes to; -: whatever, no: anything but met"""


@pytest.mark.parametrize(("name", "arms", "expected"), VERDICTS)
def test_every_claim_can_be_met_and_can_fail(name: str, arms: Arms, expected: str) -> None:
    found = STUDIES[name].conclude([Runs(list(one)) for one in arms])
    for verdict, wanted in zip(found, expected.split(", "), strict=False):
        said = str(verdict.outcome)
        assert wanted == "-" or said.startswith(wanted) or (wanted == "no" and said != "met"), (
            verdict.claim
        )


def test_a_paper_is_named(tmp_path: Path, capsys) -> None:
    assert make_plan().paper.name == "mode_switching"
    out = tmp_path / "out"
    given = ("reproduce", "--paper", "polytope_vo", "--study", "turnaround", "--quick")
    done = physim(*given, "--workers", "1", "-o", out, capture=capsys)
    assert done.code == 0, done.err
    page = (out / "REPRODUCTION.md").read_text()
    assert page.startswith("# Polytope velocity obstacles, reproduced")
    assert "physim reproduce --paper polytope_vo --study turnaround" in page
    for wrong, words in (
        (
            ("--paper", "polytope"),
            "not a paper; allowed: mode_switching, polytope_vo; did you mean",
        ),
        (("--paper", "polytope_vo", "--figure", "1"), "has studies only; use --study"),
        (("--paper", "polytope_vo", "--study", "alpha"), "allowed: eight, corridor, turnaround"),
    ):
        refused = physim("reproduce", *wrong, "-o", tmp_path / "no", capture=capsys)
        assert refused.code == 2
        assert words in refused.err
