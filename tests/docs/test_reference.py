"""The reference has all that there is. What is made from the code fails to build without a word."""

from __future__ import annotations

import json
import re
from pathlib import Path

import physim
from physim.world import World
from tests.helpers import inside

CONTROLLER, shipped_parts = inside("physim.parts", "CONTROLLER", "shipped_parts")

PAGES = Path(__file__).parents[2] / "docs/reference"


def of(page: str, pattern: str) -> set[str]:
    """What a pattern finds on a page."""
    return set(re.findall(pattern, (PAGES / page).read_text(encoding="utf-8"), re.MULTILINE))


def test_every_key_of_a_world_is_told() -> None:
    models = {name for name in World.model_json_schema()["$defs"] if "Choice" not in name}
    assert of("worlds.md", r"generated: keys (\w+) -->") == {"World", *models} - {"OwnController"}
    settings = of("worlds.md", r"generated: keys settings (\w+) -->")
    assert settings == set(shipped_parts(CONTROLLER))
    assert of("worlds.md", "generated: (stages) -->")  # of every one that ships


def test_every_public_name_is_told() -> None:
    assert of("python.md", r"^::: physim\.(\w+)$") == set(physim.__all__)


def test_every_key_of_a_summary_is_told() -> None:
    world = physim.load_world("straight", overrides=["time.duration=0.1"])
    found = json.loads(physim.summarise(physim.simulate(world)).to_json())
    assert found.keys() <= of("results.md", r"`(\w+)`")


def test_every_figure_is_told() -> None:
    assert of("figures.md", r"^\| `(\w+)` \|") == set(physim.plots.NAMES)
