"""The world at one time as a camera sees it: ground, trails, robots, contacts, names."""

from __future__ import annotations

import cv2
import numpy as np

from physim.geometry.shapes import FloatArray
from physim.video import marks, theme
from physim.video.background import Background
from physim.video.camera import Camera, Lens, fixed
from physim.video.closest import Pair, closest_pair
from physim.video.ground import Ground
from physim.video.labels import Labels, Tag, leader
from physim.video.layout import Box
from physim.video.robots import Fleet, Outline, draw_robot
from physim.video.story import Story
from physim.video.text import Image, shorten, sprite, stamp
from physim.video.ticks import metres

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

    def __init__(self, story: Story, world: Ground, box: Box, speed: float, fps: float) -> None:
        """``world`` is the ground that the record shows, ``box`` where the view stands."""
        self.story, self.box = story, box
        self.camera = Camera(story, world.extent, box, speed)
        self._speed = speed
        self._background = Background(world, self.camera.scale)
        self._fleet = Fleet(story.record.footprints)
        self._labels = Labels()
        solid = [stroke.pieces for stroke in world.strokes if stroke.colour == theme.WALL]
        self._walls = np.concatenate(solid)
        self._names = [shorten(name, theme.TEXT, 110) for name in story.record.names]
        self._period = max(speed / fps, theme.TRAIL / TRAIL_STEPS)
        grid = np.arange(int(story.duration / self._period) + 1) * self._period
        self._history = story.pose(grid)[:, :, :2]

    def paint(self, image: Image, time: float) -> Pair | None:
        """Draw into the view's box of ``image``; the closest pair of robots at ``time`` [s]."""
        pose = self.story.pose(time)
        vertices = self._fleet.placed(pose)
        pair = closest_pair(self._fleet.split(vertices), pose, self._fleet.reach)
        self._paint(self.box.of(image), self.camera.lens(time), time, pose, vertices, pair)
        return pair

    def _paint(
        self,
        view: Image,
        lens: Lens,
        time: float,
        pose: FloatArray,
        vertices: FloatArray,
        pair: Pair | None,
    ) -> None:
        story = self.story
        rows = story.decisions(time)
        self._background.paint(view, lens)
        bands = min(max(TRAIL_BANDS // story.robots, 4), 16)
        for index, trail in enumerate(lens.fixed(self._trails(time, pose))):
            marks.draw_trail(view, trail, theme.robot_colour(index), bands)
        targets = story.targets(rows)
        for place, target in zip(pose[:, :2], targets, strict=True):
            marks.draw_target(view, lens, place, target)
        touching = story.contacts.touching(time, story.robots)
        outlines = self._fleet.split(lens.fixed(vertices))
        for outline, colour, touches in zip(outlines, story.colours(rows), touching, strict=True):
            draw_robot(view, outline, colour, bool(touches))
        for place, figure in zip(pose[:, :2], self._fleet.figures, strict=True):
            if figure.eccentric:
                marks.draw_reference_point(view, lens, place)
        if pair is not None:
            marks.draw_closest(view, lens, pair)
        self._mark_contacts(view, lens, time)
        self._write_labels(view, lens, outlines, pair, lens.pixels(targets))

    def _mark_contacts(self, view: Image, lens: Lens, time: float) -> None:
        """A flash where a contact begins; a cross that goes with it for as long as it lasts.

        A graze between two samples has a sign of its own.
        """
        contacts = self.story.contacts
        recent = contacts.recent(time, marks.mark_lasts(self._speed))
        for row in recent:
            age = time - float(contacts.began[row])
            marks.draw_flash(view, lens, contacts.place[row], age, self._speed)
        for row in np.union1d(recent, contacts.present(time)):
            draw = marks.draw_graze if contacts.swept[row] else marks.draw_contact
            draw(view, lens, contacts.place_at(int(row), time))

    def _trails(self, time: float, pose: FloatArray) -> FloatArray:
        """Return the robots' places of the last seconds, (N, T, 2) [m], old to new."""
        first = int(np.ceil(max(time - theme.TRAIL, 0.0) / self._period - 1e-9))
        last = int(np.floor(time / self._period + 1e-9)) + 1
        places = np.concatenate((self._history[first:last], pose[None, :, :2]))
        return np.ascontiguousarray(places.transpose(1, 0, 2))

    def _write_labels(
        self,
        view: Image,
        lens: Lens,
        outlines: list[Outline[np.int32]],
        pair: Pair | None,
        targets: FloatArray,
    ) -> None:
        """Names of the robots in view, and the distance of the closest pair."""
        high, wide = view.shape[:2]
        shapes = [np.concatenate(outline.rings) / marks.ONE for outline in outlines]
        boxes = np.array([[*s.min(axis=0), *s.max(axis=0)] for s in shapes])
        aims = np.flatnonzero(np.isfinite(targets).all(axis=1))
        rings = targets[aims]
        keep_clear = np.concatenate((boxes, np.hstack((rings - 5.0, rings + 5.0))))
        tags, pictures = [], []
        if pair is not None:
            middle = lens.pixels(pair.points).mean(axis=0)
            span = float(np.hypot(*(pair.points[1] - pair.points[0]))) * lens.scale / 2.0
            text = metres(pair.distance) if pair.distance > 0.0 else "contact"
            pictures.append(sprite(text, theme.TEXT, theme.INK))
            reach = min(max(span * 0.2, 8.0), 30.0)
            key = -1 - pair.a * self.story.robots - pair.b  # another pair chooses anew
            tags.append(Tag(key, (middle[0], middle[1]), reach, _size(pictures[-1])))
        if len(boxes) <= NAMED:
            for index, box in enumerate(boxes):
                if box[2] < 0 or box[3] < 0 or box[0] > wide or box[1] > high:
                    continue
                pictures.append(sprite(self._names[index], theme.TEXT, theme.INK))
                middle = (box[:2] + box[2:]) / 2.0
                reach = float(np.hypot(*(shapes[index] - middle).T).max()) * 0.85
                tags.append(
                    Tag(
                        index,
                        (middle[0], middle[1]),
                        reach,
                        _size(pictures[-1]),
                        shapes[index] - middle,
                    )
                )
        owners = np.concatenate((np.arange(len(boxes)), aims))
        walls = lens.pixels(self._walls)
        middles = self._labels.place(tags, keep_clear, (wide, high), owners, walls)
        for tag, picture, at in zip(tags, pictures, middles, strict=True):
            line = leader(tag, at)
            if line is not None:
                cv2.polylines(view, [fixed(line)], False, theme.QUIET, 1, cv2.LINE_AA, theme.SHIFT)
            left, top = at - np.array(_size(picture)) / 2.0
            stamp(view, picture, round(left), round(top))


def _size(picture: tuple[Image, object]) -> tuple[int, int]:
    return picture[0].shape[1], picture[0].shape[0]
