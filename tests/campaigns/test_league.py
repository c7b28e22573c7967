"""The league: who enters, what runs once, what cannot; who is surely better, and the verdict."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from physim import simulate
from physim.campaigns import Processes, Row
from physim.statistics import duels
from physim.world.file import parse_world
from tests.campaigns.samples import FIXED, rows_in
from tests.campaigns.tables import failed, hit, row
from tests.cli.commands import physim
from tests.helpers import check_error, inside

League, Entrant, outcome_of = inside("physim.campaigns", "League", "Entrant", "outcome_of")
standings, HOLDS, FAILS, OPEN = inside("physim.campaigns", "standings", "HOLDS", "FAILS", "OPEN")
answer, markdown_of = inside("physim.campaigns", "answer", "content")
Outcomes, MARKDOWN = inside("physim.campaigns", "Outcomes", "MARKDOWN")

PROGRAMME = """\
entrants:
  - {name: paper, controller: mode_switching}
  - {name: deaf, controller: path_following}
groups:
  - {name: small ones, worlds: [small.yaml, fixed.yaml]}
seeds: [0, 3]
reference: paper
"null": deaf
"""
OWN = """\
from physim import Decision, Fault


class Mine:
    told = "never"

    def decide(self, observation, memory):
        return Decision(0.5, 0.0, 0.1)


class Fussy(Mine):
    def world_faults(self, world, where):
        return [Fault(where, "it is a Sunday")]
"""


@pytest.fixture
def played(here: Path, in_process: Processes, capsys: Any) -> Path:
    (here / "league.yaml").write_text(PROGRAMME, encoding="utf-8")
    (here / "own.py").write_text(OWN, encoding="utf-8")
    (here / "fixed.yaml").write_text(FIXED, encoding="utf-8")
    assert run(capsys, "--programme", "league.yaml").code == 0
    return here


def run(capsys: Any, *arguments: object) -> Any:
    return physim("league", "-o", "out", "--no-video", *arguments, capture=capsys)


def told(folder: Path) -> str:
    return (folder / "out" / MARKDOWN).read_text(encoding="utf-8").replace("\\", "")


def test_ones_own_controller_is_placed_among_those_that_ran(played: Path, capsys: Any) -> None:
    before = rows_in(played / "out")
    assert len(before) == 2 * (3 + 1)  # in one world nothing is random
    done = run(capsys, "--controllers", "own:Mine")
    assert done.code == 0
    assert [name in done.out for name in ("paper", "deaf", "own:Mine")] == [True] * 3
    after = rows_in(played / "out")
    assert len(after) == 12
    assert all(one in after for one in before)
    worlds = told(played).partition("## Who takes part")[0]
    for part in worlds.split("### ")[-2:]:
        assert part.count("| own:Mine |") == 2


def test_what_ran_does_not_run_again(played: Path, capsys: Any) -> None:
    files = sorted((played / "out/rows").iterdir())
    assert run(capsys).code == 0  # the programme is that of the folder
    assert sorted((played / "out/rows").iterdir()) == files
    assert run(capsys, "--no-run").code == 0
    run(capsys, "--seeds", "0:5")
    assert len(rows_in(played / "out")) == 2 * (5 + 1)
    assert "Not complete" not in told(played)
    for file in sorted((played / "out/rows").iterdir())[1:]:
        file.unlink()
    run(capsys, "--no-run")
    assert "Not complete: 4 of the runs" in told(played)


def test_a_world_that_refuses_an_entrant_is_told_with_the_reason(played: Path, capsys: Any) -> None:
    done = run(capsys, "--controllers", "own:Fussy,own:Mine", "--worlds", "small.yaml")
    assert done.code == 0
    assert "| own:Fussy | cannot |" in told(played)
    assert "own:Fussy cannot drive here: it is a Sunday" in told(played)


def test_all_figures_as_json(played: Path, capsys: Any) -> None:
    found = json.loads(run(capsys, "--no-run", "--json").out)
    assert {one["entrant"] for one in found["cells"]} == {"paper", "deaf"}
    assert [one["criterion"] for one in found["rankings"]] == ["contact_free", "rate", "time"]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (("--controllers", "papr"), ("--controllers papr", "entrants: paper, deaf")),
        (("--programme", "own.py"), ("own.py",)),
        (("--worlds", "none"), ("none",)),
        (("--seeds", "4"), ("--seeds",)),
    ],
)
def test_what_is_amiss_is_said_in_a_line(
    given: tuple[str, ...], said: tuple[str, ...], played: Path, capsys: Any
) -> None:
    before = told(played)
    done = run(capsys, *given)
    assert done.code == 2
    check_error(done.err, *said)
    assert told(played) == before


def test_a_campaign_that_is_no_league_is_left_alone(played: Path, capsys: Any) -> None:
    assert physim("sweep", "small.yaml", "-o", "swept", "--quiet", capture=capsys).code == 0
    done = physim("league", "--programme", "league.yaml", "-o", "swept", capture=capsys)
    assert done.code == 2
    check_error(done.err, "swept", "no league")


# What came of a run

STANDS = """\
name: empty road
seed: 1
time: {step: 0.05, duration: 15.0}  # [s]
corridor: {centreline: [[0, 0], [30, 0]], width: 8.0}  # [m]
robots:
  - {name: a, footprint: {length: 1.8, width: 1.0}, pose: [3.0, 0.0, 0.0], path: {offset: 0.0}}
controller: {type: constant, v: SPEED}
"""


@pytest.mark.parametrize(
    ("speed", "came"), [("0.0", "deadlock"), ("0.5", "timeout"), ("0.005", "deadlock")]
)
def test_deadlock_is_told_from_time_that_was_up(speed: str, came: str) -> None:
    from physim.campaigns import run_one, spec_of

    found = run_one(spec_of(parse_world(STANDS.replace("SPEED", speed)), 1))
    assert outcome_of(found) == came
    with simulate(parse_world(STANDS.replace("SPEED", speed))) as record:
        assert record.ended == "duration"


def test_every_run_has_one_outcome() -> None:
    late = {"ended": "duration", "time_to_finish": None}
    rows = {
        "arrived": row(), "contact": hit(), "error": failed(), "timeout": row(**late, standstill=9),
        "deadlock": row(**late, standstill=10.0),
    }  # fmt: skip
    assert {outcome_of(one): name for name, one in rows.items()} == {name: name for name in rows}
    assert outcome_of(row(grazes=1)) == outcome_of(hit(**late, standstill=30.0)) == "contact"


# Who is better

SEEDS = range(20)
WORLDS = [f"w{k}" for k in range(4)]


def planted(good: dict[str, float], faster: float = 1.0) -> Any:
    """Standings of controllers each with a share of its runs without contact, arrived so; ``b``
    takes ``faster`` times as long as others."""
    rows: list[Row] = []
    for world in WORLDS:
        for k, (name, share) in enumerate(good.items()):
            for seed in SEEDS:
                time = 20.0 + 0.1 * seed + (20.0 * (faster - 1.0) if name == "b" else 0.0)
                spread = (seed * 7 + k) % len(SEEDS)  # other seeds for each
                make = row if spread < share * len(SEEDS) else hit
                rows.append(make(seed, world=world, controller=name, time_to_finish=time))
    league = League(
        entrants=[Entrant(name=name, controller=name) for name in good], reference="a",
        groups=[{"name": "all", "worlds": WORLDS}], seeds=[0, 20],
    )  # fmt: skip
    return standings(league, Outcomes(rows))


def sures(found: Any, a: str, b: str) -> list[int]:
    return [one.sure(found.place(a), found.place(b)) for one in found.rankings]


def test_who_is_better_is_found_and_who_is_not_is_left_open() -> None:
    found = planted({"a": 0.95, "b": 0.4, "c": 0.9})
    assert sures(found, "a", "b") == [1, 1, 0]
    assert sures(found, "b", "a") == [-1, -1, 0]
    assert sures(found, "a", "c") == [0, 0, 0]
    (free, *_) = found.rankings
    assert free.values == pytest.approx((0.95, 0.4, 0.9))
    one = free.duels[0, 1]
    assert one.low < one.difference < one.high
    assert one.difference == pytest.approx(0.55)


def test_time_counts_where_both_arrive() -> None:
    found = planted({"a": 0.9, "b": 0.9}, faster=0.8)
    assert sures(found, "b", "a") == [0, 0, 1]
    assert found.rankings[2].values[1] == pytest.approx(0.81, abs=0.01)
    (cell,) = {one.both for (_, name), one in found.cells.items() if name == "b"}
    assert 14 <= cell < 18  # not the runs in which one of the two touched


def test_few_seeds_that_never_differ_show_nothing() -> None:
    """A bootstrap of them has no spread."""
    rows = [make(seed, world="w0", controller=name) for name, make in (("a", row), ("b", hit))
            for seed in range(3)]  # fmt: skip
    league = League(
        entrants=[Entrant(name=name, controller=name) for name in "ab"], reference="a",
        groups=[{"name": "all", "worlds": ["w0"]}], seeds=[0, 3],
    )  # fmt: skip
    assert sures(standings(league, Outcomes(rows)), "a", "b") == [0, 0, 0]


@pytest.mark.parametrize(
    ("shares", "verdict", "said"),
    [
        ({"a": 0.95, "b": 0.4}, HOLDS, "it holds against b"),
        ({"a": 0.4, "b": 0.95}, FAILS, "it does not hold against b"),
        ({"a": 0.9, "b": 0.9}, OPEN, "it cannot be told against b"),
    ],
)
def test_the_verdict_follows_the_runs(shares: dict[str, float], verdict: str, said: str) -> None:
    found = planted(shares)
    assert [one.verdict for one in found.verdicts] == [verdict]
    first = next(answer(found))
    assert said in "".join(one if isinstance(one, str) else one.text for one in first)
    (one,) = found.verdicts
    assert (len(one.wins), len(one.loses)) == {HOLDS: (4, 0), FAILS: (0, 4), OPEN: (0, 0)}[verdict]


def test_code_of_ones_own_runs_only_where_the_command_line_names_it(
    here: Path, in_process: Processes, capsys: Any
) -> None:
    (here / "own.py").write_text(OWN, encoding="utf-8")
    (here / "fixed.yaml").write_text(FIXED, encoding="utf-8")
    text = PROGRAMME.replace("controller: mode_switching", 'controller: "own:Mine"')
    (here / "league.yaml").write_text(text, encoding="utf-8")
    done = run(capsys, "--programme", "league.yaml", "--controllers", "paper,deaf")
    assert done.code == 2
    assert "--controllers own:Mine" in done.err
    assert not (here / "out").exists()
    done = run(capsys, "--programme", "league.yaml", "--controllers", "own:Mine,deaf")
    assert done.code == 0


def test_noise_does_not_keep_ones_own_controller_out(
    here: Path, in_process: Processes, capsys: Any
) -> None:
    (here / "own.py").write_text(OWN, encoding="utf-8")
    text = FIXED + "sensing: {stages: [{type: noise, position: 0.01}]}\n"
    (here / "noisy.yaml").write_text(text, encoding="utf-8")
    done = run(capsys, "--controllers", "own:Mine", "--worlds", "noisy.yaml", "--seeds", "0:1")
    assert done.code == 0
    assert len(rows_in(here / "out")) == 1


def test_a_world_that_nobody_can_drive_in_changes_no_duel() -> None:
    drawn = np.random.default_rng(0).integers(0, 2, (2, 12)).astype(float)
    (with_it,), (alone,) = duels([np.zeros((2, 0)), drawn]).values(), duels([drawn]).values()
    assert with_it.difference == pytest.approx(alone.difference)
    assert with_it.worlds == alone.worlds == 1
