"""Switching between safe and danger mode (Fig. 5), with hysteresis.

Danger begins when a distance, a collision time or a boundary distance falls below its lower
threshold, and ends only when distance and collision time are above their upper thresholds and the
boundary distance is above its own: five thresholds.

Departures from the paper: its five symbols are lost; these are our reading. Which of (12) and (13)
serves in danger mode is a setting, ``avoidance``; (12) whenever shapes touch, unless there is (13)
alone.
"""

from __future__ import annotations

from physim.compiled import compiled

from .settings import DISTANCE_ALONE, DISTANCE_FIRST, NO_AVOIDANCE, TIME_ALONE, Rules

SAFE, DISTANCE, TIME = 0, 1, 2
"""Numbers of the modes in `physim.declared.PAPER_MODES`"""


@compiled
def next_mode(
    previous: int, distance: float, collision_time: float, boundary_distance: float, rules: Rules
) -> int:
    """Mode by Fig. 5: SAFE, DISTANCE (avoid by (12)) or TIME (avoid by (13)).

    ``distance`` [m] to the nearest considered robot, ``collision_time`` [s] under the command that
    safe mode would give, ``boundary_distance`` [m].
    """
    in_danger = previous in (DISTANCE, TIME)
    distance_threshold = rules.distance_high if in_danger else rules.distance_low
    time_threshold = rules.time_high if in_danger else rules.time_low
    if in_danger:  # safe again only strictly above the thresholds
        short_distance = distance <= distance_threshold
        short_time = collision_time <= time_threshold
        short_boundary = boundary_distance <= rules.boundary_low
    else:
        short_distance = distance < distance_threshold
        short_time = collision_time < time_threshold
        short_boundary = boundary_distance < rules.boundary_low
    if not (short_distance or short_time or short_boundary) or rules.avoidance == NO_AVOIDANCE:
        return SAFE
    touching = collision_time <= 0.0 or distance <= 0.0 or boundary_distance <= 0.0
    if rules.avoidance == TIME_ALONE:
        return TIME
    if rules.avoidance == DISTANCE_ALONE or touching:
        return DISTANCE
    if rules.avoidance == DISTANCE_FIRST:
        is_near = distance < rules.distance_low or boundary_distance < rules.boundary_low
        return DISTANCE if is_near else TIME
    return TIME if short_time else DISTANCE
