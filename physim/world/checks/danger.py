"""Room on the paths against what the controller keeps from the boundaries.

Where a path has less room than the controller keeps, its robot never leaves danger mode.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.errors import ControllerError, plural
from physim.parts.registry import settings_model
from physim.world.checks.findings import Diagnostics
from physim.world.checks.room import ClearanceProfile
from physim.world.faults import describe
from physim.world.scene import Layout

NEARLY_ALL = 0.95
"""Share of a path over which a robot in danger is taken never to leave danger mode"""


def setting(laid: Layout, controller: type[Any] | None, key: str) -> float | None:
    """A length among the controller's settings [m]: as set, else its default; None without one."""
    value = chosen(laid, controller, key)
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if is_number and 1e-9 <= value <= 1e6 else None


def chosen(laid: Layout, controller: type[Any] | None, key: str) -> Any:
    """A value among the controller's settings: as set, else its default; None without one."""
    try:
        model = settings_model(controller) if controller is not None else None
    except ControllerError:
        return None
    field = model.model_fields.get(key) if model is not None else None
    if field is None or laid.world.controller is None:
        return None
    return laid.world.controller.settings.get(key, field.default)


def check_safe_area(laid: Layout, safe_distance: float | None, found: Diagnostics) -> None:
    """Warn where no place is as far from the boundaries as the controller wants to be."""
    if safe_distance is None:
        return
    if laid.area.shrunk(safe_distance, 4).is_empty:
        found.warn(
            ("controller", "safe_distance"),
            f"no place is {safe_distance:.4g} m from every boundary, so there is no safe area; "
            f"the largest distance is {laid.area.largest_distance():.4g} m; widen the corridor, or "
            "set safe_distance below that",
        )


def check_always_danger(
    profiles: tuple[ClearanceProfile, ...], threshold: float | None, found: Diagnostics
) -> None:
    """Warn of a distance threshold [m] for boundaries that is beyond the room beside the paths.

    A robot on its path, or led away from the walls to the safe distance, reaches them up to its
    inscribed radius at least: never too large, so that the warning is never without need.
    """
    if threshold is None:
        return
    always: list[tuple[float, ClearanceProfile]] = []
    for profile in profiles:
        if profile.inscribed <= 0.0:
            continue  # the reference point may lie outside the footprint
        room = np.maximum(profile.clearance, profile.safe_distance or 0.0) - profile.inscribed
        if profile.share(room < threshold) >= NEARLY_ALL:
            always.append((float(room[profile.is_reached].max()), profile))
    if not always:
        return
    room_there, first = max(always, key=lambda pair: pair[0])
    others = f", {plural(len(always) - 1, 'other robot')} no more" if len(always) > 1 else ""
    found.warn(
        ("controller", "boundary_low"),
        f"below {threshold:.4g} m from a boundary a robot is in danger mode, and "
        f"{describe(first.robot)} has at most {room_there:.4g} m beside it on "
        f"its path{others}: it would not leave danger mode and may never arrive; set "
        "boundary_low below that, or widen the road",
    )


def check_turning_room(
    laid: Layout, profiles: tuple[ClearanceProfile, ...], found: Diagnostics
) -> None:
    """Warn of paths in the danger area, where no place of the safe area lets the robot turn."""
    largest: float | None = None
    tight = []
    for profile in profiles:
        if profile.safe_distance is None or (profile.danger_share or 0.0) < NEARLY_ALL:
            continue
        largest = laid.area.largest_distance() if largest is None else largest
        if profile.safe_distance <= largest < profile.safe_distance + profile.circumscribed:
            tight.append(profile)
    if not tight or largest is None:
        return
    first = tight[0]
    others = f" (of {plural(len(tight) - 1, 'more robot')} too)" if len(tight) > 1 else ""
    found.warn(
        laid.path_key(first.number),
        f"the path of {describe(first.robot)}{others} lies in the danger area, "
        f"less than {first.safe_distance:.4g} m from a wall, over {first.danger_share:.0%} of its "
        f"length, and no place is more than {largest:.4g} m from the walls, too little to turn "
        f"in the safe area, which takes {first.circumscribed:.4g} m more than the safe distance: "
        "the robot may come to a standstill; lead the path along the middle, or widen the road",
    )
