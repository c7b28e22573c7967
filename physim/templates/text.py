"""The text of a new world, with a comment on every key."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import ceil

import shapely

from physim.geometry.shapes import FloatArray
from physim.templates.group import Place, fitted
from physim.templates.roads import Road
from physim.world.yaml_text import scalar_text
from physim.world_file.schema import FILE

LINE = 96
SLOWEST = 0.7
"""[m/s] along the path, by which the duration is long enough with room to spare"""


def world_text(name: str, template: str, robots: int) -> str:
    """Text of a world of that name. Raises ValueError for more robots than fit."""
    road, group = fitted(template, robots)
    lines = [*_head(name, road), *_walls(road), *_robots(group)]
    text = "\n".join(lines) + "\n" + (FORMATION if robots > 1 else "") + TAIL
    return text + "\n".join(_optional(road, group)) + "\n"


def _head(name: str, road: Road) -> Iterator[str]:
    yield f"# yaml-language-server: $schema={FILE}"
    yield f"# {road.what}"
    yield "# Lengths [m], times [s], angles [rad]; x to the right, y up, headings from the x axis,"
    yield "# counter-clockwise positive. Further keys: at the end."
    yield f"name: {scalar_text(name)}  # label: in the video, and of the folder of a run"
    yield f"description: {scalar_text(road.what)}"
    yield "seed: 1  # start of everything random, as headings are when they say so"
    yield "time:"
    yield "  step: 0.01  # [s] one physics step"
    duration = 10 * ceil((shapely.LineString(road.reference).length / SLOWEST + 10.0) / 10.0)
    yield f"  duration: {duration:.1f}  # [s] at most; the run ends when all robots have arrived"


def _walls(road: Road) -> Iterator[str]:
    if road.width is not None:
        yield "corridor:  # a road along a line; or draw walls: boundaries and reference_path"
        yield "  centreline:  # [m] points [x, y]; also the path that the formation keeps to"
        yield from _points("    ", road.reference)
        yield f"  width: {road.width}  # [m] from wall to wall; or a list, one for each point"
        yield "  end_margin: 3.0  # [m] the road goes on beyond both ends of the line, to its caps"
    else:
        note = road.notes["boundaries"]
        yield f"boundaries:  # [m] walls as polylines of points [x, y]: {note}"
        for line in road.boundaries:
            yield from _points("  - ", line)
        yield "reference_path:  # [m] points [x, y]; the formation keeps its distances along it"
        yield from _points("  ", road.reference)
    if road.obstacles:
        yield f"obstacles:  # [m] closed polygons, solid: {road.notes['obstacles']}"
        for ring in road.obstacles:
            yield from _points("  - ", ring)


def _robots(group: list[Place]) -> Iterator[str]:
    yield "robots:"
    notes = ROBOT_NOTES
    for i, place in enumerate(group):
        yield f"  - name: r{i + 1}{notes[0]}"
        yield f"    footprint: {place.footprint}{notes[1]}"
        yield f"    pose: [{place.x}, {place.offset}, 0.0]{notes[2]}"
        yield f"    path: {{offset: {place.offset}}}{notes[3]}"
        notes = ("",) * 4


def _optional(road: Road, group: list[Place]) -> Iterator[str]:
    """Keys that are left out, as they would read here."""
    x, y = group[0].x + 3.0, 0.5 * road.start_width - 0.2
    yield ""
    yield "# Left out here, each with what stands in its place:"
    yield "# start: a region [m] in which the seed places all robots that have no pose"
    corners = ", ".join(f"[{a}, {b}]" for a, b in ((-2.0, -y), (x, -y), (x, y), (-2.0, y)))
    yield f"#   start: {{region: [{corners}], heading: random, min_gap: 0.3}}"
    yield "# of a robot: its mass [kg], 100 for each m²; its largest speeds [m/s], [rad/s]"
    yield "#   limits: {v: 1.5, omega: 1.6}"
    if not road.obstacles:
        yield "# obstacles: closed polygons [m], none"
    yield "# physics: friction and elasticity in contact, 0"


ROBOT_NOTES = (
    "  # label, different for each robot",
    "  # [m] a box; or corners [x, y] in the robot's frame, x forward",
    "  # [m, m, rad] x, y and heading at the start; the heading may be: random",
    "  # [m] from the reference path, left positive; or points [x, y]",
)

FORMATION = """\
formation:  # speeds that keep the distances along the reference path; without it: controller.speed
  gain: 0.05  # [1/s] how strongly a distance error changes the speed, alpha of (7)
  speed: 1.0  # [m/s] of the group
  limits: [0.8, 1.3]  # [m/s] least and greatest speed
  spacing: initial  # wanted distances: as at the start; or a list [m], the lead over the first
  range: 10.0  # [m] robots further away along the path are not kept to, nor seen
"""

TAIL = """\
controller:
  type: mode_switching  # the paper's; others: physim list, or --controller module:Class
  look_ahead: 2.0  # [m] the point steered to lies this far ahead on the path
  safe_distance: 1.0  # [m] nearer to a wall than this is the danger area
expect:  # what the run must show; else physim run ends with exit code 1
  contacts: 0
  min_distance: 0.05  # [m] between two robots
  min_boundary_distance: 0.05  # [m] between a robot and a wall or obstacle
  finished: true  # all robots arrive
"""


def _points(head: str, points: FloatArray) -> Iterator[str]:
    pieces = [f"[{x + 0.0:.6g}, {y + 0.0:.6g}]" for x, y in points.round(2)]
    return flow_list(head, pieces, LINE)


def flow_list(head: str, pieces: Sequence[str], width: int) -> Iterator[str]:
    """Lines of ``head[piece, piece]``, a YAML list broken where it is wider than ``width`` columns.

    ``head`` holds the indentation, and the dash or key before the list.
    """
    whole = f"{head}[{', '.join(pieces)}]"
    if len(whole) <= width:
        yield whole
        return
    yield f"{head}["
    space = " " * (len(head) - len(head.lstrip(" -")))
    line = f"{space} "
    for piece in pieces:
        if line.strip() and len(line) + len(piece) + 2 > width:
            yield line
            line = f"{space} "
        line += f" {piece},"
    yield line
    yield f"{space}]"
