"""The text of a new world, with a comment on every key, and of a new project.

Robots stand in lanes, as many abreast as the road is wide enough for. A project is a folder to
work in: worlds, controllers, media, and a README with the next commands.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil

import shapely

from physim.authoring.templates.roads import LONGEST, ROADS, Road
from physim.geometry.shapes import FloatArray
from physim.world.file.schema import FILE
from physim.world.yaml_text import flow_list, scalar_text

LANE = 2.0
"""[m] from one lane to the next: robots 1 m wide pass at 1 m, above the distance at which the
controller's danger mode begins and ends"""
EDGE = 1.3
"""[m] from the middle of an outer lane to the wall at least: the danger area and some more"""
ROW, FILE_ROW = 4.0, 3.5
"""[m] from one robot to the next in a lane; where there is one lane only"""
BACK, FRONT = 1.0, 4.0
"""[m] from the beginning of the straight stretch to the last robot, from the first to its end"""

FOOTPRINTS = (
    "{length: 1.8, width: 1.0}",
    "{length: 1.5, width: 0.9}",
    "[[0.9, 0.0], [0.4, 0.5], [-0.8, 0.5], [-0.8, -0.5], [0.4, -0.5]]",
)
"""Taken in turn"""
BOX = (1.2, 0.7)
"""[m] half the region in which the seed draws a start: a footprint, and 0.2 m or more round it"""


@dataclass(frozen=True)
class Place:
    """Where one robot starts: x [m] along the straight stretch, and its lane's offset [m]."""

    x: float
    offset: float
    footprint: str


def lanes_of(width: float) -> int:
    """Lanes that a road of that width [m] has room for, at least one."""
    return max(1, 1 + int((width - 2.0 * EDGE) / LANE + 1e-9))


def lane_offsets(lanes: int) -> list[float]:
    """Offsets [m] of lanes abreast, left positive, in the order in which robots take them.

    From the middle outwards, left before right.
    """
    offsets = [LANE * (k - 0.5 * (lanes - 1)) for k in range(lanes)]
    return sorted(offsets, key=lambda offset: (abs(offset), -offset))


def places(width: float, robots: int) -> list[Place]:
    """Starts of a group in lanes that fit into a width [m], the first robot foremost.

    The last one stands at x = `BACK`. Neighbours stand staggered, so that each has one robot beside
    it at a time. Small groups take fewer lanes.
    """
    lanes = min(lanes_of(width), ceil(robots / 2))
    offsets = lane_offsets(lanes)
    apart = (ROW if lanes > 1 else FILE_ROW) / lanes
    return [
        Place(
            round(BACK + apart * (robots - 1 - i), 2),
            offsets[i % lanes],
            FOOTPRINTS[i % len(FOOTPRINTS)],
        )
        for i in range(robots)
    ]


def fitted(template: str, robots: int) -> tuple[Road, list[Place]]:
    """Road of a template, as long as the group needs, and where that starts.

    Raises ValueError for more robots than its longest straight stretch holds.
    """
    make = ROADS[template]
    found = places(make(LONGEST).narrowest, robots)
    straight = found[0].x + FRONT
    if straight > LONGEST:
        raise ValueError(f"{robots} robots do not fit; {most_robots(template)} do")
    return make(straight), found


def most_robots(template: str) -> int:
    """Largest group that a template has room for."""
    width, robots = ROADS[template](LONGEST).narrowest, 1
    while places(width, robots + 1)[0].x + FRONT <= LONGEST:
        robots += 1
    return robots


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
    yield f"seed: 1  # draws {'the road and ' if road.drawn else ''}where robots start; or --seed N"
    yield "time:"
    yield "  step: 0.01  # [s] one physics step"
    duration = 10 * ceil((shapely.LineString(road.reference).length / SLOWEST + 10.0) / 10.0)
    yield f"  duration: {duration:.1f}  # [s] at most; the run ends when all robots have arrived"


def _walls(road: Road) -> Iterator[str]:
    if road.drawn:
        yield "corridor:  # a road that the seed draws; physim new NAME --from FILE writes it out"
        yield "  random:  # instead of this: centreline and width, as in the template corridor"
        for key, value, note in road.drawn:
            yield f"    {key}: {value}  # {note}"
        yield "  end_margin: 3.0  # [m] the road goes on beyond both ends of the line, to its caps"
    elif road.width is not None:
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
        if i == 0:
            pose = f"pose: [{place.x}, {place.offset}, 0.0]"
            yield f"    # the seed draws where it starts, within a region; {pose} in place of"
            yield "    # start draws nothing: with one for every robot all seeds give the same run"
        yield f"    start: {{region: {_box(place)}, heading: 0.0}}{notes[2]}"
        yield f"    path: {{offset: {place.offset}}}{notes[3]}"
        notes = ("",) * 4


def _box(place: Place) -> str:
    (x, y), (a, b) = (place.x, place.offset), BOX
    corners = ((x - a, y - b), (x + a, y - b), (x + a, y + b), (x - a, y + b))
    return f"[{', '.join(f'[{u:.4g}, {v:.4g}]' for u, v in corners)}]"


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
    if not road.obstacles and not road.drawn:
        yield "# obstacles: closed polygons [m], none"
    yield "# physics: friction and elasticity in contact, 0"


ROBOT_NOTES = (
    "  # label, different for each robot",
    "  # [m] a box; or corners [x, y] in the robot's frame, x forward",
    "  # [m], [rad]",
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
expect:  # what the run must satisfy; else physim run ends with exit code 1
  contacts: 0
  min_distance: 0.05  # [m] between two robots
  min_boundary_distance: 0.05  # [m] between a robot and a wall or obstacle
  finished: true  # all robots arrive
"""


def _points(head: str, points: FloatArray) -> Iterator[str]:
    pieces = [f"[{x + 0.0:.6g}, {y + 0.0:.6g}]" for x, y in points.round(2)]
    return flow_list(head, pieces, LINE)


CONTROLLER = '''\
"""A controller to begin with: it is given a physim.Observation and returns a Decision."""

from math import atan2, hypot, pi

from physim import Decision, Mode


class Cautious:
    """Steer to a point 2 m ahead; wait while a robot further along is within 2.2 m."""

    # name, colour, words; summary, plots and video show them
    modes = (
        Mode("go", "#0072b2", "on its way"),
        Mode("wait", "#e69f00", "waits for another", danger=True),
        Mode("there", "#009e73", "at its stop station"),
    )

    def decide(self, observation, memory):
        o = observation
        if o.station >= o.stop_station - 0.05:  # [m]
            return Decision(v=0.0, omega=0.0, hold=0.1, mode="there")
        x, y, heading = o.pose  # [m, m, rad]
        tx, ty = o.path.target(o.station, 2.0)  # [m]
        error = (atan2(ty - y, tx - x) - heading + pi) % (2 * pi) - pi
        omega = max(-o.limits[1], min(o.limits[1], 2.0 * error))  # [rad/s]
        ahead = [s for s in o.others if s.station > o.reference_station]
        near = any(hypot(s.pose[0] - x, s.pose[1] - y) < 2.2 for s in ahead)
        v, mode = (0.0, "wait") if near else (min(0.8, o.limits[0]), "go")
        return Decision(v=v, omega=omega, hold=0.1, mode=mode)  # [m/s], [rad/s], [s]
'''

README = """\
# {title}

`worlds/` holds the worlds, `controllers/` controllers of your own, `media/` what is worth keeping.
Runs go to `runs/`. In this folder:

```sh
physim preview worlds/{stem}.yaml -o media/{stem}.png
physim run worlds/{stem}.yaml -o runs/{stem}
physim run worlds/{stem}.yaml -o runs/cautious --controller controllers.cautious:Cautious
```

The first draws the world, the second runs it with its own controller and writes record, video and
summary, the third runs it with the one in `controllers/cautious.py`. An editor that knows YAML
schemas completes the keys of a world and shows what they mean.
"""

MEDIA = """\
# Media

| file | made by |
|---|---|
| `{stem}.png` | `physim preview worlds/{stem}.yaml -o media/{stem}.png` |
"""


def new_project(title: str, stem: str, world: str, schema: str) -> dict[str, str]:
    """Text of every file of a new project, by its path in the folder.

    ``stem`` is the file name of the first world, without its ending; ``world`` its text.
    """
    return {
        "README.md": README.format(title=title, stem=stem),
        ".gitignore": "runs/\nsweeps/\nfalsified/\n__pycache__/\n",
        f"worlds/{stem}.yaml": world,
        "worlds/world.schema.json": schema,
        "controllers/__init__.py": "",
        "controllers/cautious.py": CONTROLLER,
        "media/README.md": MEDIA.format(stem=stem),
    }
