"""The panel beside the view: time, speed, contacts, distances, legend, scale bar."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from physim.drawing import palette
from physim.drawing.crowd import NAMED
from physim.drawing.drivers import MOST_DRIVERS, owner_of
from physim.drawing.items import PUSHED, Item
from physim.drawing.palette import Colour, rgb
from physim.drawing.scene_model import shape
from physim.drawing.timeline import Moment, Timeline
from physim.drawing.video.canvas import (
    SHORT_TRAIL,
    TRAIL,
    Box,
    Canvas,
    Fleet,
    Image,
    Lens,
    draw_closest,
    draw_contacts,
    draw_moved,
    draw_progress,
    draw_ring,
    draw_robots,
    draw_scale,
    draw_targets,
    draw_trails,
)
from physim.drawing.video.ground import Ground
from physim.drawing.video.text import BOLD, SMALL, TEXT, TITLE, shorten, width, wrapped
from physim.drawing.video.view import Pair
from physim.errors import plural
from physim.geometry.shapes import FloatArray
from physim.parts.declarations import Mode
from physim.units import amount, true_minus

Sign = Callable[[Canvas, FloatArray], None]
"""Draws a sign, of which the middle of the left edge (2,) [px] is given."""

PAD = 18
"""[px] beside and between what the legend shows"""
ROW, LEAST_ROW = 21, 15
"""[px] height of a line of the legend, and the least where there are many"""
SIGN, WIDE = 30, 22
"""[px] room for a sign, and its width"""
CLOCK, FIGURES = 70, 142
"""[px] tops of the clock and the figures"""
FIGURE, HEAD, SETTINGS = 22, 18, 15
"""[px] height of a line of figures, of the words above the modes, and of a line of settings"""
GAP = 6
"""[px] above the second and further groups of modes"""
SCALE = 74
"""[px] room below it for the scale bar"""
BELOW = 134
"""[px] room below the legend for the scale bar and a small overview"""
NO_MODES, NO_MODE = "robot; no modes are given", "robot without a mode"
DEEP = "too deep: not physical"
GROUND = (
    "path", "way of a mover", "reference path", "boundary", "obstacle", "safe area", "danger area",
    "accessible area",
)  # fmt: skip
"""What of the ground the legend explains, in its order"""
KEPT = ("safe area", "danger area")
"""What is so by the distance that a controller keeps"""
START, MIDDLE, END = np.array([[0.0, 0.0], [WIDE / 2.0, 0.0], [WIDE, 0.0]])
_BOX = shape([np.array([[-9.0, -5.5], [9.0, -5.5], [9.0, 5.5], [-9.0, 5.5]])])

# Legend


def signs(timeline: Timeline, ground: Ground, whole: bool = False) -> dict[str, Sign]:
    """Return the signs that can appear in the video of a record by their words, in order.

    ``whole``: in the picture of its end, where trails are those of the whole run.
    """
    contacts, crowd = timeline.contacts, timeline.robots > NAMED
    own, plural = (palette.BAND, "s") if crowd else (palette.robot_colour(0), "")
    last = f"last {SHORT_TRAIL if crowd else TRAIL:g} s"
    course = f"trail{plural} of the whole run" if whole else f"trail{plural}, {last}"
    moving: dict[str, tuple[object, Sign]] = {
        NO_MODES: (timeline.modeless, _robot(own)),
        NO_MODE: (timeline.partly_modeless, _robot(palette.UNDECIDED)),
        "contact": (True, _contact()),
        "a contact begins": (
            contacts.began.size, lambda canvas, at: draw_ring(canvas, at + MIDDLE, 6.0, 2.0)
        ),
        DEEP: (np.isfinite(contacts.deep).any(), _contact(deep=True)),
        "contact between samples": (contacts.swept.any(), _contact(swept=True)),
        "closest pair": (
            timeline.moving > 1,
            lambda canvas, at: draw_closest(canvas, at + [[3.0, 0.0], [19.0, 0.0]]),
        ),
        "mover": (
            "mover" in timeline.scene.moved_keys,
            lambda canvas, at: draw_moved(
                canvas, Fleet([_BOX]), Lens(1.0, *(at + MIDDLE)), np.zeros((1, 3)),
                [palette.MOVER], np.zeros(1, bool),
            ),
        ),
        PUSHED: ("obstacle" in timeline.scene.moved_keys, _area(palette.OBSTACLE)),
        "target": (
            not crowd and timeline.aims,
            lambda canvas, at: draw_targets(canvas, at[None], at + END[None] - (4.0, 0.0)),
        ),
        course: (True, _line(own, 1.0 if crowd else 3.0) if whole else _trail(own)),
    }  # fmt: skip
    found = {words: sign for words, (there, sign) in moving.items() if there}
    for what in GROUND:
        if drawn := [item for item in ground.items if item.what == what]:
            words, sign = _of_items(drawn, plural)
            found[words + owner_of(timeline.drivers) * (what in KEPT)] = sign
    return found


def _of_items(drawn: Sequence[Item], plural: str) -> tuple[str, Sign]:
    """Words and sign of all items that are the same thing."""
    first = next((item for item in drawn if isinstance(item.key, int)), drawn[0])
    if first.width == 0.0:
        return first.what, _area(first.colour)
    dashed = any(item.dash for item in drawn)
    words = first.what if first.what != "path" else f"path{plural}"
    return (
        f"{words}, dashed in danger area" if dashed and first.what == "path" else words,
        _line(first.colour, 2.0 * first.width - 1.0, dashed),
    )


def draw_signs(
    canvas: Canvas,
    left: int,
    top: int,
    row: int,
    entries: Iterable[tuple[str, Sign]],
    room: int = 0,
) -> None:
    """Draw signs and their words, in ``room`` [px] if given, one a line of ``row`` [px]."""
    for k, (words, sign) in enumerate(entries):
        y = top + k * row + row / 2.0
        sign(canvas, np.array([left, y]))
        words = shorten(words, TEXT, room - SIGN) if room else words
        canvas.write(words, (left + SIGN, y + 5), TEXT)


class Group(NamedTuple):
    """A part of the legend: words, and below them modes and of whom they are counted."""

    words: list[str]
    modes: Sequence[int] = ()
    robots: Sequence[int] | None = None
    """all where it is None"""


def heads(groups: Sequence[Group]) -> int:
    """Height [px] of the words of groups."""
    return sum(GAP + HEAD + SETTINGS * (len(group.words) - 1) for group in groups) - GAP


def groupings(timeline: Timeline, room: int) -> Iterator[list[Group]]:
    """Groups for lines of ``room`` [px], the most telling first.

    Modes stand below their controller, each with its robots; where that is too much, all at once
    below few controllers.
    """
    setup, explained = timeline.record.setup, timeline.explained_modes
    drivers = timeline.drivers
    if not drivers:
        head = f"{'modes of' if explained else 'controller'} {setup.controller.name}"
        head = head if setup.judged is None else setup.controller.name
        beside = wrapped(setup.controller.set_to, SMALL, room, most=3)
        yield [Group([shorten(head, SMALL, room), *beside], explained)]
        return
    for most in (2, 1) if len(drivers) <= MOST_DRIVERS else ():
        yield [
            Group(wrapped(one.words, SMALL, room, most), one.modes, one.robots) for one in drivers
        ]
    together = [Group(["modes of all controllers"], explained)] if explained else []
    for count in range(min(len(drivers), MOST_DRIVERS), 0, -1):
        shown = [Group([shorten(one.words, SMALL, room)]) for one in drivers[:count]]
        if more := len(drivers) - count:
            shown.append(Group([f"and {plural(more, 'controller')} more"]))
        yield [*shown, *together]


def mode_signs(modes: Iterable[Mode]) -> list[tuple[str, Sign]]:
    """Return words and sign of each mode: a robot in its colour."""
    return [(str(mode), _robot(rgb(mode.colour))) for mode in modes]


def _robot(colour: Colour) -> Sign:
    def draw(canvas: Canvas, at: FloatArray) -> None:
        lens, pose = Lens(1.0, *(at + MIDDLE)), np.zeros((1, 3))
        draw_robots(canvas, Fleet([_BOX]), lens, pose, np.array([colour]), np.zeros(1, bool))

    return draw


def _contact(swept: bool = False, deep: bool = False) -> Sign:
    return lambda canvas, at: draw_contacts(canvas, at + MIDDLE[None], swept, deep=deep)


def _trail(colour: Colour) -> Sign:
    line: FloatArray = np.linspace(START, END, 13)[None]
    return lambda canvas, at: draw_trails(canvas, at + line, [colour], 12)


def _line(colour: Colour, width: float, dashed: bool = False) -> Sign:
    parts = ((0, 9), (12, 15), (19, 22)) if dashed else ((0, WIDE),)
    lines = np.array([[(start, 0.0), (end, 0.0)] for start, end in parts])
    return lambda canvas, at: canvas.lines(np.round(at) + lines, colour, width)


def _area(colour: Colour) -> Sign:
    def draw(canvas: Canvas, at: FloatArray) -> None:
        x, y = np.rint(at).astype(int).tolist()
        corners = x, y - 6, x + WIDE, y + 6
        canvas.area(*corners, colour)
        canvas.frame(*corners, palette.mix(colour, palette.INK, 0.25))

    return draw


# Panel


class Panel:
    """Draws the panel; all that stays the same is drawn once, and texts when they change."""

    def __init__(
        self,
        timeline: Timeline,
        ground: Ground,
        canvas: Canvas,
        scales: tuple[float, float],
        speed: float,
    ) -> None:
        """``canvas`` keeps what is painted in it, from one moment to the next.

        ``scales`` [px/m] are the view's, during the run and at its end.
        """
        self._timeline, self._canvas = timeline, canvas
        wide, high = canvas.size
        self._wide, self._right = wide, wide - PAD
        contacts = timeline.contacts
        lines = 3 + bool(len(contacts.began)) + bool(np.isfinite(contacts.deep).any())
        self._rule = FIGURES + 12 + lines * FIGURE
        legends = [
            signs(timeline, ground, over and scales[0] != scales[1]) for over in (False, True)
        ]
        for groups in groupings(timeline, self._right - PAD):
            modes = sum(len(group.modes) for group in groups)
            top, rows = self._rule + 8 + heads(groups), modes + len(legends[0])
            self._groups = groups
            if top + rows * LEAST_ROW + SCALE <= high:
                break
        self._row = max(LEAST_ROW, min(ROW, (high - top - BELOW) // max(rows, 1)))
        self._legend = top + modes * self._row + 12 * bool(modes)
        self._bar = top + rows * self._row + 12 * (1 + bool(modes))
        self.free = Box(PAD, self._bar + 36, self._right - PAD, high - self._bar - 50)
        """the part of the panel, in its own pixels, that is left for the whole map"""
        self._speed, self._scales, self._legends = speed, scales, legends
        self._over: bool | None = None
        self._still: Image = canvas.pixels[:0]
        self._shown: dict[Box, object] = {}

    def _draw_still(self, over: bool) -> Image:
        canvas = Canvas(self._canvas.size)
        record, room = self._timeline.record, self._right - PAD
        canvas.area(0, 0, 0, canvas.box.height, palette.RULE)
        canvas.write(shorten(record.name, TITLE, room, BOLD), (PAD, 32), TITLE, weight=BOLD)
        canvas.write(f"×{self._speed:g}", (self._right, CLOCK + 31), 20, colour=palette.QUIET,
              weight=BOLD, anchor="right")  # fmt: skip
        count = self._timeline.robots
        robots = "1 robot" if count == 1 else f"{count} robots"
        canvas.write(f"{robots}, seed {record.seed}", (PAD, 53), SMALL, colour=palette.QUIET)
        colour = palette.INK if self._timeline.drivers else palette.QUIET
        for group, top in self._placed():
            for k, line in enumerate(group.words, 1):
                y = top - HEAD + 10 - SETTINGS * (len(group.words) - k)
                canvas.write(line, (PAD, y), SMALL, colour=colour)
            modes = [self._timeline.scene.modes[mode] for mode in group.modes]
            draw_signs(canvas, PAD, top, self._row, mode_signs(modes), room - 30)
        rules = [self._rule, self._bar - 6]
        if any(group.modes for group in self._groups):
            rules.append(self._legend - 6)
        for y in rules:
            canvas.area(PAD, y, self._right, y, palette.RULE)
        draw_signs(canvas, PAD, self._legend, self._row, self._legends[over].items())
        draw_scale(canvas, PAD, self._bar + 14, self._scales[over])
        return canvas.pixels

    def _placed(self) -> Iterator[tuple[Group, int]]:
        """Every group, and the top [px] of its modes."""
        top = self._rule + 8 - GAP
        for group in self._groups:
            top += GAP + HEAD + SETTINGS * (len(group.words) - 1)
            yield group, top
            top += self._row * len(group.modes)

    def paint(self, now: Moment, pair: Pair | None) -> None:
        """Show one moment, with the closest pair of robots."""
        over = self._timeline.over(now.time)
        if over != self._over:
            self._over, self._shown = over, {}
            self._canvas.pixels[:] = self._still = self._draw_still(over)
        words = f"{now.time:.1f} s"
        if self._is_new(Box(PAD, CLOCK + 4, self._right - 60 - PAD, 38), words):
            self._canvas.write(words, (PAD, CLOCK + 32), 30, weight=BOLD)
        begin, end = self._timeline.begin, self._timeline.duration
        share = (now.time - begin) / max(end - begin, 1e-9)
        length = round((self._right - PAD) * share)
        if self._is_new(Box(PAD - 4, CLOCK + 46, self._right - PAD + 8, 9), length):
            draw_progress(self._canvas, PAD, self._right, CLOCK + 50, share)
        # judged by the motion; the legend counts who is in each mode, such as the paper's "arrived"
        every = self._timeline.arrived(now.time) == self._timeline.robots
        words = "finished" if every else ""
        self._show_line(53, "", words, palette.INK, size=SMALL, left=self._wide // 2)
        for row, (words, value, colour) in enumerate(self._figures(now, pair)):
            self._show_line(FIGURES + 12 + row * FIGURE, words, value, colour)
        for group, top in self._placed():
            theirs = now.modes if group.robots is None else now.modes[list(group.robots)]
            for k, mode in enumerate(group.modes):
                count = int((theirs == mode).sum())
                y = top + k * self._row + self._row // 2 + 5
                colour = palette.INK if count else palette.QUIET
                self._show_line(y, "", str(count), colour, left=self._right - 50)

    def _show_line(
        self, y: int, words: str, value: str, colour: Colour, size: int = TEXT, left: int = PAD
    ) -> None:
        """Show words and at the right end a value, with their baseline at ``y`` [px]."""
        box = Box(left, y - size + 1, self._wide - left, size + 4)
        if self._is_new(box, (words, value, colour)):
            self._canvas.write(words, (left, y), size, colour=palette.QUIET)
            self._canvas.write(value, (self._right, y), size, colour=colour, weight=BOLD,
                  anchor="right")  # fmt: skip

    def _is_new(self, box: Box, content: object) -> bool:
        """Whether a box is to show something else than it does; it is blank then."""
        if self._shown.get(box) == content:
            return False
        self._shown[box] = content
        box.of(self._canvas.pixels)[:] = box.of(self._still)
        return True

    def _figures(self, now: Moment, pair: Pair | None) -> Iterator[tuple[str, str, Colour]]:
        """Words, value and colour of every line of figures."""
        contacts, alarm = self._timeline.contacts, (palette.INK, palette.CONTACT)
        swept = contacts.swept_count(now.time)
        touched = contacts.count(now.time) - swept
        if contacts.swept.any():
            value = f"{touched}, {swept}"
            yield "contacts, between samples", value, alarm[touched + swept > 0]
        else:
            yield "contacts so far", str(touched), alarm[touched > 0]
        if np.isfinite(contacts.deep).any():
            deep = contacts.deep_count(now.time)
            yield "of them not physical", str(deep), alarm[deep > 0]
        if len(contacts.began):
            words, present = "touching now", contacts.present(now.time)
            value = "none"
            if len(present):  # the last that began, and how many others
                more = f" + {len(present) - 1}" if len(present) > 1 else ""
                a, b = contacts.bodies[present[-1]].tolist()
                value = self._both(a, b, words, more) + more
            yield words, value, alarm[len(present) > 0]
        if pair is not None:
            words, value = "closest now: ", true_minus(amount(pair.distance, "m"))
            words += self._both(pair.a, pair.b, words, value)
            yield words, value, alarm[pair.distance <= 0.0]
        wall = float(self._timeline.distances_at(np.array([now.sample]))[1].min())
        if np.isfinite(wall):
            yield "wall, closest now", true_minus(amount(wall, "m")), alarm[wall <= 0.0]
        if pair is None:
            deviation = float(self._timeline.record.course[now.sample, 0, 1])
            side = "left" if deviation >= 0.0 else "right"
            yield f"off its path now, {side}", amount(abs(deviation), "m"), palette.INK

    def _both(self, a: int, b: int, *beside: str) -> str:
        """Names of two bodies, cut so that they fit in one line with what stands ``beside``."""
        names, dash = [self._timeline.record.bodies[k].name for k in (a, b)], " – "
        free = self._right - PAD - 12 - sum(width(words, TEXT, BOLD) for words in (dash, *beside))
        one = shorten(names[0], TEXT, free // 2, BOLD)
        other = shorten(names[1], TEXT, free - width(one, TEXT, BOLD), BOLD)
        return one + dash + other
