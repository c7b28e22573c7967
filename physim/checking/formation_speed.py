"""Speeds of the formation: within their limits, and a gain that leaves (7) something to do.

By (7) Robot i drives nu_0 + alpha S_i, held within the limits, with S_i the sum over its neighbours
of l_ij - l*_ij. The larger the gain, the smaller the error at which a limit is reached; where a
limit is reached by almost any error, the speed jumps between the limits and nothing of (7) is left.

The greatest sensible gain is M / S*, with M [m/s] the distance of nu_0 from the nearer limit and
S* [m] a sum that (7) should still answer within the limits, the larger of

* a tenth of the largest abs(S_i) at the start: large errors may well saturate, their last tenth
  should not;
* n (v_max - v_min) 0.1 s: what S_i of a robot with n neighbours changes by within one update (14)
  when they drive at opposite limits; beyond it the robots swing from limit to limit.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from physim.checking.findings import MOST_ALIKE, Diagnostics
from physim.checking.formation import listed_leads, start_stations
from physim.geometry.shapes import FloatArray
from physim.layout import PartialLayout
from physim.world.faults import describe

LAST_SHARE = 0.1
"""Share of the initial error sums at which (7) should be within the limits again."""
UPDATE = 0.1
"""[s] longest update interval (14)"""


def check_formation_speed(laid: PartialLayout, found: Diagnostics) -> None:
    """Warn of a steady speed outside the limits, slow robots, and a gain that saturates."""
    plan = laid.world.formation
    if plan is None or plan.speed is None or plan.limits is None or len(laid.world.robots) < 2:
        return
    speed, (low, high) = plan.speed, plan.limits
    if low > high:
        return
    _check_slow(laid, low, found)
    if not low <= speed <= high:
        found.warn(
            ("formation", "speed" if "speed" in plan.model_fields_set else "limits"),
            f"the steady speed, {speed:.6g} m/s, lies outside the limits, {low:.6g} to {high:.6g} "
            f"m/s: (7) holds every robot at {low if speed < low else high:.6g} m/s until errors "
            "are large; write a speed between the limits, or widen them",
        )
    elif plan.gain is not None:
        _check_gain(laid, found)


def _check_slow(laid: PartialLayout, low: float, found: Diagnostics) -> None:
    """Warn of robots slower than the least speed [m/s] that (7) gives the others."""
    tops = [robot.limits.v for robot in laid.world.robots]
    slow = [i for i, top in enumerate(tops) if top is not None and top < low]
    for i in slow[:MOST_ALIKE]:
        found.warn(
            ("robots", i, "limits", "v"),
            f"{describe(laid.names[i])} drives at most {tops[i]:.6g} m/s and cannot keep up: by "
            f"formation.limits the others drive at least {low:.6g} m/s; raise this limit, or lower "
            "the least speed of the formation",
        )


def _check_gain(laid: PartialLayout, found: Diagnostics) -> None:
    plan = laid.world.formation
    gain, speed, (low, high) = plan.gain, plan.speed, plan.limits
    margin = min((m for m in (high - speed, speed - low) if m > 0.0), default=0.0)
    sums, neighbours = _error_sums(laid)
    start = float(np.abs(sums).max(initial=0.0))
    swing = neighbours * (high - low) * UPDATE
    error = max(LAST_SHARE * start, swing)
    if margin <= 0.0 or error <= 0.0 or gain * error <= margin:
        return
    why = (
        f"a tenth of the {start:.3g} m that the errors of (7) sum up to at the start"
        if LAST_SHARE * start >= swing
        else f"{swing:.3g} m, the change of the sum within {UPDATE:g} s that {neighbours} "
        f"neighbour{'s' if neighbours > 1 else ''} at the opposite limit can make"
    )
    found.warn(
        ("formation", "gain"),
        f"{gain:.6g} 1/s saturates the cluster: an error sum of {margin / gain:.3g} m takes a "
        f"robot from {speed:.6g} m/s to a limit, and all beyond changes nothing; use at "
        f"most {margin / error:.3g} 1/s ({margin:.3g} m/s to the nearer limit, divided by {why})",
    )


def _error_sums(laid: PartialLayout) -> tuple[FloatArray, int]:
    """S_i (N,) [m] at the start, and the most neighbours that a robot has there; 0 if unknown."""
    count, plan = len(laid.world.robots), laid.world.formation
    reference = laid.reference
    station = None if reference is None else start_stations(laid, shapely.LineString(reference))
    if station is None:
        return np.zeros(count), 1
    listed = listed_leads(laid)
    lead = station if listed is None else listed
    sums, most = np.zeros(count), 0
    pairs = _pairs(laid)
    reach = plan.range or 0.0
    for i in range(count):
        near = np.abs(station - station[i]) <= reach
        if plan.neighbours != "range":
            near = np.ones(count, dtype=bool) if pairs is None else pairs[i]
        near[i] = False
        sums[i] = ((station - station[i]) - (lead - lead[i]))[near].sum()
        most = max(most, int(near.sum()))
    return sums, most


def _pairs(laid: PartialLayout) -> NDArray[np.bool_] | None:
    """Who keeps distance to whom (N, N), where pairs of names are listed; else None."""
    given = laid.world.formation.neighbours
    if not isinstance(given, tuple):
        return None
    index = {name: i for i, name in enumerate(laid.names)}
    near = np.zeros((len(index), len(index)), dtype=bool)
    for a, b in given:
        if a in index and b in index:
            near[index[a], index[b]] = near[index[b], index[a]] = True
    return near
