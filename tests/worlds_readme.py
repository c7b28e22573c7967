"""The tables of keys in docs/reference/worlds.md, made from the models that check a world."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import BaseModel

from physim.world import (
    Arrival,
    Box,
    Corridor,
    Expectation,
    Formation,
    Limits,
    Physics,
    RandomCorridor,
    RandomRoad,
    Robot,
    RobotGroup,
    Sensing,
    Start,
    Time,
    World,
)
from tests.helpers import inside

ModeSwitchingSettings = inside("physim.controllers", "ModeSwitchingSettings")

SECTIONS: list[tuple[str, str, type[BaseModel]]] = [
    ("The world", "", World),
    ("`time`", "", Time),
    ("`corridor`", "", Corridor),
    ("`corridor` drawn by the seed", "", RandomCorridor),
    ("`random`, of such a corridor", "", RandomRoad),
    ("`start`, of the world or of one robot", "", Start),
    ("Each of `robots`", "", Robot),
    ("Each of `robots` with a `count`", "", RobotGroup),
    ("`footprint` of a robot, as a box", "", Box),
    ("`limits` of a robot", "", Limits),
    ("`formation`", "", Formation),
    ("`controller`, for `type: mode_switching`", "", ModeSwitchingSettings),
    ("`sensing`", "", Sensing),
    ("`arrival`", "", Arrival),
    ("`expect`", "", Expectation),
    ("`physics`", "", Physics),
]


def key_tables() -> str:
    """Markdown: one table a model, one row a key with its default and meaning."""
    text = ""
    for title, note, model in SECTIONS:
        text += f"\n### {title}\n{note}\n| key | default | meaning |\n|---|---|---|\n"
        for key, field in model.model_fields.items():
            default = "required" if field.is_required() else _shown(field.get_default())
            text += f"| `{key}` | {default} | {field.description} |\n"
    return text + "\n"


def _shown(value: Any) -> str:
    if value is None or value in ("", ()):
        return "none"
    if isinstance(value, BaseModel):
        return "as below"
    if isinstance(value, list | tuple):
        shown = (v if isinstance(v, str) else f"{v:.5g}" for v in value)
        return f"`[{', '.join(shown)}]`"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    return f"`{value}`"


def main() -> None:
    """Write the tables into docs/reference/worlds.md."""
    readme = Path(__file__).parents[1] / "docs/reference/worlds.md"
    text = readme.read_text(encoding="utf-8")
    before, rest = text.split("<!-- keys -->\n")
    after = rest.split("<!-- end of keys -->")[1]
    readme.write_text(f"{before}<!-- keys -->\n{key_tables()}<!-- end of keys -->{after}", "utf-8")


if __name__ == "__main__":
    main()
