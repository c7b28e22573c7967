"""The world at one time as a camera sees it: ground, trails, robots, contacts, names.

Names stand beside the robots, away from robots and from each other: each takes the place that
covers least, is on no wall, and is nearer to its robot than to any other or its target. It prefers
to be near and to stay where it is, and glides to a new place.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from physim.drawing import palette
from physim.drawing.labels import (
    ANGLES,
    Label,
    around,
    covered,
    grown,
    leader,
    metres,
    overlaps,
    places,
)
from physim.drawing.timeline import Moment, Timeline
from physim.drawing.video.camera import Camera
from physim.drawing.video.ground import Background, Ground
from physim.drawing.video.layout import ONE, TEXT, TRAIL, Box, Image, Lens, fixed
from physim.drawing.video.marks import (
    Fleet,
    Pair,
    closest_pair,
    draw_closest,
    draw_contact,
    draw_flash,
    draw_lines,
    draw_reference_point,
    draw_robot,
    draw_target,
    draw_trail,
    mark_lasts,
)
from physim.drawing.video.text import Sprite, shorten, size_of, sprite, stamp
from physim.geometry.shapes import FloatArray, IntArray

GAPS = (2.0, 12.0, 28.0, 48.0)
"""[px] between a robot and its label"""
PRICES = (0.0, 0.3, 0.9, 1.6)
"""What these gaps cost; covering a whole label costs 10."""
TURN = 0.2
"""What it costs to stand below rather than above: a label that glides must not cross its robot."""
COVERED, ON_WALL, ASTRAY, OUTSIDE = 10.0, 2.0, 1.5, 2.0
"""What it costs to cover a whole label, to cross a wall, to touch another robot than the own, and
to reach out of the view (a hundredth of it more for every px)."""
STAYS = 0.6
"""What a label saves where it stays in its direction."""
CLEARER = 8.0
"""[px] by which a label should be nearer to its own robot than to others"""
AIR = 2.0
"""[px] round a label that is counted as covered, too"""
GLIDE = 0.3
"""Share of the way that a label moves in a frame."""
EVERY = 6
"""Frames between two choices of places."""


class Labels:
    """Places labels frame by frame; it remembers where they were, and nothing else."""

    def __init__(self) -> None:
        self._chosen: dict[int, int] = {}
        self._wanted: dict[int, FloatArray] = {}
        self._offset: dict[int, FloatArray] = {}
        self._frame = 0

    def place(
        self,
        labels: Mapping[int, Label],
        boxes: FloatArray,
        area: tuple[int, int],
        owners: IntArray | None = None,
        walls: FloatArray | None = None,
    ) -> list[FloatArray]:
        """Return the middles (2,) [px] of labels, which are named by any number.

        ``boxes`` (m, 4) are left, top, right, bottom of what should not be covered, ``owners``
        (m,) the numbers of the labels that they belong to (first the body, then its target), and
        ``walls`` (s, 2, 2) segments; ``area`` is the width and height of the view.
        """
        owners = np.arange(len(boxes)) if owners is None else owners
        walls = np.zeros((0, 2, 2)) if walls is None else walls
        choose = self._frame % EVERY == 0 or not labels.keys() <= self._chosen.keys()
        self._frame += 1
        middles, taken = [], boxes
        for key, label in labels.items():
            if choose:
                found = places(label, GAPS, up=-1.0)
                room = around(found, label.size)
                cost = _cost(key, room, boxes, owners, walls, area)
                # where a shape is given, its places clear its own body anyway
                others = taken if label.shape is None else np.delete(taken, key, axis=0)
                lapped = overlaps(grown(room, AIR), others).sum(axis=1)
                cost += COVERED * lapped / np.prod(np.array(label.size) + 2.0 * AIR)
                if key in self._chosen:
                    cost[self._chosen[key]] -= STAYS
                best = self._chosen[key] = int(np.argmin(cost))
                self._wanted[key] = found[best] - label.at
                taken = np.concatenate((taken, room[best : best + 1]))
            before = self._offset.get(key, self._wanted[key])
            self._offset[key] = before + (self._wanted[key] - before) * GLIDE
            middles.append(self._offset[key] + label.at)
        return middles


def _cost(
    key: int,
    found: FloatArray,
    boxes: FloatArray,
    owners: IntArray,
    walls: FloatArray,
    area: tuple[int, int],
) -> FloatArray:
    """Return what each place (n, 4) costs for itself: gap, direction, walls, other robots."""
    cost = np.add.outer(PRICES, TURN * (1.0 - np.sin(ANGLES)) / 2.0).ravel()
    cost += ON_WALL * (covered(found, walls) > 0.0)
    low, high = found[:, None, :2], found[:, None, 2:]
    outside = np.maximum(-low, 0.0) + np.maximum(high - area, 0.0)
    cost += OUTSIDE * (outside > 0.0).any(axis=(1, 2)) + 0.01 * OUTSIDE * outside.sum(axis=(1, 2))
    others = boxes[owners != key]
    if key >= 0 and len(others):
        apart = np.maximum(np.maximum(others[:, :2] - high, low - others[:, 2:]), 0.0)
        wanted = np.repeat(GAPS, len(ANGLES)) + CLEARER
        distance = np.hypot(apart[..., 0], apart[..., 1]).min(axis=1)
        cost += ASTRAY * np.clip(1.0 - distance / wanted, 0.0, 1.0)
    return np.asarray(cost)


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

        A swept contact, between two samples, has a sign of its own.
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
