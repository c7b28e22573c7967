"""The world at one time as a camera sees it: ground, trails, robots, contacts, names."""

from __future__ import annotations

import numpy as np

from physim import palette
from physim.geometry.shapes import FloatArray
from physim.labels import Label, grown, leader, metres
from physim.timeline import Moment, Timeline
from physim.video.background import Background
from physim.video.camera import Camera
from physim.video.closest import Pair, closest_pair
from physim.video.ground import Ground
from physim.video.labels import Labels
from physim.video.layout import ONE, TEXT, TRAIL, Box, Image, Lens, fixed
from physim.video.marks import (
    draw_closest,
    draw_contact,
    draw_flash,
    draw_lines,
    draw_reference_point,
    draw_target,
    draw_trail,
    mark_lasts,
)
from physim.video.robots import Fleet, draw_robot
from physim.video.text import Sprite, shorten, size_of, sprite, stamp

NAMED = 60
"""Robots above which names would only hide the picture."""
TRAIL_BANDS = 70
"""Steps in which trails fade, over all robots."""
TRAIL_STEPS = 60
"""Most places of a trail."""


class View:
    """Draws the world of one record at one playback speed.

    Only the places of labels depend on what was drawn before (they glide); all else is a function
    of the time.
    """

    def __init__(
        self, timeline: Timeline, world: Ground, box: Box, speed: float, fps: float
    ) -> None:
        """``world`` is the ground that the record shows, ``box`` where the view stands."""
        self.timeline, self.box = timeline, box
        self.camera = Camera(timeline, world.extent, box, speed)
        self._speed = speed
        self._background = Background(world, self.camera.scale)
        self._fleet = Fleet(timeline.record.footprints)
        self._labels = Labels()
        solid = [stroke.pieces for stroke in world.strokes if stroke.colour == palette.WALL]
        self._walls = np.concatenate(solid)
        self._names = [shorten(name, TEXT, 110) for name in timeline.record.names]
        self._period = max(speed / fps, TRAIL / TRAIL_STEPS)
        grid = np.arange(int(timeline.duration / self._period) + 1) * self._period
        self._history = timeline.pose(grid)[:, :, :2]

    def paint(self, image: Image, now: Moment) -> Pair | None:
        """Draw into the view's box of ``image``; returns the closest pair of robots."""
        view, lens = self.box.of(image), self.camera.lens(now.time)
        scene = self.timeline.scene
        pair = closest_pair(scene.footprints, now.pose, scene.reach)
        self._background.paint(view, lens)
        bands = min(max(TRAIL_BANDS // self.timeline.robots, 4), 16)
        for index, trail in enumerate(lens.fixed(self._trails(now))):
            draw_trail(view, trail, palette.robot_colour(index), bands)
        for place, target in zip(now.pose[:, :2], now.targets, strict=True):
            draw_target(view, lens, place, target)
        touching = self.timeline.contacts.touching(now.time, self.timeline.robots)
        outlines = self._fleet.split(lens.fixed(self._fleet.placed(now.pose)))
        for outline, colour, touches in zip(outlines, now.colours, touching, strict=True):
            draw_robot(view, outline, colour, bool(touches))
        for place, figure in zip(now.pose[:, :2], self._fleet.figures, strict=True):
            if figure.eccentric:
                draw_reference_point(view, lens, place)
        if pair is not None:
            draw_closest(view, lens, pair)
        self._mark_contacts(view, lens, now.time)
        shapes = [np.concatenate(outline.rings) / ONE for outline in outlines]
        self._write_labels(view, lens, shapes, pair, lens.pixels(now.targets))
        return pair

    def _mark_contacts(self, view: Image, lens: Lens, time: float) -> None:
        """A flash where a contact begins; a cross that goes with it for as long as it lasts.

        A graze between two samples has a sign of its own.
        """
        contacts = self.timeline.contacts
        recent = contacts.recent(time, mark_lasts(self._speed))
        for row in recent:
            began = float(contacts.began[row])
            place = lens.pixels(contacts.place_at(row, began))
            draw_flash(view, place, time - began, self._speed)
        for row in np.union1d(recent, contacts.present(time)):
            draw_contact(view, lens.pixels(contacts.place_at(row, time)), bool(contacts.swept[row]))

    def _trails(self, now: Moment) -> FloatArray:
        """Return the robots' places of the last seconds, (N, T, 2) [m], old to new."""
        first = int(np.ceil(max(now.time - TRAIL, 0.0) / self._period - 1e-9))
        last = int(np.floor(now.time / self._period + 1e-9)) + 1
        places = np.concatenate((self._history[first:last], now.pose[None, :, :2]))
        return np.ascontiguousarray(places.transpose(1, 0, 2))

    def _write_labels(
        self,
        view: Image,
        lens: Lens,
        shapes: list[FloatArray],
        pair: Pair | None,
        targets: FloatArray,
    ) -> None:
        """Names of the robots in view, and the distance of the closest pair.

        ``shapes`` (n, 2) are the outlines of the robots, and ``targets`` (N, 2), all [px].
        """
        high, wide = view.shape[:2]
        boxes = np.array([[*s.min(axis=0), *s.max(axis=0)] for s in shapes])
        aims = np.flatnonzero(np.isfinite(targets).all(axis=1))
        rings = grown(np.tile(targets[aims], 2), 5.0)
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
        inside = (boxes[:, 2:] >= 0).all(axis=1) & (boxes[:, :2] <= (wide, high)).all(axis=1)
        for k in np.flatnonzero(inside & (len(boxes) <= NAMED)).tolist():
            pictures[k] = sprite(self._names[k], TEXT, palette.INK)
            shape, (x, y) = shapes[k] - middles[k], middles[k]
            reach = float(np.hypot(*shape.T).max())
            labels[k] = Label((x, y), reach, size_of(pictures[k]), shape)
        owners = np.concatenate((np.arange(len(boxes)), aims))
        walls = lens.pixels(self._walls)
        places = self._labels.place(
            labels, np.concatenate((boxes, rings)), (wide, high), owners, walls
        )
        for (key, label), at in zip(labels.items(), places, strict=True):
            line = None if key < 0 else leader(label, at, 2.0 * label.reach)
            if line is not None:
                draw_lines(view, fixed(line[None]), palette.QUIET, 1)
            left, top = at - np.array(label.size) / 2.0
            stamp(view, pictures[key], round(left), round(top))
