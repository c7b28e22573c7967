"""The formation along the paths: long enough for it, apart in it, and connected.

The error sum of (7) is taken over a robot's neighbours. Where no chain of neighbours connects two
parts of the formation, neither keeps its distance to the other, whatever the gain.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import islice

import numpy as np
import shapely
from numpy.typing import ArrayLike
from shapely.affinity import translate

from physim.errors import Fault, place_text
from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray
from physim.tolerances import CONTACT
from physim.units import figure
from physim.world.checks.findings import MOST_ALIKE
from physim.world.checks.stations import leads, lines_of, spans, stations_on
from physim.world.faults import describe
from physim.world.ground.lines import placed_outline
from physim.world.ground.polyline import Polyline
from physim.world.layout.robots import shared
from physim.world.scene import Layout


def check_length(laid: Layout) -> Iterator[Fault]:
    """Refuse a reference path shorter than the formation."""
    length, lead = shapely.LineString(laid.reference).length, leads(laid)
    if (extent := float(np.ptp(lead))) > length:
        yield Fault(
            laid.reference_key,
            f"the reference path is {figure(length)} m long and the formation {figure(extent)} m; "
            "make it longer than the formation",
        )


def check_ends(laid: Layout) -> Iterator[Fault]:
    """Robots that start at or past their stops, and those whose way leaves the reference path.

    Before it begins and beyond its end a formation cannot measure its distances.
    """
    reference, points = shapely.LineString(laid.reference), laid.reference
    if float(np.ptp(leads(laid))) > reference.length:
        return
    is_measured = laid.world.formation is not None
    is_told, at = not is_measured, stations_on(reference, laid)
    for i, (line, (begin, stop)) in enumerate(zip(lines_of(laid), spans(laid), strict=True)):
        name, reach = describe(laid.names[i]), circumscribed_radius(laid.footprints[i])
        said, end = "", line.interpolate(stop)
        if begin >= stop:
            said = (
                f"starts at station {begin:.2f} m of its path, at or past its stop station, "
                f"{stop:.2f} m: it has arrived before it moves"
            )
        elif is_measured and at[i] <= 0.0 and _is_past(points[1::-1], laid.start[i, :2], reach):
            said = (
                "starts before the reference path begins, where the formation cannot measure its "
                "distance; extend the reference path backwards"
            )
        if said:
            yield Fault((*laid.entry_key(i), "pose"), f"{name} {said}", "warning")
        is_end = not is_told and reference.project(end) >= reference.length
        if is_end and _is_past(points[-2:], end.coords[0], reach):
            is_told = True
            yield Fault(
                laid.path_key(i),
                f"{name} stops {figure(reference.distance(end))} m beyond the end of the reference "
                "path, where the formation cannot measure its distance; extend the reference path",
                "warning",
            )


def _is_past(leg: FloatArray, place: ArrayLike, reach: float) -> bool:
    """Whether a place lies past the end of the last leg (2, 2) of a line by more than a reach."""
    along = leg[1] - leg[0]
    return bool((place - leg[1]) @ along / np.hypot(*along) > reach + CONTACT)


def check_stops(laid: Layout) -> Iterator[Fault]:
    """Robots whose outlines overlap where they stop: the second finds its stop taken."""
    expect = laid.world.expect
    if expect is not None and expect.finished is False:
        return
    ways = shared(Polyline, laid.paths)
    ends = [way.at(stop) for way, (_, stop) in zip(ways, spans(laid), strict=True)]
    shapes = [
        placed_outline(footprint, (*place, np.arctan2(*along[::-1])))
        for footprint, (place, along) in zip(laid.footprints, ends, strict=True)
    ]
    pairs = shapely.STRtree(shapes).query(shapes, predicate="intersects").T.tolist()
    met: dict[int, int] = {}
    for i, j in sorted(pair for pair in pairs if pair[1] < pair[0]):
        if i not in met and shapes[i].intersection(shapes[j]).area > CONTACT:
            met[i] = j
            if len(met) == MOST_ALIKE:
                break
    for i, j in met.items():
        yield Fault(
            laid.path_key(i),
            f"{describe(laid.names[i])} stops where {describe(laid.names[j])} does, at "
            f"{place_text(*ends[i][0])}; let one path end elsewhere"
            + (", or give them a formation" if laid.world.formation is None else ""),
            "warning",
        )


def check_spacing(laid: Layout) -> Iterator[Fault]:
    """Refuse robots that would overlap in formation on the path that they share."""
    plan = laid.world.formation
    if plan is None:
        return
    lead, is_listed = leads(laid), plan.spacing != "initial"
    remedy = (
        "list the leads in formation.spacing (as [0, -3, …]), or start them where they are farther "
        "apart along the reference path"
    )
    if is_listed:
        remedy = "space them farther apart, or separate their paths"
    together: dict[int, list[int]] = {}
    for i, path in enumerate(laid.paths):
        together.setdefault(id(path), []).append(i)
    for robots in together.values():
        shapes = [translate(shapely.Polygon(laid.footprints[i]), lead[i]) for i in robots]
        pairs = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=CONTACT)
        met = sorted((robots[a], robots[b]) for a, b in pairs.T.tolist() if a < b)
        for i, j in islice(met, MOST_ALIKE):
            yield Fault(
                ("formation", "spacing", j) if is_listed else ("formation",),
                f"{describe(laid.names[i])} and {describe(laid.names[j])}, which share a path, are "
                f"{figure(abs(lead[j] - lead[i]))} m apart in formation, along the reference path: "
                f"their footprints overlap; {remedy}",
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
    where, moments = ("formation", "neighbours"), []
    if plan.neighbours == "range":
        where = ("formation", "range")
        start = stations_on(shapely.LineString(laid.reference), laid)
        for when, at in (("in formation ", leads(laid)), ("at the start ", start)):
            order = np.argsort(at, kind="stable")
            near = np.diff(at[order]) <= plan.range
            linked = np.stack([order[:-1][near], order[1:][near]], axis=1).tolist()
            moments.append((when, f"range of {plan.range:.4g} m", linked))
    else:
        index = {name: i for i, name in enumerate(laid.names)}
        moments.append(("", "pair", [(index[a], index[b]) for a, b in plan.neighbours]))
    for when, by, pairs in moments:
        part = np.array(_parts(count, pairs))
        left = np.flatnonzero(part != np.argmax(np.bincount(part))).tolist()
        if left:
            names = ", ".join(describe(laid.names[i]) for i in left[:MOST_ALIKE])
            more = f" and {len(left) - MOST_ALIKE} more" if len(left) > MOST_ALIKE else ""
            yield Fault(
                where,
                f"{when}no {by} connects {names}{more} with the other robots: by (7) neither side "
                "keeps its distance to the other, whatever the gain; use a longer range, or list "
                "pairs that lead from each robot to every other",
                "warning",
            )
            return


def _parts(count: int, pairs: Iterable[Sequence[int]]) -> list[int]:
    """Of each robot a number that those connected with it by pairs have, too."""
    above = list(range(count))

    def top(i: int) -> int:
        while above[i] != i:
            above[i] = i = above[above[i]]
        return i

    for a, b in pairs:
        above[top(a)] = top(b)
    return [top(i) for i in range(count)]
