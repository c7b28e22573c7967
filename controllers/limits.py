"""Commands that a robot's limits do not allow, reported before the run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from physim.errors import Fault, plural

if TYPE_CHECKING:
    from physim.world import Robot


def omega_faults(
    omegas: Sequence[float], is_written: bool, robots: Mapping[int, Robot]
) -> list[Fault]:
    """Faults of a set of rotational speeds [rad/s], chosen from by robots without one of their own.

    They stand at ``controller.omegas`` where the world writes the set, else at the robots' limits.
    """
    using = {i: robot for i, robot in robots.items() if robot.omegas is None}
    if is_written:
        return [
            fault for k, omega in enumerate(omegas) for fault in _beyond(k, float(omega), using)
        ]
    fastest = max((abs(float(omega)) for omega in omegas), default=0.0)
    return [
        Fault(
            ("robots", i, "limits", "omega"),
            f"{robot.limits.omega:g} rad/s is below {fastest:.5g} rad/s, the fastest of the "
            "controller's rotational speeds; raise the limit, or give the robot its own omegas "
            "within it",
        )
        for i, robot in using.items()
        if fastest > robot.limits.omega
    ]


def _beyond(k: int, omega: float, robots: Mapping[int, Robot]) -> list[Fault]:
    """Fault of one speed [rad/s] of the set, with the robot of the lowest limit."""
    slow = [robot for robot in robots.values() if abs(omega) > robot.limits.omega]
    if not slow:
        return []
    slowest = min(slow, key=lambda robot: robot.limits.omega)
    more = f" and beyond that of {plural(len(slow) - 1, 'more robot')}" if len(slow) > 1 else ""
    message = (
        f"{omega:g} rad/s is beyond limits.omega = {slowest.limits.omega:g} of "
        f'"{slowest.name}"{more}; use slower ones, raise the limit, or give the robot its own '
        "omegas"
    )
    return [Fault(("controller", "omegas", k), message)]
