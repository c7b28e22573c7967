"""From a source to a world: read, enclose, find a path, place the robots, write, and check."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from math import hypot
from pathlib import Path

import numpy as np
import shapely

from physim.authoring.importing.drawing import (
    Drawing,
    ImportSourceError,
    listed,
    number,
    place,
    refused,
)
from physim.authoring.importing.drawn_robots import as_drawn
from physim.authoring.importing.enclosure import (
    DENSE,
    LARGEST_PLACE,
    check_size,
    check_sound,
    enclose,
    thin_out,
)
from physim.authoring.importing.fit import Fit, fit
from physim.authoring.importing.formation import MARGIN, RANGE, lost, neighbour_range
from physim.authoring.importing.lines import length_of
from physim.authoring.importing.options import TOLERANT, Options, check_options
from physim.authoring.importing.placed import Placed
from physim.authoring.importing.robots import fill_in
from physim.authoring.importing.shapes import with_lines
from physim.authoring.importing.source import format_of
from physim.authoring.importing.stops import stop_warnings
from physim.authoring.importing.work import GRAIN
from physim.authoring.importing.world_text import world_text
from physim.errors import Location, WorldError, plural
from physim.escaping import escaped
from physim.world import World
from physim.world.file import parse_world
from physim.world.layout.scene_builder import build_scene

STEPS = (0.01, 0.005, 0.002, 0.001)
"""[s] of a world, and shorter ones for robots with narrow parts"""
MOST_DRAWN = 500
"""Robots of a drawing, each of which gets a lane of its own"""
READERS = {
    "track": ("physim.authoring.importing.track", "read_track"),
    "ros-map": ("physim.authoring.importing.ros_map", "read_ros_map"),
    "svg": ("physim.authoring.importing.svg", "read_svg"),
    "wkt": ("physim.authoring.importing.vector", "read_wkt"),
    "geojson": ("physim.authoring.importing.vector", "read_geojson"),
}


@dataclass(frozen=True)
class Imported:
    """A world made from a source: its text, the same loaded, and what was done to get there.

    ``facts`` say what was read and how; ``changes`` every line dropped or repaired.
    """

    text: str
    world: World
    kind: str
    facts: tuple[str, ...]
    changes: tuple[str, ...]


def import_world(source: str | os.PathLike[str], options: Options | None = None) -> Imported:
    """Make a world of a race-track CSV, ROS map, SVG drawing, WKT or GeoJSON file.

    The world has been loaded and its scene built, so `physim run` takes it. Raises
    ImportSourceError, which says what is wrong with the source and where.
    """
    source = Path(source)
    try:
        return _imported(source, options or Options())
    except shapely.errors.GEOSException as error:  # whichever of many calls it was
        reason = escaped(str(error).split(": ", 1)[-1].strip())[:120]
        raise refused(
            source,
            f"its lines cannot be told apart where they cross or touch ({reason}); draw each once, "
            "clear of the others",
        ) from None


def _imported(source: Path, options: Options) -> Imported:
    form = options.format or format_of(source)
    check_options(source, form, options)
    module, name = READERS[form]
    reader: Callable[[Path, Options], Drawing] = getattr(import_module(module), name)
    drawing = with_lines(reader(source, options))
    drawing.path = source
    drawn = bool(drawing.robots) and options.robots is None
    if drawn and len(drawing.robots) > MOST_DRAWN:
        raise refused(
            source,
            f"{len(drawing.robots)} robots are drawn; at most {MOST_DRAWN} are read; draw fewer, "
            "or have boxes placed instead by --robots N",
        )
    if drawn and (given := [f"--{name}" for name in ("lanes", "robot") if getattr(options, name)]):
        raise refused(
            source,
            f"{given[0]}: {plural(len(drawing.robots), 'robot')} of the drawing are taken as they "
            "are drawn; with --robots N boxes are placed instead",
        )
    left = [] if drawn else _paths_left(drawing)
    many = thin_out(drawing, GRAIN if options.tolerance is None else options.tolerance)
    if options.tolerance is not None and not many and form not in TOLERANT:
        drawing.facts.append(
            f"--tolerance {options.tolerance:g} without effect: walls of at most {DENSE} points "
            "are kept as they are"
        )
    check_sound(source, drawing)
    if drawing.area is None:
        enclose(source, drawing, options.origin)
    _check_extent(source, drawing)
    _find_route(source, drawing, options)
    found = fit(source, drawing, options)
    if drawing.robots and not drawn:
        drawing.changes.append(
            f"{plural(len(drawing.robots), 'robot')} of the drawing left out (--robots)"
        )
        drawing.changes += left
    if drawn:
        drawing.changes[:0] = _missed(found, options) + _renamed(drawing)
        robots = as_drawn(drawing, found)
    else:
        found, robots = fill_in(source, drawing, found, options)
        if reason := lost(found, robots):
            message = f"{reason}, and the formation would be lost; fewer --lanes or --robots"
            raise drawing.refused_at(source, message, found.reference[0], "path")
        drawing.changes[:0] = _missed(found, options)
    drawing.facts += _about(drawing, found, robots, options)
    drawing.facts += stop_warnings(drawing, found.reference, robots, found.size, drawn)
    name = options.name or _name(source)

    def written(step: float) -> str:
        return world_text(name, escaped(source.name), drawing, found, robots, step)

    text, world = _checked(source, written, drawing, robots, options)
    return Imported(text, world, drawing.kind, tuple(drawing.facts), tuple(drawing.changes))


def _renamed(drawing: Drawing) -> list[str]:
    """What is said of robots whose drawn name another bears."""
    twice = [one for one in drawing.robots if one.own_name not in ("", one.name)]
    return listed([f"a second robot {one.own_name} is called {one.name}" for one in twice])


def _paths_left(drawing: Drawing) -> list[str]:
    """What is said of robots' own paths that are left out with them: all but the reference path."""
    names = [name for name, line in drawing.paths.items() if line is not drawing.reference]
    return listed([f"path of {name} left out (--robots)" for name in names])


def _check_extent(source: Path, drawing: Drawing) -> None:
    """Refuse a place too small for robots, and report one that is hardly in metres."""
    x0, y0, x1, y1 = drawing.area.bounds
    check_size(source, np.array([x1 - x0, y1 - y0]))
    if max(x1 - x0, y1 - y0) > LARGEST_PLACE:
        drawing.changes.append(
            f"check the scale: the place is {x1 - x0:.3g} x {y1 - y0:.3g} m (--scale 0.001 for "
            "millimetres)"
        )


def _find_route(source: Path, drawing: Drawing, options: Options) -> None:
    """Find a path where none is drawn, or where the user asks for another."""
    if drawing.reference is not None:
        if options.origin is None and options.goal is None:
            return
        drawing.changes.append("path of the source left out: --from and --to ask for another")
    find = import_module("physim.authoring.importing.route").find_route
    find(source, drawing, options)


MISSED = 2.0
"""[robots] from which on it is told how far the path stays from a place asked for"""


def _missed(found: Fit, options: Options) -> list[str]:
    """How far the path begins from --from and ends from --to, where that is ``MISSED`` robots away.

    It is shortened where the group has no room to stand, which a place asked for must not hide.
    """
    said = []
    ends = (("--from", options.origin, "begins"), ("--to", options.goal, "ends"))
    for (word, asked, what), end in zip(ends, found.reference[[0, -1]], strict=True):
        if asked is None:
            continue
        away = hypot(*(end - asked))
        if away > MISSED * found.box[0]:
            said.append(
                f"WARNING: the path {what} {away:.2f} m away from {word} {place(asked)}, at "
                f"{place(end)}, as robots {number(found.box[0])} m long have no room nearer to "
                "it; smaller ones may (--robot)"
            )
    return said


def _about(drawing: Drawing, found: Fit, robots: list[Placed], options: Options) -> list[str]:
    points = sum(len(line) for line in drawing.boundaries)
    walls = (
        f"{plural(len(drawing.boundaries), 'boundary', 'boundaries')} of {plural(points, 'point')}"
    )
    corners = sum(len(ring) for ring in drawing.obstacles)
    if corners:
        walls += f", {plural(len(drawing.obstacles), 'obstacle')} of {corners} corners"
    length = length_of(found.reference)
    facts = [
        f"{walls}, to the millimetre",
        f"reference path of {length:.2f} m, {len(found.reference)} points, narrowest at "
        f"{place(found.narrowest_at)}: {found.narrowest / 2.0:.2f} m to the nearest boundary",
    ]
    count = plural(len(robots), "robot")
    if drawing.robots and options.robots is None:
        return [*facts, f"{count} as drawn", *_range(drawing, found, robots)]
    lanes = plural(min(options.lanes or 1, len(robots)), "lane")
    if (options.lanes or 1) > len(robots):
        lanes += f" of the {options.lanes} asked for, a robot each"
    chosen = "as asked (--robot)"
    if options.robot is None and drawing.robots:
        drawn = len(drawing.robots)
        which = "the robot drawn" if drawn == 1 else f"the largest of {drawn} robots drawn"
        chosen = f"the size of {which} (--robot)"
    elif options.robot is None:
        chosen = "as large as fits, at most 1.8 x 1.0 m (--robot)"
    box = f"{number(found.box[0])} x {number(found.box[1])} m"
    return [*facts, f"{count} in {lanes}, {box}, {chosen}"]


def _range(drawing: Drawing, found: Fit, robots: list[Placed]) -> list[str]:
    """A line on robots of a formation that start farther apart than neighbours usually are."""
    reach = neighbour_range(found, robots) if drawing.has_formation else 0.0
    if reach <= RANGE * found.size:
        return []
    return [
        f"formation.range is {reach:.3g} m, as robots start up to {reach / MARGIN:.2f} m apart "
        "along the path and would not be neighbours within the usual range"
    ]


def _name(source: Path) -> str:
    return (escaped(source.stem).strip() or "imported")[:100]


def _checked(
    source: Path,
    written: Callable[[float], str],
    drawing: Drawing,
    robots: Sequence[Placed],
    options: Options,
) -> tuple[str, World]:
    """The text of the world, loaded, and its scene built as a run would.

    With a shorter step than usual where robots as they are drawn have parts too narrow for it.
    """
    usual, *shorter = STEPS
    text = _short_enough(source, written(usual))
    try:
        return text, _built(text)
    except WorldError as error:
        first = error
    is_of_step = first.faults[0].location[:2] == ("time", "step") or (
        first.faults[0].location[:1] == ("robots",) and first.faults[0].location[2:] == ("limits",)
    )
    for step in shorter if is_of_step and drawing.robots and options.robots is None else []:
        told = f"steps of {step:g} s instead of {usual:g} s, as a robot has narrow parts"
        drawing.facts.append(told)
        try:
            text = written(step)
            return text, _built(text)
        except WorldError:
            drawing.facts.remove(told)
    raise _cannot_run(source, first, drawing, robots, options) from None


def _built(text: str) -> World:
    world = parse_world(text, "the world")
    build_scene(world)
    return world


def _short_enough(source: Path, text: str) -> str:
    if len(text) > 5_000_000:
        raise refused(
            source,
            f"the world would have {len(text) / 1e6:.1f} MB, and a world file has at most 5 MB; "
            "use a larger --tolerance",
        )
    return text


def _cannot_run(
    source: Path, error: WorldError, drawing: Drawing, robots: Sequence[Placed], options: Options
) -> ImportSourceError:
    first = error.faults[0]
    more = f" (and {len(error.faults) - 1} more)" if len(error.faults) > 1 else ""
    message = f"the world made of it cannot run: {first}{more}"
    if options.robot is not None and first.location[:1] == ("time",):
        message += "; another --robot LENGTH,WIDTH, less long for its width"
    return _refused_where(source, message, first.location, drawing, robots)


def _refused_where(
    source: Path, message: str, location: Location, drawing: Drawing, robots: Sequence[Placed]
) -> ImportSourceError:
    """Error of the world at what of the drawing became the key that it is about."""
    key, k = location[0] if location else "", location[1] if len(location) > 1 else None
    if isinstance(k, int) and key == "robots" and k < len(robots):
        drawn = [one for one in drawing.sources if one.role == "robot"]
        if len(drawn) == len(robots) and drawing.robots:
            return refused(source, f"{drawn[k].label}: {message}", drawn[k].line)
        return drawing.refused_at(source, message, robots[k].pose[:2], "path", "boundary")
    lines = {"boundaries": drawing.boundaries, "obstacles": drawing.obstacles}.get(str(key), [])
    if isinstance(k, int) and k < len(lines):
        roles = ("boundary", "obstacle") if key == "boundaries" else ("obstacle", "boundary")
        return drawing.refused_at(source, message, lines[k][len(lines[k]) // 2], *roles)
    if drawing.reference is not None and key == "reference_path":
        return drawing.refused_at(source, message, drawing.reference[0], "path")
    return refused(source, message)
