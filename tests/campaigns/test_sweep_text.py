"""What a sweep says at its end: which runs to look at, not only how many."""

from __future__ import annotations

import json
import re
from pathlib import Path

from tests.campaigns.tables import failed, hit, row, table
from tests.helpers import facts, inside

Outcomes, Tally = inside("physim.campaigns", "Outcomes", "Tally")
sweep_text, sweep_values = inside("physim.campaigns.report", "sweep_text", "sweep_values")

GOOD = ("yard", "", "good")


def text(rows: list[dict[str, object]], *labels: tuple[str, str, str]) -> str:
    return sweep_text(
        Path("out"), Outcomes(table(rows)), dict.fromkeys(labels or [GOOD], ""), Tally(len(rows))
    )


def named(said: str) -> list[int]:
    return [int(seed) for seed in re.findall(r"^  .*, seed (\d+):", said, flags=re.MULTILINE)]


def test_contacts_then_failures_then_what_did_not_finish() -> None:
    rows = [row(1), row(2, ended="duration"), failed(3), hit(4), row(5), hit(6, grazes=2)]
    said = text(rows)
    assert named(said) == [4, 6, 3, 2]
    lines = {int(one.partition("seed ")[2].partition(":")[0]): one for one in said.splitlines()
             if one.startswith("  yard")}  # fmt: skip
    assert re.search(facts("good", "contact", "3.10 s"), lines[4])
    assert re.search(facts("error", "it broke"), lines[3])
    assert "not finished" in lines[2]
    assert f"physim replay out:{hit(4)['run']}" in said


def test_the_list_is_bounded_and_says_where_the_rest_is() -> None:
    said = text([hit(seed) for seed in range(25)])
    assert named(said) == list(range(10))
    assert re.search(facts("15", "physim report out"), said.splitlines()[-2])


def test_counts_and_values() -> None:
    rows = [row(1), row(2, ended="duration"), failed(3), failed(4, "killed"), hit(5)]
    draws = {GOOD: "the starts", ("none", "", "x"): ""}
    found = sweep_values(Path("out"), Outcomes(table(rows)), draws, Tally(5), {})
    one, nothing = found["cells"]
    counts = {key: one[key] for key in ("runs", "contact_free", "finished", "failed", "error",
                                        "killed", "timeout")}  # fmt: skip
    assert counts == {"runs": 5, "contact_free": 2, "finished": 2, "failed": 2, "error": 1,
                      "killed": 1, "timeout": 0}  # fmt: skip
    assert nothing["runs"] == 0
    assert [one["seed"] for one in found["to_look_at"]["first"]] == [5, 3, 4, 2]
    assert found["to_look_at"]["runs"] == 4
    json.dumps(found, allow_nan=False)
