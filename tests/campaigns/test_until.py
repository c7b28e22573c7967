"""Campaigns that stop when a goal is decided, whoever was done first."""

from __future__ import annotations

from pathlib import Path

from physim.campaigns import Row
from tests.helpers import inside
from tests.statistics.coverage import draws

Decided = inside("physim.campaigns", "Decided")
UNTIL, Until, read_until = inside("physim.campaigns", "UNTIL", "Until", "read_until")
succeeded, write_until = inside("physim.campaigns", "succeeded", "write_until")
decide, read_goal = inside("physim.statistics", "decide", "read_goal")

GOOD, BAD = ("yard", "", "good"), ("yard", "", "bad")


def row(seed: int, label: tuple[str, str, str] = GOOD, *, contact: bool = False) -> Row:
    world, settings, controller = label
    return Row(
        run=f"{seed:020x}", world=world, seed=seed, settings=settings, controller=controller,
        physim="0.1.0", engine="pymunk 7.3.1", ended="finished", contacts=int(contact),
        grazes=0,
    )  # fmt: skip


def stopped_at(folder: Path, rows: list[Row], goal: str, cells: list[tuple[str, str, str]]) -> int:
    """How many rows it took, asked after each."""
    decided = Decided(folder, Until(read_goal(goal), 1), cells)
    seen: list[Row] = []
    for one in rows:
        seen.append(one)
        if decided(seen):
            break
    return len(seen)


def test_it_stops_at_the_first_run_that_decides(tmp_path: Path) -> None:
    good = draws(1).random(2000) < 0.97
    rows = [row(seed, contact=not fine) for seed, fine in enumerate(good)]
    for goal in ("rate > 0.9", "contact_free < 0.9", "0.08"):
        whole = decide(read_goal(goal), good)
        assert whole.decided
        assert stopped_at(tmp_path, rows, goal, [GOOD]) == whole.runs
    assert (
        stopped_at(tmp_path, rows, "finished < 0.9", [GOOD])
        == decide(read_goal("finished < 0.9"), [True] * 2000).runs
    )


def test_all_cells_are_to_be_decided(tmp_path: Path) -> None:
    rows = [
        row(seed, label, contact=label == BAD and seed % 8 == 0)
        for seed in range(1000)
        for label in (GOOD, BAD)
    ]
    goal = read_goal("rate > 0.8")
    runs = [
        decide(goal, [one.safe for one in rows if one.controller == label[2]]).runs
        for label in (GOOD, BAD)
    ]
    assert runs[0] < runs[1]
    assert stopped_at(tmp_path, rows, "rate > 0.8", [GOOD, BAD]) == 2 * runs[1]


def test_rows_that_come_several_at_a_time_are_as_one_by_one(tmp_path: Path) -> None:
    rows = [row(seed, contact=seed % 50 == 9) for seed in range(400)]
    runs = stopped_at(tmp_path, rows, "rate > 0.9", [GOOD])
    together = Decided(tmp_path, Until(read_goal("rate > 0.9"), 1), [GOOD])
    assert not together(rows[: runs - 1])
    assert together(rows[: runs + 30])
    assert together.watches[GOOD].runs == runs


def test_the_folder_tells_the_goal_from_the_first_row_on(tmp_path: Path) -> None:
    assert read_until(tmp_path) is None
    until = Until(read_goal("rate > 99%"), 5)
    Decided(tmp_path, until, [GOOD])([row(5)])
    assert read_until(tmp_path) == until
    write_until(tmp_path, Until(read_goal("0.02"), 9))
    assert read_until(tmp_path) == Until(read_goal("0.02"), 5)
