"""What does not move: drawn in tiles, which are cut to the view, and whole.

The world whole is small beside the view, and in the view when the run is over. That last picture
shows where all robots went, where they touched and how they ended: a view that follows the cluster
would show little else than the end of the road.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import ArrayLike

from physim.analysis.metrics import Figures
from physim.drawing import palette
from physim.drawing.crowd import NAMED
from physim.drawing.items import Item, Level, items
from physim.drawing.labels import grown, overlaps
from physim.drawing.scene_model import pieces_of
from physim.drawing.timeline import NO_ROW, Moment, Timeline
from physim.drawing.video.canvas import (
    Box,
    Canvas,
    Fleet,
    Image,
    Lens,
    draw_contacts,
    draw_moved,
    draw_robots,
    draw_wheels,
)
from physim.drawing.video.text import BOLD, NORMAL, TEXT, shorten, sprite
from physim.geometry.shapes import FloatArray

TILE = 512
"""[px] edge of a tile"""
EDGE = 16
"""[px] drawn round a tile and cut off: lines that end at an edge are drawn blunt there"""
KEPT = 48
"""Tiles kept (48 MB): memory stays flat however large the world."""


class Ground(NamedTuple):
    """What does not move, in the order of drawing; world frame [m]."""

    items: Sequence[Item]
    extent: tuple[FloatArray, FloatArray]
    """lowest and highest x, y [m] of all of it, and of every place a robot went"""


def ground(timeline: Timeline) -> Ground:
    """Collect what does not move in a run."""
    scene = timeline.scene
    places, reach = timeline.record.pose[:, :, :2].reshape(-1, 2), scene.reach.max()
    low = np.minimum(scene.extent[0], places.min(axis=0) - reach)
    high = np.maximum(scene.extent[1], places.max(axis=0) + reach)
    if scene.moved:
        places = timeline.record.moving_pose[:, timeline.robots :, :2]
        reach = np.array([np.hypot(*one.rings[0].T).max() for one in scene.moved_shapes])[:, None]
        low = np.minimum(low, (places - reach).min(axis=(0, 1)))
        high = np.maximum(high, (places + reach).max(axis=(0, 1)))
    return Ground([item for item in items(scene) if item.level <= Level.WALL], (low, high))


def draw_ground(canvas: Canvas, ground: Ground, lens: Lens, small: bool = False) -> None:
    """Draw what does not move as seen through ``lens``.

    ``small``: what can be distinguished then, thin, without paths, and one area.
    """
    area = [item.colour for item in ground.items if item.level == Level.AREA][-1:]
    for item in ground.items:
        if item.width == 0.0:
            colour = area[0] if small and item.level == Level.AREA else item.colour
            canvas.fill([lens.pixels(ring) for ring in item.lines], colour)
        elif not (small and item.level == Level.PATH):
            _draw_lines(canvas, item, lens, 1.0 if small else 2.0 * item.width - 1.0)


def _draw_lines(canvas: Canvas, item: Item, lens: Lens, width: float) -> None:
    if item.dash is None:
        canvas.lines([lens.pixels(line) for line in item.lines], item.colour, width)
        return
    every = lens.pixels(pieces_of(item.lines))
    edge = canvas.box.size + width + 2
    seen = ((every.max(axis=1) >= -width - 2) & (every.min(axis=1) <= edge)).all(axis=1)
    length = np.hypot(*(every[:, 1] - every[:, 0]).T)
    before = np.concatenate(([0.0], np.cumsum(length)[:-1]))  # dashes go on round corners
    canvas.lines(_dashes(every[seen], before[seen], item.dash, edge), item.colour, width)


def _dashes(
    pieces: FloatArray, before: FloatArray, dash: tuple[float, float], edge: FloatArray
) -> FloatArray:
    """Cut pieces (M, 2, 2) [px] into dashes (D, 2, 2), those that a picture from 0 to ``edge`` (2,)
    [px] may show: a piece may be long beyond any bound."""
    period, cut = sum(dash), [np.zeros((0, 2, 2))]
    centre, far = edge / 2.0, float(np.hypot(*edge)) + period
    for (start, end), offset in zip(pieces, before, strict=True):
        length = float(np.hypot(*(end - start)))
        along = (end - start) / max(length, 1e-9)
        middle = float((centre - start) @ along)
        whole = max(0.0, (middle - far) // period) * period
        first = np.arange(whole - offset % period, min(length, middle + far), period)
        span = np.clip(np.stack((first, first + dash[0]), axis=1), 0.0, length)
        cut.append(start + span[span[:, 1] > span[:, 0]][:, :, None] * along)
    return np.concatenate(cut)


class Background:
    """Cuts the ground at one scale to any view; tiles are drawn when first seen."""

    def __init__(self, ground: Ground, scale: float) -> None:
        self._ground = ground
        self._scale = scale
        self._tile = lru_cache(KEPT)(self._drawn)

    def paint(self, view: Image, lens: Lens) -> None:
        """Fill ``view`` with the ground; ``lens`` has this background's scale."""
        left, top = -round(lens.x), -round(lens.y)
        high, wide = view.shape[:2]
        for row in range(top // TILE, (top + high - 1) // TILE + 1):
            for column in range(left // TILE, (left + wide - 1) // TILE + 1):
                tile = self._tile(column, row)
                x, y = column * TILE - left, row * TILE - top
                x0, x1 = max(x, 0), min(x + TILE, wide)
                y0, y1 = max(y, 0), min(y + TILE, high)
                view[y0:y1, x0:x1] = tile[y0 - y : y1 - y, x0 - x : x1 - x]

    def _drawn(self, column: int, row: int) -> Image:
        drawn = Canvas((TILE + 2 * EDGE, TILE + 2 * EDGE), palette.OUTSIDE)
        lens = Lens(self._scale, EDGE - column * TILE, EDGE - row * TILE)
        draw_ground(drawn, self._ground, lens)
        return drawn.pixels[EDGE:-EDGE, EDGE:-EDGE].copy()


POINTS = 1500
"""Points of a course, at most."""
TINY = 9.0
"""[px] length of a robot below which a dot stands for it"""
LINE, BORDER = TEXT + 6, 10
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
        self._timeline, self._ground, self._box, self._small = timeline, ground, box, small
        self.lens = Lens.whole(ground.extent, box.size, margin)

    @cached_property
    def _still(self) -> Image:
        canvas = Canvas((self._box.width, self._box.height), palette.OUTSIDE)
        draw_ground(canvas, self._ground, self.lens, self._small)
        return canvas.pixels

    def paint_small(self, canvas: Canvas, now: Moment, corners: FloatArray | None) -> None:
        """Draw robots as dots, and what the view shows, two ``corners`` (2, 2) [m], as a box."""
        canvas.pixels[:] = self._still
        order = np.arange(len(now.pose))
        if len(order) > NAMED:  # those in danger are over the others
            dangerous = np.array([*(mode.danger for mode in self._timeline.scene.modes), False])
            order = np.argsort(dangerous[now.modes], kind="stable")
        places = self.lens.pixels(now.pose[order, :2])
        _draw_dots(canvas.pixels, places, now.colours[order], 5 if len(order) <= NAMED else 2)
        moved = self.lens.pixels(now.moving_pose[len(order) :, :2])
        if len(moved):
            faces = list(map(palette.keyed, self._timeline.scene.moved_keys))
            for size, colours in ((7, [palette.WALL] * len(faces)), (5, faces)):
                _draw_dots(canvas.pixels, moved, colours, size)
        if corners is not None:
            (x0, y0), (x1, y1) = np.rint(self.lens.pixels(corners)).astype(int).tolist()
            canvas.frame(x0, y1, x1, y0, palette.INK)
        canvas.frame(0, 0, canvas.box.width - 1, canvas.box.height - 1, palette.RULE)

    def paint_end(self, view: Canvas, now: Moment, fleet: Fleet) -> None:
        """Draw the last moment, all that came before it, and notes; ``fleet`` are the robots."""
        timeline, lens, record = self._timeline, self.lens, self._timeline.record
        view.pixels[:] = self._still
        crowd = timeline.robots > NAMED
        rows = np.unique(np.linspace(0, len(record.pose) - 1, POINTS).astype(int))
        for robot, course in enumerate(record.pose[rows][:, :, :2].transpose(1, 0, 2)):
            colour = palette.BAND if crowd else palette.robot_colour(robot)
            view.lines(lens.pixels(course)[None], colour, 1.0 if crowd else 3.0)
        contacts, moving = timeline.contacts, now.moving_pose
        touching = contacts.touching(now.time, len(moving))
        faces = list(map(palette.keyed, timeline.scene.moved_keys))
        draw_moved(view, fleet, lens, moving, faces, touching)
        if 2.0 * float(timeline.scene.reach.max()) * lens.scale >= TINY:
            draw_robots(view, fleet, lens, now.pose, now.colours, touching)
            draw_wheels(view, lens, timeline.scene.wheels_at(now.pose, now.steering), now.colours)
        else:
            edges = np.where(touching[: len(now.pose), None], palette.CONTACT, palette.INK)
            for size, colours in ((7, edges), (5, now.colours)):
                _draw_dots(view.pixels, lens.pixels(now.pose[:, :2]), colours, size)
        if len(contacts.began):
            places = lens.pixels(contacts.places[contacts.first])
            for swept in (True, False):
                draw_contacts(view, places[contacts.swept == swept], swept, small=True)
            draw_contacts(view, places[np.isfinite(contacts.deep)], False, deep=True)
        span = f"{timeline.begin:.1f} to " if timeline.begin else ""
        title = f"the whole run, {span}{timeline.duration:.1f} s: where the robots went"
        boxes = fleet.boxes(lens.pixels(fleet.placed(moving)))
        write_corner(view, [title, *notes(timeline)], grown(boxes, 3.0))


def _draw_dots(image: Image, places: FloatArray, colours: ArrayLike, size: int) -> None:
    """Draw squares of so many pixels at places (N, 2) [px], later ones over earlier ones."""
    y, x = np.mgrid[:size, :size].reshape(2, -1) - size // 2
    high, wide = image.shape[:2]
    column, row = np.rint(places).astype(int).T[:, :, None]
    colours = np.asarray(colours)[:, None]
    image[(row + y).clip(0, high - 1), (column + x).clip(0, wide - 1), :3] = colours


def write_corner(view: Canvas, lines: Sequence[str], bodies: FloatArray) -> None:
    """Write lines, the first one bold, at the side of a view where they cover the least.

    First of ``bodies``, boxes (N, 4) [px] of the robots they speak of, then of all that is drawn;
    in a corner where that covers no more.
    """
    wide, high = view.size
    room = max(round(WIDEST * wide), min(wide - 2 * BORDER, LEAST))
    words = [
        sprite(shorten(line, TEXT, room), TEXT, palette.INK, NORMAL if k else BOLD, halo=True)
        for k, line in enumerate(lines)
    ]
    width, tall = max(word.size[0] for word in words), LINE * len(words)
    ends = BORDER, high - BORDER - tall
    empty = (view.pixels[..., :3] == palette.OUTSIDE).all(axis=2)

    def covered(place: tuple[int, int]) -> tuple[float, int, bool]:
        left, top = place
        box = np.array([[left, top, left + width, top + tall]], float)
        hidden = float(overlaps(box, bodies).sum())
        drawn = int((~empty[top : top + tall, left : left + width]).sum())
        return hidden, drawn, top not in ends

    sides = BORDER, wide - BORDER - width
    tops = *ends, *range(BORDER, max(ends), LINE)
    left, top = min(((x, y) for y in tops for x in sides), key=covered)
    for k, word in enumerate(words):
        view.stamp(word, left, top + k * LINE)


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
