"""From a source to a world: read it, find place and path, place the robots, write what was made."""

from __future__ import annotations

import os
import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from physim.authoring.importing.area import Place, find_place
from physim.authoring.importing.drawing import Drawing, refused
from physim.authoring.importing.drawn import Placed, as_drawn, robot_names
from physim.authoring.importing.group import fill_in, reach_of
from physim.authoring.importing.options import Options, check_options
from physim.authoring.importing.paths import drawn_paths
from physim.authoring.importing.size import Size, check_way, size_as_drawn, size_of
from physim.authoring.importing.source import FORMATS, format_of
from physim.errors import MissingExtraError, WorldError, plural
from physim.escaping import escaped
from physim.geometry.shapes import FloatArray
from physim.world import World
from physim.world.file.schema import FILE
from physim.world.ground.polyline import Polyline
from physim.world.layout.scene_builder import build_scene
from physim.world.yaml_text import yaml_text

STEPS = (0.01, 0.005, 0.002, 0.001)
"""[s] of a world, and shorter ones for robots with narrow parts"""
AGAINST = 0.5
"""[-] share of its path that leads back along the reference path of a robot that goes against it"""
MOST_TEXT = 5_000_000
"""Characters of a world file"""
SETTINGS = {
    "look_ahead": 2.0,
    "safe_distance": 1.0,
    "arrival_tolerance": 0.06,
    "distance_low": 0.5,
    "distance_high": 0.8,
    "boundary_low": 0.15,
}
"""[m] settings of the shipped controller that are lengths, at size 1"""
CORNERS = {"boundary_time_high": 1.0}
"""[s] a setting of it: else robots that had to stop before a corner may stand there for ever"""
RANGE, MARGIN = 10.0, 1.1
"""[m] of formation neighbours at size 1, and [-] how many times the longest gap between them"""
TOLERANCE = 0.1
"""[m] of arrival, at size 1"""
SPACE = 1.35
"""[-] duration over the time that the path takes at the formation's speed"""


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
    wrong with the source and where; MissingExtraError for an SVG drawing without `physim[import]`.
    """
    source, options = Path(source), options or Options()
    try:
        form = options.format or format_of(source)
        check_options(source, form, options)
        module, name = FORMATS[form].reader.split(".")
        try:
            found = import_module(f"physim.authoring.importing.{module}")
        except ModuleNotFoundError:
            if form != "svg":
                raise
            raise MissingExtraError("an SVG drawing", "import") from None
        reader: Callable[[Path, Options], Drawing] = getattr(found, name)
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
    """The world [m] and its text; its scene has been built as a run would.

    With a shorter step than usual where robots have parts too narrow for it.
    """
    factor, source = size.factor, escaped(drawing.path.name)

    def scaled(value: float) -> float:
        return float(f"{value * factor:.3g}")

    longest = max(Polyline(line).length for line in (reference, *(one.path for one in robots)))
    controller: dict[str, Any] = {"type": "mode_switching", **CORNERS}
    count = "One robot" if len(robots) == 1 else plural(len(robots), "robot")
    values: dict[str, Any] = {
        "name": options.name or (escaped(drawing.path.stem).strip() or "imported")[:100],
        "description": f"{count} in a place imported from {source}.",
        "boundaries": [line.tolist() for line in where.boundaries],
        "obstacles": [ring.tolist() for ring in where.obstacles],
        "reference_path": reference.tolist(),
        "robots": [_robot(one, None if factor == 1.0 else scaled(1.5)) for one in robots],
        "expect": {"contacts": 0, "finished": True},
        "controller": controller,
    }
    if factor != 1.0:
        controller |= {key: scaled(value) for key, value in SETTINGS.items()}
        values["arrival"] = {"tolerance": scaled(TOLERANCE)}
    if has_formation:
        stations = Polyline(reference).nearest(np.array([one.pose[:2] for one in robots]))
        gap = float(np.diff(np.sort(stations)).max(initial=0.0))  # one behind the other
        reach = scaled(max(RANGE, MARGIN * gap / factor))
        limits = [scaled(0.8), scaled(1.3)]
        values["formation"] = {
            "gain": 0.05, "speed": scaled(1.0), "limits": limits, "range": reach,
        }  # fmt: skip
    else:  # robots that may reverse stand for ever in tight bends
        controller |= {"speed": scaled(1.0), "reverse_in_safe_mode": False}
        values["sensing"] = {"range": scaled(RANGE)}
    duration = 10.0 * ceil((longest / factor * SPACE + 20.0) / 10.0)
    for step in STEPS:
        values["time"] = {"step": step, "duration": duration}
        try:
            world = World(**values)
            build_scene(world)
            break
        except WorldError as error:
            first, more = error.faults[0], len(error.faults) - 1
            at = first.location or ("",)
            is_of_step = (at[0], at[-1]) in (("time", "step"), ("robots", "limits"))
            if not is_of_step or step == STEPS[-1]:
                k = at[1] if at[0] == "robots" and len(at) > 1 else None
                shape = robots[k].shape if isinstance(k, int) else None
                message = f"the world made of it cannot run: {first}"
                message += f" (and {more} more)" if more else ""
                raise drawing.refusal(message, shape) from None
    if step != STEPS[0]:
        drawing.facts.append(f"steps of {step:g} s, as a robot has narrow parts")
    if factor != 1.0:
        drawing.facts.append(
            f"lengths and speeds of the control are the usual ones times {factor:g}"
        )
    lines = [
        f"# yaml-language-server: $schema={FILE}",
        *textwrap.wrap(f"# Imported from {source}: {drawing.kind}.", 100, subsequent_indent="# "),
    ]
    for told in (*drawing.facts, *drawing.changes):
        lines += textwrap.wrap(f"# - {escaped(told)}", 100, subsequent_indent="#   ")
    text = "\n".join(lines) + "\n" + yaml_text(world)
    if len(text) > MOST_TEXT:
        raise drawing.refusal(
            f"the world would have {len(text) / 1e6:.1f} MB, and a world file has at most "
            f"{MOST_TEXT / 1e6:.0f} MB; simplify the source"
        )
    return Imported(text, world, drawing.kind, tuple(drawing.facts), tuple(drawing.changes))


def _robot(robot: Placed, speed: float | None) -> dict[str, Any]:
    """Keys of a robot; ``speed`` [m/s] is its limit, where that is not the usual one."""
    box = robot.footprint
    keys: dict[str, Any] = {
        "name": robot.name,
        "footprint": {"length": box[0], "width": box[1]}
        if isinstance(box, tuple)
        else box.tolist(),
        "pose": list(robot.pose),
        "path": robot.path.tolist() if robot.offset is None else {"offset": robot.offset},
    }
    return keys if speed is None else {**keys, "limits": {"v": speed, "omega": 1.6}}
