"""Mutations that name a rule: each finds what it breaks, and is told apart from the others."""

from __future__ import annotations

import pytest

from tests.mutation.rules import RULES, UNDO, undo


@pytest.mark.deep
def test_every_rule_finds_what_it_breaks() -> None:
    for room, name, function in RULES:
        try:
            function()
            assert UNDO, f"{room}: {name} replaces nothing"
        except (AttributeError, ImportError) as error:
            pytest.fail(f"{room}: {name}: {error}")
        finally:
            undo()
    assert len({name for _, name, _ in RULES}) == len(RULES)
    assert all(function.__doc__ for *_, function in RULES)
