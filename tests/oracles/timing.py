"""Update interval (14), shortened by a short collision time, and by the way left to the stop."""


def interval(longest, beta, time, event_triggered):
    """tau [s]: the longest, or beta times the smallest collision time where that is shorter."""
    return min(longest, beta * time) if event_triggered else longest


def longest_interval(s):
    """Longest time between two decisions [s] by the settings ``s``: twice a plan, unless given."""
    return 2.0 * s.update_period if s.longest_interval is None else s.longest_interval


def until_stop(left, v):
    """Time [s] in which a robot covers the ``left`` [m] of its way; for ever unless it advances."""
    return left / v if v > 0.0 else float("inf")


def stretched(part, period, longest):
    """Interval of one dwell time of a plan that takes ``longest`` instead of ``period``."""
    return longest * part / period
