"""What pictures show of the place of a run: bodies, walls, paths, areas, names, colours.

One frozen value, had alike from a world that is laid out, a scene and a record, so that preview,
plots and video draw the same things in the same colours (`physim.drawing.palette`). It holds no
kernels and no simulation, and nothing that changes in a run: where robots go is in the record.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import shapely

from physim.drawing.palette import UNDECIDED, Colour, rgb, robot_colour
from physim.errors import PhysimError
from physim.geometry.polygon import convex_parts
from physim.geometry.shapes import FloatArray, Polylines, Shapes, body_parts
from physim.geometry.timed_paths import timed_paths, timed_poses
from physim.parts.declarations import NO_NUMBER, Mode
from physim.world.ground.area import united
from physim.world.group import robot_count
from physim.world.scene import Body

if TYPE_CHECKING:
    from physim.record import Record
    from physim.world import Mover, World
    from physim.world.scene import Layout

SEAM = 1e-6
"""[m] Parts of a body closer than this are one: their shared edges agree only to rounding."""
HAIR = 1e-6
"""Share of L by which a path may miss the safe area and still count as in it: paths that run along
its very edge."""
LOOK = 0.05
"""[rad] between two places of the way of a mover that turns"""
FAR = 0.2
"""Distance of the reference point from the centroid, over the reach, from which it is shown."""
BESIDE, ROLL = 0.72, 0.17
"""Front wheels: how far from the middle, over half the width of the robot; half their length, over
the wheelbase"""


@dataclass(frozen=True, eq=False)
class Shape:
    """A robot's footprint made ready to draw, robot's frame [m]."""

    rings: tuple[FloatArray, ...]
    """outline and holes of the union of its parts"""
    mark: FloatArray
    """(3, 2) heading mark, a triangle pointing along x at the widest place of the footprint"""
    eccentric: bool
    """whether the reference point is far from the centroid, so that it must be shown"""


@dataclass(frozen=True, eq=False)
class SceneModel:
    """N robots, what moves beside them, and what does not; lengths [m], angles [rad], world frame
    unless said."""

    name: str
    seed: int
    bodies: tuple[Body, ...]
    """robots by index, movers, obstacles that can be pushed, then boundaries, then obstacles"""
    footprints: tuple[tuple[FloatArray, ...], ...]
    """convex parts (n, 2) of each robot, in its frame"""
    start: FloatArray
    """(N, 3) poses at sample 0; NaN in a record without samples"""
    moved: tuple[tuple[FloatArray, ...], ...]
    """convex parts of each mover, and of each obstacle that can be pushed, in its frame"""
    moved_start: FloatArray
    """(M, 3) poses of these M bodies at sample 0, as of ``start``"""
    ways: tuple[tuple[FloatArray, ...], ...]
    """lines (n, 2) of each mover: where its reference point goes; of one that turns at one place
    its outlines at the waypoints"""
    wheelbase: FloatArray
    """(N,) from the reference point to the front axle; 0 of a robot that is no car, and in a record
    that does not tell how wheels were turned"""
    boundaries: tuple[FloatArray, ...]
    """polylines (n, 2)"""
    obstacles: tuple[FloatArray, ...]
    """outlines (n, 2), solid inside"""
    paths: tuple[FloatArray, ...]
    """own path (n, 2) of each robot"""
    reference: FloatArray
    """(n, 2) s*"""
    stop_station: FloatArray
    """(N,) along the own path"""
    accessible: tuple[FloatArray, ...]
    """rings (n, 2), even-odd"""
    safe: tuple[FloatArray, ...]
    """rings of the safe area, even-odd; none where no safe distance is known"""
    safe_distance: float
    """L; 0 where the controller has none"""
    modes: tuple[Mode, ...]
    """as the controller declares them; numbers of modes count in them"""

    @classmethod
    def of_layout(
        cls, layout: Layout, modes: Sequence[Mode] = (), safe_distance: float = 0.0
    ) -> SceneModel:
        """Model of a world before its run; no kernel is called."""
        world, drawn = layout.world, layout.boundaries
        names = [("robot", robot.name) for robot in layout.robots]
        names += [(one.kind, one.name) for one in layout.moved]
        names += [("boundary", name) for name in drawn]
        names += [("obstacle", f"obstacle {k + 1}") for k in layout.standing]
        area = layout.area
        return cls(
            name=world.name,
            seed=world.seed,
            bodies=tuple(Body(k, *one) for k, one in enumerate(names)),
            footprints=tuple(layout.parts),
            start=layout.start,
            moved=tuple(convex_parts(one.outline) for one in layout.moved),
            moved_start=np.array([one.start for one in layout.moved]).reshape(-1, 3),
            ways=tuple(map(_way, world.movers)),
            wheelbase=_wheelbases(world),
            boundaries=tuple(drawn.values()),
            obstacles=tuple(layout.obstacles),
            paths=tuple(layout.paths),
            reference=layout.reference,
            stop_station=_stop_stations(layout),
            accessible=tuple(area.accessible_rings),
            safe=tuple(area.safe_rings(safe_distance)) if safe_distance > 0.0 else (),
            safe_distance=safe_distance,
            modes=tuple(modes),
        )

    @classmethod
    def of_record(cls, record: Record) -> SceneModel:
        """Model of the scene in a record."""
        nowhere = np.full((record.moving, 3), np.nan)
        start = record.moving_pose[0] if record.samples else nowhere
        beside = range(record.robots, record.moving)
        movers: tuple[Mover, ...] = ()
        wheelbase, steers = np.zeros(record.robots), record.holds("/steps/steering")
        is_mover = (record.bodies[body].kind == "mover" for body in beside)
        # where a log has movers the world does not know
        if record.judged is None and (steers or any(is_mover)):
            with suppress(PhysimError):  # the world inside is faulty: it shows none
                movers = record.world.movers
                wheelbase = _wheelbases(record.world) if steers else wheelbase
        return cls(
            name=record.name,
            seed=record.seed,
            bodies=record.bodies,
            footprints=record.footprints,
            start=start[: record.robots],
            moved=tuple(tuple(body_parts(record.shapes, body)) for body in beside),
            moved_start=start[record.robots :],
            ways=tuple(map(_way, movers)),
            wheelbase=wheelbase,
            **_walls(record.bodies[record.moving :], record.walls),
            paths=_lines(record.paths),
            reference=_lines(record.reference)[0],
            stop_station=record.stop_station,
            accessible=tuple(record.accessible),
            safe=tuple(record.safe) if record.safe_distance > 0.0 else (),
            safe_distance=record.safe_distance,
            modes=record.modes,
        )

    @property
    def robots(self) -> int:
        """Number of robots N."""
        return len(self.footprints)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the N robots."""
        return tuple(body.name for body in self.bodies[: self.robots])

    @property
    def moved_names(self) -> tuple[str, ...]:
        """Names of the M bodies that move beside the robots; movers come first."""
        return tuple(body.name for body in self.bodies[self.robots :][: len(self.moved)])

    @property
    def colours(self) -> tuple[Colour, ...]:
        """Colours of the robots' own lines."""
        return tuple(robot_colour(i) for i in range(self.robots))

    def mode_colour(self, mode: int) -> Colour:
        """Colour of a mode by number, and of a robot that has not decided or gave none."""
        return rgb(self.modes[mode].colour) if mode != NO_NUMBER else UNDECIDED

    @cached_property
    def reach(self) -> FloatArray:
        """(N,) [m] from the reference point of each robot to its farthest corner."""
        return np.array([np.hypot(*np.concatenate(body).T).max() for body in self.footprints])

    @cached_property
    def shapes(self) -> tuple[Shape, ...]:
        """Shape of each robot; robots with equal footprints have the same one."""
        keys = [tuple(part.tobytes() for part in parts) for parts in self.footprints]
        each = {
            key: shape(parts)
            for key, parts in dict(zip(keys, self.footprints, strict=True)).items()
        }
        return tuple(each[key] for key in keys)

    @property
    def outlines(self) -> tuple[FloatArray, ...]:
        """Outline (n, 2) of each robot, in its frame."""
        return tuple(shape.rings[0] for shape in self.shapes)

    @cached_property
    def solid_rings(self) -> tuple[FloatArray, ...]:
        """Rings of all obstacles together, even-odd, without the seams between those that touch."""
        return tuple(rings_of(united([_polygon(corners) for corners in self.obstacles])))

    @cached_property
    def path_pieces(self) -> tuple[tuple[list[FloatArray], list[FloatArray]], ...]:
        """Own path of each robot in lines (n, 2): in the safe area (all if L = 0), and the rest."""
        if self.safe_distance <= 0.0:
            return tuple(([path], []) for path in self.paths)
        nearly = region(self.safe).buffer(HAIR * self.safe_distance)
        each = {path.tobytes(): path for path in self.paths}  # robots may share one
        pieces = {key: split_at(path, nearly) for key, path in each.items()}
        return tuple(pieces[path.tobytes()] for path in self.paths)

    @cached_property
    def wheels(self) -> dict[int, FloatArray]:
        """Middles (2, 2) of the front wheels of each car, in its frame."""
        found = {}
        for car in np.flatnonzero(self.wheelbase).tolist():
            low, high = self.outlines[car][:, 1].min(), self.outlines[car][:, 1].max()
            sides = (low + high + BESIDE * (high - low) * np.array([-1.0, 1.0])) / 2.0
            found[car] = np.column_stack((np.full(2, self.wheelbase[car]), sides))
        return found

    def wheels_at(self, pose: FloatArray, steering: FloatArray) -> dict[int, FloatArray]:
        """Lines (2, 2, 2) of the front wheels of cars at poses (N, 3) and angles (N,) [rad]."""
        found = {}
        for car, middles in self.wheels.items():
            c, s = np.cos(steering[car]), np.sin(steering[car])
            half = ROLL * self.wheelbase[car] * np.array([c, s])
            ends = np.stack((middles - half, middles + half), axis=1)
            found[car] = placed(ends, pose[car])
        return found

    @cached_property
    def moved_shapes(self) -> tuple[Shape, ...]:
        """Shapes of the M bodies that move beside the robots."""
        return tuple(map(shape, self.moved))

    @property
    def moved_keys(self) -> tuple[str, ...]:
        """Names of their colours in `physim.drawing.palette.KEYS`: mover or obstacle."""
        return tuple(one.kind for one in self.bodies[self.robots :][: len(self.moved)])

    @cached_property
    def moved_starting(self) -> tuple[FloatArray, ...]:
        """Their outlines (n, 2) at the start; NaN where it is not known."""
        pairs = zip(self.moved_shapes, self.moved_start, strict=True)
        return tuple(placed(one.rings[0], pose) for one, pose in pairs)

    @property
    def stops(self) -> FloatArray:
        """(N, 2) places of the stop stations."""
        lines = [shapely.LineString(path) for path in self.paths]
        points = shapely.line_interpolate_point(lines, self.stop_station)
        return np.asarray(shapely.get_coordinates(points))

    @cached_property
    def starting(self) -> tuple[FloatArray, ...]:
        """Outlines (n, 2) of the robots at the start; NaN where it is not known."""
        return tuple(map(placed, self.outlines, self.start))

    @property
    def extent(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest x, y of all lines and of the robots at the start."""
        lines = [*self.boundaries, *self.obstacles, *self.paths, self.reference, *self.accessible]
        lines += [line for way in self.ways for line in way]
        points = np.concatenate((*lines, *self.starting, *self.moved_starting))
        return np.nanmin(points, axis=0), np.nanmax(points, axis=0)


def placed(points: FloatArray, pose: FloatArray) -> FloatArray:
    """Points (n, 2) of a body's frame at a pose (3,), in the world's."""
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    return np.asarray(points @ np.array([[cos, sin], [-sin, cos]]) + pose[:2])


def outline(parts: Sequence[FloatArray]) -> FloatArray:
    """Outline (n, 2) of the union of parts, without seams; of pieces apart, the largest."""
    if len(parts) == 1:
        return np.asarray(parts[0], dtype=np.float64)
    return rings_of(largest(union(parts)))[0]


def shape(parts: Sequence[FloatArray]) -> Shape:
    """Prepare a footprint given as convex parts (n, 2)."""
    whole = union(parts)
    body = largest(whole)
    # a disc about as large as any within it, round the centroid where that serves: a long shape
    # has many such discs
    middle, edge = shapely.get_coordinates(shapely.maximum_inscribed_circle(body))
    radius = float(np.hypot(*(edge - middle)))
    room = float(shapely.distance(body.centroid, body.boundary))
    if body.contains(body.centroid) and room > 0.85 * radius:
        middle, radius = shapely.get_coordinates(body.centroid)[0], room
    mark = middle + 0.72 * radius * np.array([[0.95, 0.0], [-0.6, 0.72], [-0.6, -0.72]])
    reach = np.hypot(*np.concatenate(parts).T).max()
    eccentric = float(np.hypot(whole.centroid.x, whole.centroid.y)) > FAR * reach
    return Shape(tuple(rings_of(whole)), mark, eccentric)


def union(parts: Sequence[FloatArray]) -> shapely.Geometry:
    """Union of the convex parts (n, 2) of a body, without seams."""
    polygons = [_polygon(part) for part in parts]
    if len(parts) == 1:
        return polygons[0]
    whole = shapely.union_all([shapely.buffer(p, SEAM, join_style="mitre") for p in polygons])
    return shapely.buffer(whole, -SEAM, join_style="mitre")


def largest(area: shapely.Geometry) -> shapely.Polygon:
    """Largest polygon of an area."""
    polygons = [part for part in shapely.get_parts(area) if part.geom_type == "Polygon"]
    return max(polygons, key=lambda polygon: float(polygon.area))


def rings_of(area: shapely.Geometry) -> list[FloatArray]:
    """Outlines and holes (n, 2) of an area; an outline and its holes go in opposite senses."""
    parts = [part for part in shapely.get_parts(area) if part.geom_type == "Polygon"]
    rings = [ring for part in parts for ring in (part.exterior, *part.interiors)]
    return [shapely.get_coordinates(ring)[:-1] for ring in rings if not ring.is_empty]


def pieces_of(lines: Iterable[FloatArray]) -> FloatArray:
    """Straight pieces (s, 2, 2) of lines (n, 2)."""
    pieces = [np.stack((line[:-1], line[1:]), axis=1) for line in lines]
    return np.concatenate(pieces) if pieces else np.zeros((0, 2, 2))


def closed(ring: FloatArray) -> FloatArray:
    """Ring (n, 2) as a line (n + 1, 2) that ends where it begins."""
    return np.concatenate((ring, ring[:1]))


def _way(mover: Mover) -> tuple[FloatArray, ...]:
    """Lines of `SceneModel.ways` of one mover."""
    poses, times = np.array(mover.poses), mover.moments
    if not np.ptp(poses[:, :2], axis=0).any():
        ring = np.array(mover.outline)
        return tuple(closed(placed(ring, pose)) for pose in np.unique(poses, axis=0))
    paths = timed_paths([poses], [times], ["once"])
    looks = [
        np.linspace(*ends, 2 + int(abs(turn) / LOOK))
        for ends, turn in zip(pairwise(times), np.diff(poses[:, 2]).tolist(), strict=True)
    ]
    return (np.concatenate([timed_poses(paths, t)[:, :2] for t in np.concatenate(looks).tolist()]),)


def _wheelbases(world: World) -> FloatArray:
    """`SceneModel.wheelbase` of the robots of a world."""
    each = []
    for one in world.robots:
        is_car = one.drive is not None and one.drive.type == "car"
        given = one.drive.settings.get("wheelbase") if one.drive and is_car else None
        each.append(float(given) if isinstance(given, int | float) else 0.0)
    return np.repeat(each, [robot_count([one]) for one in world.robots])


def _polygon(corners: FloatArray) -> shapely.Geometry:
    return shapely.make_valid(shapely.Polygon(corners))


def region(rings: Iterable[FloatArray]) -> shapely.Geometry:
    """Area within rings by the even-odd rule.

    Two and two are put together: one after the other, thousands of holes would take minutes.
    """
    parts = [_polygon(ring) for ring in rings if len(ring) >= 3]
    while len(parts) > 1:
        last = parts[len(parts) // 2 * 2 :]
        parts = [*shapely.symmetric_difference(parts[: len(parts) - len(last) : 2], parts[1::2])]
        parts += last
    return parts[0] if parts else shapely.Polygon()


def split_at(line: FloatArray, area: shapely.Geometry) -> tuple[list[FloatArray], list[FloatArray]]:
    """Pieces (n, 2) of a line (m, 2) inside of an area, and outside, each as long as it goes.

    Straight piece by straight piece: of a line as a whole shapely works out every crossing with
    itself, of which a drawing by a stranger may have thousands of millions.
    """
    pieces = np.stack((line[:-1], line[1:]), axis=1)
    pieces = pieces[(pieces[:, 0] != pieces[:, 1]).any(axis=1)]
    lines = shapely.linestrings(pieces)
    shapely.prepare(area)
    inside, outside = shapely.covers(area, lines), shapely.disjoint(area, lines)
    across = np.flatnonzero(~inside & ~outside)
    found = []
    for whole, cut in ((inside, shapely.intersection), (outside, shapely.difference)):
        parts, index = shapely.get_parts(cut(lines[across], area), return_index=True)
        long = shapely.length(parts) > 0.0
        parts, which = parts[long], across[index[long]]
        two = [shapely.get_coordinates(shapely.get_point(parts, k)) for k in (0, -1)]
        ends = np.stack(two, axis=1)
        along = pieces[which, 1] - pieces[which, 0]
        far = ((ends - pieces[which, :1]) * along[:, None]).sum(axis=2)
        back = far[:, 0] > far[:, 1]
        ends[back] = ends[back, ::-1]
        # whole pieces and parts of others in the order of the line, joined where one begins as
        # the one before ends
        which = np.concatenate((np.flatnonzero(whole), which))
        before = np.concatenate((np.zeros(whole.sum()), far.min(axis=1)))
        every = np.concatenate((pieces[whole], ends))[np.lexsort((before, which))]
        apart = (every[1:, 0] != every[:-1, 1]).any(axis=1)
        runs = np.split(every, np.flatnonzero(apart) + 1)
        found.append([np.concatenate((run[:, 0], run[-1:, 1])) for run in runs if len(run)])
    return found[0], found[1]


def _bodies(shapes: Shapes) -> tuple[tuple[FloatArray, ...], ...]:
    parts = [shapes.vertices[a:b] for a, b in pairwise(shapes.part_start)]
    return tuple(tuple(parts[a:b]) for a, b in pairwise(shapes.body_start))


def _walls(bodies: Sequence[Body], walls: Shapes) -> dict[str, tuple[FloatArray, ...]]:
    """Polylines of the boundaries and outlines of the obstacles, from their convex parts."""
    found: dict[str, list[FloatArray]] = {"boundary": [], "obstacle": []}
    for body, parts in zip(bodies, _bodies(walls), strict=True):
        line = [parts[0][0], *(part[1] for part in parts)] if body.kind == "boundary" else []
        found[body.kind].append(np.array(line) if line else outline(parts))
    return {"boundaries": tuple(found["boundary"]), "obstacles": tuple(found["obstacle"])}


def _lines(lines: Polylines) -> tuple[FloatArray, ...]:
    return tuple(lines.points[a:b] for a, b in pairwise(lines.start))


def _stop_stations(layout: Layout) -> FloatArray:
    """(N,) stop stations: ends of the paths, staggered by the desired leads of the formation."""
    formation = layout.world.formation
    lead = np.zeros(len(layout.start))
    if formation is not None and formation.spacing == "initial":
        line = shapely.LineString(layout.reference)
        station = shapely.line_locate_point(line, shapely.points(layout.start[:, :2]))
        lead = station - station[0]
    elif formation is not None:
        lead = np.array(formation.spacing, dtype=np.float64)
    ends = shapely.length([shapely.LineString(path) for path in layout.paths])
    return np.asarray(np.maximum(ends - (lead.max() - lead), 0.0))
