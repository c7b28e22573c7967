"""The picture of 1280 x 720 pixels: its parts, the map from the world to it, lines and marks.

matplotlib's Agg renderer draws what is smooth, numpy what goes along rows and columns of pixels.
Lengths are pixels of the picture, y goes down, and whole numbers are the middles of pixels.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Self

import numpy as np
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.path import Path
from matplotlib.transforms import Bbox
from numpy.typing import NDArray

from physim.drawing import palette
from physim.drawing.labels import number
from physim.drawing.palette import Colour
from physim.drawing.scene_model import Shape
from physim.drawing.video.text import ABOVE, LEFT, NORMAL, TEXT, Sprite, sprite, width
from physim.geometry.shapes import FloatArray, IntArray

Image = NDArray[np.uint8]
Colours = Sequence[Colour] | NDArray[Any]
"""(n, 3) from 0 to 255"""
WIDTH, HEIGHT = 1280, 720
PANEL_WIDTH, STRIP_HEIGHT = 272, 184

TRAIL, SHORT_TRAIL = 10.0, 2.0
"""[s] simulated length of a trail, and of one in a crowd, where robots follow close behind"""
FLASH = 0.5
"""[s of video] length of the flash at a contact"""
MARK = 1.0
"""[s] least simulated time that the mark of a contact stays, and at least FLASH of video"""
LONGEST = 150
"""[px] a scale bar is at most so long"""


class Box(NamedTuple):
    """A rectangle of pixels."""

    left: int
    top: int
    width: int
    height: int

    @property
    def size(self) -> FloatArray:
        """Width and height (2,)."""
        return np.array([self.width, self.height], dtype=np.float64)

    def of(self, image: Image) -> Image:
        """Return the part of ``image`` in this box, as a view."""
        return image[self.top : self.top + self.height, self.left : self.left + self.width]


VIEW = Box(0, 0, WIDTH - PANEL_WIDTH, HEIGHT - STRIP_HEIGHT)
PANEL = Box(VIEW.width, 0, PANEL_WIDTH, HEIGHT)
STRIP = Box(0, VIEW.height, VIEW.width, STRIP_HEIGHT)


class Lens(NamedTuple):
    """World to pixels: scale [px/m], and the world's origin in pixels of the view (y down)."""

    scale: float
    x: float
    y: float

    @classmethod
    def whole(cls, extent: tuple[FloatArray, FloatArray], size: FloatArray, margin: float) -> Lens:
        """Return the map that shows all of an extent [m] in the middle of a size (2,) [px]."""
        low, high = extent
        scale = float(((size - 2.0 * margin) / np.maximum(high - low, 1e-6)).min())
        x, y = size / 2.0 + np.array([-0.5, 0.5]) * (low + high) * scale
        return cls(scale, float(round(x)), float(round(y)))

    def pixels(self, points: FloatArray) -> FloatArray:
        """Return points (…, 2) [m] as pixels (…, 2)."""
        found: FloatArray = np.asarray(points) * self.scale
        found[..., 0] += self.x  # column by column, three times as fast as both at once
        np.subtract(self.y, found[..., 1], out=found[..., 1])
        return found

    def matrix(self) -> FloatArray:
        """Return the map as a matrix (3, 3)."""
        return np.array([[self.scale, 0.0, self.x], [0.0, -self.scale, self.y], [0.0, 0.0, 1.0]])


AS_IS, NOWHERE = np.eye(3), np.zeros((1, 2))
TURNS = np.linspace(0.0, 2.0 * np.pi, 33)


class Line(NamedTuple):
    """What Agg reads of a `matplotlib.path.Path`, which takes ten times as long to make."""

    vertices: FloatArray
    """(n, 2)"""
    codes: NDArray[np.uint8] | None = None
    """(n,) those of such a path"""
    should_simplify: bool = False
    simplify_threshold: float = 0.0


DISC = Line(np.column_stack((np.cos(TURNS), np.sin(TURNS))))


class Canvas:
    """A picture to draw in, or a part of one, at whose edges what is drawn ends."""

    def __init__(self, size: tuple[int, int], colour: Colour = palette.WHITE) -> None:
        """``size`` is width and height [px]."""
        self._agg: Any = RendererAgg(*size, 72)  # type: ignore[no-untyped-call]
        buffer = self._agg.buffer_rgba()  # type: ignore[no-untyped-call]
        self._whole: Image = np.asarray(buffer)
        self._take(Box(0, 0, *size))
        self.pixels[:] = (*colour, 255)

    def _take(self, box: Box) -> None:
        high = len(self._whole)
        self.box = box
        self.pixels = box.of(self._whole)
        """(h, w, 4): red, green, blue, and 255"""
        self._gc = self._agg.new_gc()
        self._gc.set_capstyle("round")
        self._gc.set_snap(False)
        bottom = high - box.top - box.height
        self._gc.set_clip_rectangle(Bbox.from_bounds(box.left, bottom, box.width, box.height))
        x, y = box.left + 0.5, high - box.top - 0.5
        self._placed = np.array([[1.0, 0.0, x], [0.0, -1.0, y], [0.0, 0.0, 1.0]])

    def part(self, box: Box) -> Self:
        """Return a part of this picture, to draw in by its own pixels."""
        part = type(self).__new__(type(self))
        part._agg, part._whole = self._agg, self._whole
        left, top = self.box.left + box.left, self.box.top + box.top
        part._take(Box(left, top, box.width, box.height))
        return part

    @property
    def size(self) -> tuple[int, int]:
        """Width and height [px]."""
        return self.box.width, self.box.height

    def draw(
        self,
        paths: Sequence[Line],
        faces: Colours = (),
        edges: Colours = (),
        widths: Sequence[float] | FloatArray = (1.0,),
        *,
        turned: FloatArray = AS_IS[None],
        lens: FloatArray = AS_IS,
        at: FloatArray = NOWHERE,
    ) -> None:
        """Draw paths filled in colours ``faces``, with lines in colours ``edges``, one by one.

        ``turned`` (n, 3, 3) and then ``lens`` (3, 3) take their points to pixels, and ``at`` (n, 2)
        is added. What there are fewer of than of the longest begins again.
        """
        self._agg.draw_path_collection(
            self._gc, self._placed @ lens, paths, turned, at * (1.0, -1.0), AS_IS,
            _shares(faces), _shares(edges), widths, [(0, None)], [True], [None], "screen",
        )  # fmt: skip

    def lines(
        self,
        lines: Sequence[FloatArray] | FloatArray,
        colour: Colour,
        width: float,
        closed: bool = False,
    ) -> None:
        """Draw lines (n, 2) of one colour and width."""
        if len(lines):
            self.draw([joined(lines, closed)], edges=[colour], widths=[width])

    def fill(self, rings: Sequence[FloatArray], colour: Colour) -> None:
        """Fill rings (n, 2); of one that goes round another the other way, what is between them."""
        if len(rings):
            self.draw([joined(rings, closed=True)], faces=[colour])

    def discs(
        self,
        at: FloatArray,
        radius: float,
        face: Colour | None,
        edge: Colour | None = None,
        width: float = 1.0,
    ) -> None:
        """Draw discs round middles (n, 2), filled, with an edge, or both."""
        if len(at):
            faces, edges = ([] if colour is None else [colour] for colour in (face, edge))
            scaled = np.diag((radius, radius, 1.0))[None]
            self.draw([DISC], faces, edges, [width], turned=scaled, at=at)

    def area(self, left: int, top: int, right: int, bottom: int, colour: Colour) -> None:
        """Fill a rectangle from its first to its last column and row."""
        part = np.s_[max(top, 0) : max(bottom + 1, 0), max(left, 0) : max(right + 1, 0)]
        self.pixels[part] = (*colour, 255)

    def frame(self, left: int, top: int, right: int, bottom: int, colour: Colour) -> None:
        """Draw a line of one pixel along the edges of a rectangle."""
        for y in (top, bottom):
            self.area(left, y, right, y, colour)
        for x in (left, right):
            self.area(x, top, x, bottom, colour)

    def write(
        self,
        text: str,
        at: tuple[float, float],
        size: int,
        *,
        colour: Colour = palette.INK,
        weight: str = NORMAL,
        anchor: str = "left",
    ) -> None:
        """Write a text with its baseline at (x, y); ``anchor``: left, middle, right."""
        share = {"left": 0.0, "middle": 0.5, "right": 1.0}[anchor]
        x = round(at[0] - share * width(text, size, weight))
        self.stamp(sprite(text, size, colour, weight), x - LEFT, round(at[1]) - size - ABOVE)

    def stamp(self, picture: Sprite, left: int, top: int) -> None:
        """Blend a text into the picture with its corner at (left, top)."""
        wide, high = picture.size
        y0, y1 = max(top, 0), min(top + high, self.box.height)
        x0, x1 = max(left, 0), min(left + wide, self.box.width)
        if y0 >= y1 or x0 >= x1:
            return
        part = np.s_[y0 - top : y1 - top, x0 - left : x1 - left]
        blended = self.pixels[y0:y1, x0:x1] * picture.transparency[part]
        blended += picture.colour[part]
        self.pixels[y0:y1, x0:x1] = blended


def joined(lines: Sequence[FloatArray] | FloatArray, closed: bool = False) -> Line:
    """Return lines (n, 2) as one."""
    if closed:
        lines = [np.concatenate((line, line[:1])) for line in lines]
    codes = _codes(tuple(map(len, lines)), closed)
    return Line(np.concatenate(lines), codes)


@functools.lru_cache(maxsize=256)
def _codes(lengths: tuple[int, ...], closed: bool) -> NDArray[np.uint8]:
    ends = np.cumsum(lengths)
    codes = np.full(ends[-1], Path.LINETO, np.uint8)
    codes[[0, *ends[:-1]]] = Path.MOVETO
    if closed:
        codes[ends - 1] = Path.CLOSEPOLY
    return codes


def _shares(colours: Colours) -> FloatArray:
    """Colours as (n, 4) from 0 to 1, opaque."""
    if isinstance(colours, np.ndarray):
        return np.column_stack((colours / 255.0, np.ones(len(colours))))
    return _shares_of(tuple(colours))


@functools.lru_cache(maxsize=256)
def _shares_of(colours: tuple[Colour, ...]) -> FloatArray:
    return _shares(np.array(colours, float).reshape(-1, 3))


# Lines


def draw_progress(canvas: Canvas, left: int, right: int, y: int, share: float) -> None:
    """Draw a bar of which a share is done."""
    canvas.area(left, y - 2, right, y + 2, palette.FAINT)
    canvas.area(left, y - 2, left + round((right - left) * share), y + 2, palette.QUIET)


def draw_scale(canvas: Canvas, left: int, y: int, scale: float) -> None:
    """Draw a bar at ``left``, ``y`` [px] for a scale [px/m], and its length beside it.

    The length is the greatest of 1, 2, 5 × a power of ten [m] with room for it.
    """
    most = LONGEST / scale
    decade = 10.0 ** math.floor(math.log10(most))
    length = next(factor * decade for factor in (5.0, 2.0, 1.0, 0.5) if factor * decade <= most)
    end = left + round(length * scale)
    canvas.area(left, y - 1, end, y, palette.INK)
    for x in (left, end):
        canvas.area(x - 1, y - 5, x, y + 5, palette.INK)
    canvas.write(f"{number(length, length)} m", (end + 10, y + 5), TEXT)


# Marks

CORNERS = np.array([[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]])
"""of the diamond of a swept contact"""
ARMS = np.array([[[-1.0, -1.0], [1.0, 1.0]], [[-1.0, 1.0], [1.0, -1.0]]])
"""of the cross of a contact"""


class Fleet:
    """All that moves: paths to draw, and their vertices, which are placed in one go a frame."""

    def __init__(self, shapes: Sequence[Shape]) -> None:
        self.shapes = shapes
        each = {id(one): (joined(one.rings, True), joined([one.mark], True)) for one in shapes}
        self.paths = [each[id(one)] for one in shapes]
        """of each body its outline and its mark, in its frame"""
        bodies = [np.concatenate(one.rings) for one in shapes]
        self._points = np.concatenate(bodies)
        self._start = np.cumsum([0, *map(len, bodies)])
        self._owner = np.repeat(np.arange(len(bodies)), np.diff(self._start))

    def placed(self, pose: FloatArray) -> FloatArray:
        """Return the vertices of all outlines (V, 2) [m] in the world frame for poses (N, 3)."""
        c, s = np.cos(pose[:, 2]).take(self._owner), np.sin(pose[:, 2]).take(self._owner)
        x, y = self._points.T
        turned = np.stack((c * x - s * y, s * x + c * y), axis=1)
        return turned + pose[:, :2].take(self._owner, axis=0)

    def outline(self, vertices: FloatArray, robot: int) -> FloatArray:
        """Return those (n, 2) of vertices (V, 2) that are of one robot."""
        return vertices[self._start[robot] : self._start[robot + 1]]

    def boxes(self, vertices: FloatArray) -> FloatArray:
        """Return left, top, right, bottom (N, 4) [px] of robots, of vertices (V, 2) [px]."""
        low = np.minimum.reduceat(vertices, self._start[:-1], axis=0)
        high = np.maximum.reduceat(vertices, self._start[:-1], axis=0)
        return np.concatenate((low, high), axis=1)


def draw_robots(
    canvas: Canvas,
    fleet: Fleet,
    lens: Lens,
    pose: FloatArray,
    colours: NDArray[Any],
    touching: NDArray[np.bool_],
    seen: IntArray | None = None,
) -> None:
    """Draw robots, or those ``seen``, at poses (N, 3) in colours (N, 3) of their modes.

    One that touches something is over the others, with a firm outline in the contact colour.
    """
    robots = np.arange(len(pose)) if seen is None else seen
    robots = robots[np.argsort(touching[robots], kind="stable")]
    colour, turned = colours[robots], _turned(pose[robots])
    firm = touching[robots]
    edges = np.where(firm[:, None], palette.CONTACT, 0.4 * colour)
    canvas.draw(
        [path for robot in robots.tolist() for path in fleet.paths[robot]],
        np.stack((colour, np.full_like(colour, 255)), axis=1).reshape(-1, 3),
        np.repeat(edges, 2, axis=0),
        np.stack((np.where(firm, 4.0, 1.0), np.zeros(len(robots))), axis=1).ravel(),
        turned=np.repeat(turned, 2, axis=0),
        lens=lens.matrix(),
    )


def draw_wheels(
    canvas: Canvas, lens: Lens, wheels: Mapping[int, FloatArray], colours: NDArray[Any]
) -> None:
    """Draw front wheels, lines (2, 2, 2) [m] by car, of robots in colours (N, 3)."""
    for car, lines in wheels.items():
        edge = tuple((0.4 * colours[car]).astype(int).tolist())
        canvas.lines(lens.pixels(lines), edge, 3.0)


def draw_moved(
    canvas: Canvas,
    fleet: Fleet,
    lens: Lens,
    pose: FloatArray,
    faces: Sequence[Colour],
    touching: NDArray[np.bool_],
) -> None:
    """Draw what moves beside robots, the last of a fleet, at poses (B, 3) in colours ``faces``.

    Without marks of headings, and with firm outlines, in the contact colour of what touches.
    """
    first = len(pose) - len(faces)
    edges = [palette.CONTACT if one else palette.WALL for one in touching[first:].tolist()]
    if faces:
        canvas.draw(
            [outline for outline, _ in fleet.paths[first:]], faces, edges,
            np.where(touching[first:], 4.0, 2.0), turned=_turned(pose[first:]), lens=lens.matrix(),
        )  # fmt: skip


def draw_ghosts(canvas: Canvas, fleet: Fleet, lens: Lens, pose: FloatArray) -> None:
    """Draw the outlines of robots at poses (N, 3): where those of another run are."""
    canvas.draw(
        [outline for outline, _ in fleet.paths], edges=[palette.QUIET], widths=[2.0],
        turned=_turned(pose), lens=lens.matrix(),
    )  # fmt: skip


def _turned(pose: FloatArray) -> FloatArray:
    """Poses (n, 3) as matrices (n, 3, 3) from the frames of robots to the world."""
    c, s, turned = np.cos(pose[:, 2]), np.sin(pose[:, 2]), np.zeros((len(pose), 3, 3))
    turned[:, 0, 0], turned[:, 0, 1], turned[:, 0, 2] = c, -s, pose[:, 0]
    turned[:, 1, 0], turned[:, 1, 1], turned[:, 1, 2] = s, c, pose[:, 1]
    turned[:, 2, 2] = 1.0
    return turned


def draw_trails(
    canvas: Canvas,
    trails: FloatArray,
    colours: Sequence[Colour],
    bands: int,
    width: float = 3.0,
) -> None:
    """Draw where robots went, (N, T, 2) [px], old to new, fading in steps.

    ``colours`` are one for each, or one for all.
    """
    count, paths, edges = trails.shape[1] - 1, [], []
    for band in range(bands):
        first, last = band * count // bands, (band + 1) * count // bands
        if last > first and len(trails):
            pieces, fade = trails[:, first : last + 1], 0.85 * (1.0 - (band + 1) / bands)
            paths += [joined(pieces)] if len(colours) == 1 else list(map(Line, pieces))
            edges += [palette.mix(colour, palette.SAFE_AREA, fade) for colour in colours]
    if paths:
        canvas.draw(paths, edges=edges, widths=[width])


def draw_targets(canvas: Canvas, robots: FloatArray, targets: FloatArray) -> None:
    """Draw targets (N, 2) as small rings, joined to their robots (N, 2) by thin lines; all [px]."""
    known = np.isfinite(targets).all(axis=1)
    canvas.lines(np.stack((robots[known], targets[known]), axis=1), palette.QUIET, 1.0)
    canvas.discs(targets[known], 3.0, palette.WHITE, palette.INK)


def draw_closest(canvas: Canvas, points: FloatArray) -> None:
    """Join the closest points (2, 2) [px] of two bodies."""
    canvas.lines(points[None], palette.WHITE, 6.0)
    canvas.lines(points[None], palette.INK, 3.0)
    canvas.discs(points, 3.0, palette.INK)


def draw_ring(canvas: Canvas, centre: FloatArray, radius: float, width: float) -> None:
    """Draw a ring in the contact colour round ``centre`` (2,), all [px]."""
    canvas.discs(centre[None], radius, None, palette.WHITE, width + 3.0)
    canvas.discs(centre[None], radius, None, palette.CONTACT, width)


def draw_contacts(
    canvas: Canvas, centres: FloatArray, swept: bool, small: bool = False, deep: bool = False
) -> None:
    """Draw crosses of contacts, or open diamonds of swept ones, at ``centres`` (C, 2) [px].

    Of those that are too ``deep`` to be physical the cross is white on a disc.
    """
    centres = centres[np.isfinite(centres).all(axis=1)]
    shape, arm, width = ARMS, 4.0 if small else 7.0, 2.5 if small else 4.5
    colours = [(palette.WHITE, width + 3.0), (palette.CONTACT, width)]
    if deep:
        canvas.discs(centres, 13.0, palette.WHITE)
        canvas.discs(centres, 11.0, palette.CONTACT)
        arm, colours = 5.0, [(palette.WHITE, 3.0)]
    elif swept:
        shape, arm, width = CORNERS[None], 5.0 if small else 9.0, 2.5 if small else 3.5
        colours = [(palette.WHITE, width + 3.0), (palette.CONTACT, width)]
    lines = (centres[:, None, None] + arm * shape).reshape(-1, *shape.shape[1:])
    for colour, width in colours:
        canvas.lines(lines, colour, width, closed=swept and not deep)
