"""Switching between safe and danger mode (Fig. 5), and when a robot decides again (14).

Danger begins when a distance, a collision time or a boundary distance falls below its lower
threshold, and ends only when distance and collision time are above their upper thresholds and the
boundary distance is above its own: five thresholds.

Departures from the paper: its five symbols are lost; these are our reading. Which of (12) and (13)
serves in danger mode is a setting, ``avoidance``; (12) whenever shapes touch, unless there is (13)
alone. A sixth threshold, ``boundary_time_high``, may let danger end while a boundary is still
within ``time_high`` ahead: the paper has robots consider boundaries within the danger area only.

(14) is lost. The text says what it is for, to save messages and work, and that can only come from
intervals longer than the 0.1 s of a plan; so the plan may be stretched to a longest interval of
its own. Where that is the plan's own length (14) can only shorten it. An interval is cut short
where the robot would come to its stop station, so that where it stands does not depend on when it
decides. What is left of a plan is dropped when an interval is cut short.
"""

from __future__ import annotations

from physim.compiled import compiled

from .settings import DISTANCE_ALONE, DISTANCE_FIRST, NO_AVOIDANCE, TIME_ALONE, Rules

SAFE, DISTANCE, TIME = 0, 1, 2
"""Numbers of the modes in `physim.parts.declarations.PAPER_MODES`"""


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


@compiled
def update_interval(longest: float, beta: float, collision_time: float) -> float:
    """tau_i [s] by (14): the longest, or ``beta`` times the smallest collision time if shorter.

    The simulation rounds it down to physics steps, one at least.
    """
    return min(longest, beta * collision_time)  # (14)
