"""Straight corridors with an end wall near the stop, for tests of arrival."""

from __future__ import annotations

from collections.abc import Sequence

ROBOT = (
    "  - {{name: r{k}, footprint: {{length: 1.8, width: 1.0}}, pose: [{x}, 0, 0], "
    "path: {{offset: 0.0}}}}\n"
)


def dead_end(margin: float, starts: Sequence[float] = (2.0,), width: float = 6.0) -> str:
    """A world of 12 m whose end wall lies ``margin`` [m] beyond the path; robots at ``starts``."""
    robots = "".join(ROBOT.format(k=k + 1, x=x) for k, x in enumerate(starts))
    return (
        "name: dead_end\ntime: {step: 0.01, duration: 20.0}\n"
        f"corridor: {{centreline: [[0, 0], [12, 0]], width: {width}, end_margin: {margin}}}\n"
        f"robots:\n{robots}"
        "formation: {gain: 0.05, speed: 1.0, limits: [0.8, 1.3], range: 10.0}\n"
        "controller: {type: mode_switching}\n"
    )
