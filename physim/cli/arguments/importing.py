"""Arguments of ``physim import``."""

from __future__ import annotations

from pathlib import Path

from physim.cli.arguments.commands import Commands, Wrapped, lazy
from physim.cli.arguments.types import count, distance, pair, positive, size

FORMATS = ("track", "ros-map", "svg", "wkt", "geojson")

EPILOG = """\
formats, by suffix or content:
  track     centreline and widths, columns x_m, y_m, w_tr_right_m, w_tr_left_m (.csv)
  ros-map   map.yaml with its image, PGM or PNG (.yaml)
  svg       drawing with layers or ids boundary, obstacle, path, robot (.svg)
  wkt       polygons and lines as well-known text (.wkt)
  geojson   the same as GeoJSON in metres (.geojson, .json)

exit codes:
  0    the world is written; it loads and its scene builds
  2    bad input: one message says what and where, and nothing is written
  130  interrupted (Ctrl-C): no world is written

examples:
  physim import track.csv -o track.yaml --robots 6 --lanes 2
  physim import map.yaml -o office.yaml --robots 5 --from 1,2 --to 14.5,-3
  physim import plan.svg -o plan.yaml --scale 0.1
"""


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    importing = commands.add_parser(
        "import",
        help="make a world from a track, map, drawing or polygons",
        description="Make a world from a race-track CSV, ROS map, SVG drawing, WKT or GeoJSON, "
        "and list every line that was dropped or repaired. Beside it goes "
        "world.schema.json, by which editors complete keys.",
        epilog=EPILOG,
        formatter_class=Wrapped,
    )
    importing.add_argument("source", metavar="SOURCE", type=Path, help="the file to import")
    importing.add_argument(
        "-o", "--output", type=Path, metavar="WORLD", required=True, help="the world file to write"
    )
    importing.add_argument("--force", action="store_true", help="write over an existing file")
    importing.add_argument(
        "--format", choices=FORMATS, help="kind of the source (default: by suffix or content)"
    )
    importing.add_argument(
        "--name", metavar="NAME", help="name of the world (default: that of the source)"
    )
    lines = importing.add_argument_group("lines")
    lines.add_argument(
        "--scale", type=positive, metavar="M",
        help="metres per unit of the source (default: 1; svg: the document's real-world units)",
    )  # fmt: skip
    lines.add_argument(
        "--tolerance", type=positive, metavar="M",
        help="[m] how far lines may move: simplified outlines (one cell), flattened curves (0.01)",
    )  # fmt: skip
    lines.add_argument(
        "--specks", type=distance, metavar="M2",
        help="[m²] occupied patches of a map up to this area are left out (default: 2 cells)",
    )  # fmt: skip
    lines.add_argument(
        "--start", type=distance, metavar="S",
        help="[m] station at which a closed track is cut open (0)",
    )  # fmt: skip
    lines.add_argument(
        "--gap", type=positive, metavar="M", help="[m] of road left out at the cut (2)"
    )
    path = importing.add_argument_group("path and robots")
    path.add_argument(
        "--from", dest="origin", type=pair, metavar="X,Y",
        help="[m] where the path begins (default: as drawn, else far from its end)",
    )  # fmt: skip
    path.add_argument("--to", dest="goal", type=pair, metavar="X,Y", help="[m] where it ends")
    path.add_argument("--robots", type=count, metavar="N", help="robots (default: as drawn, or 1)")
    path.add_argument("--lanes", type=count, metavar="K", help="robots abreast (1)")
    path.add_argument(
        "--robot", type=size, metavar="L,W",
        help="[m] length and width of a robot (default: as large as passes, at most 1.8,1.0)",
    )  # fmt: skip
    importing.add_argument("--quiet", action="store_true", help="no report")
    importing.set_defaults(action=lazy("physim.cli.importing", "import_command"))
