"""The world whole: small beside the view, and in the view when the run is over.

That last picture shows where all robots went, where they touched and how they ended: a view that
follows the cluster would show little else than the end of the road.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
import shapely

from physim.analysis.metrics import Figures
from physim.drawing import palette
from physim.drawing.crowd import NAMED
from physim.drawing.labels import grown, overlaps
from physim.drawing.palette import Colour
from physim.drawing.timeline import NO_ROW, Moment, Timeline
from physim.drawing.video.canvas import (
    NORMAL,
    TEXT,
    Box,
    Image,
    Lens,
    draw_lines,
    fixed,
    shorten,
    size_of,
    sprite,
    stamp,
)
from physim.drawing.video.ground import Ground, draw_ground
from physim.drawing.video.marks import Fleet, draw_contacts, draw_robots
from physim.geometry.shapes import FloatArray

POINTS = 1500
"""Points of a course, at most."""
TINY = 9.0
"""[px] length of a robot below which a dot stands for it"""
LINE, EDGE = TEXT + 6, 10
"""[px] from one line of words to the next, and round them"""
WIDEST, LEAST = 0.7, 560
"""Share of the view that a line of words may take, and [px] that it may in a narrow one"""
ACROSS = 10.0
"""[deg] from the direction of its path at which a robot is said to stand across it"""
LATELY = 5.0
"""[s] before the end in which a contact or a mode of danger explains how a robot stands"""
MOST_NOTES = 5


class Whole:
    """Draws the whole world of a run into pictures of one size."""

    def __init__(
        self, timeline: Timeline, ground: Ground, box: Box, margin: float, small: bool = False
    ) -> None:
        """``margin`` [px] is free round the world; ``small`` leaves out what would blur."""
        self._timeline = timeline
        self.lens = Lens.whole(ground.extent, box.size, margin)
        self._ground = np.empty((box.height, box.width, 3), np.uint8)
        draw_ground(self._ground, ground, self.lens, small)

    def paint_small(self, image: Image, now: Moment, corners: FloatArray | None) -> None:
        """Draw robots as dots, and what the view shows, two ``corners`` (2, 2) [m], as a box."""
        image[:] = self._ground
        order = np.arange(len(now.pose))
        if len(order) > NAMED:  # those in danger are over the others
            dangerous = np.array([*(mode.danger for mode in self._timeline.scene.modes), False])
            order = np.argsort(dangerous[now.modes], kind="stable")
        colours = np.array(now.colours, np.uint8)[order]
        places = self.lens.pixels(now.pose[order, :2])
        _draw_dots(image, places, colours, 5 if len(order) <= NAMED else 2)
        if corners is not None:
            (x0, y0), (x1, y1) = np.rint(self.lens.pixels(corners)).astype(int).tolist()
            cv2.rectangle(image, (x0, y0), (x1, y1), palette.INK, 1)
        cv2.rectangle(image, (0, 0), (image.shape[1] - 1, image.shape[0] - 1), palette.RULE, 1)

    def paint_end(self, view: Image, now: Moment, fleet: Fleet) -> None:
        """Draw the last moment, all that came before it, and notes; ``fleet`` are the robots."""
        timeline, lens, record = self._timeline, self.lens, self._timeline.record
        view[:] = self._ground
        crowd = timeline.robots > NAMED
        rows = np.unique(np.linspace(0, len(record.pose) - 1, POINTS).astype(int))
        for robot, course in enumerate(record.pose[rows][:, :, :2].transpose(1, 0, 2)):
            colour = palette.BAND if crowd else palette.robot_colour(robot)
            draw_lines(view, fixed(lens.pixels(course))[None], colour, 1 if crowd else 2)
        contacts, vertices = timeline.contacts, lens.fixed(fleet.placed(now.pose))
        touching = contacts.touching(now.time, len(now.pose)).tolist()
        if 2.0 * float(timeline.scene.reach.max()) * lens.scale >= TINY:
            draw_robots(view, fleet.split(vertices), now.colours, touching)
        else:
            edges: list[Colour] = [palette.CONTACT if one else palette.INK for one in touching]
            for size, colours in ((7, edges), (5, now.colours)):
                places = lens.pixels(now.pose[:, :2])
                _draw_dots(view, places, np.array(colours, np.uint8), size)
        if len(contacts.began):
            places = lens.pixels(contacts.places[contacts.first])
            for swept in (True, False):
                draw_contacts(view, places[contacts.swept == swept], swept, small=True)
            draw_contacts(view, places[np.isfinite(contacts.deep)], False, deep=True)
        title = f"the whole run, {timeline.duration:.1f} s: where the robots went"
        write_corner(view, [title, *notes(timeline)], grown(fleet.boxes(vertices), 3.0))


def _draw_dots(image: Image, places: FloatArray, colours: Image, size: int) -> None:
    """Draw squares of so many pixels at places (N, 2) [px], later ones over earlier ones."""
    y, x = np.mgrid[:size, :size].reshape(2, -1) - size // 2
    high, wide = image.shape[:2]
    column, row = np.rint(places).astype(int).T[:, :, None]
    image[(row + y).clip(0, high - 1), (column + x).clip(0, wide - 1)] = colours[:, None]


def write_corner(view: Image, lines: Sequence[str], bodies: FloatArray) -> None:
    """Write lines, the first one bold, at the side of a view where they cover the least.

    First of ``bodies``, boxes (N, 4) [px] of the robots they speak of, then of all that is drawn;
    in a corner where that covers no more.
    """
    high, wide = view.shape[:2]
    room = max(round(WIDEST * wide), min(wide - 2 * EDGE, LEAST))
    words = [
        sprite(shorten(line, TEXT, room), TEXT, palette.INK, *(() if k == 0 else (NORMAL,)))
        for k, line in enumerate(lines)
    ]
    width, tall = max(size_of(word)[0] for word in words), LINE * len(words)
    ends = EDGE, high - EDGE - tall
    empty = (view == palette.OUTSIDE).all(axis=2)

    def covered(place: tuple[int, int]) -> tuple[float, int, bool]:
        left, top = place
        box = np.array([[left, top, left + width, top + tall]], float)
        hidden = float(overlaps(box, bodies).sum())
        drawn = int((~empty[top : top + tall, left : left + width]).sum())
        return hidden, drawn, top not in ends

    sides = EDGE, wide - EDGE - width
    tops = *ends, *range(EDGE, max(ends), LINE)
    left, top = min(((x, y) for y in tops for x in sides), key=covered)
    for k, word in enumerate(words):
        stamp(view, word, left, top + k * LINE)


def notes(timeline: Timeline) -> list[str]:
    """Return at most `MOST_NOTES` lines about robots, by index: what is odd at the end, and why."""
    record = timeline.record
    missing = {one.robot: one for one in Figures(record).absent}
    found: list[tuple[int, str]] = []
    for robot, angle in enumerate(_across(timeline).tolist()):
        name = record.names[robot]
        turned = f"{abs(angle):.0f}° across its path" if abs(angle) >= ACROSS else ""
        if robot in missing:
            said = missing[robot].is_astray or not turned
            found.append((robot, missing[robot].sentence(name) + ("" if said else f", {turned}")))
        elif turned:
            found.append((robot, f"{name} stands {turned}"))
    shown = found if len(found) <= MOST_NOTES else found[: MOST_NOTES - 1]
    lines = [f"{line}: {_why(timeline, k, arrived=k not in missing)}" for k, line in shown]
    more = len(found) - len(shown)
    return [*lines, f"and {more} robots more"] if more else lines


def _across(timeline: Timeline) -> FloatArray:
    """Angle (N,) [deg] from the direction of each robot's path to its heading at the end."""
    pose = timeline.record.pose[-1]
    lines = [shapely.LineString(path) for path in timeline.scene.paths]
    station = shapely.line_locate_point(lines, shapely.points(pose[:, :2]))
    length = shapely.length(lines)
    before, after = (
        shapely.get_coordinates(
            shapely.line_interpolate_point(lines, np.clip(station + by, 0.0, length))
        )
        for by in (-0.05, 0.05)
    )
    heading = np.arctan2(*(after - before).T[::-1])
    turned = (pose[:, 2] - heading + np.pi) % (2.0 * np.pi) - np.pi
    return np.asarray(np.degrees(turned))


def _why(timeline: Timeline, robot: int, arrived: bool) -> str:
    """What the record says about why a robot stands as it does at the end."""
    end, contacts = timeline.duration, timeline.contacts
    mine = np.flatnonzero((contacts.bodies == robot).any(axis=1))
    if len(mine) and contacts.ended[mine].max() >= end - LATELY:
        last = int(mine[np.argmax(contacts.ended[mine])])
        a, b = contacts.bodies[last].tolist()
        other = timeline.record.bodies[b if a == robot else a].name
        lasts = contacts.ended[last] > end + 1e-9
        when = f"since {contacts.began[last]:.1f}" if lasts else f"until {contacts.ended[last]:.1f}"
        return f"in contact with {other} {when} s"
    modes = timeline.scene.modes
    for time in np.arange(end, max(end - LATELY, 0.0), -0.1).tolist():
        mode = int(timeline.modes(timeline.decisions(time))[robot])
        if mode >= 0 and modes[mode].danger:
            return f"its mode was “{modes[mode]}” until {time:.1f} s"
    if timeline.decisions(end)[robot] == NO_ROW:
        return "it has not decided"
    return "to arrive is to stand at its station, however turned" if arrived else "no contact"
