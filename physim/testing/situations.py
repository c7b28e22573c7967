"""Small worlds in which a robot meets what it seldom meets: nobody, no wall, no way on.

The numbers are bare, every situation starts with what it is named after.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from physim.scene import Scene
from physim.scene_builder import build_scene
from physim.world_file import parse_world

HEAD = "{{name: situation, time: {{step: 0.02, duration: 60.0}}, {}}}"

SITUATIONS = {
    "nobody in sight": """
        corridor: {centreline: [[0, 0], [60, 0]], width: 8},
        robots: [
          {name: a, footprint: {length: 1.8, width: 1.0}, pose: [40, 1, 0.2], path: {offset: 0}},
          {name: b, footprint: {length: 1.8, width: 1.0}, pose: [5, -1, 0], path: {offset: 0}}],
        formation: {range: 10}""",
    "no wall in sight": """
        corridor: {centreline: [[0, 0], [60, 0]], width: 60, end_margin: 20},
        robots: [
          {name: a, footprint: {length: 1.8, width: 1.0}, pose: [24, 1, 0], path: {offset: 1}},
          {name: b, footprint: {length: 1.4, width: 1.2}, pose: [20, 0, 0.5], path: {offset: 0}},
          {name: alone, footprint: {length: 1.8, width: 1.0}, pose: [45, 0, 0], path: {offset: 0}}],
        formation: {range: 6}""",
    "at the end of the path": """
        corridor: {centreline: [[0, 0], [40, 0]], width: 10},
        robots: [
          {name: at, footprint: {length: 1.8, width: 1.0}, pose: [20, 2, 0],
           path: [[0, 2], [20, 2]]},
          {name: past, footprint: {length: 1.8, width: 1.0}, pose: [23, 0, 0.5],
           path: [[0, 0], [20, 0]]},
          {name: before, footprint: {length: 1.8, width: 1.0}, pose: [19.4, -2, 0],
           path: [[0, -2], [20, -2]]}]""",
    "facing backwards": """
        corridor: {centreline: [[0, 0], [40, 0]], width: 10},
        robots: [
          {name: back, footprint: {length: 1.8, width: 1.0}, pose: [20, 2, 3.141592653589793],
           path: {offset: 2}},
          {name: right, footprint: [[0.9, 0], [-0.9, 0.5], [-0.5, 0], [-0.9, -0.5]],
           pose: [16, 0, -1.5707963267948966], path: {offset: 0}},
          {name: askew, footprint: {length: 1.8, width: 1.0}, pose: [14, -2, 2.6],
           path: {offset: -2}}],
        formation: {range: 10}""",
    "overlapping": """
        corridor: {centreline: [[0, 0], [40, 0]], width: 8},
        robots: [
          {name: a, footprint: {length: 1.8, width: 1.0}, pose: [12, 0, 0], path: {offset: 0}},
          {name: b, footprint: {length: 1.4, width: 1.2}, pose: [9, 0, 0.4], path: {offset: 0}},
          {name: in_wall, footprint: {length: 1.8, width: 1.0}, pose: [20, 2, 0],
           path: {offset: 2}}],
        formation: {range: 10}""",
}  # fmt: skip
"""By what they are: corridor, robots and formation, as a world file writes them."""

OVERLAPPING = ((1, (11.2, 0.3, 0.4)), (2, (20.0, 3.8, 0.2)))
"""Start poses that no world may have: robot and pose [m, m, rad]."""


def situations() -> dict[str, Scene]:
    """Scenes by name; ``Simulation(scene, controller=MyController())`` runs one."""
    scenes = {
        name: build_scene(parse_world(HEAD.format(text))) for name, text in SITUATIONS.items()
    }
    overlapping = scenes["overlapping"]
    start = np.array(overlapping.start)
    for i, pose in OVERLAPPING:
        start[i] = pose
    return {**scenes, "overlapping": replace(overlapping, start=start)}
