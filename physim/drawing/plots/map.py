"""Maps: paths, trajectories and snapshots over the safe and danger areas (Figs. 1a, 2a, 3a, 6a,
6b); the width of the corridor along the first robot's path (Fig. 4); and both before a run, which
needs no kernel.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from physim.contacts import Kind, Phase
from physim.drawing import palette
from physim.drawing.crowd import MOST_LINES, NAMED
from physim.drawing.drivers import MOST_DRIVERS, drivers_of, marks_of, owner_of
from physim.drawing.items import PUSHED, Item, Level, items
from physim.drawing.labels import round_step, significant
from physim.drawing.palette import hexed
from physim.drawing.plots.frame import (
    USUAL,
    Note,
    Paper,
    driver_handle,
    finished,
    framed,
    mark,
    note,
    nothing,
    pointed,
    settle,
    short,
)
from physim.drawing.plots.style import CONTACT, INK, QUIET, WIDTH, WIDTHS, robot_colour
from physim.drawing.scene_model import SceneModel, closed, pieces_of, placed, region, rings_of
from physim.geometry.shapes import FloatArray, IntArray
from physim.world.ground.corridor import Widths

if TYPE_CHECKING:
    from physim.drawing.timeline import Timeline
    from physim.record import Record

THIN = 0.45
"""[pt] the thinnest line"""
ON_WALL, ON_PATH, ON_ROBOT = 0.27, 0.05, 1.0
"""What every [pt] of a line costs that words cover"""


def draw_items(axis: Any, drawn: Iterable[Item], thin: float = THIN) -> list[Any]:
    """Draw items, the thinnest line ``thin`` [pt] wide; returns handles of a legend."""
    from matplotlib.collections import LineCollection
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    handles: dict[str, Any] = {}
    for item in drawn:
        how: dict[str, Any] = {
            "zorder": 1.0 + item.level / 10.0,
            "gid": item.what,
            "label": _called(item),
        }
        colour, crowd = hexed(item.colour), len(item.robots) > NAMED
        artist: Any
        if item.level == Level.STOP:
            (artist,) = axis.plot(
                *np.concatenate(item.lines).T, "s", markersize=1.7 if crowd else 4.0,
                markerfacecolor="white", markeredgecolor=colour,
                markeredgewidth=0.4 if crowd else 1.0, **how,
            )  # fmt: skip
        elif item.width:
            dash = "-" if item.dash is None else (0.0, item.dash)
            lines = LineCollection(list(item.lines), colors=colour, linestyles=[dash],
                                   linewidths=thin * item.width, **how)  # fmt: skip
            artist = axis.add_collection(lines, autolim=False)
        else:
            rings = rings_of(region(item.lines)) if item.level == Level.AREA else item.lines
            whole = Path.make_compound_path(*(Path(closed(ring), closed=True) for ring in rings))
            edge = INK if item.what == "robot" and not crowd else "none"
            artist = axis.add_patch(PathPatch(whole, facecolor=colour, edgecolor=edge,
                                              linewidth=thin, **how))  # fmt: skip
        handles.setdefault(_called(item), artist)
    return [artist for label, artist in handles.items() if not label.startswith("_")]


def _called(item: Item) -> str:
    """What a legend calls an item; one that it leaves out begins with _."""
    count = len(item.robots)
    if item.what == "path":
        words = "path" if count == 1 else "shared path" if count <= NAMED else f"{count:,} paths"
        return words if item.dash is None else f"{words}, danger area"
    if item.what in ("stop", "robot"):
        one, many = {
            "stop": ("stop station", "stop stations"),
            "robot": ("robot at the start", "robots at the start"),
        }[item.what]
        return one if count == 1 else f"{count:,} {many}"
    return "_" if item.what == "heading" or item.width == 1.0 else item.what


def draw_lines(axis: Any, lines: Iterable[FloatArray], **style: Any) -> Any:
    """Add lines (n, 2) to a map, whose limits they leave alone; returns their collection."""
    from matplotlib.collections import LineCollection

    return axis.add_collection(LineCollection(list(lines), **style), autolim=False)


def frame_map(axis: Any, low: FloatArray, high: FloatArray) -> None:
    """Set the axes of a map about all there is from ``low`` to ``high`` (2,), with some room."""
    margin = 0.04 * float((high - low).max())
    low, high = low - margin, high + margin
    axis.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    axis.set(xlabel="x [m]", ylabel="y [m]")
    axis.grid(False)


def _framed_run(axis: Any, scene: SceneModel, record: Record) -> None:
    pose = record.moving_pose if scene.moved else record.pose
    cloud = np.concatenate((np.array(scene.extent), pose[:, :, :2].reshape(-1, 2)))
    frame_map(axis, cloud.min(axis=0), cloud.max(axis=0))


# Trajectories

SNAPSHOTS = 10
"""About as many snapshots as are drawn where nothing else is said."""
LEAST_SNAPSHOTS = 5
"""of few robots, of any run"""
MOST_SNAPSHOTS = 200
MANY_CONTACTS = 30
"""Contacts from which on their marks are small."""
SIMPLE = (1.0, 2.0, 3.0, 5.0)
"""Leading figures of the time between snapshots."""
LONGEST = 32
"""Characters of a mode in the legend."""
TINY = 6.0
"""[pt] length of a robot below which it is drawn in its colour alone"""
POINTS = 1500
"""Points of a trajectory, at most."""


def trajectories(record: Record, every: float | None = None, paper: Paper = USUAL) -> Any:
    """Figure: a map [m] with paths, trajectories, and the robots every ``every`` [s].

    Where a path lies outside the safe area it is dashed. More than 12 robots are filled with the
    colours of their modes.
    """
    from physim.drawing.timeline import Timeline  # only here: it brings kernels along

    figure = framed(record, "Paths and trajectories", "Figs. 1a, 2a, 3a, 6a, 6b", paper=paper,
                    width=WIDTH, height=4.0)  # fmt: skip
    axis = figure.subplots()
    scene = SceneModel.of_record(record)
    _framed_run(axis, scene, record)
    handles = draw_items(axis, [item for item in items(scene) if item.level <= Level.WALL])
    drivers = drivers_of(record)
    for handle in handles:
        if handle.get_label() in ("danger area", "safe area"):
            handle.set_label(handle.get_label() + owner_of(drivers))
    if not record.samples:
        nothing(axis, "no sample was recorded")
        return finished(figure, handles)
    timeline = Timeline(record)
    every = snapshot_interval(record) if every is None else every
    count = min(int((timeline.duration - timeline.begin) / every + 1e-9) + 1, MOST_SNAPSHOTS)
    at = np.unique(timeline.sample(timeline.begin + every * np.arange(count)))
    handles += _courses(axis, record) + _moved(axis, timeline, at)
    handles += _snapshots(axis, timeline, at) + _contacts(axis, record)
    handles += map(driver_handle, drivers[:MOST_DRIVERS])
    axis.set_title(f"robots every {every:g} s", loc="right", fontsize=8.5)
    finished(figure, handles)
    _write_times(axis, scene, record, at)
    return figure


def snapshot_interval(record: Record) -> float:
    """Time [s] between snapshots, 1, 2, 3 or 5 times a power of ten.

    About ten in the run, but so far apart that the cluster has left its place in between: two of a
    crowd, five of few robots at least, which may be no cluster and have colours of their own.
    """
    middle = np.median(record.pose[:: max(1, record.samples // 200), :, :2], axis=1)
    length = float(np.hypot(*np.diff(middle, axis=0).T).sum())
    halfway = record.pose[record.samples // 2, :, :2]
    share = float(np.hypot(*np.ptp(halfway, axis=0))) / length if length > 0.0 else 0.0
    duration = max(record.steps_made * record.dt, 1e-3)
    least = duration * min(share, 0.5 if record.robots > MOST_LINES else 1.0 / LEAST_SNAPSHOTS)
    wanted = max(duration / SNAPSHOTS, least)
    power = 10.0 ** np.floor(np.log10(wanted))
    simple = [f * power for f in (*SIMPLE, 10.0) if f * power >= 0.9 * least]
    return float(min(simple, key=lambda t: abs(np.log(t / wanted))))


def _courses(axis: Any, record: Record) -> list[Any]:
    """Where the robots went."""
    rows = np.unique(np.linspace(0, record.samples - 1, POINTS).astype(int))
    courses = record.pose[rows][:, :, :2].transpose(1, 0, 2)
    if record.robots > MOST_LINES:
        alpha = min(max(20.0 / record.robots, 0.02), 0.35)
        draw_lines(axis, courses, color=INK, linewidth=0.5, zorder=2.0, alpha=alpha)
        label = f"trajectories of {record.robots} robots"
        return [*axis.plot([], [], color=INK, linewidth=0.5, alpha=0.35, label=label)]
    marks = marks_of(drivers_of(record), record.robots)
    return [
        axis.plot(*course.T, color=robot_colour(i), linewidth=1.2, zorder=2.0,
                  label=short(record.names[i]) + marks[i])[0]
        for i, course in enumerate(courses)
    ]  # fmt: skip


def _moved(axis: Any, timeline: Timeline, at: IntArray) -> list[Any]:
    """What moves beside the robots at samples ``at``, and the names of movers."""
    from matplotlib.collections import PolyCollection

    scene, handles = timeline.scene, []
    poses = timeline.record.moving_pose[at][:, timeline.robots :] if scene.moved else ()
    outlines = [one.rings[0] for one in scene.moved_shapes]
    movers = zip(scene.moved_names, scene.moved_keys, strict=True)
    called = short(", ".join(name for name, key in movers if key == "mover"), LONGEST)
    for key, word in (("mover", called), ("obstacle", PUSHED)):
        which = [k for k, kind in enumerate(scene.moved_keys) if kind == key]
        shapes = [placed(outlines[k], pose[k]) for pose in poses for k in which]
        if shapes:
            bodies = PolyCollection(shapes, facecolor=hexed(palette.KEYS[key]), edgecolor=INK,
                                    linewidth=0.6, zorder=2.5, label=word, gid=key)  # fmt: skip
            handles.append(axis.add_collection(bodies, autolim=False))
    return handles


def _snapshots(axis: Any, timeline: Timeline, at: IntArray) -> list[Any]:
    """Robots at samples ``at``, in their own colours or, of a crowd, in those of their modes.

    A tick shows the heading. Robots in danger are over the others; outlines and ticks of those
    that are tiny on paper would hide their colours and are left out.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch

    scene, crowd = timeline.scene, timeline.robots > MOST_LINES
    shapes, ticks = [], []
    moments = [timeline.at(time) for time in timeline.time[at].tolist()]
    tips = [np.array([[0.0, 0.0], [points[:, 0].max(), 0.0]]) for points in scene.outlines]
    for now in moments:
        shapes += [placed(*pair) for pair in zip(scene.outlines, now.pose, strict=True)]
        ticks += [placed(*pair) for pair in zip(tips, now.pose, strict=True)]
    size = 72.0 * WIDTH / float(np.ptp(axis.get_xlim())) * 2.0 * float(scene.reach.max())  # [pt]
    edge = 0.4 if not crowd else 0.2 if size >= TINY else 0.0
    danger = np.append([mode.danger for mode in scene.modes], False)
    order = np.argsort(danger[np.concatenate([now.modes for now in moments])], kind="stable")
    order = order if crowd else np.arange(len(shapes))
    colours = [now.colours if crowd else np.array(scene.colours) for now in moments]
    faces = np.concatenate(colours)[order] / 255.0
    bodies = PolyCollection([shapes[k] for k in order], facecolor=faces, edgecolor=INK,
                            linewidth=edge, zorder=3.0)  # fmt: skip
    axis.add_collection(bodies, autolim=False)
    if edge:
        draw_lines(axis, ticks, color="white", linewidth=2.0 * edge, zorder=3.1)
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


def _write_times(axis: Any, scene: SceneModel, record: Record, at: IntArray) -> None:
    """Write the time of each of the samples ``at`` beside its robots, those near the first."""
    notes = []
    near = 0.1 * float(np.ptp(axis.get_xlim()))
    for row in at:
        places = record.pose[row, :, :2]
        group = places[np.hypot(*(places - places[0]).T) <= near]
        middle, time = group.mean(axis=0), float(record.time[row])
        said = f"{time:.3g} s" if time < 999.5 else f"{time:.0f} s"
        words = note(axis, middle, said, fontsize=7.5, color=INK, gid="time")
        around = shapely.MultiPoint(group).buffer(float(scene.reach.max())).convex_hull
        hull = shapely.get_coordinates(around)[:-1]
        notes.append(Note(words, 0.0, pointed(axis, hull) - pointed(axis, middle[None])))
    rows = np.unique(np.linspace(0, record.samples - 1, POINTS // 5).astype(int))
    courses = record.pose[rows][:, :, :2].transpose(1, 0, 2)[:MOST_LINES]
    walls = [*scene.boundaries, *map(closed, scene.solid_rings)]
    robots, reach = pointed(axis, record.pose[at][:, :, :2].reshape(-1, 2)), scene.reach.max()
    reach *= np.ptp(pointed(axis, np.array([[0.0, 0.0], [1.0, 0.0]]))[:, 0])
    taken = np.concatenate((robots - reach, robots + reach), axis=1)
    for row in at if scene.moved else ():
        poses = record.moving_pose[row, record.robots :]
        for body, pose in zip(scene.moved_shapes, poses, strict=True):
            outline = pointed(axis, placed(body.rings[0], pose))
            taken = np.vstack((taken, np.append(outline.min(axis=0), outline.max(axis=0))))
    lines = _priced(axis, ((walls, ON_WALL), (courses, ON_PATH)))
    found = settle(axis, notes, lines, taken)
    for one, is_placed in zip(notes, found, strict=True):
        if not is_placed:
            one.words.remove()


def _priced(
    axis: Any, kinds: Iterable[tuple[Iterable[FloatArray], float]]
) -> tuple[FloatArray, FloatArray]:
    """Pieces (s, 2, 2) [pt] of lines of a map, and what a point of each costs (s,)."""
    pieces = [(pieces_of(pointed(axis, line) for line in lines), price) for lines, price in kinds]
    prices = [np.full(len(some), price) for some, price in pieces]
    return np.concatenate([some for some, _ in pieces]), np.concatenate(prices)


# Widths

MOST_SEGMENTS = 90
"""Places on the map at which the shortest segments are drawn."""


def width(record: Record, paper: Paper = USUAL) -> Any:
    """Figure: a map with the shortest segments to both sides above the width over the station."""
    from physim.analysis.metrics import Figures  # only here: it brings kernels along

    figure = framed(record, "Corridor width", "Fig. 4", paper=paper, width=WIDTH, height=5.4)
    above, below = figure.subplots(2, 1, height_ratios=(3.6, 1.4))
    found = Figures(record).width
    if found is None:
        for axis in (above, below):
            nothing(axis, "no robot")
        return figure
    scene = SceneModel.of_record(record)
    _framed_run(above, scene, record)
    fixed = (Level.AREA, Level.SOLID, Level.WALL)
    handles = draw_items(above, [item for item in items(scene) if item.level in fixed])
    name = short(record.names[0])
    own = hexed(scene.colours[0])
    handles += above.plot(*scene.paths[0].T, color=own, linewidth=1.2, label=f"path of {name}")
    apart = [np.hypot(*(feet - found.points).T) for feet in (found.left, found.right)]
    widths = Widths(
        station=found.station, point=found.points, left=apart[0], right=apart[1],
        left_foot=found.left, right_foot=found.right, between=~np.isnan(found.width),
    )  # fmt: skip
    rows = np.unique(np.linspace(0, len(found.station) - 1, MOST_SEGMENTS).astype(int))
    for feet, colour, side in ((found.left, WIDTHS, "left"), (found.right, QUIET, "right")):
        pieces = np.stack((found.points[rows], feet[rows]), axis=1)
        pieces = pieces[np.isfinite(pieces).all(axis=(1, 2)) & widths.between[rows]]
        label = f"shortest to the {side}"
        handles.append(draw_lines(above, pieces, color=colour, linewidth=0.7, label=label))
    return finished(figure, handles + draw_widths(above, below, widths, name))


def draw_widths(above: Any, below: Any, widths: Widths, name: str) -> list[Any]:
    """Draw the width over the station along the path of ``name``; on the map, where it is least."""
    below.set(xlabel=f"station along the path of {name} [m]", ylabel="width [m]")
    below.set_xlim(0.0, widths.station[-1])
    between = np.where(widths.between & np.isfinite(widths.width), widths.width, np.nan)
    if np.isnan(between).all():
        nothing(below, "nowhere between two walls")
        return []
    below.plot(widths.station, between, color=WIDTHS, linewidth=1.3, gid="width")
    below.set_ylim(0.0, 1.3 * float(np.nanmax(between)))
    handles: list[Any] = []
    if not widths.between.all():
        handles += below.plot(widths.station, widths.width, ":", color=WIDTHS, linewidth=0.8,
                              label="width, walls not abreast")  # fmt: skip
    least, most = widths.narrowest or 0, int(np.nanargmax(between))
    for k, word, colour in ((least, "narrowest", WIDTHS), (most, "widest", INK)):
        station, value = float(widths.station[k]), float(widths.width[k])
        text = f"{word} {significant(value)} m at {significant(station)} m"
        mark(below, station, value, text, below=k == least, colour=colour)
    bar = np.array([widths.left_foot[least], widths.point[least], widths.right_foot[least]])
    handles += above.plot(
        *bar.T, color=WIDTHS, linewidth=1.8, zorder=4, gid="narrowest", marker="o", markersize=3.4,
        markevery=2, label="narrowest place",
    )  # fmt: skip
    return handles


# Before the run

MOST_TICKS = 14
"""Station ticks along the first robot's path, about."""
SMALL, SMALLEST = 2.5, 1.6
"""[pt] A robot has a dot of this size at least; of a crowd"""
STALK = 5.0
"""[pt] by which the line of a heading reaches beyond the robot"""
FEW_NAMED = 12
"""Names of a crowd that are tried, of robots as far apart in the list as can be."""
LEAST = 3.0
"""[pt] least distance that a name keeps from a reference point"""
RIM = 0.15
"""Share of a robot's extent, on every side, that words may cover if need be."""


def draw_start(axis: Any, scene: SceneModel, names: Sequence[str], course: FloatArray,
               widths: Widths) -> list[Any]:  # fmt: skip
    """Draw the map of a world before it is run, with the names of all that moves, robots first.

    And a tick every round number of metres along the ``course`` (n, 2) of the first robot.
    """
    frame_map(axis, *scene.extent)
    limits = np.array([axis.get_xlim(), axis.get_ylim()])
    inches = axis.figure.get_size_inches() * axis.get_position(original=True).size
    scale = float((72.0 * inches / np.ptp(limits, axis=1)).min())  # [pt/m]
    ends = limits.mean(axis=1)[:, None] + 36.0 / scale * inches[:, None] * (-1.0, 1.0)
    axis.set(xlim=ends[0], ylim=ends[1], facecolor=hexed(palette.OUTSIDE))
    k, crowd = widths.narrowest, scene.robots > NAMED
    room = 10.0 if k is None else scale * widths.width[k]  # two walls close together stay two
    handles = draw_items(axis, items(scene), float(np.clip(0.07 * room, 0.14, 0.6)))
    place, heading = scene.start[:, :2], scene.start[:, 2]
    colours = [hexed(palette.BAND)] * scene.robots if crowd else list(map(hexed, scene.colours))
    axis.scatter(*place.T, s=(SMALLEST if crowd else SMALL) ** 2, c=colours, linewidths=0.0,
                 zorder=1.55)  # fmt: skip
    if not crowd:
        ahead = np.column_stack((np.cos(heading), np.sin(heading)))
        tips = place + ahead * (scene.reach + STALK / scale)[:, None]
        draw_lines(axis, np.stack((place, tips), axis=1), colors=INK, linewidths=1.0, zorder=1.57,
                   gid="headings")  # fmt: skip
    ticks, *stations = _stations(axis, course, scale)
    _write_names(axis, scene, names, scale, stations, widths)
    return [*handles, ticks]


def _stations(axis: Any, course: FloatArray, scale: float) -> tuple[Any, FloatArray, FloatArray]:
    """Ticks along a course: their handle, points (T, 2) and stations (T,) [m]."""
    line = shapely.LineString(course)
    step = round_step(line.length, MOST_TICKS)
    stations = step * np.arange(np.floor(line.length / step * (1.0 + 1e-12)) + 1.0)
    hair = line.length * 1e-6
    ends = [np.clip(stations + d, 0.0, line.length) for d in (-hair, hair, 0.0)]
    before, after, point = (
        shapely.get_coordinates(shapely.line_interpolate_point(line, end)) for end in ends
    )
    along = after - before
    along /= np.maximum(np.hypot(*along.T), np.finfo(float).tiny)[:, None]
    half = 3.2 / scale * np.column_stack((-along[:, 1], along[:, 0]))
    ticks = np.stack((point - half, point + half), axis=1)
    handle = draw_lines(axis, ticks, colors=QUIET, linewidths=0.9, zorder=1.35, gid="stations",
                        label=f"stations, every {step:,g} m")  # fmt: skip
    return handle, point, stations


def _write_names(axis: Any, scene: SceneModel, names: Sequence[str], scale: float,
                 stations: Sequence[FloatArray], widths: Widths) -> None:  # fmt: skip
    """Write the least width, names of robots and stations, as far as they do not overlap."""
    notes, k, crowd = [], widths.narrowest, scene.robots > NAMED
    if k is not None:
        words = f"{significant(widths.width[k])} m"
        notes.append(Note(note(axis, widths.left_foot[k], words, color=WIDTHS, fontsize=8.5,
                               fontweight="bold")))  # fmt: skip
    for i in range(0, scene.robots, ceil(scene.robots / FEW_NAMED) if crowd else 1):
        words = note(axis, scene.start[i], names[i], fontsize=7.5, fontweight="bold", gid="name",
                     color=INK if crowd else hexed(scene.colours[i]))  # fmt: skip
        notes.append(Note(words, max(scene.reach[i] * scale, LEAST)))
    for name, outline in zip(names[scene.robots :], scene.moved_starting, strict=False):
        middle = outline.mean(axis=0)
        words = note(axis, middle, name, fontsize=7.5, fontweight="bold", gid="name", color=INK)
        notes.append(Note(words, 0.0, pointed(axis, outline) - pointed(axis, middle[None])))
    for at, station in zip(*stations, strict=True):
        notes.append(Note(note(axis, at, f"{station:.12g}", fontsize=6.5, color=QUIET)))
    starting = *scene.starting, *scene.moved_starting
    outlines = [pointed(axis, outline) for outline in starting]
    low = np.array([outline.min(axis=0) for outline in outlines])
    high = np.array([outline.max(axis=0) for outline in outlines])
    rim, stops = RIM * (high - low), np.tile(pointed(axis, scene.stops), 2)
    taken = np.concatenate((np.concatenate((low + rim, high - rim), axis=1),
                            stops + (-2.8, -2.8, 2.8, 2.8)))  # fmt: skip
    walls = [*scene.boundaries, *map(closed, scene.obstacles)]
    if k is not None:
        walls.append(np.array([widths.left_foot[k], widths.right_foot[k]]))
    paths = list({path.tobytes(): path for path in scene.paths}.values())
    lines = _priced(axis, ((walls, ON_WALL), (paths, ON_PATH),
                           (map(closed, starting), ON_ROBOT)))  # fmt: skip
    found = settle(axis, notes, lines, taken, pointed(axis, scene.start[:, :2]))
    for one, is_placed in zip(notes, found, strict=True):
        if not is_placed:
            one.words.remove()
