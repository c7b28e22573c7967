"""Worlds to preview, as text."""

from __future__ import annotations

import json
from collections.abc import Sequence

from physim.drawing.preview import Contents, preview_of
from physim.world.file import parse_world
from tests.helpers import inside

lay_out = inside("physim.world.layout", "lay_out")


def world(
    centreline: Sequence[Sequence[float]] = ((0.0, 0.0), (20.0, 0.0)),
    width: object = 6.0,
    names: Sequence[str] = ("a", "b"),
    *,
    size: float = 1.0,
    name: str = "small",
    description: str = "",
    margin: float = 3.0,
    more: str = "",
) -> str:
    """A corridor with robots of ``size`` [m] in a row on the centreline's first leg."""
    (x0, y0), (x1, y1) = centreline[:2]
    length = ((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5
    robots = []
    for i, label in enumerate(names):
        along = (1.0 + 1.5 * i) * size / length
        robots.append(
            {
                "name": label,
                "footprint": {"length": size, "width": 0.6 * size},
                "pose": [x0 + along * (x1 - x0), y0 + along * (y1 - y0), 0.0],
                "path": {"offset": 0.0},
                "limits": {"v": size, "omega": 1.0},
                "omegas": [-1.0, 0.0, 1.0],
            }
        )
    corridor = {"centreline": centreline, "width": width, "end_margin": margin}
    return "\n".join(
        [
            f"name: {json.dumps(name, ensure_ascii=False)}",
            f"description: {json.dumps(description, ensure_ascii=False)}",
            "time: {step: 0.01, duration: 10.0}",
            f"corridor: {json.dumps(corridor)}",
            f"robots: {json.dumps(robots, ensure_ascii=False)}",
            more,
        ]
    )


def shown(text: str) -> Contents:
    """What a preview of a world's text shows."""
    return preview_of(lay_out(parse_world(text)))


TINY = world(
    ((0.0, 0.0), (0.1, 0.0), (0.15, 0.05)), 0.04, size=0.01, margin=0.02,
    more="controller: {type: mode_switching, safe_distance: 0.008}",
)  # fmt: skip
FAR = world(((10000.0, -10000.0), (10040.0, -10000.0), (10060.0, -9980.0)))
FAR_AND_TINY = world(
    ((999999.0, 0.0), (999999.1, 0.0), (999999.15, 0.05)), 0.04, size=0.01, margin=0.02,
    more="controller: {type: mode_switching, safe_distance: 0.008}",
)  # fmt: skip
TALL = world(((0.0, 0.0), (0.0, 300.0)))
WIDE = world(((0.0, 0.0), (3000.0, 0.0)))
ONE = world(names=("solo",), more="controller: {type: path_following}")
HUNDRED = world(((0.0, 0.0), (200.0, 0.0)), names=[f"robot {i}" for i in range(100)])
MANY = world(((0.0, 0.0), (200.0, 0.0)), names=[f"robot {i}" for i in range(40)])
NARROW = world(
    ((0.0, 0.0), (20.0, 0.0), (24.0, 0.0), (44.0, 0.0)), (8.0, 1.5, 1.5, 8.0),
    more="obstacles: [[[32, 0.6], [33, 0.6], [33, 2], [32, 2]]]",
)  # fmt: skip
HOSTILE_NAMES = (
    "$x^2$ & <b>\"bold\"</b>", "</text><script>alert(1)</script>", "O'Brien \\frac{a}{b} $",
    "x" * 100, "机器人", "روبوت", "🤖", "_^{}%#~", "../../etc/passwd", "$\\undefined{$",
)  # fmt: skip
HOSTILE = world(
    ((0.0, 0.0), (60.0, 0.0), (70.0, 10.0)), 6.0, HOSTILE_NAMES,
    name="$\\alpha$ <svg onload=\"x\"> & ]]> " + "名" * 20,
    description="<img src=x> $\\frac{1}{0}$ & 'quoted' " + "long words " * 60,
)  # fmt: skip
WORLDS = {
    "tiny": TINY, "far": FAR, "far and tiny": FAR_AND_TINY, "tall": TALL, "wide": WIDE,
    "one": ONE, "hundred": HUNDRED, "narrow": NARROW, "hostile": HOSTILE,
}  # fmt: skip
