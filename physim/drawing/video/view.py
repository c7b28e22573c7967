"""The world at one time as a camera sees it: ground, trails, robots, contacts, names.

Of a crowd, trails are short and of one colour, targets are left out, and only the closest pair and
robots that touch something have names: all others would hide what they name.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from physim.analysis.metrics.walls import nearest_points
from physim.drawing import palette
from physim.drawing.crowd import NAMED
from physim.drawing.items import Level
from physim.drawing.labels import Label, grown, leader, metres
from physim.drawing.scene_model import pieces_of
from physim.drawing.timeline import Moment, Timeline
from physim.drawing.video.camera import Camera
from physim.drawing.video.closest import Closest, Pair
from physim.drawing.video.closing import Closing, write_corner
from physim.drawing.video.ending import notes
from physim.drawing.video.ground import Background, Ground
from physim.drawing.video.layout import (
    ONE,
    SHORT_TRAIL,
    TEXT,
    TRAIL,
    Box,
    Image,
    Lens,
    fixed,
)
from physim.drawing.video.marks import (
    Fleet,
    draw_closest,
    draw_contacts,
    draw_flash,
    draw_lines,
    draw_reference_point,
    draw_robots,
    draw_targets,
    draw_trails,
    mark_lasts,
)
from physim.drawing.video.names import Labels
from physim.drawing.video.text import Sprite, shorten, size_of, sprite, stamp
from physim.geometry.shapes import FloatArray, IntArray

TRAIL_BANDS = 70
"""Steps in which trails fade, over all robots."""
TRAIL_STEPS, SHORT_STEPS = 21, 6
"""Most places of a trail, and of one in a crowd."""
FADING = 3
"""Steps in which those fade."""
MOST_NAMED = 12
"""Names in a crowd."""
NEAR = 160.0
"""[px] from a name within which it keeps off robots"""


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
        self._speed = speed
        self._lasts = max(mark_lasts(speed), timeline.spacing)
        self._background = Background(world, self.camera.scale)
        scene = timeline.scene
        self._fleet = Fleet(scene.shapes)
        self._closest = Closest(scene.footprints, scene.reach)
        self._closing = None if self.camera.whole else Closing(timeline, world, box)
        self._eccentric = np.array([one.eccentric for one in scene.shapes])
        self._labels = Labels()
        self._walls = pieces_of(
            line for item in world.items if item.level == Level.WALL for line in item.lines
        )
        self._names = [shorten(name, TEXT, 110) for name in timeline.record.names]
        self._between: tuple[int, int] | None = None
        self._crowd = timeline.robots > NAMED
        self._trail = SHORT_TRAIL if self._crowd else TRAIL
        steps = SHORT_STEPS if self._crowd else TRAIL_STEPS
        self._period = max(speed / fps, self._trail / steps)
        grid = np.arange(int(timeline.duration / self._period) + 1) * self._period
        self._history = timeline.pose(grid)[:, :, :2]

    @property
    def scales(self) -> tuple[float, float]:
        """Scale [px/m] during the run, and of the picture of its end."""
        last = self.camera.scale if self._closing is None else self._closing.scale
        return self.camera.scale, last

    def corners(self, time: float) -> FloatArray:
        """Lower left and upper right corner (2, 2) [m] of what is seen at ``time`` [s]."""
        if self._closing is not None and self.timeline.over(time):
            return self._closing.corners
        return self.camera.corners(time)

    def paint(self, image: Image, now: Moment, held: bool = False) -> Pair | None:
        """Draw into the view's box of ``image``; returns the closest pair of robots.

        At the end of the run the whole of it is shown, and why robots stand as they do; not where
        the view is ``held``, since another run goes on.
        """
        view, lens = self.box.of(image), self.camera.lens(now.time)
        closest = pair = self._closest.pair(now.pose)
        if self._between is not None:
            pair = self._marked(now.pose, *self._between)
        over = self.timeline.over(now.time) and not held
        if over and self._closing is not None:
            self._closing.paint(view, now, self._fleet)
            return closest
        self._background.paint(view, lens)
        self._draw_trails(view, lens, now)
        seen = self._seen(lens, now.pose)
        if not self._crowd:
            draw_targets(view, lens, now.pose[:, :2], now.targets)
        touching = self.timeline.contacts.touching(now.time, self.timeline.robots)
        vertices = lens.fixed(self._fleet.placed(now.pose))
        outlines = self._fleet.split(vertices, seen.tolist())
        draw_robots(
            view, outlines, [now.colours[k] for k in seen.tolist()], touching[seen].tolist()
        )
        for place in now.pose[seen[self._eccentric[seen]], :2]:
            draw_reference_point(view, lens, place)
        if pair is not None:
            draw_closest(view, lens, pair)
        self._mark_contacts(view, lens, now.time)
        boxes = self._fleet.boxes(vertices)
        place = {robot: k for k, robot in enumerate(seen.tolist())}
        named = (k for k in self._named(pair, touching) if k in place and self._shows(boxes[k]))
        most = MOST_NAMED if self._crowd else None
        shapes = {
            robot: np.concatenate(outlines[place[robot]].rings) / ONE
            for robot in itertools.islice(named, most)
        }
        self._write_labels(view, lens, now, pair, shapes, boxes)
        if over and (lines := notes(self.timeline)):
            write_corner(view, ["at the end", *lines], boxes)
        return closest

    def mark(self, a: int, b: int) -> None:
        """Mark the distance of robot ``a`` to body ``b``, not that of the closest two robots."""
        self._between = a, b

    def _marked(self, pose: FloatArray, a: int, b: int) -> Pair:
        points = nearest_points(self.timeline.record, a, b, pose)
        return Pair(a, b, float(np.hypot(*(points[1] - points[0]))), points)

    def _seen(self, lens: Lens, pose: FloatArray) -> IntArray:
        """Robots of which some may be in the view, by index."""
        places, reach = lens.pixels(pose[:, :2]), self.timeline.scene.reach * lens.scale + 3.0
        inside = (places >= -reach[:, None]) & (places <= self.box.size + reach[:, None])
        return np.flatnonzero(inside.all(axis=1))

    def _mark_contacts(self, view: Image, lens: Lens, time: float) -> None:
        """A flash where a contact begins; a cross that goes with it for as long as it lasts.

        A swept contact, between two samples, has a sign of its own. Of a crowd signs are small.
        A pair that rattles, apart for less than a mark lasts, has one mark and flashes once.
        """
        contacts, lasts = self.timeline.contacts, self._lasts
        recent = contacts.recent(time, lasts)
        for row in recent[contacts.apart[recent] > lasts]:
            began = float(contacts.began[row])
            place = lens.pixels(contacts.place_at(row, began))
            draw_flash(view, place, time - began, self._speed)
        shown = np.union1d(recent, contacts.present(time))
        deep = shown[contacts.deep[shown] <= time + 1e-9]
        rows = contacts.latest(shown)
        for swept in (False, True):
            chosen = self._places(lens, rows[contacts.swept[rows] == swept], time)
            draw_contacts(view, chosen, swept, small=self._crowd)
        draw_contacts(view, self._places(lens, deep, time), False, deep=True)

    def _places(self, lens: Lens, rows: IntArray, time: float) -> FloatArray:
        """Places (C, 2) [px] of contacts at a time."""
        contacts = self.timeline.contacts
        return lens.pixels(np.array([contacts.place_at(k, time) for k in rows]).reshape(-1, 2))

    def _draw_trails(self, view: Image, lens: Lens, now: Moment) -> None:
        """Trails of the robots, those of a crowd in one colour; only what reaches into the view."""
        trails = lens.pixels(self._trails(now))
        low, high = trails.min(axis=0), trails.max(axis=0)
        seen = np.flatnonzero(((high > -3.0) & (low < self.box.size + 3.0)).all(axis=1))
        lines = np.ascontiguousarray(fixed(trails[:, seen]).transpose(1, 0, 2))
        if self._crowd:
            draw_trails(view, lines, palette.BAND, FADING, 1)
            return
        bands = min(max(TRAIL_BANDS // self.timeline.robots, 4), 16)
        for index, line in zip(seen.tolist(), lines, strict=True):
            draw_trails(view, line[None], palette.robot_colour(index), bands)

    def _trails(self, now: Moment) -> FloatArray:
        """Return the robots' places of the last seconds, (T, N, 2) [m], old to new."""
        first = int(np.ceil(max(now.time - self._trail, 0.0) / self._period - 1e-9))
        last = int(np.floor(now.time / self._period + 1e-9)) + 1
        return np.concatenate((self._history[first:last], now.pose[None, :, :2]))

    def _write_labels(
        self,
        view: Image,
        lens: Lens,
        now: Moment,
        pair: Pair | None,
        shapes: Mapping[int, FloatArray],
        boxes: FloatArray,
    ) -> None:
        """The distance of the closest pair, and names of robots, of given ``shapes`` (n, 2) [px].

        ``boxes`` (N, 4) [px] are those of all robots.
        """
        pictures: dict[int, Sprite] = {}
        labels: dict[int, Label] = {}
        if pair is not None:
            span = float(np.hypot(*(pair.points[1] - pair.points[0]))) * lens.scale / 2.0
            text = metres(pair.distance) if pair.distance > 0.0 else "contact"
            key = -1 - pair.a * self.timeline.robots - pair.b  # another pair chooses anew
            x, y = lens.pixels(pair.points).mean(axis=0)
            pictures[key] = sprite(text, TEXT, palette.INK)
            labels[key] = Label((x, y), min(max(span * 0.2, 8.0), 30.0), size_of(pictures[key]))
        middles = (boxes[:, :2] + boxes[:, 2:]) / 2.0
        for robot, shape in shapes.items():
            pictures[robot] = sprite(self._names[robot], TEXT, palette.INK)
            (x, y), around = middles[robot].tolist(), shape - middles[robot]
            reach = math.sqrt(float((around * around).sum(axis=1).max()))
            labels[robot] = Label((x, y), reach, size_of(pictures[robot]), around)
        high, wide = view.shape[:2]
        obstacles, owners = self._obstacles(lens, now, boxes, labels)
        walls = lens.pixels(self._walls)
        places = self._labels.place(labels, obstacles, (wide, high), owners, walls)
        for (key, label), at in zip(labels.items(), places, strict=True):
            least = 2.0 * label.reach
            if key >= 0 and math.dist(at, label.at) > least:
                line = leader(label, at, least)
                if line is not None:
                    draw_lines(view, fixed(line[None]), palette.QUIET, 1)
            (x, y), (wide, high) = at.tolist(), label.size
            stamp(view, pictures[key], round(x - wide / 2.0), round(y - high / 2.0))

    def _obstacles(
        self, lens: Lens, now: Moment, boxes: FloatArray, labels: Mapping[int, Label]
    ) -> tuple[FloatArray, IntArray]:
        """Boxes (m, 4) [px] that labels should not cover, and the robots (m,) that they are of."""
        if not self._crowd:
            aims = np.flatnonzero(np.isfinite(now.targets).all(axis=1))
            rings = grown(np.tile(lens.pixels(now.targets[aims]), 2), 5.0)
            return np.concatenate((boxes, rings)), np.append(np.arange(len(boxes)), aims)
        near = np.zeros(len(boxes), dtype=bool)  # what is far from all labels is in no one's way
        for label in labels.values():
            near |= (np.abs(boxes[:, :2] - label.at) < NEAR).all(axis=1)
        robots = np.flatnonzero(near)
        return boxes[robots], robots

    def _named(self, pair: Pair | None, touching: NDArray[np.bool_]) -> Iterable[int]:
        """Robots that have names: all, or of a crowd the closest pair and those that touch."""
        if not self._crowd:
            return range(self.timeline.robots)
        closest = [] if pair is None else [pair.a, pair.b]
        return dict.fromkeys((*closest, *np.flatnonzero(touching).tolist()))

    def _shows(self, box: FloatArray) -> bool:
        """Whether some of a box (4,) [px] is in the view."""
        left, top, right, bottom = box.tolist()
        wide, high = self.box.width, self.box.height
        return bool(right >= 0.0 and bottom >= 0.0 and left <= wide and top <= high)
