"""Wide straight roads with boxes on them: worlds in which little happens, for tests of the loop."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from physim.world import World

BOX = {"length": 1.8, "width": 1.0}


def road(
    poses: Sequence[Sequence[Any]],
    *,
    step: float = 0.01,
    duration: float = 10.0,
    limits: dict[str, float] | None = None,
    **more: Any,
) -> World:
    """A road of 200 m by 40 m; every robot has a straight path through its own start.

    ``more`` are further keys of the world.
    """
    robots = [
        {
            "name": f"r{i + 1}",
            "footprint": BOX,
            "pose": list(pose),
            "path": [[0.0, pose[1]], [200.0, pose[1]]],
            **({"limits": limits} if limits else {}),
        }
        for i, pose in enumerate(poses)
    ]
    values: dict[str, Any] = {
        "name": "road",
        "time": {"step": step, "duration": duration},
        "corridor": {"centreline": [[0.0, 0.0], [200.0, 0.0]], "width": 40.0},
        "robots": robots,
    }
    return World(**{**values, **more})
