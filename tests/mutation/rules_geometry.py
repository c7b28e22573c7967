"""Rules of geometry, broken: arcs, distances, collision times (11) and their guarantee, paths."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tests.helpers import inside
from tests.mutation.rules import called, found, given, instead, rule

COLLISION = "physim.geometry.collision:"
MOTION = "physim.geometry.motion:"
PATH = "physim.geometry.path:"


@rule("geometry")
def arc_is_its_tangent() -> None:
    """(1) moves along the heading at the start."""
    instead(
        MOTION + "arc",
        lambda a: (
            a.x + a.v * a.t * math.cos(a.heading),
            a.y + a.v * a.t * math.sin(a.heading),
            a.heading + a.omega * a.t,
        ),
    )


@rule("geometry")
def chord_is_as_long_as_its_arc() -> None:
    """(1) has the direction of the chord and the length of the arc."""
    instead(MOTION + "chord_factor", lambda a: 1.0)


@rule("geometry")
def headings_are_wrapped() -> None:
    """A heading lies within half a turn of the x axis."""
    found(MOTION + "arc", lambda value, a: (*value[:2], math.remainder(value[2], 2.0 * math.pi)))


@rule("geometry")
def course_turns_with_its_velocity_alone() -> None:
    """A body on an arc keeps its heading while it goes round."""
    found(MOTION + "facing_course", lambda course, a: course._replace(spin=0.0))


@rule("geometry")
def depth_is_nought() -> None:
    """Overlap has no depth: the distance is unsigned."""
    found("physim.geometry.convex:part_gap", lambda gap, a: max(gap, 0.0))


@rule("geometry")
def depth_is_not_the_shortest_way_out() -> None:
    """The depth of an overlap goes by how the middles lie, and may be more than the least."""

    def deeper(gap: float, a: Any) -> float:
        if gap >= 0.0:
            return gap
        f, (V, *p), (W, *q) = a.f, a.P, a.Q
        turn = np.array([[f.c, -f.s], [f.s, f.c]])
        between = ((W[slice(*q)] - (f.rx, f.ry)) @ turn.T + (f.tx, f.ty)).mean(axis=0)
        between -= V[slice(*p)].mean(axis=0)
        size = math.hypot(*between)
        return gap if size == 0.0 else gap * (1.0 + abs(between[1]) / size)

    found("physim.geometry.convex:part_gap", deeper)


@rule("geometry")
def only_the_first_part_counts() -> None:
    """A nonconvex body is its first convex part."""
    Part, part_gap = inside("physim.geometry", "Part", "part_gap")

    def first(shapes: Any, body: int) -> Any:
        part = shapes.body_start[body]
        return Part(shapes.vertices, shapes.part_start[part], shapes.part_start[part + 1])

    instead(
        "physim.geometry.bodies:body_gap",
        lambda a: part_gap(first(a.shapes_a, a.i), first(a.shapes_b, a.j), a.f, math.inf),
    )


@rule("geometry")
def footprint_is_its_hull() -> None:
    """A nonconvex outline is filled in."""
    from shapely import MultiPoint

    def hull(a: Any) -> Any:
        return [np.array(MultiPoint(a.polygon).convex_hull.exterior.coords)[:0:-1]]

    instead("physim.geometry.polygon:convex_parts", hull)


@rule("geometry")
def clearance_to_the_nearest_middle() -> None:
    """The nearest robot is the one whose reference point is nearest."""

    def nearest(old: Any, a: Any) -> Any:
        answer = old()
        place = a.frame[: a.discs.robots, :2]
        apart = np.hypot(*(place[:, None] - place).transpose(2, 0, 1))
        np.fill_diagonal(apart, np.inf)
        if len(place) > 1:
            a.other[:] = apart.argmin(axis=1)
        return answer

    called("physim.geometry.neighbours:nearest_others", nearest)


# Collision time


@rule("geometry")
def collision_time_is_late() -> None:
    """A collision time may be a little later than the first touch."""
    found(COLLISION + "bodies_time", lambda xi, a: xi + 1e-5 if xi > 0.0 else xi)


@rule("geometry")
def collision_time_is_early() -> None:
    """At a collision time the shapes need not touch yet."""
    found(COLLISION + "bodies_time", lambda xi, a: 0.9999 * xi)


@rule("geometry")
def overlap_is_no_collision() -> None:
    """Bodies that overlap at the start have no collision time."""
    found(COLLISION + "bodies_time", lambda xi, a: math.inf if xi == 0.0 else xi)


@rule("geometry")
def headings_are_kept_in_11() -> None:
    """A collision time takes both bodies as not turning."""
    given(
        COLLISION + "collision_time_pair",
        twist_i=lambda a: np.array((a.twist_i[0], 0.0, 0.0)),
        twist_j=lambda a: np.array((a.twist_j[0], 0.0, 0.0)),
    )  # fmt: skip


@rule("geometry")
def walls_are_not_foreseen() -> None:
    """A robot meets no wall that it does not touch."""
    found("physim.geometry.walls:seen_time", lambda xi, a: xi if xi == 0.0 else math.inf)


@rule("geometry")
def swept_check_looks_at_the_middle() -> None:
    """A contact between two samples is one only where the middle of the step touches."""
    body_distance = inside("physim.geometry", "body_distance")

    def middle(a: Any) -> float:
        one, other = 0.5 * (a.start_i + a.end_i), 0.5 * (a.start_j + a.end_j)
        gap = body_distance(a.shapes_a, a.i, one, a.shapes_b, a.j, other)
        return 0.5 * a.dt if gap <= 1e-9 else math.inf

    instead("physim.geometry.swept:swept_time", middle)


# Paths and areas


@rule("geometry")
def projection_jumps() -> None:
    """The projection is the nearest point of all the path, also where it passes near itself."""
    given(PATH + "track", window=lambda a: 1e9)


@rule("world")
def walls_within_the_area_have_no_danger_area() -> None:
    """Only the edge of the accessible area has one, not a wall that stands in it."""
    from shapely import MultiLineString

    instead("physim.world.ground.area:inner_lines", lambda a: MultiLineString())


@rule("world")
def corridor_corners_are_not_mitred() -> None:
    """A wall is the middle line's points moved square to one leg: it is narrower in bends."""
    instead(
        "physim.world.ground.corridor:offset_polyline",
        lambda a: (
            a.points
            + np.asarray(a.offset)[:, None]
            * (lambda leg: np.stack((-leg[:, 1], leg[:, 0]), 1) / np.hypot(*leg.T)[:, None])(
                np.diff(a.points, axis=0, append=2.0 * a.points[-1:] - a.points[-2:-1])
            )
        ),
    )
