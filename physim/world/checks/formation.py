"""The formation along the paths: long enough for it, apart in it, connected, and soon enough there.

The error sum of (7) is taken over a robot's neighbours. Where no chain of neighbours connects two
parts of the formation, neither keeps its distance to the other, whatever the gain.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

import numpy as np
import shapely
from numpy.typing import ArrayLike
from shapely.affinity import translate

from physim.errors import Fault, Location, place_text
from physim.geometry.arc_length import Polyline
from physim.geometry.outline import placed_outline
from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray, IntArray
from physim.tolerances import CONTACT
from physim.world.checks.findings import MOST_ALIKE
from physim.world.checks.stations import leads, lines_of, spans, stations_on
from physim.world.faults import describe
from physim.world.scene import Layout


def check_length(laid: Layout) -> Iterator[Fault]:
    """Refuse a reference path shorter than the formation."""
    length, lead = shapely.LineString(laid.reference).length, leads(laid)
    if (extent := float(np.ptp(lead))) > length:
        yield Fault(
            laid.reference_key,
            f"the reference path is {length:.4g} m long and the formation {extent:.4g} m; make it "
            "longer than the formation",
        )


def check_ends(laid: Layout) -> Iterator[Fault]:
    """Robots that start at or past their stops, and those whose way leaves the reference path.

    Before it begins and beyond its end a formation cannot measure its distances.
    """
    reference, points = shapely.LineString(laid.reference), laid.reference
    if float(np.ptp(leads(laid))) > reference.length:
        return
    at, is_told = stations_on(reference, laid), laid.world.formation is None
    for i, (line, (begin, stop)) in enumerate(zip(lines_of(laid), spans(laid), strict=True)):
        where: Location = (*laid.entry_key(i), "pose")
        name, reach = describe(laid.names[i]), circumscribed_radius(laid.footprints[i])
        end = line.interpolate(stop)
        if begin >= stop:
            yield Fault(
                where,
                f"{name} starts at station {begin:.2f} m of its path, at or past its stop station, "
                f"{stop:.2f} m: it has arrived before it moves",
                "warning",
            )
        elif (
            laid.world.formation is not None
            and at[i] <= 0.0
            and _is_past(points[1], points[0], laid.start[i, :2], reach)
        ):
            yield Fault(
                where,
                f"{name} starts before the reference path begins, where the formation cannot "
                "measure its distance; extend the reference path backwards",
                "warning",
            )
        is_end = not is_told and reference.project(end) >= reference.length
        if is_end and _is_past(points[-2], points[-1], end.coords[0], reach):
            is_told = True
            yield Fault(
                laid.path_key(i),
                f"{name} stops {reference.distance(end):.4g} m beyond the end of the reference "
                "path, where the formation cannot measure its distance; extend the reference path",
                "warning",
            )


def _is_past(inner: FloatArray, end: FloatArray, place: ArrayLike, reach: float) -> bool:
    """Whether a place lies past the end of a line, next to ``inner``, by more than a reach [m]."""
    along = np.subtract(place, end) @ np.subtract(end, inner)
    return bool(along / np.hypot(*np.subtract(end, inner)) > reach + CONTACT)


def check_stops(laid: Layout) -> Iterator[Fault]:
    """Robots whose outlines overlap where they stop: the second finds its stop taken."""
    expect = laid.world.expect
    if expect is not None and expect.finished is False:
        return
    ways = {id(path): Polyline(path) for path in laid.paths}
    stops, shapes, told = [], [], 0
    for path, footprint, (_, stop) in zip(laid.paths, laid.footprints, spans(laid), strict=True):
        (x, y), (tx, ty) = ways[id(path)].at(stop)
        stops.append((x, y))
        shapes.append(placed_outline(footprint, (x, y, np.arctan2(ty, tx))))
    tree = shapely.STRtree(shapes)
    for i, shape in enumerate(shapes):
        near = np.sort(tree.query(shape, predicate="intersects"))
        common = (int(j) for j in near[near < i] if shape.intersection(shapes[j]).area > CONTACT)
        if (j := next(common, None)) is None:
            continue
        if told == MOST_ALIKE:
            return
        told += 1
        yield Fault(
            laid.path_key(i),
            f"{describe(laid.names[i])} stops where {describe(laid.names[j])} does, at "
            f"{place_text(*stops[i])}; let one path end elsewhere, or give them a formation",
            "warning",
        )


def check_duration(laid: Layout) -> Iterator[Fault]:
    """A run that ends before its robots can be there at their fastest, but is to finish."""
    expect, duration = laid.world.expect, laid.world.time.duration
    if expect is None or not expect.finished:
        return
    way = np.subtract(*spans(laid).T[::-1])
    needed = way / [robot.limits.v for robot in laid.robots]
    i = int(np.argmax(needed))
    if needed[i] > duration:
        yield Fault(
            ("time", "duration"),
            f"the run is too short to finish: {describe(laid.names[i])} has {way[i]:.4g} m to go, "
            f"{needed[i]:.4g} s at its limit, and the run lasts {duration:.6g} s; make it longer, "
            "or remove expect.finished",
            "warning",
        )


def check_spacing(laid: Layout) -> Iterator[Fault]:
    """Refuse robots that would overlap in formation on the path that they share."""
    plan = laid.world.formation
    if plan is None:
        return
    lead = leads(laid)
    is_listed = plan.spacing != "initial"
    where: Location = ("formation", "spacing") if is_listed else ("formation",)
    remedy = (
        "space them further apart, or separate their paths"
        if is_listed
        else "spacing is initial, so they start this close along it: start them farther apart, or "
        "list the leads in formation.spacing"
    )
    together: dict[int, list[int]] = {}
    for i in range(len(laid.names)):
        together.setdefault(id(laid.paths[i]), []).append(i)
    for robots in together.values():
        shapes = [translate(shapely.Polygon(laid.footprints[i]), lead[i]) for i in robots]
        pairs = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=CONTACT)
        met = sorted((robots[a], robots[b]) for a, b in pairs.T.tolist() if a < b)
        for i, j in islice(met, MOST_ALIKE):
            yield Fault(
                (*where, j) if is_listed else where,
                f"{abs(lead[j] - lead[i]):.4g} m between {describe(laid.names[i])} and "
                f"{describe(laid.names[j])} along the path that they share is less than their "
                f"footprints need: they would overlap in formation; {remedy}",
            )


def check_slow(laid: Layout) -> Iterator[Fault]:
    """Robots slower than the least speed that (7) gives the others."""
    plan = laid.world.formation
    if plan is None or len(laid.names) < 2:
        return
    low = plan.limits[0]
    slow = [i for i, robot in enumerate(laid.robots) if robot.limits.v < low]
    for i in slow[:MOST_ALIKE]:
        yield Fault(
            (*laid.entry_key(i), "limits", "v"),
            f"{describe(laid.names[i])} drives at most {laid.robots[i].limits.v:.6g} m/s and "
            f"cannot keep up: by formation.limits the others drive at least {low:.6g} m/s; raise "
            "this limit, or lower the least speed of the formation",
            "warning",
        )


def check_neighbours(laid: Layout) -> Iterator[Fault]:
    """A formation whose parts are not connected by neighbours, at the start or in formation."""
    plan, count = laid.world.formation, len(laid.names)
    if plan is None or not plan.gain or count < 2 or plan.neighbours == "all":
        return
    from scipy.sparse import coo_array  # half of what a check imports, and seldom needed
    from scipy.sparse.csgraph import connected_components

    moments: list[tuple[str, IntArray]] = []
    if plan.neighbours == "range":
        start = stations_on(shapely.LineString(laid.reference), laid)
        for when, at in (("in formation ", leads(laid)), ("at the start ", start)):
            order = np.argsort(at, kind="stable")
            near = np.diff(at[order]) <= plan.range
            moments.append((when, np.stack([order[:-1][near], order[1:][near]], axis=1)))
    else:
        index = {name: i for i, name in enumerate(laid.names)}
        listed = [[index[a], index[b]] for a, b in plan.neighbours]
        moments.append(("", np.array(listed, dtype=np.int64).reshape(-1, 2)))
    for when, pairs in moments:
        graph = coo_array((np.ones(len(pairs)), pairs.T), shape=(count, count))
        parts, part = connected_components(graph, directed=False)
        if parts > 1:
            left = np.flatnonzero(part != np.argmax(np.bincount(part))).tolist()
            names = ", ".join(describe(laid.names[i]) for i in left[:MOST_ALIKE])
            more = f" and {len(left) - MOST_ALIKE} more" if len(left) > MOST_ALIKE else ""
            by = f"range of {plan.range:.4g} m" if when else "pair"
            yield Fault(
                ("formation", "range" if when else "neighbours"),
                f"{when}no {by} connects {names}{more} with the other robots: by (7) neither side "
                "keeps its distance to the other, whatever the gain; use a longer range, or list "
                "pairs that lead from each robot to every other",
                "warning",
            )
            return
