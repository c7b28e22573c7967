"""The text of an imported world, pleasant to read: lengths to the millimetre, sources named."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from math import ceil

from physim.authoring.importing.drawing import Drawing, number
from physim.authoring.importing.fit import Fit
from physim.authoring.importing.formation import RANGE, neighbour_range
from physim.authoring.importing.lines import length_of
from physim.authoring.importing.placed import Placed
from physim.escaping import escaped
from physim.geometry.shapes import FloatArray
from physim.world.file.schema import FILE
from physim.world.yaml_text import flow_list, scalar_text

LINE = 100
SETTINGS = {
    "look_ahead": 2.0,
    "safe_distance": 1.0,
    "arrival_tolerance": 0.06,
    "distance_low": 0.5,
    "distance_high": 0.8,
    "boundary_low": 0.15,
}
"""[m] settings of the shipped controller that are lengths, at size 1"""
CORNERS = "boundary_time_high: 1.0"
"""A setting of it [s]: else robots that had to stop before a corner may stand there for ever"""
FORWARD = "reverse_in_safe_mode: false"
"""A setting of it without a formation: robots that may reverse stand for ever in tight bends"""
TOLERANCE = 0.1
"""[m] of arrival, at size 1"""
SPACE = 1.35
"""[-] duration over the time that the path takes at the formation's speed"""


def world_text(
    name: str, source: str, drawing: Drawing, found: Fit, robots: list[Placed], step: float
) -> str:
    """YAML text of the world, run in steps of ``step`` [s]; loading it checks it."""
    lines = [f"# yaml-language-server: $schema={FILE}", *_heading(source, drawing)]
    group = "One robot" if len(robots) == 1 else f"{len(robots)} robots"
    longest = max(length_of(path) for path in (found.reference, *(one.path for one in robots)))
    duration = 10.0 * ceil((longest / found.size * SPACE + 20.0) / 10.0)
    lines.append(f"name: {scalar_text(name)}")
    lines.append(f"description: {scalar_text(f'{group} in a place imported from {source}.')}")
    lines.append(f"time: {{step: {step:g}, duration: {duration:.1f}}}  # [s]")
    lines.append("boundaries:  # [m] polylines, points x, y")
    for boundary in drawing.boundaries:
        lines += _points("  - ", boundary)
    if drawing.obstacles:
        lines.append("obstacles:  # [m] closed, solid")
        for obstacle in drawing.obstacles:
            lines += _points("  - ", obstacle)
    lines.append("reference_path:  # [m]")
    lines += _points("  ", found.reference)
    lines.append("robots:  # lengths [m] in the robot's frame, pose [m, m, rad], path [m]")
    named: dict[int, str] = {}
    for robot in robots:
        anchor = _anchor(robot, robots, named) if robot.offset is None else ""
        lines += _robot(robot, found.size, anchor)
    reach = _scaled(neighbour_range(found, robots), 1.0) if drawing.has_formation else ""
    lines += _control(found.size, reach)
    return "\n".join(lines) + "\n"


def _heading(source: str, drawing: Drawing) -> Iterator[str]:
    yield from _comment(f"Imported from {source}: {drawing.kind}.")
    for text in (*drawing.facts, *drawing.changes):
        yield from _comment(f"- {text}")


def _comment(text: str) -> Iterator[str]:
    indent = "#   " if text.startswith("- ") else "# "
    yield from textwrap.wrap(
        escaped(text), LINE, initial_indent="# ", subsequent_indent=indent, break_long_words=True
    )


def _anchor(robot: Placed, robots: list[Placed], named: dict[int, str]) -> str:
    """Anchor of a path that several robots follow, or the alias of one written before."""
    key = id(robot.path)
    if key in named:
        return f"*{named[key]}"
    if sum(other.path is robot.path for other in robots) == 1:
        return ""
    named[key] = f"lane{len(named) + 1}"
    return f"&{named[key]} "


def _points(head: str, points: FloatArray) -> Iterator[str]:
    pieces = [f"[{number(float(x))}, {number(float(y))}]" for x, y in points]
    return flow_list(head, pieces, LINE)


def _robot(robot: Placed, size: float, anchor: str) -> Iterator[str]:
    yield f"  - name: {scalar_text(robot.name)}"
    if isinstance(robot.footprint, tuple):
        length, width = robot.footprint
        yield f"    footprint: {{length: {number(length)}, width: {number(width)}}}"
    else:
        yield from _points("    footprint: ", robot.footprint)
    x, y, heading = robot.pose
    yield f"    pose: [{number(x)}, {number(y)}, {number(heading)}]"
    if robot.offset is not None:
        yield f"    path: {{offset: {number(robot.offset)}}}"
    elif anchor.startswith("*"):
        yield f"    path: {anchor}"
    else:
        yield from _points(f"    path: {anchor}", robot.path)
    if size != 1.0:
        yield f"    limits: {{v: {_scaled(1.5, size)}, omega: 1.6}}  # [m/s], [rad/s]"


def _control(size: float, reach: str) -> Iterator[str]:
    """Formation within range ``reach`` [m], none where that is empty, controller, expectations."""
    if size != 1.0:
        yield f"# Lengths and speeds below are the usual ones times {size:g}, as the robots are."
    limits = f"[{_scaled(0.8, size)}, {_scaled(1.3, size)}]"
    speeds = f"speed: {_scaled(1.0, size)}, limits: {limits}, range: {reach}"
    if reach:
        yield f"formation: {{gain: 0.05, {speeds}}}  # [1/s, m/s, m]"
    if size != 1.0:
        yield "controller:  # [m]"
        yield "  type: mode_switching"
        for key, value in SETTINGS.items():
            yield f"  {key}: {_scaled(value, size)}"
        yield f"  {CORNERS}  # [s]"
        if not reach:
            yield f"  speed: {_scaled(1.0, size)}  # [m/s]"
            yield f"  {FORWARD}"
            yield f"sensing: {{range: {_scaled(RANGE, size)}}}  # [m]"
        yield f"arrival: {{tolerance: {_scaled(TOLERANCE, size)}}}  # [m]"
    else:
        more = CORNERS if reach else f"{CORNERS}, {FORWARD}"
        yield f"controller: {{type: mode_switching, {more}}}  # [s]"
    yield "expect: {contacts: 0, finished: true}"


def _scaled(value: float, size: float) -> str:
    scaled = float(f"{value * size:.3g}")
    text = f"{scaled:.9f}".rstrip("0")
    return text + "0" if text.endswith(".") else text
