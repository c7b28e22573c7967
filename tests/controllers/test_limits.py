"""Rotational speeds that a robot's limits do not allow."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from physim.world import Robot
from tests.helpers import inside

omega_faults = inside("physim.controllers", "omega_faults")


def robot(omega: float, own: tuple[float, ...] | None = None) -> Robot:
    return Robot.model_validate(
        {
            "name": f"r{omega:g}",
            "footprint": {"length": 1.8, "width": 1.0},
            "pose": [0.0, 0.0, 0.0],
            "path": {"offset": 0.0},
            "limits": {"omega": omega},
            "omegas": own,
        }
    )


ROBOTS = {0: robot(1.6), 1: robot(0.5), 2: robot(0.9), 4: robot(0.1, own=(0.0, 0.1))}


def places(omegas: Sequence[float], is_written: bool) -> list[tuple[int | str, ...]]:
    return [tuple(fault.location) for fault in omega_faults(omegas, is_written, ROBOTS)]


@pytest.mark.parametrize(
    ("omegas", "written", "default"),
    [
        ((-0.5, 0.0, 0.5), [], []),
        ((0.0, 0.6), [1], [1]),
        ((-0.6, 0.0, 0.4), [0], [1]),
        ((-1.0, 0.0, 0.5, 1.0), [0, 3], [1, 2]),
        ((0.0, 2.0), [1], [0, 1, 2]),
    ],
)
def test_where_faults_are_told(
    omegas: tuple[float, ...], written: list[int], default: list[int]
) -> None:
    """A set that the world writes: at its values; the default: at the limits of the robots.

    r4 has speeds of its own, so its limit does not matter.
    """
    assert places(omegas, True) == [("controller", "omegas", k) for k in written]
    assert places(omegas, False) == [("robots", i, "limits", "omega") for i in default]
