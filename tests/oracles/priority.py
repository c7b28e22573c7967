"""Which robots Robot i considers: those ahead along s* within range, ties by index."""

from __future__ import annotations

import math


def has_priority(station_i, index_i, station_j, index_j):
    """Whether Robot j has priority over Robot i: j is ahead; of equals the lower index."""
    return (station_j, -index_j) > (station_i, -index_i)


def considered(index, pose, station, others, reach):
    """Indices of those of ``others`` (index, pose, station) that Robot ``index`` considers."""
    return [
        j
        for j, other_pose, other_station in others
        if has_priority(station, index, other_station, j)
        and other_station - station <= reach
        and math.hypot(other_pose[0] - pose[0], other_pose[1] - pose[1]) <= reach
    ]
