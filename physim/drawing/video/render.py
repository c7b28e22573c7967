"""A record as a video, or as stills: of one run, or of two side by side at the same time.

Shows simulated time only: same record, same frames.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import PIL.Image

from physim.analysis.parting import is_branch, parting
from physim.drawing import palette
from physim.drawing.drivers import key_of, owner_of
from physim.drawing.palette import rgb
from physim.drawing.timeline import Timeline
from physim.drawing.video.canvas import (
    HEIGHT,
    PANEL,
    STRIP,
    VIEW,
    WIDTH,
    Box,
    Canvas,
    Image,
    draw_progress,
    draw_scale,
)
from physim.drawing.video.film import (
    MP4,
    Animation,
    VideoFile,
    check_length,
    check_still,
    kind_of,
    rate,
    resized,
    rgb_of,
    save_still,
    size_at,
)
from physim.drawing.video.ground import Whole, ground
from physim.drawing.video.panel import GROUND, KEPT, ROW, SIGN, Panel, draw_signs, mode_signs, signs
from physim.drawing.video.strip import Strip
from physim.drawing.video.text import BOLD, TEXT, TITLE, shorten, width
from physim.drawing.video.view import SHORT, Camera, View, smallest_length
from physim.errors import PhysimError
from physim.geometry.shapes import FloatArray
from physim.world.differences import differences, stages_apart

if TYPE_CHECKING:
    from physim.record import Record
    from physim.world import World

DISTANCES = 0.5
"""Share of the strip for the least distances, where there are any"""
LEAST_WHOLE = 24
"""[px] height below which the whole world is not shown beside the view"""


class Painter:
    """Draws frames of one run at one playback speed: the view, figures beside it and below.

    There is one picture; from frame to frame only the parts of it that change are drawn.
    """

    def __init__(self, timeline: Timeline, speed: float, fps: float) -> None:
        self.timeline, world = timeline, ground(timeline)
        self._canvas = Canvas((WIDTH, HEIGHT))
        self._view = View(timeline, world, VIEW, speed, fps)
        self._seen, panel = self._canvas.part(VIEW), self._canvas.part(PANEL)
        self._panel = Panel(timeline, world, panel, self._view.scales, speed)
        free, self._whole = self._panel.free, None
        if not self._view.camera.whole and free.height >= LEAST_WHOLE:
            self._whole = Whole(timeline, world, free, 5.0, small=True), panel.part(free)
        split = round(DISTANCES * STRIP.width) if timeline.distances.names else 0
        left, right = STRIP._replace(width=split), STRIP._replace(left=split)
        right = right._replace(width=STRIP.width - split)
        self._strips = [Strip(timeline, timeline.curves, self._canvas.part(right))]
        if split:
            self._strips.append(Strip(timeline, timeline.distances, self._canvas.part(left)))

    def paint(self, time: float) -> Image:
        """Return the picture at ``time`` [s], until the next is drawn."""
        now = self.timeline.at(time)
        pair = self._view.paint(self._seen, now)
        self._panel.paint(now, pair)
        if self._whole is not None:
            over = self.timeline.over(now.time)
            corners = None if over else self._view.camera.corners(now.time)
            whole, canvas = self._whole
            whole.paint_small(canvas, now, corners)
        for strip in self._strips:
            strip.paint(now)
        return self._canvas.pixels


HEADER, BARS, FOOTER = 62, 26, 78
"""[px] height of the titles above the two views, of the scale bars below them, and of time and
legend below these"""
PAD, GAP = 16, 3
BAR_END = WIDTH - 140
"""[px] where the bar of the time ends; then comes the sign of a contact"""
BARS_TOP = HEIGHT - FOOTER - BARS
BESIDE = 230
"""[px] from the left end of a scale bar to the first sign beside it"""
LEAST_WORDS = 24
"""[px] of a mode's words, however many there are"""
OUTCOME, ENDED = 200, 340
"""[px] at the right end of a header for what came of a run, and of one that ends first"""
BANNER = (33, 57)
"""[px] from top to bottom of what marks the header of such a run"""
PALE = 0.45
"""Share of white in its picture"""
MOST_NAMED = 2
"""Differing values of the two worlds that the titles name."""


class Beside:
    """Draws frames of two runs: the first on the left, the second on the right.

    The titles say in what the two worlds differ, and below them how the files are called. A branch
    is called that, with where it parts from its original, whose robots are outlines in it. Of a run
    that is over before the other its last picture stays, pale and marked as such; when both are
    over, either is shown whole.
    """

    def __init__(self, left: Timeline, right: Timeline, speed: float, fps: float) -> None:
        timelines = left, right
        self.begin, self.duration = _span([left, right])
        self._speed = speed
        half, high = (WIDTH - GAP) // 2, HEIGHT - HEADER - BARS - FOOTER
        boxes = Box(0, HEADER, half, high), Box(WIDTH - half, HEADER, half, high)
        self._grounds = [ground(timeline) for timeline in timelines]
        shown = [*zip(timelines, self._grounds, boxes, strict=True)]
        # the largest scale that both can have, unless a robot would be too small
        most = min(Camera(one, world.extent, box, speed).scale for one, world, box in shown)
        if min(map(smallest_length, timelines)) * most < SHORT:
            most = np.inf
        self._views = [View(one, world, box, speed, fps, most) for one, world, box in shown]
        self._is_branch = is_branch(right.record, left.record)
        if self._is_branch:
            self._views[1].ghosts = self._views[0]
        self._still = self._draw_still()
        self._canvas = Canvas((WIDTH, HEIGHT))
        self._parts = [self._canvas.part(box) for box in boxes]

    def paint(self, time: float) -> Image:
        """Return the picture at ``time`` [s], until the next is drawn."""
        canvas = self._canvas
        canvas.pixels[:] = self._still
        for view, part in zip(self._views, self._parts, strict=True):
            then = min(time, view.timeline.duration)
            held = view.timeline.over(time) and time < self.duration - 1e-9
            now = view.timeline.at(then)
            view.paint(part, now, held)
            if held:
                part.pixels[:] = PALE * 255.0 + (1.0 - PALE) * part.pixels
            self._outcome(canvas, view, now.time, then, held)
            over = view.timeline.over(now.time) and not held
            draw_scale(canvas, view.box.left + PAD, BARS_TOP + BARS // 2, view.scales[over])
        y = HEIGHT - FOOTER + 32
        canvas.write(f"{time:.1f} s", (PAD, y), 24, weight=BOLD)
        share = (time - self.begin) / max(self.duration - self.begin, 1e-9)
        draw_progress(canvas, PAD + 200, BAR_END, y - 8, share)
        return canvas.pixels

    def _outcome(self, canvas: Canvas, view: View, time: float, clock: float, held: bool) -> None:
        """What came of a run so far, at the right end of its title; of one ``held`` that it is.

        ``time`` is that of the view, told where the ``clock`` is ahead of it.
        """
        timeline, right = view.timeline, view.box.left + view.box.width - PAD
        count, end = timeline.contacts.count(time), timeline.duration
        colour = palette.CONTACT if count else palette.INK
        words = f"{count} contacts so far" if count != 1 else "1 contact so far"
        canvas.write(words, (right, 26), TITLE, colour=colour, weight=BOLD, anchor="right")
        words = f"{timeline.arrived(time)} of {timeline.robots} finished"
        if held:
            words = f"ended at {end:.1f} s, last picture: {words}"
            words = shorten(words, TEXT, ENDED - PAD, BOLD)
            left, (top, bottom) = right - width(words, TEXT, BOLD) - PAD // 2, BANNER
            canvas.area(left, top, right + PAD // 2 - 1, bottom - 1, palette.INK)
            canvas.write(words, (right, 50), TEXT, colour=palette.WHITE, weight=BOLD,
                  anchor="right")  # fmt: skip
            return
        if timeline.over(time) and end < self.duration:
            words = f"ended at {end:.1f} s, {words}"
        if time < clock - 1e-6:
            words = f"shown at {time:.1f} s: {words}"
        canvas.write(words, (right, 48), TEXT, colour=palette.QUIET, anchor="right")

    def _draw_still(self) -> Image:
        canvas = Canvas((WIDTH, HEIGHT))
        records = [view.timeline.record for view in self._views]
        named = titles(records[0].world, records[1].world)
        files = file_names(records[0].path, records[1].path)
        for view, title, name in zip(self._views, named, files, strict=True):
            record, left = view.timeline.record, view.box.left + PAD
            room = view.box.width - 2 * PAD
            words = f"{record.name}, seed {record.seed}"
            if drivers := view.timeline.drivers:
                words += f": {key_of(drivers)}"
            if title and name:
                words = f"{name}: {words}"
            if self._is_branch and view is self._views[0]:
                title = f"Original, {title}" if title else "Original"
            elif self._is_branch:
                title = f"Branch, {title or 'nothing changed'}"
                words = "outlines: original, from which it does not part"
                if parted := parting(records[0], record):
                    words = f"outlines: original; parted at {parted.time:.2f} s ({parted.name})"
            head = shorten(title or name, TITLE, room - OUTCOME, BOLD)
            canvas.write(head, (left, 26), TITLE, weight=BOLD)
            beside = ENDED if view.timeline.duration < self.duration else OUTCOME
            words = shorten(words, TEXT, room - beside)
            canvas.write(words, (left, 48), TEXT, colour=palette.QUIET)
        middle, top = WIDTH // 2, HEIGHT - FOOTER + 48
        for first, last in ((0, HEIGHT - FOOTER), (top, top + ROW)):
            canvas.area(middle - GAP // 2, first, middle + GAP // 2, last, palette.RULE)
        canvas.write(f"×{self._speed:g}", (PAD + 190, HEIGHT - FOOTER + 31), 17,
              colour=palette.QUIET, weight=BOLD, anchor="right")  # fmt: skip
        for view, world in zip(self._views, self._grounds, strict=True):
            timeline, left = view.timeline, view.box.left + PAD
            right, entries = view.box.left + view.box.width - PAD, signs(timeline, world)
            _draw_row(canvas, timeline, left, right, top)
            contact = [("contact", entries["contact"])]
            draw_signs(canvas, BAR_END + 2 * PAD, HEIGHT - FOOTER + 14, ROW, contact)
            left = view.box.left + BESIDE
            owner = owner_of(timeline.drivers)
            still = {word + owner if word in KEPT else word for word in (*GROUND, "mover")}
            ordered = [*reversed(entries)]
            ordered.sort(key=lambda word: word != "mover")
            for words in (word for word in ordered if word in still):
                wide = SIGN + width(words, TEXT)
                if left + wide <= right:  # of what stands still as many as have the room
                    entry = [(words, entries[words])]
                    draw_signs(canvas, left, BARS_TOP + (BARS - ROW) // 2, ROW, entry)
                    left += wide + PAD
        return canvas.pixels


def _draw_row(canvas: Canvas, timeline: Timeline, left: int, right: int, top: int) -> None:
    """Draw modes side by side, the longest cut so that all end before ``right`` [px]."""
    entries = mode_signs([timeline.scene.modes[k] for k in timeline.explained_modes])
    lengths = [width(words, TEXT) for words, _ in entries]
    room = right - left - len(entries) * (SIGN + PAD) + PAD
    most = max(lengths, default=0)
    while most > LEAST_WORDS and sum(min(length, most) for length in lengths) > room:
        most -= 1
    for entry, length in zip(entries, lengths, strict=True):
        draw_signs(canvas, left, top, ROW, [entry], SIGN + most)
        left += SIGN + min(length, most) + PAD


def titles(left: World, right: World) -> tuple[str, str]:
    """Say of two effective worlds in what they differ: a title for either.

    Each is one line: the values of the keys that differ; where they are many, the names of the
    worlds, or of worlds with one name how many and the first of them; empty where the worlds are
    the same.
    """
    found = differences(left, right)
    if len(found) > MOST_NAMED and left.name != right.name:
        return left.name, right.name
    stages = {
        f"{key}.{k}.": stage.type
        for world in (left, right)
        for key, listed in (("sensing.stages", world.sensing.stages), ("filters", world.filters),
                            ("disturbances", world.disturbances))
        for k, stage in enumerate(listed)
    }  # fmt: skip
    many, (rest, apart) = len(found), stages_apart(found)
    found, words = rest, []
    for key in found:  # of filters.0 not 0 alone
        parts = key.removesuffix(".type").split(".")
        last = max((k for k, part in enumerate(parts) if not part.isdigit()), default=0)
        whose = [name for at, name in stages.items() if key.startswith(at) and key != f"{at}type"]
        words.append(" ".join([*whose, ".".join(parts[last:])]))
    if len(set(words)) < len(words):
        words = list(found)
    named = list(zip(words, found.values(), strict=True))[:MOST_NAMED]
    count = f"{many} values, " if len(found) > len(named) else ""
    first, second = (
        count
        + ", ".join(
            [pair[side] for pair in apart] + [f"{word}: {pair[side]}" for word, pair in named]
        )
        for side in (0, 1)
    )
    return first, second


def file_names(left: Path | None, right: Path | None) -> tuple[str, str]:
    """Names by which the files of two records are told apart; empty where they have none.

    Of ``with/record.h5`` the name is that of the folder.
    """
    first, second = (
        "" if path is None else path.absolute().parent.name if path.stem == "record" else path.stem
        for path in (left, right)
    )
    return (first, second) if first != second else ("", "")


TILE = (560, 298)
"""[px] width and height of a close-up: shown at this size or somewhat less, names can be read"""
FPS = 25.0
"""of a still, in which labels are where they begin in a film"""
SPEEDS = (1, 2, 4, 5, 8)
"""Playback speeds of the first decade; the others are these times a power of ten."""
MOST_KEPT = 40
"""Colours of modes that a GIF is sure to have."""
HOLD = 1.5
"""[s of video] that the last picture stays, so that the end can be read"""


def playback_speed(duration: float, longest: float = MP4.longest) -> float:
    """Return simulated seconds per second of video: 1, 2, 4, 5, 8, 10, 20 …

    With it ``duration`` [s] takes at most ``longest`` [s of video].
    """
    speeds = (speed * 10.0**power for power in itertools.count() for speed in SPEEDS)
    return next(speed for speed in speeds if duration <= longest * speed * (1.0 + 1e-9))


def frame_times(start: float, end: float, fps: float, speed: float) -> FloatArray:
    """Return the simulated times of all frames (F,) [s].

    From ``start`` to ``end`` [s] inclusive; then the end again for `HOLD` seconds of video.
    """
    last = int(np.ceil((end - start) * fps / speed - 1e-6))
    frames = last + 1 + round(HOLD * fps)
    times: FloatArray = np.minimum(start + np.arange(frames) * (speed / fps), end)
    return times


def render(
    record: Record,
    path: Path | str,
    *,
    beside: Record | None = None,
    start: float = 0.0,
    end: float = math.inf,
    fps: float | None = None,
    speed: float | None = None,
    width: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    stop: Callable[[], bool] | None = None,
    cut_short: Path | str | None = None,
) -> int:
    """Write the video of a record and return the number of frames in it.

    With ``beside`` the two runs go on side by side, the second on the right, until both are over;
    titles say in what their worlds differ. ``start`` and ``end`` [s of simulated time] are those
    of the film; a start before that of the run, of two runs of the later, is the run's, and so is
    an end after its end.

    The suffix says what is made: H.264 in MP4 (yuv420p, 25 frames a second), GIF (20) or WebP
    (25), which play again and again, or what ``fps`` asks for. ``width`` is 1280 px, of GIF and
    WebP 800, or less. ``speed`` is simulated seconds per second of video; by default the least of
    1, 2, 4, 5, 8, 10, 20 … with which the film lasts at most 80 s (GIF, WebP: 20 s); then the
    last picture stays for 1.5 s, and so many more frames are counted. ``progress(done, total)`` is
    called after each frame. ``stop()`` is asked after each frame; once True, the file is
    completed with the frames so far, and named ``cut_short`` if that is given.

    The file appears under its name only when it is complete. Raises
    PhysimError (one line) when it cannot be written or nothing can be shown.
    """
    kind = kind_of(Path(path))
    fps, width = rate(kind, fps), kind.width if width is None else width
    size_at(width)
    timelines = _timelines(record, beside)
    begin, last = _span(timelines)
    is_early, start, end = start < 0.0, max(start, begin), min(end, last)
    if is_early or (not start < end and (start, end) != (begin, begin)):
        raise PhysimError(
            f"from {start:g} s to {end:g} s: nothing to show; the start must be at least 0 s and "
            f"before the end, and the run is from {begin:g} s to {last:g} s"
        )
    speed = _speed(speed, end - start, kind.longest)
    times = frame_times(start, end, fps, speed)
    film: VideoFile | Animation
    if kind.tick:
        check_length(len(np.unique(times)), width)
        # colours that say something must not be lost
        modes = [rgb(mode.colour) for one in timelines for mode in one.scene.modes]
        kept = [*palette.KEYS.values(), *modes[:MOST_KEPT], *palette.ROBOTS]
        film = Animation(path, fps, width, kept)
    else:
        film = VideoFile(path, fps, width)
    painter = _painter(timelines, speed, fps)
    done, drawn = 0, math.nan
    with film:
        for time in times.tolist():
            if time != drawn:
                drawn = time
                film.write(painter.paint(time))
            else:
                film.hold()
            done += 1
            if progress is not None:
                progress(done, len(times))
            if stop is not None and done < len(times) and stop():
                if cut_short is not None:
                    film.path = Path(cut_short).absolute()
                break
    return done


def frame_at(
    record: Record,
    time: float,
    *,
    beside: Record | None = None,
    fps: float = FPS,
    speed: float | None = None,
) -> Image:
    """Return the picture (720, 1280, 3) uint8 RGB of a record at ``time`` [s].

    It equals the video's frame of that time but for the places of names, which glide in a video;
    ``beside`` as for `render`. A time outside the record is taken to its nearer end. Raises
    PhysimError.
    """
    if not math.isfinite(time):
        raise PhysimError(f"time of a still: {time} given; allowed: a finite number of seconds")
    timelines = _timelines(record, beside)
    begin, end = _span(timelines)
    painter = _painter(timelines, _speed(speed, end - begin, MP4.longest), rate(MP4, fps))
    return rgb_of(painter.paint(min(max(float(time), begin), end)))


def close_up(record: Record, time: float, between: tuple[int, int] | None = None) -> Image:
    """Return a small picture (298, 560, 3) uint8 RGB of the robots at ``time`` [s], for a tile.

    With ``between`` it is about a robot and another body (ids), whose distance is marked.
    """
    timeline = Timeline(record)
    box = Box(0, 0, *TILE) if between is None else VIEW
    speed = _speed(None, timeline.duration, MP4.longest)
    view, now = View(timeline, ground(timeline), box, speed, FPS), timeline.at(time)
    view.between = between
    canvas = Canvas((box.width, box.height))
    marked = view.paint(canvas, now)
    middle = box.size / 2.0
    if between is not None and marked is not None:
        middle = view.camera.lens(now.time).pixels(marked.points).mean(axis=0)
    left, top = np.clip(middle - np.array(TILE) / 2.0, 0.0, box.size - TILE).astype(int).tolist()
    return rgb_of(Box(left, top, *TILE).of(canvas.pixels))


def still(
    record: Record,
    path: Path | str,
    time: float,
    *,
    beside: Record | None = None,
    speed: float | None = None,
    width: int | None = None,
) -> None:
    """Write the picture of a record at ``time`` [s] as PNG; the others as for `render`.

    Raises PhysimError (one line) for a time outside the run and for a place that
    cannot be written.
    """
    check_still(Path(path))
    size, (begin, end) = size_at(width or WIDTH), _span(_timelines(record, beside))
    if not begin - 1e-9 <= time <= end + 1e-9:
        raise PhysimError(f"{time:g} s is outside the run, which goes from {begin:g} to {end:g} s")
    image = frame_at(record, time, beside=beside, speed=speed)
    picture = resized(PIL.Image.fromarray(image), size)
    save_still(Path(path), np.asarray(picture))


def _timelines(record: Record, beside: Record | None) -> list[Timeline]:
    return [Timeline(record)] if beside is None else [Timeline(record), Timeline(beside)]


def _span(timelines: list[Timeline]) -> tuple[float, float]:
    """[s] from where all runs have begun to where all are over."""
    begins, ends = zip(*((one.begin, one.duration) for one in timelines), strict=True)
    return max(begins), max(ends)


def _speed(speed: float | None, duration: float, longest: float) -> float:
    """Return the playback speed for ``duration`` [s] of a run; refuses one that cannot be."""
    if speed is not None and not (math.isfinite(speed) and 1e-3 <= speed <= 1e6):
        raise PhysimError(f"playback speed: {speed} given; allowed: 0.001 to 1000000")
    return playback_speed(duration, longest) if speed is None else float(speed)


def _painter(timelines: list[Timeline], speed: float, fps: float) -> Painter | Beside:
    if len(timelines) == 2:
        return Beside(timelines[0], timelines[1], speed, fps)
    return Painter(timelines[0], speed, fps)
