"""What the page says of rules: in the controller's words, with equations and thresholds."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from physim import Rule
from physim.drawing.page import write_page
from physim.record import Record
from tests.helpers import inside
from tests.helpers.records import make_record

PROSE, explanations = inside("physim.drawing.page", "PROSE", "explanations")
CONTROLLER, find_part, make_part = inside("physim.parts", "CONTROLLER", "find_part", "make_part")
Part, Setup = inside("physim.record", "Part", "Setup")


class Told:
    """As much of a record as is asked."""

    def __init__(
        self, name: str, settings: dict[str, Any], rules: tuple[Rule, ...], world: dict[str, Any]
    ) -> None:
        self.world_settings, self.robots, self.moving = world, 1, 1
        self.setup = Setup(((Part(name, settings), (0,)),), {}, (), {})
        self.declared = type("Declared", (), {"rules": rules})


def of(name: str, settings: dict[str, Any] | None = None, **world: Any) -> dict[str, Any]:
    """What is told of a shipped controller, and of those whom it drives: here all."""
    rules = getattr(find_part(CONTROLLER, name), "rules", ())
    told: Any = Told(name, settings or {}, rules, world)
    found = explanations(told)
    assert [one["robots"] for one in found["drivers"]] == [None]
    return {**found, **found["drivers"][0]}


@pytest.mark.parametrize("name", PROSE)
def test_every_rule_of_a_shipped_controller_has_prose(name: str) -> None:
    rules = find_part(CONTROLLER, name).rules
    assert {rule.name for rule in rules} == set(PROSE[name])
    for told, rule in zip(of(name)["rules"], rules, strict=True):
        assert told["words"] == str(rule)
        assert told["prose"].endswith(".")
        assert not re.search(r"[{}]", told["prose"])


def test_thresholds_are_the_settings_in_force() -> None:
    """Those of the world, and the controller's defaults for the others."""
    given = {"time_low": 1.5, "time_high": 3.0, "horizon": 4.5}
    told = of("mode_switching", given)
    made: Any = make_part(CONTROLLER, "mode_switching", given)
    rules = made.settings.rules()
    assert {one["column"]: (one["enter"], one["leave"]) for one in told["thresholds"]} == {
        "distance": (rules.distance_low, rules.distance_high),
        "collision_time": (1.5, 3.0),
        "boundary_distance": (rules.boundary_low, rules.boundary_low),
    }
    (time,) = [one for one in told["thresholds"] if one["column"] == "collision_time"]
    assert "boundary" not in time
    (time,) = [
        one
        for one in of("mode_switching", {**given, "boundary_time_high": 1.7})["thresholds"]
        if one["column"] == "collision_time"
    ]
    assert (time["leave"], time["boundary"]) == (3.0, 1.7)
    assert told["horizon"] == 4.5
    assert told["next"]["equation"] == "(14)"
    assert f"{rules.beta:g} times" in told["next"]["words"]
    assert f"{rules.longest_interval:g} s" in told["next"]["words"]
    assert told["avoids"]
    assert not of("mode_switching", {"avoidance": "none"})["avoids"]


def test_of_a_controller_that_nobody_knows_its_own_words_are_told() -> None:
    told: Any = Told("mine:Own", {"distance_low": 3}, (Rule("go", "goes on, (99)"),), {})
    found = explanations(told)
    assert found["rules"] == [
        {"name": "go", "words": "goes on, (99)", "equation": "(99)", "prose": ""}
    ]
    (driver,) = found["drivers"]
    assert (driver["thresholds"], driver["next"]) == ([], None)


@pytest.mark.parametrize(
    "setting",
    ["beta: 7", "beta: 2.0, update_period: [a]"],
)
def test_of_settings_that_are_refused_nothing_is_told(tmp_path: Path, setting: str) -> None:
    """They may be anything: what no page can hold as a number, and what no rule can use."""
    text = f"name: odd\nseed: 1\ncontroller: {{type: mode_switching, {setting}}}\n"
    make_record(tmp_path / "r.h5", 2, 1.0, world_text=text).close()
    with Record.load(tmp_path / "r.h5") as record:
        told = explanations(record)["drivers"][0]
        assert (told["thresholds"], told["next"], told["horizon"]) == ([], None, None)
        write_page([record], tmp_path / "page.html")
