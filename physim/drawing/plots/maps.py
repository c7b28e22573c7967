"""Maps: paths, trajectories and snapshots over the safe and danger areas (Figs. 1a, 2a, 3a, 6a,
6b), and the width of the corridor along the first robot's path, with its shortest segments
(Fig. 4).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.analysis.metrics import Width, corridor_width
from physim.analysis.metrics.distances import width_extreme
from physim.contacts import Kind, Phase
from physim.drawing.crowd import MOST_LINES
from physim.drawing.palette import Colour, hexed
from physim.drawing.plots.frame import (
    ROW,
    framed,
    legend_below,
    legend_beside,
    mark,
    nothing,
    short,
)
from physim.drawing.plots.scene import add_bodies, add_lines, draw_scene
from physim.drawing.plots.style import CONTACT, INK, QUIET, WIDTH, WIDTHS, robot_colour
from physim.drawing.plots.times import write_times
from physim.drawing.scene_model import SceneModel, placed
from physim.drawing.timeline import Timeline
from physim.geometry.shapes import IntArray
from physim.record import Record

SNAPSHOTS = 10
"""About as many snapshots as are drawn where nothing else is said."""
LEAST_SNAPSHOTS = 5
"""of few robots, of any run"""
MOST_SNAPSHOTS = 200
MANY_CONTACTS = 30
"""Contacts from which on their marks are small."""
COLUMNS = 5
"""of the legend"""
SIMPLE = (1.0, 2.0, 3.0, 5.0)
"""Leading figures of the time between snapshots."""
LONGEST = 32
"""Characters of a mode in the legend."""
TINY = 6.0
"""[pt] length of a robot below which it is drawn in its colour alone"""
POINTS = 1500
"""Points of a trajectory, at most."""


def trajectories(record: Record, snapshots: float | None = None) -> Any:
    """Figure: a map [m] with paths, trajectories, and the robots every ``snapshots`` [s].

    Where a path lies outside the safe area it is dashed. More than 12 robots are
    filled with the colours of their modes.
    """
    figure = framed(record, "Paths and trajectories", "Figs. 1a, 2a, 3a, 6a, 6b", width=WIDTH,
                    height=6.0, source_on_top=True)  # fmt: skip
    axis = figure.subplots()
    scene = SceneModel.of_record(record)
    tall = frame_map(axis, scene, record, 6.5, 6.2)
    handles = draw_scene(axis, scene, 1.1) + _paths(axis, scene)
    if not record.samples:
        nothing(axis, "no sample was recorded")
        return figure
    timeline = Timeline(record)
    every = snapshot_interval(record) if snapshots is None else snapshots
    at = snapshot_rows(timeline, every)
    handles += _courses(axis, record)
    handles += _snapshots(axis, timeline, at)
    handles += _contacts(axis, record)
    write_times(axis, record, at)
    axis.set_title(f"robots every {every:g} s", loc="right", fontsize=8.5)
    rows = legend_below(figure, handles, COLUMNS)
    figure.set_size_inches(WIDTH, tall + 0.5 + ROW * rows)
    return figure


def frame_map(axis: Any, scene: SceneModel, record: Record, height: float, share: float) -> float:
    """Set the axes of a map about all there is; returns its height [in], ``height`` at most.

    ``share`` [in] is the width that it has.
    """
    cloud = np.concatenate((np.array(scene.extent), record.pose[:, :, :2].reshape(-1, 2)))
    low, high = cloud.min(axis=0), cloud.max(axis=0)
    margin = 0.02 * float((high - low).max()) + 0.1
    low, high = low - margin, high + margin
    axis.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    axis.set(xlabel="x [m]", ylabel="y [m]")
    axis.grid(False)
    wide, tall = high - low
    return float(min(height, max(1.2, share * tall / wide + 0.6)))


def snapshot_interval(record: Record) -> float:
    """Time [s] between snapshots, 1, 2, 3 or 5 times a power of ten.

    About ten in the run, but so far apart that the cluster has left its place in between: two of a
    crowd, five of few robots at least, which may be no cluster and have colours of their own.
    """
    middle = np.median(record.pose[:: max(1, record.samples // 200), :, :2], axis=1)
    length = float(np.hypot(*np.diff(middle, axis=0).T).sum())
    halfway = record.pose[record.samples // 2, :, :2]
    share = float(np.hypot(*np.ptp(halfway, axis=0))) / length if length > 0.0 else 0.0
    duration = max(record.steps_run * record.dt, 1e-3)
    least = duration * min(share, 0.5 if record.robots > MOST_LINES else 1.0 / LEAST_SNAPSHOTS)
    wanted = max(duration / SNAPSHOTS, least)
    power = 10.0 ** np.floor(np.log10(wanted))
    simple = [f * power for f in (*SIMPLE, 10.0) if f * power >= 0.9 * least]
    return float(min(simple, key=lambda t: abs(np.log(t / wanted))))


def snapshot_rows(timeline: Timeline, every: float) -> IntArray:
    """Samples nearest to 0, ``every``, 2 ``every`` … [s]; at most `MOST_SNAPSHOTS`."""
    count = min(int(timeline.duration / every + 1e-9) + 1, MOST_SNAPSHOTS)
    return np.unique(timeline.sample(every * np.arange(count)))


def _paths(axis: Any, scene: SceneModel) -> list[Any]:
    """Own paths, thin: whole inside of the safe area, dashed outside."""
    paths = zip(scene.paths, scene.path_pieces, strict=True)
    each = {path.tobytes(): pieces for path, pieces in paths}.values()  # robots may share one
    inside = [piece for pieces, _ in each for piece in pieces]
    outside = [piece for _, pieces in each for piece in pieces]
    style = {"color": QUIET, "alpha": 0.8, "zorder": 1.6}
    style["linewidth"] = 0.8 if scene.robots <= MOST_LINES else 0.4
    kinds = ((inside, "-", "path"), (outside, (0, (3, 2)), "path, danger area"))
    return [
        add_lines(axis, pieces, linestyle=dash, label=label, **style)
        for pieces, dash, label in kinds
        if pieces
    ]


def _courses(axis: Any, record: Record) -> list[Any]:
    """Where the robots went."""
    rows = np.unique(np.linspace(0, record.samples - 1, POINTS).astype(int))
    courses = record.pose[rows][:, :, :2].transpose(1, 0, 2)
    if record.robots > MOST_LINES:
        from matplotlib.lines import Line2D

        style: dict[str, Any] = {"color": INK, "linewidth": 0.5, "zorder": 2.0}
        add_lines(axis, courses, alpha=min(max(20.0 / record.robots, 0.02), 0.35), **style)
        return [
            Line2D([], [], alpha=0.35, label=f"trajectories of\n{record.robots} robots", **style)
        ]
    style = {"linewidth": 1.2, "zorder": 2.0}
    return [
        axis.plot(*course.T, color=robot_colour(i), label=short(record.names[i]), **style)[0]
        for i, course in enumerate(courses)
    ]


def _snapshots(axis: Any, timeline: Timeline, at: IntArray) -> list[Any]:
    """Robots at samples ``at``, in their own colours or, of a crowd, in those of their modes.

    A tick shows the heading. Robots in danger are over the others; outlines and ticks of those
    that are tiny on paper would hide their colours and are left out.
    """
    from matplotlib.patches import Patch

    scene, crowd = timeline.scene, timeline.robots > MOST_LINES
    shapes, ticks = [], []
    colours: list[Colour] = []
    moments = [timeline.at(time) for time in timeline.time[at].tolist()]
    tips = [np.array([[0.0, 0.0], [points[:, 0].max(), 0.0]]) for points in scene.outlines]
    for now in moments:
        shapes += [placed(*pair) for pair in zip(scene.outlines, now.pose, strict=True)]
        colours += now.colours if crowd else scene.colours
        ticks += [placed(*pair) for pair in zip(tips, now.pose, strict=True)]
    edge = 0.2 if crowd else 0.4
    size = 72.0 * WIDTH / float(np.ptp(axis.get_xlim())) * 2.0 * float(scene.reach.max())  # [pt]
    if crowd and size < TINY:
        edge = 0.0
    danger = np.append([mode.danger for mode in scene.modes], False)
    order = np.argsort(danger[np.concatenate([now.modes for now in moments])], kind="stable")
    order = order if crowd else np.arange(len(shapes))
    faces = [hexed(colours[k]) for k in order]
    add_bodies(axis, [shapes[k] for k in order], facecolor=faces, edgecolor=INK, linewidth=edge,
               zorder=3.0)  # fmt: skip
    if edge:
        add_lines(axis, ticks, color="white", linewidth=2.0 * edge, zorder=3.1)
    given = {mode for now in moments for mode in now.modes.tolist()} if crowd else set()
    return [
        Patch(facecolor=mode.colour, label=short(f"robot, {mode}", LONGEST))
        for k, mode in enumerate(scene.modes)
        if k in given
    ]


def _contacts(axis: Any, record: Record) -> list[Any]:
    """Places at which contacts began, and of swept ones, between two samples."""
    rows = record.contacts
    began = rows[(rows["phase"] == Phase.BEGAN) & (rows["kind"] == Kind.PHYSICAL)]
    swept = rows[rows["kind"] == Kind.SWEPT]
    handles = []
    for found, marker, word in ((began, "x", "contact"), (swept, "+", "contact between samples")):
        if len(found):
            size = 6.0 if len(found) <= MANY_CONTACTS else 3.2  # [pt]
            how = {"color": CONTACT, "markersize": size, "markeredgewidth": size / 4, "zorder": 5}
            label = f"{word} ({len(found)})"
            handles += axis.plot(found["x"], found["y"], marker, label=label, **how)
    return handles


MOST_SEGMENTS = 90
"""Places on the map at which the shortest segments are drawn."""


def width(record: Record) -> Any:
    """Figure: a map with the shortest segments to both sides above the width over the station."""
    figure = framed(record, "Corridor width", "Fig. 4", width=WIDTH, height=6.0)
    above, below = figure.subplots(2, 1, height_ratios=(3, 1))
    if not record.robots:
        nothing(above, "no robot")
        nothing(below, "no robot")
        return figure
    name = short(record.names[0])
    scene = SceneModel.of_record(record)
    tall = frame_map(above, scene, record, 4.6, 4.6)
    figure.set_size_inches(WIDTH, tall + 1.9)
    below.get_subplotspec().get_gridspec().set_height_ratios((tall, 1.4))
    found = corridor_width(record, 0)
    handles = draw_scene(above, scene, 1.1)
    handles += _segments(above, found)
    handles += above.plot(*scene.paths[0].T, color=INK, linewidth=1.2, label=f"path of {name}")
    below.set(xlabel=f"station along the path of {name} [m]", ylabel="width [m]")
    below.set_xlim(0.0, found.station[-1])
    ends = [width_extreme(found, 0, largest) for largest in (False, True)]
    if not np.isfinite(found.width).any():
        nothing(below, "nowhere between two walls")
        return figure
    below.plot(found.station, found.width, color=INK, linewidth=1.1)
    between = found.width[np.isfinite(found.width)]
    below.set_ylim(0.0, 1.3 * float(between.max()))
    if len(between) < len(found.width):
        apart = [np.hypot(*(feet - found.points).T) for feet in (found.left, found.right)]
        dots = below.plot(found.station, apart[0] + apart[1], ":", color=INK, linewidth=0.8)
        dots[0].set_label("walls not abreast")
        handles += dots
    for end, word, colour in zip(ends, ("least", "greatest"), (WIDTHS, INK), strict=True):
        if end is not None:
            text = f"{word} {end.value:.2f} m"
            mark(below, end.station, end.value, text, below=word == "least", colour=colour)
            handles += _extreme(above, found, end.station, f"{text}", colour)
    legend_beside(figure, handles)
    return figure


def _segments(axis: Any, found: Width) -> list[Any]:
    """Shortest segments to the left and to the right at evenly spread places."""
    rows = np.unique(np.linspace(0, len(found.station) - 1, MOST_SEGMENTS).astype(int))
    handles = []
    for feet, colour, label in (
        (found.left, WIDTHS, "shortest to the left"),
        (found.right, QUIET, "shortest to the right"),
    ):
        pieces = np.stack((found.points[rows], feet[rows]), axis=1)
        counts = np.isfinite(pieces).all(axis=(1, 2)) & ~np.isnan(found.width[rows])
        handles.append(add_lines(axis, pieces[counts], color=colour, linewidth=0.7, label=label))
    return handles


def _extreme(axis: Any, found: Width, station: float, label: str, colour: str) -> list[Any]:
    """The two segments at the narrowest or widest place, thick."""
    k = int(np.argmin(np.abs(found.station - station)))
    points = np.array([found.left[k], found.points[k], found.right[k]])
    return list(axis.plot(*points.T, color=colour, linewidth=2.4, label=label, zorder=4))
