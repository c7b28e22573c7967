"""The formation: whether the robots, each at its wanted place, stand apart, and can get there."""

from __future__ import annotations

from math import hypot
from typing import Any

import numpy as np
import shapely

from physim.checking.sketch import Sketch
from physim.checking.telling import MOST_ALIKE, Told
from physim.errors import Location
from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray
from physim.tolerances import CONTACT
from physim.world.faults import shown

PLACES = 12
"""Stations of the reference path at which the whole formation is laid out."""


def check_formation(
    sketch: Sketch,
    paths: dict[int, FloatArray],
    outlines: dict[int, FloatArray],
    told: Told,
) -> None:
    """Spacing longer than the footprints, and a reference path longer than the formation."""
    reference = sketch.reference
    numbers = [robot.number for robot in sketch.robots]
    if reference is None or not numbers:
        return
    line = shapely.LineString(reference)
    stations = _start_stations(sketch, line)
    leads = sketch.leads
    if not sketch.has_formation:
        leads = np.zeros(len(numbers))
    elif leads is None:
        if stations is None or not sketch.is_spacing_initial:
            return
        leads = stations - stations[0]
    if sketch.has_formation:
        _check_spacing(sketch, line, leads, paths, outlines, told)
    if stations is not None:
        _check_length(sketch, line, stations, leads, paths, outlines, told)


def _start_stations(sketch: Sketch, line: shapely.LineString) -> FloatArray | None:
    """(N,) [m] stations at the start along the reference path; None unless all are known."""
    places = [robot.position for robot in sketch.robots]
    if any(place is None for place in places):
        return None
    return np.asarray(line.project(shapely.points(np.array(places))))


def _check_spacing(
    sketch: Sketch,
    line: shapely.LineString,
    leads: FloatArray,
    paths: dict[int, FloatArray],
    outlines: dict[int, FloatArray],
    told: Told,
) -> None:
    """Lay the formation out along the reference path and see which footprints meet."""
    shared = [robot.number for robot in sketch.robots if robot.number in paths]
    shared = [number for number in shared if number in outlines]
    if len(shared) < 2 or len(shared) > 1000:
        return
    room = line.length - (leads.max() - leads.min())
    if room <= 0.0:
        return  # told as a reference path that is too short
    met: dict[tuple[int, int], int] = {}
    bases = np.linspace(-leads.min(), -leads.min() + room, PLACES)
    laid_out = np.array(
        [_laid_out(line, bases + leads[n], paths[n], outlines[n]) for n in shared], dtype=object
    )
    for shapes in laid_out.T:
        tree = shapely.STRtree(shapes)
        for i, j in np.transpose(tree.query(shapes, predicate="dwithin", distance=CONTACT)):
            if i < j:
                pair = (shared[i], shared[j])
                met[pair] = met.get(pair, 0) + 1
    where: Location = ("formation", "spacing") if sketch.leads is not None else ("formation",)
    everywhere = sorted(pair for pair, count in met.items() if count == PLACES)
    for i, j in everywhere[:MOST_ALIKE]:
        told.error(
            where if sketch.leads is None else (*where, j),
            f"{abs(leads[j] - leads[i]):.4g} m between {_name(sketch, i)} and {_name(sketch, j)} "
            "along the reference path is less than their footprints need on their paths: they "
            f"would overlap in formation; {_remedy(sketch, i, j)}",
        )
    somewhere = sorted(pair for pair, count in met.items() if count < PLACES)
    for i, j in somewhere[:MOST_ALIKE]:
        told.warn(
            where,
            f"in formation {_name(sketch, i)} and {_name(sketch, j)} would overlap at "
            f"{met[i, j]} of {PLACES} places along the reference path, where their paths come "
            "close; space them further apart there",
        )


def _remedy(sketch: Sketch, i: int, j: int) -> str:
    """What parts two robots that would overlap in formation: depends on where spacing is from."""
    if sketch.leads is not None:
        return "space them further apart, or part their paths"
    if any(sketch.robots[k].drawn is not None for k in (i, j)):
        return (
            "spacing is initial, and the seed places them so close along the road; try another "
            "seed, a larger min_gap or another abreast in start, or list the leads in "
            "formation.spacing"
        )
    return (
        "spacing is initial, so they start so close along the road; move their poses apart, or "
        "list the leads in formation.spacing, or part their paths"
    )


def _laid_out(
    line: shapely.LineString, stations: FloatArray, path: FloatArray, outline: FloatArray
) -> Any:
    """Footprints (K,) on the robot's own path, beside stations (K,) of the reference path."""
    own = shapely.LineString(path)
    along = own.project(line.interpolate(stations))
    places = shapely.get_coordinates(own.interpolate(along))
    way = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))))
    k = np.clip(np.searchsorted(way, along, side="right") - 1, 0, len(path) - 2)
    c, s = (np.diff(path, axis=0)[k] / np.diff(way)[k][:, None]).T
    x, y = outline.T
    turned = np.stack([np.outer(c, x) - np.outer(s, y), np.outer(s, x) + np.outer(c, y)], axis=2)
    return shapely.polygons(turned + places[:, None])


def _check_length(
    sketch: Sketch,
    line: shapely.LineString,
    stations: FloatArray,
    leads: FloatArray,
    paths: dict[int, FloatArray],
    outlines: dict[int, FloatArray],
    told: Told,
) -> None:
    """Refuse a reference path that is shorter than the formation; warn of robots with no way."""
    extent = float(leads.max() - leads.min())
    if extent > line.length:
        told.error(
            sketch.reference_key,
            f"the reference path is {line.length:.4g} m long and the formation {extent:.4g} m; "
            "make it longer than the formation",
        )
        return
    where: Location
    for robot in sketch.robots:
        k = robot.number
        if k not in paths or robot.position is None:
            continue
        where = ("robots", k, "pose")
        own = shapely.LineString(paths[k])
        stop = max(own.length - float(leads.max() - leads[k]), 0.0)
        begin = float(own.project(shapely.Point(robot.position)))
        if begin >= stop:
            told.warn(
                where,
                f"{shown(robot.name)} starts at station {begin:.2f} m of its path, at or past its "
                f"stop station, {stop:.2f} m: it has arrived before it moves",
            )
        elif (
            sketch.has_formation
            and stations[k] <= 0.0
            and _is_before(
                line, robot.position, circumscribed_radius(outlines[k]) if k in outlines else 0.0
            )
        ):
            told.warn(
                where,
                f"{shown(robot.name)} starts before the reference path begins, where the "
                "formation cannot measure its distance; prolong the reference path backwards",
            )
        _check_duration(sketch, k, stop - begin, told)


def _check_duration(sketch: Sketch, k: int, way: float, told: Told) -> None:
    """Warn once where the run is too short to arrive although it is expected to."""
    if not sketch.is_finish_expected or sketch.duration is None:
        return
    own = sketch.robots[k].v
    speed = sketch.speed if own is None else min(own, sketch.speed)
    needed = way / speed
    message = "the run is too short to finish: "
    if needed > sketch.duration and not any(message in f.message for f in told.warnings):
        told.warn(
            ("time", "duration"),
            f"{message}{_name(sketch, k)} has {way:.4g} m to go, {needed:.4g} s at "
            f"{speed:.4g} m/s, and the run lasts {sketch.duration:.6g} s; "
            "make it longer, or take expect.finished away",
        )


def _is_before(line: shapely.LineString, position: tuple[float, float], reach: float) -> bool:
    """Whether a place lies behind the first point of a path, by more than a robot's reach [m]."""
    (ax, ay), (bx, by) = shapely.get_coordinates(line)[:2]
    along = (position[0] - ax) * (bx - ax) + (position[1] - ay) * (by - ay)
    return bool(along / hypot(bx - ax, by - ay) < -reach - CONTACT)


def _name(sketch: Sketch, number: int) -> str:
    return shown(sketch.robots[number].name)
