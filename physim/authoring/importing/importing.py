"""From a source to a world: read it, find place and path, place the robots, write what was made."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import shapely

from physim.authoring.importing.area import Place, find_place
from physim.authoring.importing.drawing import Drawing, refused
from physim.authoring.importing.drawn import Placed, as_drawn, robot_names
from physim.authoring.importing.group import fill_in, reach_of
from physim.authoring.importing.made import made_world, world_text
from physim.authoring.importing.options import Options, check_options
from physim.authoring.importing.paths import drawn_paths
from physim.authoring.importing.size import Size, check_way, size_as_drawn, size_of
from physim.authoring.importing.source import format_of
from physim.errors import WorldError, plural
from physim.escaping import escaped
from physim.geometry.arc_length import Polyline
from physim.geometry.shapes import FloatArray
from physim.world import World
from physim.world.layout.scene_builder import build_scene

STEPS = (0.01, 0.005, 0.002, 0.001)
"""[s] of a world, and shorter ones for robots with narrow parts"""
AGAINST = 0.5
"""[-] share of its path that leads back along the reference path of a robot that goes against it"""
MOST_TEXT = 5_000_000
"""Characters of a world file"""
READERS = {
    "track": ("physim.authoring.importing.track", "read_track"),
    "ros-map": ("physim.authoring.importing.ros_map", "read_ros_map"),
    "svg": ("physim.authoring.importing.svg", "read_svg"),
    "wkt": ("physim.authoring.importing.vector", "read_wkt"),
    "geojson": ("physim.authoring.importing.vector", "read_geojson"),
}


@dataclass(frozen=True)
class Imported:
    """A world made from a source, its text, and what was done to get there.

    ``facts`` say what was read and how; ``changes`` every line dropped or repaired.
    """

    text: str
    world: World
    kind: str
    facts: tuple[str, ...]
    changes: tuple[str, ...]


def import_world(source: str | os.PathLike[str], options: Options | None = None) -> Imported:
    """Make a world of a race-track CSV, ROS map, SVG drawing, WKT or GeoJSON file.

    Its scene has been built, so `physim run` takes it. Raises ImportSourceError, which says what is
    wrong with the source and where.
    """
    source, options = Path(source), options or Options()
    try:
        form = options.format or format_of(source)
        check_options(source, form, options)
        module, name = READERS[form]
        reader: Callable[[Path, Options], Drawing] = getattr(import_module(module), name)
        return _made(reader(source, options), options)
    except shapely.errors.GEOSException as error:  # whichever of many calls it was
        reason = escaped(str(error).split(": ", 1)[-1].strip())[:120]
        raise refused(
            source,
            f"its lines cannot be told apart where they cross or touch ({reason}); draw each once, "
            "clear of the others",
        ) from None


def _made(drawing: Drawing, options: Options) -> Imported:
    shapes = drawing.of("robot")
    is_drawn = bool(shapes) and options.robots is None
    if is_drawn and (given := [f"--{key}" for key in ("lanes", "robot") if getattr(options, key)]):
        raise drawing.refusal(
            f"{given[0]}: {plural(len(shapes), 'robot')} of the drawing are taken as they are "
            "drawn; with --robots N boxes are placed instead"
        )
    where = find_place(drawing, options)
    reference, own = _paths(drawing, where, options, is_drawn)
    if is_drawn:
        reference, robots = as_drawn(drawing, where, reference, own)
        size = size_as_drawn(robots)
        for one in robots:
            beside = f", {one.offset:+g} m beside the reference path," if one.offset else ""
            advice = f"move it, draw a smaller robot, or a path of its own named {one.name}"
            what = f"path of {one.name}{beside}"
            check_way(drawing, where, one.path, one.box[1], what, one.shape, advice)
    else:
        size = size_of(drawing, where, reference, options, reach_of(options))
        size, robots = fill_in(drawing, where, reference, size, options)
    is_lap = any((one.path[0] == one.path[-1]).all() for one in robots)
    has_formation = not is_lap and not options.no_formation
    corners = [sum(map(len, lines)) for lines in (where.boundaries, where.obstacles)]
    walls = plural(len(where.boundaries), "boundary", "boundaries")
    walls += f" of {plural(corners[0], 'point')}"
    if where.obstacles:
        walls += f", {plural(len(where.obstacles), 'obstacle')} of {corners[1]} corners"
    box = "" if is_drawn else f"{size.box[0]:g} x {size.box[1]:g} m, "
    drawing.facts += [
        f"{walls}, to the millimetre",
        f"reference path of {Polyline(reference).length:.2f} m, {len(reference)} points",
        f"{plural(len(robots), 'robot')}, {box}{size.told}",
    ]
    if has_formation and len(robots) > 1:
        _check_one_way(drawing, reference, robots)
        drawing.facts.append(f"{len(robots)} robots in formation (--no-formation: each by itself)")
    if not has_formation:
        why = "as asked" if options.no_formation else "a path is closed: a lap each"
        drawing.facts.append(f"no formation ({why}); every robot goes to the end of its own path")
    return _written(drawing, where, reference, robots, size, has_formation, options)


def _paths(
    drawing: Drawing, where: Place, options: Options, is_drawn: bool
) -> tuple[FloatArray, dict[str, FloatArray]]:
    """The reference path (n, 2) [m], and those of robots by name.

    A route where none is drawn, or another is asked for.
    """
    if (shapes := drawing.of("robot")) and not is_drawn:
        left = {id(one) for one in drawing.of("robot", "path") if one.role == "robot" or one.name}
        drawing.shapes = [one for one in drawing.shapes if id(one) not in left]
        drawing.changes.append(
            f"{plural(len(shapes), 'robot')} and their paths left out (--robots)"
        )
    names = robot_names(drawing.of("robot"))
    paths = drawn_paths(drawing, names, options.close)
    reference = paths.pop("", None)
    if options.origin is not None or options.goal is not None:
        if reference is not None:
            drawing.changes.append("path of the source left out: --from and --to ask for another")
        reference = None
    elif reference is None and paths:
        if alone := [name for name in names if name not in paths]:
            raise drawing.refusal(
                f'robot "{alone[0]}" has no path: draw one named {alone[0]}, or one without a '
                "name for all that have none of their own"
            )
        reference = paths[names[0]]
    if reference is None:  # the search loads much of scipy
        find = import_module("physim.authoring.importing.route").find_route
        reference = find(drawing, where, options, reach_of(options))
    return reference, paths


def _check_one_way(drawing: Drawing, reference: FloatArray, robots: Sequence[Placed]) -> None:
    """Refuse a formation with a robot that goes against the reference path (n, 2) [m]."""
    way = Polyline(reference)
    for one in robots:
        begin, end = way.nearest(one.path[[0, -1]])
        if begin - end > AGAINST * min(Polyline(one.path).length, way.length):
            raise drawing.refusal(
                f"{one.name} goes against the direction of the others, and a formation has one; "
                "--no-formation lets each robot go by itself",
                one.shape,
            )


def _written(
    drawing: Drawing,
    where: Place,
    reference: FloatArray,
    robots: Sequence[Placed],
    size: Size,
    has_formation: bool,
    options: Options,
) -> Imported:
    """The world and its text; its scene has been built as a run would.

    With a shorter step than usual where robots have parts too narrow for it.
    """
    source = escaped(drawing.path.name)
    name = options.name or (escaped(drawing.path.stem).strip() or "imported")[:100]
    for step in STEPS:
        try:
            world = made_world(name, source, where, reference, robots, size, has_formation, step)
            build_scene(world)
            break
        except WorldError as error:
            first, count = error.faults[0], len(error.faults)
            key, k, last = (*first.location[:2], None, None)[:2] + (*first.location[-1:], "")[:1]
            is_of_step = (key, last) in (("time", "step"), ("robots", "limits"))
            if not is_of_step or step == STEPS[-1]:
                shape = robots[k].shape if key == "robots" and isinstance(k, int) else None
                more = f" (and {count - 1} more)" if count > 1 else ""
                message = f"the world made of it cannot run: {first}{more}"
                raise drawing.refusal(message, shape) from None
    if step != STEPS[0]:
        drawing.facts.append(f"steps of {step:g} s, as a robot has narrow parts")
    if size.factor != 1.0:
        drawing.facts.append(
            f"lengths and speeds of the control are the usual ones times {size.factor:g}"
        )
    text = world_text(world, source, drawing)
    if len(text) > MOST_TEXT:
        raise drawing.refusal(
            f"the world would have {len(text) / 1e6:.1f} MB, and a world file has at most "
            f"{MOST_TEXT / 1e6:.0f} MB; simplify the source"
        )
    return Imported(text, world, drawing.kind, tuple(drawing.facts), tuple(drawing.changes))
