"""``physim import``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from physim.cli.new import check_schema, write_schema
from physim.cli.output import its_folder, new_file, world_name, write_text
from physim.cli.parser import Options, command, flag, option
from physim.cli.values import COUNT, DISTANCE, PATH, POSITIVE, OneOf, Value, pair, size

if TYPE_CHECKING:
    from physim.authoring.importing import Imported

FORMATS = ("track", "ros-map", "svg", "wkt", "geojson")
LINES, ROUTE = "Lines", "Path and robots"
ASKED = (
    "format", "scale", "tolerance", "specks", "start", "gap", "open", "origin", "goal", "robots",
    "lanes", "robot", "no_formation", "close", "name", "boundary", "ignore", "ignore_others",
)  # fmt: skip


@command("import", "a world from a track, map, drawing or polygons")
@click.argument("source", metavar="SOURCE", type=PATH, help="the file to import")
@option("-o", "--output", type=PATH, metavar="WORLD", required=True, help="the world file to write")
@flag("--force", "overwrite an existing file")
@option("--format", type=OneOf(FORMATS), help="kind of the source (default: by suffix)")
@option("--name", metavar="NAME", help="name of the world (default: that of the source)")
@option(
    "--scale",
    type=POSITIVE,
    metavar="M",
    section=LINES,
    help="metres per unit of the source (default: 1; svg: the document's real-world units)",
)
@option(
    "--tolerance",
    type=POSITIVE,
    metavar="M",
    section=LINES,
    help="[m] how far lines may move: simplified outlines (one cell), flattened curves (0.01)",
)
@option(
    "--close",
    type=POSITIVE,
    metavar="M",
    section=LINES,
    help="[m] join ends of walls, and of pieces of a path, that are at most so far apart",
)
@option(
    "--boundary",
    multiple=True,
    metavar="ID",
    section=LINES,
    help="a shape or group of an SVG drawing, by id or label, that is a wall (may be repeated)",
)
@option(
    "--ignore",
    multiple=True,
    metavar="NAME",
    section=LINES,
    help="a shape, group or feature without a role that is left out (may be repeated)",
)
@flag("--ignore-others", "leave out all shapes and features without a role", section=LINES)
@option(
    "--specks",
    type=DISTANCE,
    metavar="M2",
    section=LINES,
    help="[m²] occupied patches of a map up to this area are left out (default: 2 cells)",
)
@option(
    "--start",
    type=DISTANCE,
    metavar="S",
    section=LINES,
    help="[m] station at which a closed track is cut open (0)",
)
@option(
    "--gap", type=POSITIVE, metavar="M", section=LINES, help="[m] of road left out at the cut (2)"
)
@flag("--open", "the track is an open one, near as its ends may be", section=LINES)
@option(
    "--from",
    "origin",
    type=Value(pair),
    metavar="X,Y",
    section=ROUTE,
    help="[m] where the path begins (default: as drawn, else far from its end)",
)
@option("--to", "goal", type=Value(pair), metavar="X,Y", section=ROUTE, help="[m] where it ends")
@option("--robots", type=COUNT, metavar="N", section=ROUTE, help="robots (default: as drawn, or 1)")
@option("--lanes", type=COUNT, metavar="K", section=ROUTE, help="robots abreast (1)")
@option(
    "--robot",
    type=Value(size),
    metavar="L,W|fit",
    section=ROUTE,
    help="[m] length and width of a robot (1.8,1.0), or fit: as large as fits, at most that",
)
@flag("--no-formation", "robots go each by itself, not in a formation", section=ROUTE)
@flag("--untried", "do not drive the world made once, to see if all robots arrive")
@flag("--quiet", "no report, and no drive")  # fmt: skip
def import_command(options: Options) -> int:
    """Make a world from a race-track CSV, ROS map, SVG drawing, WKT or GeoJSON, and list every line
    that was dropped or repaired. Beside it goes world.schema.json, by which editors complete keys.

    formats, by suffix:
      track     centreline and widths, columns x_m, y_m, w_tr_right_m, w_tr_left_m (.csv)
      ros-map   map.yaml with its image, PGM or PNG (.yaml)
      svg       drawing with layers or ids boundary, obstacle, path, robot (.svg)
      wkt       polygons and lines as well-known text (.wkt)
      geojson   the same as GeoJSON in metres (.geojson, .json)

    exit codes:
      0    the world is written; it loads and its scene builds
      2    bad input: one message says what and where, and nothing is written
      130  interrupted (Ctrl-C): no world is written, unless the report says so

    examples:
      physim import track.csv -o track.yaml --robots 6 --lanes 2
      physim import map.yaml -o office.yaml --robots 5 --robot fit --from 1,2 --to 14.5,-3
      physim import plan.svg -o plan.yaml --scale 0.1
    """
    # both now: Ctrl-C in the import of a module would end the command with the world just written
    from physim.authoring import importing
    from physim.cli.check import judge

    source, output = options.source, options.output
    _check_output(source, output, options.force)
    asked = importing.Options(**{key: getattr(options, key) for key in ASKED})
    imported = importing.import_world(source, asked)
    written = write_schema(output, options.force)  # first: without the world nothing is imported
    write_text(output, imported.text)
    if not options.quiet:
        *files, steps = written.splitlines()
        print("\n".join([*_report(source, imported), *files]), flush=True)
        judge(output, not options.untried)
        print(steps)
    return 0


def _check_output(source: Path, output: Path, force: bool) -> None:
    world_name(output)
    new_file(output, force, source)
    its_folder(output)
    check_schema(output, force, source)


def _report(source: Path, imported: Imported) -> list[str]:
    changes = "" if imported.changes else " nothing"
    return [
        f"{source}: {imported.kind}",
        *(f"  {fact}" for fact in imported.facts),
        f"dropped or repaired:{changes}",
        *(f"  {change}" for change in imported.changes),
    ]
