"""worlds/README.md says what the models say."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from physim.world.checks import check_world
from physim.world.file import load_world
from tests.helpers import inside

from .worlds_readme import key_tables

shipped_worlds = inside("physim.world.file", "shipped_worlds")

README = Path(__file__).parents[1] / "worlds" / "README.md"


def test_every_key_stands_in_the_readme_with_its_unit_and_default() -> None:
    text = README.read_text(encoding="utf-8")
    given = text.split("<!-- keys -->\n")[1].split("<!-- end of keys -->")[0]
    assert given == key_tables()


def test_every_shipped_world_stands_in_the_readme() -> None:
    text = README.read_text(encoding="utf-8")
    for name, description in shipped_worlds().items():
        assert f"| `{name}` |" in text
        assert description


def test_the_worlds_named_are_those_whose_controllers_have_settings_of_their_own() -> None:
    text = README.read_text(encoding="utf-8")
    named = text.split("All worlds but ")[1].split(" leave the controller at")[0]
    own = {name for name in shipped_worlds() if load_world(name).controller.settings}
    assert set(re.findall(r"`(\w+)`", named)) == own


WHOLE = [
    block
    for block in re.findall(r"```yaml\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    if "name: " in block.partition("\n")[0]
]


def test_whole_worlds_are_looked_for() -> None:
    assert any("fleet" in block for block in WHOLE)


@pytest.mark.parametrize("text", WHOLE)
@pytest.mark.parametrize("seed", [0, 1])
def test_every_whole_world_of_the_readme_is_accepted_without_a_warning(
    tmp_path: Path, text: str, seed: int
) -> None:
    (tmp_path / "world.yaml").write_text(text, encoding="utf-8")
    found = check_world(tmp_path / "world.yaml", seed=seed)
    assert [str(one) for one in (*found.errors, *found.warnings)] == []
