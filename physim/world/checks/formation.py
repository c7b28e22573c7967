"""The formation: whether the robots, each at its wanted place, stand apart, and can get there.

By (7) Robot i drives nu_0 + alpha S_i, held within the limits, with S_i the sum over its
neighbours of l_ij - l*_ij. The larger the gain, the smaller the error at which a limit is
reached; where a limit is reached by almost any error, the speed jumps between the limits and
nothing of (7) is left.

The greatest sensible gain is M / S*, with M [m/s] the distance of nu_0 from the nearer limit and
S* [m] a sum that (7) should still answer within the limits, the larger of

* a tenth of the largest abs(S_i) at the start: large errors may well saturate, their last tenth
  should not;
* n (v_max - v_min) 0.1 s: what S_i of a robot with n neighbours changes by within one update (14)
  when they drive at opposite limits; beyond it the robots swing from limit to limit.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike

from physim.errors import Location
from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray
from physim.tolerances import CONTACT
from physim.world.checks.findings import MOST_ALIKE, Diagnostics
from physim.world.checks.neighbourhood import neighbours_at
from physim.world.checks.spacing import (
    check_order,
    check_spacing,
    listed_leads,
    name_of,
    start_stations,
)
from physim.world.faults import describe
from physim.world.layout.shared import Shared
from physim.world.scene import Layout


def check_formation(laid: Layout, speed: float, by_7: bool, found: Diagnostics) -> None:
    """Spacing longer than the footprints, and a reference path longer than the formation.

    ``speed`` [m/s] is that at which robots move by themselves, in a world without formation; in one
    it is set ``by_7``, or stays the formation's.
    """
    plan = laid.world.formation
    if not laid.world.robots:
        return
    line = shapely.LineString(laid.reference)
    stations = start_stations(laid, line)
    leads: FloatArray | None = np.zeros(len(laid.world.robots))
    if plan is not None:
        leads = listed_leads(laid)
        if leads is None and stations is not None and plan.spacing == "initial":
            leads = stations - stations[0]
        if leads is None:
            return
        speed = 1.0 if plan.speed is None else plan.speed
        if by_7 and plan.limits is not None:
            speed = min(max(speed, plan.limits[0]), plan.limits[1])
        check_spacing(laid, laid.reference, leads, found)
        check_order(laid, leads, found)
    if stations is not None and leads is not None:
        hurried = plan.limits[1] if by_7 and plan is not None and plan.limits else speed
        _check_length(laid, line, stations, leads, (speed, max(speed, hurried)), found)


def _check_length(
    laid: Layout,
    line: shapely.LineString,
    stations: FloatArray,
    leads: FloatArray,
    speeds: tuple[float, float],
    found: Diagnostics,
) -> None:
    """Refuse a reference path shorter than the formation; warn of robots that start at a stop."""
    extent = float(leads.max() - leads.min())
    if extent > line.length:
        found.error(
            laid.reference_key,
            f"the reference path is {line.length:.4g} m long and the formation {extent:.4g} m; "
            "make it longer than the formation",
        )
        return
    line_of, points = Shared(shapely.LineString), shapely.get_coordinates(line)
    has_formation, is_told = laid.world.formation is not None, False
    ways: dict[int, float] = {}
    for k, path in enumerate(laid.paths):
        where: Location = (*laid.world.entry_of(k), "pose")
        own, position = line_of(path), laid.start[k, :2]
        stop = max(own.length - float(leads.max() - leads[k]), 0.0)
        begin = float(own.project(shapely.Point(position)))
        reach = circumscribed_radius(laid.footprints[k])
        if begin >= stop:
            found.warn(
                where,
                f"{name_of(laid, k)} starts at station {begin:.2f} m of its path, at or past its "
                f"stop station, {stop:.2f} m: it has arrived before it moves",
            )
        elif (
            has_formation and stations[k] <= 0.0 and _is_past(points[1], points[0], position, reach)
        ):
            found.warn(
                where,
                f"{name_of(laid, k)} starts before the reference path begins, where the "
                "formation cannot measure its distance; extend the reference path backwards",
            )
        end = own.interpolate(stop)
        is_end = has_formation and line.project(end) >= line.length
        if is_end and not is_told and _is_past(points[-2], points[-1], end.coords[0], reach):
            is_told = True
            found.warn(
                laid.path_key(k),
                f"{name_of(laid, k)} stops {line.distance(end):.4g} m beyond the end of the "
                "reference path, where the formation cannot measure its distance; extend the "
                "reference path",
            )
        ways[k] = stop - begin
    _check_duration(laid, ways, speeds, found)


def _check_duration(
    laid: Layout, ways: dict[int, float], speeds: tuple[float, float], found: Diagnostics
) -> None:
    """Warn where the run is too short for the ways [m] of its robots, but is expected to finish.

    ``speeds`` [m/s] are the usual one and that of robots that are hurried.
    """
    expect, duration = laid.world.expect, laid.world.time.duration
    if expect is None or not expect.finished or duration is None or not ways:
        return
    speed, hurried = speeds

    def times(k: int) -> tuple[float, float]:
        """[s] that a robot needs at least, as (7) hurries who is behind, and at its own pace."""
        own = laid.world.robots[k].limits.v
        own = np.inf if own is None else own
        return ways[k] / min(own, hurried), ways[k] / min(own, speed)

    slowest = max(ways, key=lambda k: (times(k)[0] > duration, times(k)[1]))
    least, needed = times(slowest)
    if needed > duration:
        sure = "is" if least > duration else "may be"
        found.warn(
            ("time", "duration"),
            f"the run {sure} too short to finish: {name_of(laid, slowest)} has "
            f"{ways[slowest]:.4g} m to go, {needed:.4g} s at {ways[slowest] / needed:.4g} m/s, "
            f"and the run lasts {duration:.6g} s; make it longer, or remove expect.finished",
        )


def _is_past(inner: FloatArray, end: FloatArray, position: ArrayLike, reach: float) -> bool:
    """Whether a place lies past the end of a path, by more than a robot's reach [m].

    ``inner`` is the point next to the end.
    """
    along = np.subtract(position, end) @ np.subtract(end, inner)
    return bool(along / np.hypot(*np.subtract(end, inner)) > reach + CONTACT)


LAST_SHARE = 0.1
"""Share of the initial error sums at which (7) should be within the limits again."""
UPDATE = 0.1
"""[s] longest update interval (14)"""


def check_formation_speed(laid: Layout, by_7: bool, found: Diagnostics) -> None:
    """Warn of a steady speed outside the limits, slow robots, and a gain that saturates.

    Speeds are set ``by_7``, or stay the formation's.
    """
    plan = laid.world.formation
    if plan is None or plan.speed is None or plan.limits is None or len(laid.world.robots) < 2:
        return
    speed, (low, high) = plan.speed, plan.limits
    if low > high:
        return
    _check_slow(laid, low, found)
    told = {fault.location for fault in found.warnings}
    if not low <= speed <= high and ("formation", "speed") in told:
        return
    if by_7 and not low <= speed <= high:
        found.warn(
            ("formation", "speed" if "speed" in plan.model_fields_set else "limits"),
            f"the steady speed, {speed:.6g} m/s, lies outside the limits, {low:.6g} to {high:.6g} "
            f"m/s: (7) holds every robot at {low if speed < low else high:.6g} m/s until errors "
            "are large; write a speed between the limits, or widen them",
        )
    elif plan.gain is not None:
        _check_gain(laid, found)


def _check_slow(laid: Layout, low: float, found: Diagnostics) -> None:
    """Warn of robots slower than the least speed [m/s] that (7) gives the others."""
    tops = [robot.limits.v for robot in laid.world.robots]
    slow = [i for i, top in enumerate(tops) if top is not None and top < low]
    for i in slow[:MOST_ALIKE]:
        found.warn(
            (*laid.world.entry_of(i), "limits", "v"),
            f"{describe(laid.names[i])} drives at most {tops[i]:.6g} m/s and cannot keep up: by "
            f"formation.limits the others drive at least {low:.6g} m/s; raise this limit, or lower "
            "the least speed of the formation",
        )


def _check_gain(laid: Layout, found: Diagnostics) -> None:
    plan: Any = laid.world.formation
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
        f"robot from {speed:.6g} m/s to a limit, and a larger sum changes nothing; use at "
        f"most {margin / error:.3g} 1/s ({margin:.3g} m/s to the nearer limit, divided by {why})",
    )


def _error_sums(laid: Layout) -> tuple[FloatArray, int]:
    """S_i (N,) [m] at the start, and the most neighbours that a robot has there; 0 if unknown."""
    count = len(laid.world.robots)
    plan: Any = laid.world.formation
    reference = laid.reference
    station = None if reference is None else start_stations(laid, shapely.LineString(reference))
    if station is None:
        return np.zeros(count), 1
    listed = listed_leads(laid)
    lead = station if listed is None else listed
    if plan.neighbours == "all":
        error = station - lead
        return error.sum() - count * error, count - 1
    sums, most = np.zeros(count), 0
    for i, others in enumerate(neighbours_at(laid, station)):
        sums[i] = ((station[others] - station[i]) - (lead[others] - lead[i])).sum()
        most = max(most, len(others))
    return sums, most
