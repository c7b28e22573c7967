"""One frame of the video, put together."""

from __future__ import annotations

from typing import TYPE_CHECKING

import cv2
import numpy as np

from physim.geometry.shapes import FloatArray, IntArray
from physim.video import legend, marks, theme
from physim.video.background import Background
from physim.video.camera import Camera, Lens, fixed
from physim.video.closest import Pair, closest_pair
from physim.video.ground import ground, plain
from physim.video.labels import Labels, Tag, leader
from physim.video.layout import arrange
from physim.video.overview import Overview
from physim.video.panel import Now, Panel, metres
from physim.video.robots import Fleet, Outline, draw_robot
from physim.video.story import Story
from physim.video.strip import Strip
from physim.video.text import Image, shorten, sprite, stamp

if TYPE_CHECKING:
    from physim.record import Record

NAMED = 60
"""Robots above which names would only hide the picture."""
LEAST_OVERVIEW = 24
"""[px] height below which the overview is left out"""
TRAIL_BANDS = 70
"""Steps in which trails fade, over all robots."""
TRAIL_STEPS = 60
"""Most places of a trail."""


class Painter:
    """Draws frames of one record at one playback speed.

    Only the places of labels depend on the frames drawn before (they glide); all else is a
    function of the time.
    """

    def __init__(self, record: Record, speed: float, fps: float) -> None:
        self.story = Story(record)
        self._speed = speed
        curves = self.story.curves
        self._layout = arrange(curves is not None)
        world = ground(self.story)
        view = self._layout.view
        self._camera = Camera(self.story, world.extent, view, speed)
        self._background = Background(world, self._camera.scale)
        self._fleet = Fleet(record.footprints)
        shown = legend.signs(self.story, world)
        self._panel = Panel(self.story, self._layout.panel, self._camera.scale, speed, shown)
        free = self._panel.free
        crowded = self._camera.whole or free.height < LEAST_OVERVIEW
        self._overview = None if crowded else Overview(plain(self.story, world), free)
        strip = self._layout.strip
        self._strip = Strip(self.story, curves, strip) if curves and strip else None
        self._labels = Labels()
        solid = [stroke.pieces for stroke in world.strokes if stroke.colour == theme.WALL]
        self._walls = np.concatenate(solid)
        self._names = [shorten(name, theme.TEXT, 110) for name in record.names]
        period = max(speed / fps, theme.TRAIL / TRAIL_STEPS)
        self._period = period
        grid = np.arange(int(self.story.duration / period) + 1) * period
        self._history = self.story.pose(grid)[:, :, :2]

    def frame(self, time: float) -> Image:
        """Return the picture (720, 1280, 3) uint8 RGB at ``time`` [s]."""
        story, record = self.story, self.story.record
        sample = int(story.sample(time))
        pose = story.pose(time)
        rows = story.decisions(time)
        vertices = self._fleet.placed(pose)
        pair = closest_pair(self._fleet.split(vertices), pose, self._fleet.reach)
        image = np.empty((theme.HEIGHT, theme.WIDTH, 3), np.uint8)
        lens = self._camera.lens(time)
        self._paint_view(self._layout.view.of(image), lens, time, pose, rows, vertices, pair)
        depth = float(np.min(record.clearance[sample]))
        wall = float(np.min(record.boundary_clearance[sample]))
        deviation = float(story.deviations(rows)[0])
        touched = story.contacts.count(time), story.contacts.grazes(time)
        now = Now(
            time, touched[0] - touched[1], touched[1], pair, depth, wall, story.modes(rows),
            story.arrived(time), deviation,
        )  # fmt: skip
        panel = self._layout.panel.of(image)
        self._panel.paint(panel, now)
        if self._overview is not None:
            box = self._layout.view
            half = np.array([box.width, box.height]) / 2.0 / lens.scale
            centre = self._camera.centre(time)
            corners = np.stack((centre - half, centre + half))
            free = self._panel.free.of(panel)
            self._overview.paint(free, corners, pose[:, :2], story.colours(rows))
        if self._strip is not None and self._layout.strip is not None:
            self._strip.paint(self._layout.strip.of(image), time, rows)
        return image

    def _paint_view(
        self,
        view: Image,
        lens: Lens,
        time: float,
        pose: FloatArray,
        rows: IntArray,
        vertices: FloatArray,
        pair: Pair | None,
    ) -> None:
        story = self.story
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
