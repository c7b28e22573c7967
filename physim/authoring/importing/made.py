"""The world made of a place and robots, and its text, with a comment of what was read."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from math import ceil
from typing import Any

import numpy as np

from physim.authoring.importing.area import Place
from physim.authoring.importing.drawing import Drawing
from physim.authoring.importing.drawn import Placed
from physim.authoring.importing.size import Size
from physim.errors import plural
from physim.escaping import escaped
from physim.geometry.arc_length import Polyline
from physim.geometry.shapes import FloatArray
from physim.world import World
from physim.world.file.schema import FILE
from physim.world.yaml_text import yaml_text

SETTINGS = {
    "look_ahead": 2.0,
    "safe_distance": 1.0,
    "arrival_tolerance": 0.06,
    "distance_low": 0.5,
    "distance_high": 0.8,
    "boundary_low": 0.15,
}
"""[m] settings of the shipped controller that are lengths, at size 1"""
CORNERS = {"boundary_time_high": 1.0}
"""[s] a setting of it: else robots that had to stop before a corner may stand there for ever"""
RANGE, MARGIN = 10.0, 1.1
"""[m] of formation neighbours at size 1, and [-] how many times the longest gap between them"""
TOLERANCE = 0.1
"""[m] of arrival, at size 1"""
SPACE = 1.35
"""[-] duration over the time that the path takes at the formation's speed"""


def made_world(
    name: str,
    source: str,
    where: Place,
    reference: FloatArray,
    robots: Sequence[Placed],
    size: Size,
    has_formation: bool,
    step: float,
) -> World:
    """The world [m], in steps of ``step`` [s]; WorldError where it cannot be one."""
    factor = size.factor

    def scaled(value: float) -> float:
        return float(f"{value * factor:.3g}")

    longest = max(Polyline(line).length for line in (reference, *(one.path for one in robots)))
    speed = scaled(1.0)
    controller: dict[str, Any] = {"type": "mode_switching", **CORNERS}
    values: dict[str, Any] = {
        "name": name,
        "description": f"{_count(robots)} in a place imported from {source}.",
        "time": {"step": step, "duration": 10.0 * ceil((longest / factor * SPACE + 20.0) / 10.0)},
        "boundaries": [line.tolist() for line in where.boundaries],
        "obstacles": [ring.tolist() for ring in where.obstacles],
        "reference_path": reference.tolist(),
        "robots": [_robot(one, None if factor == 1.0 else scaled(1.5)) for one in robots],
        "expect": {"contacts": 0, "finished": True},
    }
    if factor != 1.0:
        controller |= {key: scaled(value) for key, value in SETTINGS.items()}
        values["arrival"] = {"tolerance": scaled(TOLERANCE)}
    if has_formation:
        limits = [scaled(0.8), scaled(1.3)]
        reach = scaled(max(RANGE, MARGIN * _longest_gap(reference, robots) / factor))
        values["formation"] = {"gain": 0.05, "speed": speed, "limits": limits, "range": reach}
    else:  # robots that may reverse stand for ever in tight bends
        controller |= {"speed": speed, "reverse_in_safe_mode": False}
        values["sensing"] = {"range": scaled(RANGE)}
    values["controller"] = controller
    return World(**values)


def world_text(world: World, source: str, drawing: Drawing) -> str:
    """Text of the world file, with what was read and changed as a comment at its top."""
    lines = [f"# yaml-language-server: $schema={FILE}"]
    told = [f"Imported from {source}: {drawing.kind}."]
    told += [f"- {text}" for text in (*drawing.facts, *drawing.changes)]
    for text in told:
        lines += textwrap.wrap(
            escaped(text),
            100,
            initial_indent="# ",
            subsequent_indent="#   " if text.startswith("- ") else "# ",
        )
    return "\n".join(lines) + "\n" + yaml_text(world)


def _count(robots: Sequence[Placed]) -> str:
    return "One robot" if len(robots) == 1 else plural(len(robots), "robot")


def _robot(robot: Placed, speed: float | None) -> dict[str, Any]:
    """Keys of a robot; ``speed`` [m/s] is its limit, where that is not the usual one."""
    box = robot.footprint
    keys: dict[str, Any] = {
        "name": robot.name,
        "footprint": {"length": box[0], "width": box[1]}
        if isinstance(box, tuple)
        else box.tolist(),
        "pose": list(robot.pose),
        "path": robot.path.tolist() if robot.offset is None else {"offset": robot.offset},
    }
    return keys if speed is None else {**keys, "limits": {"v": speed, "omega": 1.6}}


def _longest_gap(reference: FloatArray, robots: Sequence[Placed]) -> float:
    """[m] along the reference path between robots that start one behind the other."""
    stations = Polyline(reference).nearest(np.array([one.pose[:2] for one in robots]))
    return float(np.diff(np.sort(stations)).max(initial=0.0))
