"""Update interval (14), shortened by a short collision time."""


def interval(period, beta, time, event_triggered):
    """tau [s]: the period, or beta times the smallest collision time where that is shorter."""
    return min(period, beta * time) if event_triggered else period
