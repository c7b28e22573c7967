"""The tests of this folder see two registered controllers of their own."""

from __future__ import annotations

from importlib.metadata import EntryPoint

import pytest

from physim import registry

MODULE = "tests.world_file.controllers_for_tests"


@pytest.fixture(autouse=True)
def _registered(monkeypatch):
    group = registry.CONTROLLER.group
    entries = {
        name: EntryPoint(name, f"{MODULE}:{target}", group)
        for name, target in (("mode_switching", "Switching"), ("plain", "Plain"))
    }
    entries["broken"] = EntryPoint("broken", "no_such_module_here:Class", group)
    monkeypatch.setattr(
        registry, "_entries", lambda kind: entries if kind is registry.CONTROLLER else {}
    )
