"""From a source to a world: read, enclose, find a path, place the robots, write, and check."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import numpy as np

from physim.errors import WorldError, plural
from physim.importing.drawing import Drawing, Options, number, place, printable, refused
from physim.importing.drawn import as_drawn
from physim.importing.enclosure import enclose
from physim.importing.fit import Fit, fit
from physim.importing.group import fill_in
from physim.importing.line import length_of
from physim.importing.soundness import LARGEST_PLACE, check_size, check_sound
from physim.importing.source import format_of
from physim.importing.stops import Placed, stop_warnings
from physim.importing.world_text import world_text
from physim.scene_builder import build_scene
from physim.world import World
from physim.world_file import parse_world

READERS = {
    "track": ("physim.importing.track", "read_track"),
    "ros-map": ("physim.importing.ros_map", "read_ros_map"),
    "svg": ("physim.importing.svg", "read_svg"),
    "wkt": ("physim.importing.polygons", "read_wkt"),
    "geojson": ("physim.importing.geojson", "read_geojson"),
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


def import_world(source: Path, options: Options | None = None) -> Imported:
    """Make a world of a race-track CSV, ROS map, SVG drawing, WKT or GeoJSON file.

    The world has been loaded and its scene built, so `physim run` takes it. Raises
    ImportSourceError, which says what is wrong with the source and where.
    """
    options = options or Options()
    form = options.format or format_of(source)
    module, name = READERS[form]
    reader: Callable[[Path, Options], Drawing] = getattr(import_module(module), name)
    drawing = reader(source, options)
    check_sound(source, drawing)
    if drawing.area is None:
        enclose(source, drawing, options.origin)
    _check_extent(source, drawing)
    _find_route(source, drawing, options)
    found = fit(source, drawing, options)
    drawn = bool(drawing.robots) and options.robots is None
    if drawing.robots and not drawn:
        drawing.changes.append(
            f"{plural(len(drawing.robots), 'robot')} as drawn left out (--robots)"
        )
    if drawn:
        robots = as_drawn(drawing, found)
    else:
        found, robots = fill_in(source, drawing, found, options)
    drawing.facts += _about(drawing, found, robots, options)
    drawing.facts += stop_warnings(found.reference, robots, found.size)
    text = world_text(options.name or _name(source), printable(source.name), drawing, found, robots)
    return Imported(
        text, _checked(source, text), drawing.kind, tuple(drawing.facts), tuple(drawing.changes)
    )


def _check_extent(source: Path, drawing: Drawing) -> None:
    """Refuse a place too small for robots, and report one that is hardly in metres."""
    x0, y0, x1, y1 = drawing.area.bounds
    check_size(source, np.array([x1 - x0, y1 - y0]))
    if max(x1 - x0, y1 - y0) > LARGEST_PLACE:
        drawing.changes.append(
            f"mind the scale: the place is {x1 - x0:.3g} x {y1 - y0:.3g} m (--scale 0.001 for "
            "millimetres)"
        )


def _find_route(source: Path, drawing: Drawing, options: Options) -> None:
    """Find a path where none is drawn, or where the user asks for another."""
    if drawing.reference is not None:
        if options.origin is None and options.goal is None:
            return
        drawing.changes.append("path of the source left out: --from and --to ask for another")
    find = import_module("physim.importing.route").find_route
    find(source, drawing, options)


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
        return [*facts, f"{count} as drawn"]
    lanes = plural(min(options.lanes or 1, len(robots)), "lane")
    chosen = "as asked (--robot)"
    if options.robot is None and drawing.robots:
        drawn = len(drawing.robots)
        which = "the robot drawn" if drawn == 1 else f"the largest of {drawn} robots drawn"
        chosen = f"the size of {which} (--robot)"
    elif options.robot is None:
        chosen = "as large as has room, at most 1.8 x 1.0 m (--robot)"
    box = f"{number(found.box[0])} x {number(found.box[1])} m"
    return [*facts, f"{count} in {lanes}, {box}, {chosen}"]


def _name(source: Path) -> str:
    return (printable(source.stem).strip() or "imported")[:100]


def _checked(source: Path, text: str) -> World:
    """Load the world and build its scene, as a run would."""
    if len(text) > 5_000_000:
        raise refused(
            source,
            f"the world would have {len(text) / 1e6:.1f} MB, and a world file has at most 5 MB; "
            "use a larger --tolerance",
        )
    try:
        world = parse_world(text, "the world")
        build_scene(world)
    except WorldError as error:
        first = error.faults[0]
        more = f" (and {len(error.faults) - 1} more)" if len(error.faults) > 1 else ""
        raise refused(source, f"the world made of it cannot run: {first}{more}") from None
    return world
