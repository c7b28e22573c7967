"""The tests of this folder see two registered controllers of their own."""

from __future__ import annotations

import pytest

from physim import registry

MODULE = "tests.world_file.controllers_for_tests"


@pytest.fixture(autouse=True)
def _registered(monkeypatch):
    entries = {
        "mode_switching": (f"{MODULE}:Switching",),
        "plain": (f"{MODULE}:Plain",),
        "broken": ("no_such_module_here:Class",),
    }
    monkeypatch.setattr(
        registry, "_entries", lambda kind: entries if kind is registry.CONTROLLER else {}
    )
