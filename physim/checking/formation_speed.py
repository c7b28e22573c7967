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

from collections.abc import Mapping
from typing import Any

import numpy as np
import shapely

from physim.checking.sketch import Sketch, number
from physim.checking.telling import MOST_ALIKE, Told
from physim.geometry.shapes import FloatArray
from physim.world import Formation
from physim.world.faults import shown

LAST_SHARE = 0.1
"""Share of the initial error sums at which (7) should be within the limits again."""
UPDATE = 0.1
"""[s] longest update interval (14)"""


def check_formation_speed(sketch: Sketch, values: Mapping[str, Any], told: Told) -> None:
    """Warn of a steady speed outside the limits, slow robots, and a gain that saturates."""
    plan = values.get("formation")
    if not sketch.has_formation or not isinstance(plan, Mapping) or len(sketch.robots) < 2:
        return
    defaults = {key: field.default for key, field in Formation.model_fields.items()}
    speed, gain = (number(plan.get(key, defaults[key]), 0.0, 1000.0) for key in ("speed", "gain"))
    given = plan.get("limits", list(defaults["limits"]))
    limits = given if isinstance(given, list) and len(given) == 2 else [None, None]
    low, high = (number(value, 0.0, 1000.0) for value in limits)
    if speed is None or low is None or high is None or low > high:
        return
    _check_slow(sketch, low, told)
    if not low <= speed <= high:
        told.warn(
            ("formation", "speed" if "speed" in plan else "limits"),
            f"the steady speed, {speed:.6g} m/s, lies outside the limits, {low:.6g} to {high:.6g} "
            f"m/s: (7) holds every robot at {low if speed < low else high:.6g} m/s until errors "
            "are large; write a speed between the limits, or widen them",
        )
    elif gain is not None:
        _check_gain(sketch, {**defaults, **plan}, (gain, speed, low, high), told)


def _check_slow(sketch: Sketch, low: float, told: Told) -> None:
    """Warn of robots slower than the least speed [m/s] that (7) gives the others."""
    slow = [robot for robot in sketch.robots if robot.v is not None and robot.v < low]
    for robot in slow[:MOST_ALIKE]:
        told.warn(
            ("robots", robot.number, "limits", "v"),
            f"{shown(robot.name)} drives at most {robot.v:.6g} m/s and cannot keep up: by "
            f"formation.limits the others drive at least {low:.6g} m/s; raise this limit, or lower "
            "the least speed of the formation",
        )


def _check_gain(
    sketch: Sketch,
    plan: Mapping[str, Any],
    speeds: tuple[float, float, float, float],
    told: Told,
) -> None:
    gain, speed, low, high = speeds
    margin = min((m for m in (high - speed, speed - low) if m > 0.0), default=0.0)
    sums, neighbours = _error_sums(sketch, plan)
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
    told.warn(
        ("formation", "gain"),
        f"{gain:.6g} 1/s saturates the cluster: an error sum of {margin / gain:.3g} m takes a "
        f"robot from {speed:.6g} m/s to a limit, and all beyond changes nothing; use at "
        f"most {margin / error:.3g} 1/s ({margin:.3g} m/s to the nearer limit, divided by {why})",
    )


def _error_sums(sketch: Sketch, plan: Mapping[str, Any]) -> tuple[FloatArray, int]:
    """S_i (N,) [m] at the start, and the most neighbours that a robot has there; 0 if unknown."""
    places = [robot.position for robot in sketch.robots]
    count = len(places)
    if sketch.reference is None or any(place is None for place in places):
        return np.zeros(count), 1
    line = shapely.LineString(sketch.reference)
    station = np.asarray(line.project(shapely.points(np.array(places))))
    lead = station if sketch.leads is None else sketch.leads
    sums, most = np.zeros(count), 0
    pairs = _pairs(sketch, plan["neighbours"])
    reach = number(plan["range"], 0.0, 1e6) or 0.0
    for i in range(count):
        near = np.abs(station - station[i]) <= reach
        if plan["neighbours"] != "range":
            near = np.ones(count, dtype=bool) if pairs is None else pairs[i]
        near[i] = False
        sums[i] = ((station - station[i]) - (lead - lead[i]))[near].sum()
        most = max(most, int(near.sum()))
    return sums, most


def _pairs(sketch: Sketch, given: Any) -> Any:
    """Who keeps distance to whom (N, N), where pairs of names are listed; else None."""
    if not isinstance(given, list):
        return None
    index = {robot.name: robot.number for robot in sketch.robots}
    near = np.zeros((len(sketch.robots), len(sketch.robots)), dtype=bool)
    for pair in given:
        if isinstance(pair, list) and len(pair) == 2 and all(str(name) in index for name in pair):
            i, j = (index[str(name)] for name in pair)
            near[i, j] = near[j, i] = True
    return near
