"""What users read is as it was kept; ``python -m tests.goldens`` keeps it anew."""

from __future__ import annotations

import json

import pytest

from tests.goldens.make import everything
from tests.goldens.values import FOLDER, differences, read

MADE = everything()


@pytest.mark.parametrize("name", MADE)
def test_it_is_as_kept(name: str) -> None:
    now = json.loads(json.dumps(MADE[name]()))
    told = list(differences(read(name), now))
    assert not told, "\n".join(
        [f"{len(told)} differences (python -m tests.goldens {name})", *told[:20]]
    )


def test_nothing_else_is_kept() -> None:
    assert {file.stem for file in FOLDER.iterdir()} == set(MADE)


def test_differences_are_found() -> None:
    assert list(differences({"a": [1.0, "x"]}, {"a": [1.0 + 1e-12, "x"]})) == []
    assert len(list(differences({"a": [1.0, "x"], "b": 1}, {"a": [1.1, "y"], "c": 2}))) == 4
