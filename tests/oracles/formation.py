"""Formation control, (7) to (10), and the formation error, straight from the sums."""

from __future__ import annotations

import numpy as np


def speed(station, lead, neighbours, nu_0, alpha, v_min, v_max):
    """nu_i of (7) for stations along s* and leads of Robot i and its ``neighbours`` (pairs)."""
    total = 0.0
    for other_station, other_lead in neighbours:
        l_ij = other_station - station
        wanted = other_lead - lead
        total += l_ij - wanted
    return min(max(nu_0 + alpha * total, v_min), v_max)


def inner_sum(i, station, lead, adjacency):
    """S_i: sum over N_i of l_ij - l*_ij."""
    return sum(
        (station[j] - station[i]) - (lead[j] - lead[i])
        for j in range(len(station))
        if adjacency[i][j]
    )


def energy(station, lead, adjacency):
    """W of (9)."""
    n = range(len(station))
    return 0.5 * sum(
        ((station[j] - station[i]) - (lead[j] - lead[i])) ** 2
        for i in n
        for j in n
        if adjacency[i][j]
    )


def energy_rate(station, lead, adjacency, alpha):
    """dW/dt of (10)."""
    n = range(len(station))
    return -2.0 * alpha * sum(inner_sum(i, station, lead, adjacency) ** 2 for i in n)


def error(i, station, lead):
    """Formation error of Robot i: mean of l_ij over all robots less the mean of l*_ij."""
    n = len(station)
    actual = sum(station[j] - station[i] for j in range(n)) / n
    wanted = sum(lead[j] - lead[i] for j in range(n)) / n
    return actual - wanted


def errors(station, lead):
    """Formation error of every robot."""
    return np.array([error(i, station, lead) for i in range(len(station))])
