"""Formation control along the reference path, (7) to (10).

Stations s_i are projections on the one reference path s*; l_ij = s_j - s_i is positive when Robot
j is ahead of Robot i. The desired value l*_ij is lead_j - lead_i.

Departures from the paper: the speed is held within [v_min, v_max] (the paper reports the range 0.8
to 1.3 m/s without a rule for it); N_i is by default the robots within a range along s*.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray, IntArray

if TYPE_CHECKING:
    from physim.parts.controller import FormationView
    from physim.world.scene import FormationPlan


@compiled
def is_neighbour(
    i: int,
    j: int,
    station_i: float,
    station_j: float,
    adjacency: IntArray,
    robots: int,
    neighbour_range: float,
) -> bool:
    """Whether j is in N_i: listed in ``adjacency``, or within range along s* where nobody is.

    ``adjacency`` (N N,) is that of so many ``robots``, 0 where it is empty.
    """
    if i == j:
        return False
    if robots > 0:
        return bool(adjacency[robots * i + j] != 0)
    return abs(station_j - station_i) <= neighbour_range


@compiled
def formation_sum(
    me: int,
    number: IntArray,
    neighbours: IntArray,
    many: int,
    station: FloatArray,
    lead: FloatArray,
) -> float:
    """Sum over N_i of l_ij - l*_ij [m]: positive when Robot i lags behind its neighbours.

    ``me`` and ``neighbours``, so many, are rows, of robots ``number`` (n,) at ``station`` (n,);
    ``lead`` is that of all robots.
    """
    total, own_lead = 0.0, lead[number[me]]
    for k in range(many):
        j = neighbours[k]
        total += (station[j] - station[me]) - (lead[number[j]] - own_lead)
    return total


@compiled
def formation_speed(
    nu_0: float, alpha: float, v_min: float, v_max: float, error_sum: float
) -> float:
    """Forward speed nu_i [m/s] by (7), held within [v_min, v_max]."""
    nu = nu_0 + alpha * error_sum  # (7)
    return min(max(nu, v_min), v_max)


class SpeedRule(NamedTuple):
    """What the forward speed of a robot goes by, the same for all robots of a run."""

    active: bool
    """whether there is a formation"""
    nu_0: float
    """[m/s] the speed under (7) without any error, and without a formation"""
    alpha: float
    v_min: float
    v_max: float

    @staticmethod
    def of(plan: FormationPlan | FormationView, speed: float) -> SpeedRule:
        """Return the rule of a formation; ``speed`` [m/s] where there is none."""
        nu_0 = plan.speed if plan.active else speed
        return SpeedRule(plan.active, nu_0, plan.gain, plan.v_min, plan.v_max)


@compiled
def put_neighbours(
    me: int,
    number: IntArray,
    station: FloatArray,
    rows: int,
    adjacency: IntArray,
    robots: int,
    neighbour_range: float,
    out: IntArray,
) -> int:
    """Write the rows of N_i of row ``me``, increasing, into ``out``; how many.

    Of so many ``rows`` of robots ``number`` (n,) at ``station`` (n,); the rest as `is_neighbour`.
    """
    count, here = 0, station[me]
    for j in range(rows):
        if station[j] < np.inf and is_neighbour(
            number[me], number[j], here, station[j], adjacency, robots, neighbour_range
        ):
            out[count] = j
            count += 1
    return count


@compiled
def forward_speed(
    rule: SpeedRule,
    top_speed: float,
    me: int,
    number: IntArray,
    neighbours: IntArray,
    many: int,
    station: FloatArray,
    lead: FloatArray,
) -> float:
    """Forward speed of row ``me`` [m/s]: by (7) in a formation, within its robot's limit."""
    nu = rule.nu_0
    if rule.active:
        error = formation_sum(me, number, neighbours, many, station, lead)
        nu = formation_speed(rule.nu_0, rule.alpha, rule.v_min, rule.v_max, error)
    return min(nu, top_speed)


def formation_energy(station: FloatArray, lead: FloatArray, adjacency: IntArray) -> float:
    """W [m^2] by (9) for stations and desired leads (N,) and a symmetric adjacency (N, N)."""
    error = (station[None, :] - station[:, None]) - (lead[None, :] - lead[:, None])
    return float(0.5 * (adjacency * error**2).sum())  # (9)


def formation_energy_rate(
    station: FloatArray, lead: FloatArray, adjacency: IntArray, alpha: float
) -> float:
    """dW/dt [m^2/s] by (10), never positive; holds for ideal motion (8) without saturation."""
    error = (station[None, :] - station[:, None]) - (lead[None, :] - lead[:, None])
    inner = (adjacency * error).sum(axis=1)
    return float(-2.0 * alpha * np.square(inner).sum())  # (10)
