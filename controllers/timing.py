"""When a robot decides again: event-triggered updates (14).

Departures from the paper: (14) is lost; in this reading a short collision time can only bring a
decision forward. It cuts short each dwell time of a plan alike, and what is left of the plan is
dropped then.
"""

from __future__ import annotations

from physim.compiled import compiled


@compiled
def update_interval(period: float, beta: float, collision_time: float) -> float:
    """tau_i [s] by (14): the period, or ``beta`` times the smallest collision time if shorter.

    The simulation rounds it down to physics steps, one at least.
    """
    return min(period, beta * collision_time)  # (14)
