"""docs/reference/worlds.md says what the models say."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from physim.world.checks import check_world
from tests.helpers import inside

from .worlds_readme import key_tables

shipped_worlds = inside("physim.world.file", "shipped_worlds")

README = Path(__file__).parents[1] / "docs/reference/worlds.md"


def test_every_key_stands_in_the_readme_with_its_unit_and_default() -> None:
    text = README.read_text(encoding="utf-8")
    given = text.split("<!-- keys -->\n")[1].split("<!-- end of keys -->")[0]
    assert given == key_tables()


def test_every_shipped_world_stands_in_the_readme() -> None:
    text = README.read_text(encoding="utf-8")
    for name, description in shipped_worlds().items():
        assert f"| `{name}` |" in text
        assert description


WHOLE = [
    block
    for block in re.findall(r"```yaml\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    if "name: " in block.partition("\n")[0]
]


@pytest.mark.parametrize("text", WHOLE)
@pytest.mark.parametrize("seed", [0, 1])
def test_every_whole_world_of_the_readme_is_accepted_without_a_warning(
    tmp_path: Path, text: str, seed: int
) -> None:
    (tmp_path / "world.yaml").write_text(text, encoding="utf-8")
    found = check_world(tmp_path / "world.yaml", seed=seed)
    assert [str(one) for one in (*found.errors, *found.warnings)] == []
