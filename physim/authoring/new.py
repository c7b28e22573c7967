"""New worlds for ``physim new``: a shipped one with a comment on every key, a road written out as a
seed draws it, and a project, which is a folder to work in.
"""

from __future__ import annotations

import re
import shlex
import textwrap
from collections.abc import Iterator
from typing import Any

import yaml

from physim._version import __version__
from physim.errors import ControllerError, Fault, Location, PhysimError, WorldError
from physim.escaping import escaped
from physim.parts.registry import CONTROLLER, STAGES, find_part, settings_model
from physim.world import RandomCorridor, RobotGroup, World
from physim.world.faults import field_at
from physim.world.file import read_document, read_world
from physim.world.file.schema import FILE
from physim.world.kinds import MOST_ROBOTS
from physim.world.layout.layout import lay_out

WIDTH = 100
"""Columns of a comment"""


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
    yield "# Left out here:"
    for key, field in World.model_fields.items():
        if key not in document.values:
            yield from _comment(f"{key}: {field.description}")
    for key, field in type(world.robots[0]).model_fields.items():
        if key not in document.values["robots"][0]:
            yield from _comment(f"of a robot, {key}: {field.description}")


def _comment(text: str, space: str = "") -> list[str]:
    return textwrap.wrap(text, WIDTH, initial_indent=f"{space}# ", subsequent_indent=f"{space}#   ")


def _meaning(world: World, values: Any, location: Location) -> str:
    """Description of the key at a location, those of the settings of parts too."""
    if field := field_at(World, location):
        return field.description or ""
    for kind in (CONTROLLER, *STAGES):
        if location[: len(kind.key)] == kind.key:
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


EXAMPLE = '''\
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
        "controllers/cautious.py": EXAMPLE,
        "media/README.md": MEDIA.format(stem=stem),
    }
