"""Commands that a disturbance makes of others, step by step, without a simulation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.helpers import inside

DISTURBANCE, make_part = inside("physim.parts", "DISTURBANCE", "make_part")
DT = 0.05


def applied(
    kind: str,
    robots: int,
    steps: int,
    /,
    *,
    seed: int = 7,
    names: Sequence[str] = (),
    commands: Callable[[int], NDArray[np.float64]] | None = None,
    parts: int = 2,
    **settings: Any,
) -> NDArray[np.float64]:
    """(steps, robots, parts) Commands as they are executed; all are 1 unless ``commands`` says."""
    names = tuple(names) or tuple(f"r{i}" for i in range(robots))
    scene: Any = SimpleNamespace(seed=seed, dt=DT, robots=robots, names=names)
    part = make_part(DISTURBANCE, kind, settings)
    state, held, found = part.start(scene), np.zeros((robots, parts)), []
    for step in range(steps):
        wanted = np.ones((robots, parts)) if commands is None else commands(step)
        made, state = part.disturb(scene, SimpleNamespace(step=step, command=held), wanted, state)
        held = wanted
        found.append(made)
    return np.stack(found)
