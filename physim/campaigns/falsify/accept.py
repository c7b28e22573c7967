"""Whether `physim check` accepts a world: nothing else may be a result."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

from physim.world import World
from physim.world.checks.check import check_world

Accepts = Callable[[World], str]
"""The first error of a world; empty where there is none."""


def accepted(controller: str | None = None) -> Accepts:
    """Ask the check; ``controller`` is the one that the command line named, if it did."""

    def accepts(world: World) -> str:
        with tempfile.TemporaryDirectory(prefix="physim-") as folder:
            file = Path(folder) / "world.yaml"
            world.save(file)
            errors = check_world(file, controller=controller).errors
        return errors[0].message if errors else ""

    return accepts
