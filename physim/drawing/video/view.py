"""The world at one time as a camera sees it: ground, trails, robots, contacts, names.

Of a crowd, trails are short and of one colour, targets are left out, and only the closest pair and
robots that touch something have names: all others would hide what they name.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import shapely
from scipy.ndimage import gaussian_filter1d

from physim.analysis.metrics.distances import nearest_points
from physim.drawing import palette
from physim.drawing.crowd import NAMED
from physim.drawing.items import Level
from physim.drawing.labels import Label, grown, leader
from physim.drawing.scene_model import pieces_of
from physim.drawing.timeline import Moment, Timeline
from physim.drawing.video.canvas import (
    FLASH,
    MARK,
    SHORT_TRAIL,
    TRAIL,
    Box,
    Canvas,
    Fleet,
    Lens,
    draw_closest,
    draw_contacts,
    draw_ghosts,
    draw_moved,
    draw_ring,
    draw_robots,
    draw_targets,
    draw_trails,
    draw_wheels,
)
from physim.drawing.video.ground import Background, Ground, Whole, notes, write_corner
from physim.drawing.video.names import Labels
from physim.drawing.video.text import BOLD, NAME, Sprite, shorten, sprite
from physim.geometry.shapes import FloatArray, IntArray
from physim.units import amount

if TYPE_CHECKING:
    from physim.record import Record

MARGIN = 26.0
"""[px] free edge around all that must be seen"""
ALL = 30.0
"""[px] a world in which every robot is drawn at least this long is shown whole"""
LONG, SHORT, LARGE = 35.0, 18.0, 84.0
"""[px] length of the smallest robot: wanted at least, never below, never above"""
BEYOND = 0.5
"""Share of half the view that stays within a world that is larger than the view"""
TRAIL_BANDS = 50
"""Steps in which trails fade, over all robots."""
TRAIL_STEPS, SHORT_STEPS = 21, 6
"""Most places of a trail, and of one in a crowd."""
FADING = 3
"""Steps in which those fade."""
MOST_NAMED = 12
"""Names in a crowd."""
NEAR = 160.0
"""[px] from a name within which it keeps off robots"""


class Camera:
    """Shows the world whole, or follows the cluster at a fixed scale, moving smoothly.

    The path of the camera depends on the record and the playback speed alone, so a still at a time
    equals the video's frame of that time.
    """

    def __init__(
        self,
        timeline: Timeline,
        extent: tuple[FloatArray, FloatArray],
        box: Box,
        speed: float,
        most: float = math.inf,
    ) -> None:
        """``extent`` [m] are the lowest and highest x and y of the ground; ``most`` [px/m]."""
        self.box = box
        low, high = extent
        robot = smallest_length(timeline)
        fit = Lens.whole(extent, box.size, MARGIN).scale
        self.whole = fit * robot >= ALL
        self._times, self._centre = np.zeros(1), ((low + high) / 2.0)[None, :]
        self.scale = min(fit, most)
        if self.whole:
            return
        period = max(0.25, speed / 8.0, timeline.duration / 20000.0)
        count = max(2, int(np.ceil(timeline.duration / period)) + 1)
        self._times = np.linspace(0.0, max(timeline.duration, period), count)
        places = timeline.pose(self._times)[:, :, :2]
        reach, room = timeline.scene.reach.max(), box.size - 2.0 * MARGIN
        first, last = places.min(axis=1), places.max(axis=1)
        spread = last - first + 2.0 * reach
        wanted = float((room / spread.max(axis=0)).min())
        least = SHORT if wanted * robot < LONG else LONG
        self.scale = min(float(np.clip(wanted, least / robot, LARGE / robot)), most)
        centre = (first + last) / 2.0
        lost = (spread * self.scale > room + 1e-9).any(axis=1)
        centre[lost] = np.median(places[lost], axis=1)
        half, middle = room / 2.0 / self.scale, (low + high) / 2.0
        half = np.where(high - low > 2.0 * half, BEYOND * half, half)
        centre = np.clip(centre, np.minimum(low + half, middle), np.maximum(high - half, middle))
        sigma = max(1.0, 0.8 * speed) / period  # the same forward and back
        smooth = gaussian_filter1d(centre, sigma, axis=0, mode="nearest", truncate=3.0)
        self._centre = np.asarray(smooth)

    def centre(self, time: float) -> FloatArray:
        """Return the centre of the view [m] at ``time`` [s]."""
        return np.array([np.interp(time, self._times, self._centre[:, k]) for k in (0, 1)])

    def corners(self, time: float) -> FloatArray:
        """Return the lower left and upper right corner (2, 2) [m] of what is seen."""
        half = self.box.size / 2.0 / self.scale
        return np.stack((self.centre(time) - half, self.centre(time) + half))

    def lens(self, time: float) -> Lens:
        """Return the map to pixels of the view; the world's origin falls on a whole pixel.

        So the static background can be cut from one picture of the world without resampling.
        """
        x, y = self.box.size / 2.0 + self.centre(time) * (-self.scale, self.scale)
        return Lens(self.scale, float(round(x)), float(round(y)))


def smallest_length(timeline: Timeline) -> float:
    """Return the largest extent of the robot whose largest extent is smallest [m]."""
    lengths = []
    for shape in dict.fromkeys(timeline.scene.shapes):
        hull = shapely.MultiPoint(np.concatenate(shape.rings)).minimum_rotated_rectangle
        lengths.append(np.hypot(*np.diff(shapely.get_coordinates(hull), axis=0).T).max(initial=0.0))
    return max(float(min(lengths)), 1e-6)


class Pair(NamedTuple):
    """Two bodies, their distance [m] (negative: the depth of an overlap), and its points (2, 2)."""

    a: int
    b: int
    distance: float
    points: FloatArray


def two(record: Record, bodies: tuple[int, int], now: Moment) -> Pair:
    """Return two bodies with their nearest points."""
    points = nearest_points(record, *bodies, now.moving_pose)
    return Pair(*bodies, float(np.hypot(*(points[1] - points[0]))), points)


def closest(timeline: Timeline, now: Moment) -> Pair | None:
    """Return the robot closest to anything that moves, and that body, with the distance of the
    record; None for one robot alone."""
    clearance = timeline.distances_at(np.array([now.sample]))[0][0]
    if timeline.moving < 2 or not np.isfinite(clearance).any():
        return None
    a, pose = int(np.argmin(clearance)), now.moving_pose
    reach = timeline.record.shapes.radius if timeline.scene.moved else timeline.scene.reach
    gap = np.hypot(*(pose[:, :2] - pose[a, :2]).T) - reach - reach[a]
    gap[a] = np.inf
    near = np.flatnonzero(gap <= max(float(clearance[a]), float(gap.min())) + 1e-6)
    pairs = [two(timeline.record, (min(a, b), max(a, b)), now) for b in near.tolist()]
    # of several that it overlaps the deepest
    their = np.append(clearance, np.full(timeline.moving - timeline.robots, np.inf))[near]
    k = int(np.lexsort((their, np.array([pair.distance for pair in pairs])))[0])
    return pairs[k]._replace(distance=float(clearance[a]))


class View:
    """Draws the world of one record at one playback speed.

    Only the places of labels depend on what was drawn before (they glide); all else is a function
    of the time.
    """

    def __init__(
        self,
        timeline: Timeline,
        world: Ground,
        box: Box,
        speed: float,
        fps: float,
        most: float = math.inf,
    ) -> None:
        """``world`` is the ground that the record shows, ``box`` where the view stands.

        ``most`` is the largest scale [px/m] during the run.
        """
        self.timeline, self.box = timeline, box
        self.camera = Camera(timeline, world.extent, box, speed, most)
        self.between: tuple[int, int] | None = None
        """two bodies whose distance is marked, not that of the closest two robots"""
        self.ghosts: View | None = None
        """another run, whose robots are drawn as outlines"""
        self._speed = speed
        self._lasts = max(MARK, FLASH * speed, timeline.spacing)  # [s] of the mark of a contact
        self._background = Background(world, self.camera.scale)
        self._end = None if self.camera.whole else Whole(timeline, world, box, MARGIN)
        scene = timeline.scene
        self._fleet = Fleet((*scene.shapes, *scene.moved_shapes))
        self._faces = list(map(palette.keyed, scene.moved_keys))
        self._eccentric = np.array([shape.eccentric for shape in timeline.scene.shapes])
        self._labels = Labels()
        self._walls = pieces_of(
            line for item in world.items if item.level == Level.WALL for line in item.lines
        )
        self._names = [
            shorten(name, NAME, 110, BOLD) + mark
            for name, mark in zip(timeline.record.names, timeline.marks, strict=True)
        ]
        if len(scene.moved) <= NAMED:
            self._names += [shorten(name, NAME, 110, BOLD) for name in scene.moved_names]
        self._crowd = timeline.robots > NAMED
        self._trail = SHORT_TRAIL if self._crowd else TRAIL
        steps = SHORT_STEPS if self._crowd else TRAIL_STEPS
        self._period = max(speed / fps, self._trail / steps)
        grid = np.arange(int(timeline.duration / self._period) + 1) * self._period
        self._history = timeline.pose(grid)[:, :, :2]

    @property
    def scales(self) -> tuple[float, float]:
        """Scale [px/m] during the run, and of the picture of its end."""
        run = self.camera.scale
        return run, run if self._end is None else self._end.lens.scale

    def paint(self, view: Canvas, now: Moment, held: bool = False) -> Pair | None:
        """Draw one moment, in a picture as large as the view; returns whose distance is marked.

        At the end of the run the whole of it is shown, and why robots stand as they do; not where
        the view is ``held``, since another run goes on.
        """
        lens, timeline = self.camera.lens(now.time), self.timeline
        pair = closest(timeline, now)
        if self.between is not None:
            pair = two(timeline.record, self.between, now)
        over = timeline.over(now.time) and not held
        if over and self._end is not None:
            self._end.paint_end(view, now, self._fleet)
            return pair
        self._background.paint(view.pixels, lens)
        self._draw_trails(view, lens, now)
        if not self._crowd:
            draw_targets(view, lens.pixels(now.pose[:, :2]), lens.pixels(now.targets))
        touching = timeline.contacts.touching(now.time, timeline.moving)
        vertices = lens.pixels(self._fleet.placed(now.moving_pose))
        boxes = self._fleet.boxes(vertices)
        inside = (boxes[:, 2:] >= 0.0) & (boxes[:, :2] <= self.box.size)
        there = np.flatnonzero(inside.all(axis=1))
        seen = there[there < timeline.robots]
        if (other := self.ghosts) is not None:
            draw_ghosts(view, other._fleet, lens, other.timeline.at(now.time).moving_pose)
        draw_moved(view, self._fleet, lens, now.moving_pose, self._faces, touching)
        draw_robots(view, self._fleet, lens, now.pose, now.colours, touching, seen)
        if not self._crowd:
            draw_wheels(view, lens, timeline.scene.wheels_at(now.pose, now.steering), now.colours)
        origins = lens.pixels(now.pose[seen[self._eccentric[seen]], :2])
        view.discs(origins, 3.5, palette.WHITE)  # where the lines to the targets start
        view.discs(origins, 2.2, palette.INK)
        if pair is not None:
            draw_closest(view, lens.pixels(pair.points))
        self._mark_contacts(view, lens, now.time)
        named = there[there < len(self._names)].tolist()
        if self._crowd:
            first = [] if pair is None else [pair.a, pair.b]
            those = dict.fromkeys((*first, *np.flatnonzero(touching).tolist()))
            named = [robot for robot in those if robot in named][:MOST_NAMED]
        shapes = {robot: self._fleet.outline(vertices, robot) for robot in named}
        self._write_labels(view, lens, now, pair, shapes, boxes)
        if over and (lines := notes(timeline)):
            write_corner(view, ["at the end", *lines], boxes)
        return pair

    def _mark_contacts(self, view: Canvas, lens: Lens, time: float) -> None:
        """A flash where a contact begins; a cross that goes with it for as long as it lasts.

        A swept contact, between two samples, has a sign of its own. Of a crowd signs are small.
        A pair that rattles, apart for less than a mark lasts, has one mark and flashes once.
        """
        contacts, lasts = self.timeline.contacts, self._lasts

        def places(rows: IntArray, time: float) -> FloatArray:
            return lens.pixels(np.array([contacts.place_at(k, time) for k in rows]).reshape(-1, 2))

        recent, present = contacts.recent(time, lasts), contacts.present(time)
        if not len(recent) + len(present):
            return
        for row in recent[contacts.apart[recent] > lasts]:
            began = float(contacts.began[row])
            share, place = (time - began) / (FLASH * self._speed), places(np.array([row]), began)[0]
            if share < 1.0 and np.isfinite(place).all():
                draw_ring(view, place, 9.0 + 25.0 * share, 4)
        shown = np.union1d(recent, present)
        rows = contacts.latest(shown)
        for swept in (False, True):
            chosen = places(rows[contacts.swept[rows] == swept], time)
            draw_contacts(view, chosen, swept, small=self._crowd)
        deep = shown[contacts.deep[shown] <= time + 1e-9]
        draw_contacts(view, places(deep, time), False, deep=True)

    def _draw_trails(self, view: Canvas, lens: Lens, now: Moment) -> None:
        """Where robots were in the last seconds; those of a crowd in one colour."""
        first = int(np.ceil(max(now.time - self._trail, 0.0) / self._period - 1e-9))
        last = int(np.floor(now.time / self._period + 1e-9)) + 1
        trails = np.concatenate((self._history[first:last], now.pose[None, :, :2]))
        trails = lens.pixels(trails)  # (T, N, 2), old to new
        low, high = trails.min(axis=0), trails.max(axis=0)
        seen = np.flatnonzero(((high > -3.0) & (low < self.box.size + 3.0)).all(axis=1))
        lines = trails[:, seen].transpose(1, 0, 2)
        if self._crowd:
            draw_trails(view, lines, [palette.BAND], FADING, 1.0)
            return
        bands = min(max(TRAIL_BANDS // self.timeline.robots, 4), 16)
        draw_trails(view, lines, [palette.robot_colour(k) for k in seen.tolist()], bands)

    def _write_labels(
        self,
        view: Canvas,
        lens: Lens,
        now: Moment,
        pair: Pair | None,
        shapes: Mapping[int, FloatArray],
        boxes: FloatArray,
    ) -> None:
        """The distance of a pair, and names of bodies, of given ``shapes`` (n, 2) [px].

        ``boxes`` (B, 4) [px] are those of all that moves.
        """
        pictures: dict[int, Sprite] = {}
        labels: dict[int, Label] = {}
        if pair is not None:
            span = float(np.hypot(*(pair.points[1] - pair.points[0]))) * lens.scale / 2.0
            text = amount(pair.distance, "m") if pair.distance > 0.0 else "contact"
            key = -1 - pair.a * self.timeline.moving - pair.b  # another pair chooses anew
            x, y = lens.pixels(pair.points).mean(axis=0)
            pictures[key] = sprite(text, NAME, palette.INK, BOLD, halo=True)
            labels[key] = Label((x, y), min(max(span * 0.2, 8.0), 30.0), pictures[key].size)
        middles = (boxes[:, :2] + boxes[:, 2:]) / 2.0
        for robot, shape in shapes.items():
            pictures[robot] = sprite(self._names[robot], NAME, palette.INK, BOLD, halo=True)
            (x, y), around = middles[robot].tolist(), shape - middles[robot]
            reach = math.sqrt(float((around * around).sum(axis=1).max()))
            labels[robot] = Label((x, y), reach, pictures[robot].size, around)
        obstacles, owners = self._obstacles(lens, now, boxes, labels)
        walls = lens.pixels(self._walls)
        places = self._labels.place(labels, obstacles, view.size, owners, walls)
        for (key, label), at in zip(labels.items(), places, strict=True):
            least = 2.0 * label.reach
            if key >= 0 and math.dist(at, label.at) > least:
                line = leader(label, at, least)
                if line is not None:
                    view.lines(line[None], palette.QUIET, 1.0)
            left, top = np.rint(at - np.array(label.size) / 2.0).astype(int).tolist()
            view.stamp(pictures[key], left, top)

    def _obstacles(
        self, lens: Lens, now: Moment, boxes: FloatArray, labels: Mapping[int, Label]
    ) -> tuple[FloatArray, IntArray]:
        """Boxes (m, 4) [px] that labels should not cover, and the bodies (m,) that they are of."""
        if not self._crowd:
            aims = np.flatnonzero(np.isfinite(now.targets).all(axis=1))
            rings = grown(np.tile(lens.pixels(now.targets[aims]), 2), 5.0)
            return np.concatenate((boxes, rings)), np.append(np.arange(len(boxes)), aims)
        near = np.zeros(len(boxes), dtype=bool)  # what is far from all labels is in no one's way
        for label in labels.values():
            near |= (np.abs(boxes[:, :2] - label.at) < NEAR).all(axis=1)
        robots = np.flatnonzero(near)
        return boxes[robots], robots
