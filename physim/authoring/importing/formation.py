"""Whether robots are a formation, measured along the reference path; how far its neighbours are
apart; and lanes that lose it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from physim.authoring.importing.blocked_ways import blocked_ways, sides
from physim.authoring.importing.fit import Fit
from physim.authoring.importing.lanes import leaves_out
from physim.authoring.importing.lines import length_of, pose_at, station_of
from physim.authoring.importing.measured import MOST_OFF, measured
from physim.authoring.importing.path_area import TOLD
from physim.authoring.importing.placed import Placed, shape_at
from physim.authoring.importing.queues import own_outline
from physim.authoring.importing.stops import least_stop_gap, stop_stations
from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray
from physim.world.layout.shared import Shared

ALONG = (0.5, 1.6)
"""[-] times its own way that a robot comes forward along the reference path, if a formation goes on
it: outside and inside of bends, but not across one"""
BACK = 4.0
"""[m] at size 1 that it comes back along it on its way at most"""
RANGE = 10.0
"""[m] of formation neighbours, at size 1"""
MARGIN = 1.1
"""[-] times the longest gap between robots at the start, if neighbours are to know of each other"""
SHARE = 0.5
"""[-] share of its way that a formation leaves a robot at least"""


def no_formation(found: Fit, robots: list[Placed], alone: list[Placed]) -> str:
    """Why robots on open paths are none, which each would do better without; empty if they are.

    ``alone`` are the same as they go without one.
    """
    ways = _Ways.of(found, robots)
    if ways is None:
        return "the paths are too long to be followed"
    if reason := ways.astray(found, robots) or ways.blocked(found, robots):
        return reason
    for one, other, way, begin in zip(robots, alone, ways.way, ways.begin, strict=True):
        free = length_of(other.path) - begin
        if free > found.size and way < SHARE * free:
            return f"in one, {one.name} would go {max(way, 0.0):.2f} m of its way of {free:.2f} m"
    gap, i, j = least_stop_gap(found.reference, robots, found.size)
    if gap <= 0.0 < least_stop_gap(found.reference, alone, found.size, False)[0]:
        return f"in one, {robots[i].name} and {robots[j].name} would stop in one place"
    error = float(np.abs(ways.gain.mean() - ways.gain).max())
    if error > MOST_OFF * length_of(found.reference):
        return f"at their stops the formation error would be {error:.2f} m"
    return ""


def lost(found: Fit, robots: list[Placed]) -> str:
    """Which of the robots of a group in lanes loses a part of the reference path; or empty."""
    leaves = Shared(lambda line: leaves_out(found.reference, line, found.size))
    for one in robots:
        if leaves(one.path):
            return (
                f"{one.name} would leave out a part of the path, which comes back beside itself: "
                f"its lane is {length_of(one.path):.2f} m long instead of "
                f"{length_of(found.reference):.2f} m"
            )
    return ""


def neighbour_range(found: Fit, robots: list[Placed]) -> float:
    """Range [m] of formation neighbours: the usual one, or that which connects all at the start."""
    usual = RANGE * found.size
    if len(robots) < 2:
        return usual
    station = shapely.LineString(found.reference).project(
        shapely.points([robot.pose[:2] for robot in robots])
    )
    gap = float(np.diff(np.sort(station)).max())
    return usual if gap < usual else MARGIN * gap


@dataclass(frozen=True)
class _Ways:
    """Where each of N robots begins on its path, how far it goes on it to its stop, how far it
    comes along the reference path then, and how far back on that at most; (N,) [m] each."""

    begin: FloatArray
    way: FloatArray
    gain: FloatArray
    back: FloatArray

    @classmethod
    def of(cls, found: Fit, robots: list[Placed]) -> _Ways | None:
        """Those of a formation; None where they are too long to be followed."""
        lines, poses = [one.path for one in robots], np.array([one.pose for one in robots])
        stops = stop_stations(found.reference, lines, [one.pose for one in robots])
        radius = np.array([circumscribed_radius(own_outline(one)) for one in robots])
        there = measured(lines, found.reference, poses, radius, stops)
        if there is None:
            return None
        start = [station_of(found.reference, point) for point in poses[:, :2]]
        begin = [station_of(*one) for one in zip(lines, poses[:, :2], strict=True)]
        return cls(np.array(begin), stops - begin, there[0] - start, there[1])

    def astray(self, found: Fit, robots: list[Placed]) -> str:
        """Which robot comes back along the reference path, or hardly or too far along it."""
        least, most = ALONG
        for one, way, gain, back in zip(robots, self.way, self.gain, self.back, strict=True):
            if way > found.size and not least * way < gain < most * way:
                where = "back" if gain < -TOLD else "forward"
                said = f"on its way of {way:.2f} m, {one.name} comes {abs(gain):.2f} m {where}"
                return f"{said} along the reference path"
            if back > BACK * found.size:
                return f"{one.name} comes back along the reference path by {back:.2f} m on its way"
        return ""

    def blocked(self, found: Fit, robots: list[Placed]) -> str:
        """Which robot is to stop on the way of another that comes there later, and would wait.

        As where two paths meet, and who is there first was the farther from there along the
        reference path.
        """
        lines, stops = [one.path for one in robots], self.begin + self.way
        there = [
            shape_at(one.footprint, pose_at(one.path, stop, found.size))
            for one, stop in zip(robots, stops, strict=True)
        ]
        reach = np.array([sides(own_outline(one)) for one in robots])
        start = np.array([one.pose[:2] for one in robots])
        alike = np.ones(len(robots))
        blocked = blocked_ways(lines, start, self.begin, stops, alike, reach, there)
        if not blocked:
            return ""
        late, others = next(iter(blocked.items()))
        first = robots[others[0]].name
        return f"{first} would stop in the way of {robots[late].name}, which comes there later"
