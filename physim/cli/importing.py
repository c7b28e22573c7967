"""``physim import``."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from physim.cli.new import check_files, write_schema
from physim.cli.options import Count, Distance, File, Output, Place, Positive, kind, size
from physim.escaping import escaped
from physim.files import write_text

Format = Literal["track", "ros-map", "svg", "wkt", "geojson"]


def import_world(
    source: File, /, *,
    output: Output,
    force: bool = False,
    format: Format | None = None,
    name: str | None = None,
    scale: Positive | None = None,
    tolerance: Positive | None = None,
    close: Positive | None = None,
    boundary: tuple[str, ...] = (),
    ignore: tuple[str, ...] = (),
    ignore_others: bool = False,
    specks: Distance | None = None,
    start: Distance | None = None,
    gap: Positive | None = None,
    open: bool = False,
    from_: Place | None = None,
    to: Place | None = None,
    robots: Count | None = None,
    lanes: Count | None = None,
    robot: Annotated[Place | str | None, kind(size)] = None,
    no_formation: bool = False,
    no_run: bool = False,
    quiet: bool = False,
) -> int:  # fmt: skip
    """Make a world from a race-track CSV, ROS map, SVG drawing, WKT or GeoJSON, and list every line
    that was dropped or repaired. Also write world.schema.json beside it: editors use it to complete
    keys.

    arguments:
      SOURCE  the file to import

    options:
      -o, --output WORLD  the world file to write
      --force  overwrite an existing file
      --format  kind of the source (default: by suffix)
      --name NAME  name of the world (default: that of the source)
      --no-run  check the new world as physim check does, but without a trial run
      --quiet  print no report and do not check the world

    lines:
      --scale M  metres per unit of the source (default: 1; svg: the document's real-world units)
      --tolerance M  [m] how far lines may move when outlines of a map are simplified (default: one
          cell) or curves are flattened (default: 0.01)
      --close M  [m] join ends of walls, and of pieces of a path, that are at most this far apart
      --boundary ID  use this shape or group of an SVG drawing (its id or label) as a wall (may be
          repeated)
      --ignore NAME  leave out this shape, group or feature, which has no role (may be repeated)
      --ignore-others  leave out all shapes and features without a role
      --specks M2  [m²] leave out occupied patches of a map up to this area (default: 2 cells)
      --start S  [m] station at which a closed track is cut open (0)
      --gap M  [m] of road left out at the cut (2)
      --open  the track is open, even if its ends are close together

    path and robots:
      --from X,Y  [m] where the path begins (default: as drawn, else far from its end)
      --to X,Y  [m] where it ends
      --robots N  number of robots (default: as drawn, or 1)
      --lanes K  number of robots side by side (1)
      --robot L,W|fit  [m] length and width of a robot (1.8,1.0); or fit: as large as possible, at
          most 1.8,1.0
      --no-formation  each robot drives by itself, not in a formation

    formats, by suffix:
      track     centreline and widths, columns x_m, y_m, w_tr_right_m, w_tr_left_m (.csv)
      ros-map   map.yaml with its image, PGM or PNG (.yaml)
      svg       drawing with layers or ids boundary, obstacle, path, robot (.svg); needs
                pip install "physim[import]"
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
    from physim.cli.check import looked_at

    check_files(output, force, source)
    asked = dict[str, Any](
        format=format, scale=scale, tolerance=tolerance, specks=specks, start=start, gap=gap,
        open=open, origin=from_, goal=to, robots=robots, lanes=lanes, robot=robot, name=name,
        no_formation=no_formation, close=close, boundary=boundary, ignore=ignore,
        ignore_others=ignore_others,
    )  # fmt: skip
    imported = importing.import_world(source, importing.Options(**asked))
    written = write_schema(output, force)  # first: without the world nothing is imported
    write_text(output, imported.text)
    if quiet:
        return 0
    print(f"{source}: {imported.kind}", *map(escaped, imported.facts), sep="\n  ")
    head = f"dropped or repaired:{'' if imported.changes else ' nothing'}"
    print(head, *map(escaped, imported.changes), sep="\n  ", flush=True)
    try:
        findings, trial = looked_at(output, run=not no_run, quiet=False)
        print(*filter(None, [trial]), findings, sep="\n")
    except KeyboardInterrupt:  # ends that alone: the world is there
        print("interrupted: neither checked nor tried to the end")
    print(written)
    return 0
