"""When a robot decides again: event-triggered updates (14).

Departures from the paper: (14) is lost. The text says what it is for, to save messages and work,
and that can only come from intervals longer than the 0.1 s of a plan; so the plan may be stretched
to a longest interval of its own. Where that is the plan's own length (14) can only shorten it.
An interval is cut short where the robot would come to its stop station, so that where it stands
does not depend on when it decides. What is left of a plan is dropped when an interval is cut short.
"""

from __future__ import annotations

from physim.compiled import compiled


@compiled
def update_interval(longest: float, beta: float, collision_time: float) -> float:
    """tau_i [s] by (14): the longest, or ``beta`` times the smallest collision time if shorter.

    The simulation rounds it down to physics steps, one at least.
    """
    return min(longest, beta * collision_time)  # (14)
