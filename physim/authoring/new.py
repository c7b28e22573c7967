"""New worlds for ``physim new``: a shipped one with a comment on every key, a road written out as a
seed draws it, and a project, which is a folder to work in.
"""

from __future__ import annotations

import json
import re
import shlex
import textwrap
from collections.abc import Iterator
from typing import Any

import yaml

from physim._version import __version__
from physim.errors import ControllerError, Fault, Location, PhysimError, WorldError
from physim.escaping import escaped
from physim.parts.registry import CONTROLLER, DRIVE, STAGES, find_part, settings_model
from physim.world import RandomCorridor, RobotGroup, World
from physim.world.faults import field_at
from physim.world.file import read_document, read_world
from physim.world.file.schema import FILE
from physim.world.kinds import MOST_ROBOTS
from physim.world.layout.layout import lay_out

WIDTH = 100
"""Columns of a comment"""
EXAMPLES = {
    "sensing": "{stages: [{type: noise, position: 0.05}, {type: messages, probability: 0.1}]}",
    "disturbances": "[{type: actuation, v: {noise: 0.05}}]",
    "movers": (
        "[{name: cart, footprint: {length: 1, width: 1}, waypoints: [[9, -2], [9, 2]], speed: 0.5}]"
    ),
}
"""Of keys whose values are hard to guess"""


def new_text(name: str, like: str, robots: int | None = None) -> str:
    """Text of a world called ``name`` like another, with a comment on every key.

    ``robots`` is how many its group has, where it has one. Raises WorldError where the other world
    cannot be read, PhysimError where it has no group or no room for so many.
    """
    world, _ = read_world(like)
    if robots is not None:
        groups = [k for k, one in enumerate(world.robots) if isinstance(one, RobotGroup)]
        if len(groups) != 1:
            raise PhysimError(
                f"--robots {robots}: {like} lists its robots one by one; add them to the file, or "
                "take a world with one group (count), as --like hundred_robots"
            )
        if not 1 <= robots <= MOST_ROBOTS:
            raise PhysimError(f"--robots {robots}: must be from 1 to {MOST_ROBOTS}")
        world, document = read_world(like, overrides=[f"robots.{groups[0]}.count={robots}"])
        try:
            lay_out(world)
        except WorldError as error:
            raise document.error(error.faults) from None
    return "\n".join(_commented(world.changed(name=name))) + "\n"


def _commented(world: World) -> Iterator[str]:
    """Lines of a world; what a key means stands beside it, or above it, where it comes first."""
    text = world.to_yaml()
    document = read_document(text)
    notes: dict[int, str] = {}
    told: set[Location] = set()
    nodes: list[tuple[Location, Any]] = [((), document.root)]
    while nodes:
        location, node = nodes.pop()
        if isinstance(node, yaml.SequenceNode):
            nodes += [((*location, k), item) for k, item in enumerate(node.value)][::-1]
        for key, item in node.value[::-1] if isinstance(node, yaml.MappingNode) else ():
            nodes.append(((*location, key.value), item))
        kind = tuple(part for part in location if not isinstance(part, int))
        if location and isinstance(location[-1], str) and kind not in told:
            told.add(kind)
            row = document.position(location, of_key=True).line
            notes.setdefault(row, _meaning(world, document.values, location))
    yield f"# yaml-language-server: $schema={FILE}"
    yield "# Lengths [m], times [s], angles [rad]; x to the right, y up, headings from the x axis,"
    yield "# counter-clockwise positive. Further keys: at the end."
    for number, line in enumerate(text.splitlines(), start=1):
        note = notes.get(number, "")
        bare = re.sub(r"  # \[[^\]]+\]$", "", line) if note else line
        if note and len(bare) + len(note) + 4 > WIDTH:
            yield from _comment(note, " " * (len(line) - len(line.lstrip(" "))))
            note = ""
        yield f"{bare}  # {note}" if note else bare
    yield ""
    yield "# Left out here (a line that begins with # alone is an example: remove its #):"
    for key, field in World.model_fields.items():
        if key not in document.values:
            yield from _comment(f"{key}: {field.description}")
            if key in EXAMPLES:
                yield f"#{key}: {EXAMPLES[key]}"
    for key, field in type(world.robots[0]).model_fields.items():
        if key not in document.values["robots"][0]:
            yield from _comment(f"of a robot, {key}: {field.description}")


def _comment(text: str, space: str = "") -> list[str]:
    return textwrap.wrap(text, WIDTH, initial_indent=f"{space}# ", subsequent_indent=f"{space}#   ")


def _meaning(world: World, values: Any, location: Location) -> str:
    """Description of the key at a location, those of the settings of parts too."""
    if field := field_at(World, location):
        return field.description or ""
    for kind in (CONTROLLER, *STAGES, DRIVE):
        if location[: len(kind.key)] == kind.key or (kind == DRIVE and "drive" in location):
            for key in location[:-1]:
                values = values[key]
            try:
                found = find_part(kind, values.get("type", world.controller.type))
                model = settings_model(found)
            except ControllerError:
                return ""
            field = model.model_fields.get(str(location[-1])) if model is not None else None
            return (field.description or "") if field is not None else ""
    return ""


def drawn_text(name: str, like: str, seed: int) -> str:
    """Text of a world called ``name``: another one, with its road as a seed draws it.

    Numbers are those of the drawn road to the last bit, so that a run of it moves as one of the
    other does; what else is random still comes from the same seed. Raises WorldError where there
    is no such road, or it cannot be drawn.
    """
    world, document = read_world(like, seed=seed, check_controller=False)
    if not isinstance(world.corridor, RandomCorridor):
        message = "has no corridor.random, so nothing of its road is drawn; leave out --seed"
        raise document.error([Fault((), message)])
    try:
        laid = lay_out(world)
    except WorldError as error:
        raise document.error(error.faults) from None
    margin = world.corridor.end_margin
    plain = world.changed(
        name=name,
        corridor={"centreline": laid.centreline, "width": laid.widths, "end_margin": margin},
        reference_path=laid.reference,
        obstacles=laid.obstacles,
    )
    made_by = shlex.join(["physim", "new", name, "--like", like, "--seed", str(seed)])
    lines = [
        f"# yaml-language-server: $schema={FILE}",
        f"# The road of {escaped(world.name)} as seed {seed} draws it, made by physim "
        f"{__version__} with",
        f"#   {escaped(made_by)}",
    ]
    return "\n".join(lines) + "\n" + plain.to_yaml()


CORRIDOR = """\
# yaml-language-server: $schema={schema}
# Four robots drive two abreast through a corridor that bends and narrows. The seed decides where
# each of them starts and which way it faces.
# Lengths are in metres [m], times in seconds [s], angles in radians [rad]; x points right, y up.
name: {name}
description: Four robots drive two abreast through a corridor that bends and narrows.
seed: 1  # another seed, other starts
time: {{step: 0.01, duration: 60.0}}  # [s] of one step of the physics, and of the longest run
corridor:
  # [m] points along the middle of the corridor, and how wide it is at each of them
  centreline: [[0.0, 0.0], [14.0, 0.0], [20.0, 2.0], [26.0, 6.0], [32.0, 8.0], [46.0, 8.0]]
  width: [6.0, 6.0, 5.0, 4.0, 5.0, 6.0]
start:
  region: [[1.0, -2.8], [11.0, -2.8], [11.0, 2.8], [1.0, 2.8]]  # [m] corners of where they start
  heading: random  # or along: all face the way they go
  abreast: 2  # r1 and r2 start in front, r3 and r4 behind them
robots:
  # footprint: a rectangle, or any polygon with x forward [m]
  # path: parallel to the middle of the corridor, 1 m to its left (1.0) or right (-1.0)
  - {{name: r1, footprint: {{length: 1.6, width: 0.9}}, path: {{offset: 1.0}}}}
  - {{name: r2, footprint: {{length: 1.6, width: 0.9}}, path: {{offset: -1.0}}}}
  - {{name: r3, footprint: [[0.9, 0.0], [-0.7, 0.5], [-0.7, -0.5]], path: {{offset: 1.0}}}}
  - {{name: r4, footprint: {{length: 1.2, width: 1.0}}, path: {{offset: -1.0}}}}
formation:
  speed: 1.0  # [m/s] of the group
  spacing: [0.0, -1.5, -4.0, -5.5]  # [m] how far each robot stays behind r1
controller: {{type: mode_switching}}  # the paper's; physim list names the others
expect: {{contacts: 0, finished: true}}  # a run that misses this exits with code 1
"""

EXAMPLE = '''\
"""An example of a controller, to be changed."""

from math import atan2, cos, pi, sin

from physim import Decision, Mode


class Mine:
    """Drives to a point 2 m ahead on its path; waits while another robot is in front of it."""

    modes = (
        Mode("go", "#0072b2", "drives along its path"),
        Mode("wait", "#e69f00", "waits for a robot in front", danger=True),
        Mode("there", "#009e73", "has arrived"),
    )

    def decide(self, observation, memory):
        o = observation
        x, y, heading = o.pose  # [m, m, rad]
        tx, ty = o.path.target(o.station, 2.0)  # [m] the point to drive to
        error = (atan2(ty - y, tx - x) - heading + pi) % (2 * pi) - pi  # [rad]
        v, omega, mode = min(1.0, o.limits[0]), 2.0 * error, "go"  # [m/s], [rad/s]
        in_front = []
        for other in o.others:
            dx, dy = other.pose[0] - x, other.pose[1] - y
            ahead = dx * cos(heading) + dy * sin(heading)  # [m]
            beside = dy * cos(heading) - dx * sin(heading)  # [m] to the left
            if 0.0 < ahead < 2.5 and abs(beside) < 1.2:
                v, mode = 0.0, "wait"
                in_front.append(other.index)
        if o.station >= o.stop_station - 0.05:  # [m]
            v, omega, mode = 0.0, 0.0, "there"
        omega = max(-o.limits[1], min(o.limits[1], omega))
        # asks again after 0.1 s
        return Decision(v=v, omega=omega, hold=0.1, mode=mode, considered=in_front)
'''

README = """\
# {title}

`worlds/` holds worlds, `controllers/` holds controllers. Look at the world first, then run it with
the controller in `controllers/mine.py`:

```sh
physim check worlds/{stem}.yaml
physim preview worlds/{stem}.yaml
physim run worlds/{stem}.yaml --controller controllers.mine:Mine --page -o runs/mine
```

- `check`: is the world sound? It lists every fault with its line, then tries the world once.
- `preview`: what does the world look like? It draws `{stem}.png`.
- `run`: what does the controller do? Watch `runs/mine/video.mp4`, or open `runs/mine/page.html`
  in a browser and click on a robot to see why it acts as it does.

One run says little. Run it from 20 starts, and the paper's controller from the same starts:

```sh
physim sweep worlds/{stem}.yaml --seeds 1:21 -o sweeps/first \\
  --controller mode_switching,controllers.mine:Mine
physim report sweeps/first --controller controllers.mine:Mine
physim compare sweeps/first --by controller
```

- `sweep`: what happens from each start? It writes a row per run and names the runs to look at.
- `report`: how often does a robot touch something, or not arrive? It prints rates with intervals
  and writes `sweeps/first/report.html`, with pictures of the worst runs.
- `compare`: is one controller better? It compares them start by start. Where it says "no
  difference shown", 20 starts are too few to tell: the same sweep with `--seeds 1:101` adds 80.

Now change `controllers/mine.py`, and sweep again with `-o sweeps/second`.
"""


def corridor_text(name: str) -> str:
    """Text of a world called ``name`` for a project: a corridor, and starts that the seed draws."""
    return CORRIDOR.format(schema=FILE, name=json.dumps(name, ensure_ascii=False))


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
        "controllers/mine.py": EXAMPLE,
    }
