"""The world file of an import: pleasant to read, every length to the millimetre, sources named."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from math import ceil

import numpy as np

from physim.geometry.shapes import FloatArray
from physim.importing.drawing import Drawing, number, printable
from physim.importing.fit import Fit
from physim.importing.line import stations
from physim.importing.placed import Placed
from physim.world_file.schema import FILE

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
SPACE = 1.35
"""[-] duration over the time that the path takes at the formation's speed"""


def world_text(name: str, source: str, drawing: Drawing, found: Fit, robots: list[Placed]) -> str:
    """YAML text of the world; loading it checks it."""
    lines = [f"# yaml-language-server: $schema={FILE}", *_heading(source, drawing)]
    lines.append(f"name: {_quoted(name)}")
    lines.append(f"description: {_quoted(_description(source, drawing, len(robots)))}")
    lines.append(f"time: {{step: 0.01, duration: {_duration(found):.1f}}}  # [s]")
    lines.append("boundaries:  # [m] polylines, points x, y")
    for boundary in drawing.boundaries:
        lines += _points(boundary, "  - ")
    if drawing.obstacles:
        lines.append("obstacles:  # [m] closed, solid")
        for obstacle in drawing.obstacles:
            lines += _points(obstacle, "  - ")
    lines.append("reference_path:  # [m]")
    lines += _points(found.reference, "  ")
    lines.append("robots:  # lengths [m] in the robot's frame, pose [m, m, rad], path [m]")
    named: dict[int, str] = {}
    for robot in robots:
        lines += _robot(robot, found.size, _shared(robot, robots, named))
    lines += _control(found.size, len(robots))
    return "\n".join(lines) + "\n"


def _heading(source: str, drawing: Drawing) -> Iterator[str]:
    yield from _comment(f"Imported from {source}: {drawing.kind}.")
    for text in (*drawing.facts, *drawing.changes):
        yield from _comment(f"- {text}")


def _comment(text: str) -> Iterator[str]:
    indent = "#   " if text.startswith("- ") else "# "
    yield from textwrap.wrap(
        printable(text), LINE, initial_indent="# ", subsequent_indent=indent, break_long_words=True
    )


def _description(source: str, drawing: Drawing, robots: int) -> str:
    group = "One robot" if robots == 1 else f"{robots} robots"
    return f"{group} in a place imported from {source}."


def _duration(found: Fit) -> float:
    return 10.0 * ceil((float(stations(found.reference)[-1]) / found.size * SPACE + 20.0) / 10.0)


def _shared(robot: Placed, robots: list[Placed], named: dict[int, str]) -> str:
    """Anchor of a path that several robots follow, or the alias of one written before."""
    key = id(robot.path)
    if key in named:
        return f"*{named[key]}"
    if isinstance(robot.path, float) or sum(other.path is robot.path for other in robots) == 1:
        return ""
    named[key] = f"lane{len(named) + 1}"
    return f"&{named[key]} "


def _points(points: FloatArray, head: str) -> Iterator[str]:
    """A list of points in flow style, broken after 100 columns."""
    pieces = [f"[{number(float(x))}, {number(float(y))}]" for x, y in np.asarray(points)]
    flow = ", ".join(pieces)
    if len(head) + len(flow) + 2 <= LINE:
        yield f"{head}[{flow}]"
        return
    indent = len(head) - len(head.lstrip(" -"))
    space = " " * (indent + 2)
    yield f"{head}["
    line = space
    for piece in pieces:
        if line.strip() and len(line) + len(piece) + 1 > LINE:
            yield line.rstrip()
            line = space
        line += piece + ", "
    yield line.rstrip()
    yield " " * indent + "]"


def _robot(robot: Placed, size: float, shared: str) -> Iterator[str]:
    yield f"  - name: {_quoted(robot.name)}"
    if isinstance(robot.footprint, tuple):
        length, width = robot.footprint
        yield f"    footprint: {{length: {number(length)}, width: {number(width)}}}"
    else:
        yield from _points(robot.footprint, "    footprint: ")
    x, y, heading = robot.pose
    yield f"    pose: [{number(x)}, {number(y)}, {number(heading)}]"
    if isinstance(robot.path, float):
        yield f"    path: {{offset: {number(robot.path)}}}"
    elif shared.startswith("*"):
        yield f"    path: {shared}"
    else:
        yield from _points(robot.path, f"    path: {shared}")
    if size != 1.0:
        yield f"    limits: {{v: {_scaled(1.5, size)}, omega: 1.6}}  # [m/s], [rad/s]"


def _control(size: float, robots: int) -> Iterator[str]:
    if size != 1.0:
        yield f"# Lengths and speeds below are the usual ones times {size:g}, as the robots are."
        speeds = (
            f"speed: {_scaled(1.0, size)}, limits: [{_scaled(0.8, size)}, {_scaled(1.3, size)}]"
        )
        yield f"formation: {{gain: 0.05, {speeds}, range: {_scaled(10.0, size)}}}  # [1/s, m/s, m]"
        yield "controller:  # [m]"
        yield "  type: mode_switching"
        for key, value in SETTINGS.items():
            yield f"  {key}: {_scaled(value, size)}"
    else:
        speeds = "speed: 1.0, limits: [0.8, 1.3]"
        yield f"formation: {{gain: 0.05, {speeds}, range: 10.0}}  # [1/s, m/s, m]"
        yield "controller: {type: mode_switching}"
    yield "expect: {contacts: 0, finished: true}"


def _scaled(value: float, size: float) -> str:
    scaled = float(f"{value * size:.3g}")
    text = f"{scaled:.9f}".rstrip("0")
    return text + "0" if text.endswith(".") else text


def _quoted(text: str) -> str:
    if text.replace(" ", "").replace("_", "").isalnum() and text[0].isalpha() and text.isascii():
        word = text.lower()
        if word not in ("y", "n", "yes", "no", "on", "off", "true", "false", "null", "nan", "inf"):
            return text
    return '"' + printable(text).replace("\\", "\\\\").replace('"', '\\"') + '"'
