"""Fig. 5: safe or danger, by which rule, with hysteresis."""

from __future__ import annotations

SAFE, BY_DISTANCE, BY_TIME, ARRIVED = range(4)


def next_mode(previous, distance, time, boundary, s):
    """Mode by the five thresholds of the settings ``s``."""
    was_in_danger = previous in (BY_DISTANCE, BY_TIME)
    if was_in_danger:
        calm = distance > s.distance_high and time > s.time_high and boundary > s.boundary_low
    else:
        calm = not (distance < s.distance_low or time < s.time_low or boundary < s.boundary_low)
    if calm:
        return SAFE
    if s.avoidance == "none":
        return SAFE
    if s.avoidance in ("time", "distance"):
        return BY_TIME if s.avoidance == "time" else BY_DISTANCE
    touching = time == 0.0 or distance <= 0.0 or boundary <= 0.0
    if s.avoidance == "distance_first":
        near = distance < s.distance_low or boundary < s.boundary_low
        return BY_DISTANCE if near or touching else BY_TIME
    time_is_short = time <= s.time_high if was_in_danger else time < s.time_low
    return BY_TIME if time_is_short and not touching else BY_DISTANCE
