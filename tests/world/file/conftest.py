"""The tests of this folder see registered controllers and stages of their own."""

from __future__ import annotations

import sys

import pytest

from tests.helpers import inside

registry = sys.modules[inside("physim.parts", "find_part").__module__]
MODULE = "tests.world.file.parts_for_tests"


@pytest.fixture(autouse=True)
def _registered(monkeypatch):
    entries = {
        "mode_switching": (f"{MODULE}:Switching",),
        "plain": (f"{MODULE}:Plain",),
        "broken": ("no_such_module_here:Class",),
    }
    found = {
        registry.CONTROLLER.group: entries,
        registry.SENSING.group: {"haze": (f"{MODULE}:Haze",)},
        registry.FILTER.group: {
            "slow": (f"{MODULE}:Slow",),
            "broken": ("no_such_module_here:Class",),
        },
        registry.DISTURBANCE.group: {"gains": (f"{MODULE}:Gains",)},
    }
    monkeypatch.setattr(registry, "registered", lambda group: found.get(group, {}))
