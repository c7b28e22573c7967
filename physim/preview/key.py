"""The key of a preview: what each mark of the map means."""

from __future__ import annotations

from typing import Any

from physim import palette
from physim.plots.style import BLUE, INK, QUIET
from physim.preview.contents import Contents
from physim.preview.ground_plan import DASH, MOST_TICKS, hexed, round_step


def draw_key(axis: Any, shown: Contents, named: int) -> None:
    """Draw the key; ``named`` robots have their names on the map."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    axis.set_axis_off()
    rows: list[tuple[Any, str]] = []
    edge = hexed(palette.RULE)
    if shown.safe_distance:
        level = f"{shown.safe_distance:.3g} m"
        rows.append((_patch(Patch, palette.SAFE_AREA, edge), f"safe area"))
        rows.append((_patch(Patch, palette.DANGER_AREA, edge), f"danger area: within L = {level}"))
    else:
        rows.append((_patch(Patch, palette.FLOOR, edge), "accessible area"))
    rows.append((Line2D([], [], color=hexed(palette.WALL), linewidth=1.6), "boundary"))
    if shown.obstacles:
        rows.append((_patch(Patch, palette.OBSTACLE, hexed(palette.WALL)), "obstacle"))
    step = round_step(shown.length, MOST_TICKS)
    rows.append((Line2D([], [], color=hexed(palette.REFERENCE), linewidth=2.6, alpha=0.55,
                        marker="|", markeredgecolor=QUIET, markersize=7),
                 f"reference path, a tick each {step:g} m"))
    colour = hexed(palette.robot_colour(0))
    words = "path of a robot" if len(shown.robots) > 1 else "path of the robot"
    rows.append((Line2D([], [], color=colour, linewidth=1.15), words))
    if any(route.danger for route in shown.routes):
        rows.append((Line2D([], [], color=colour, linewidth=1.15, linestyle=(0, tuple(d / 1.15 for d in DASH))), "… in the danger area"))
    rows.append((Line2D([], [], linestyle="", marker="s", markersize=4.2, markerfacecolor="white", markeredgecolor=colour, markeredgewidth=1.1), "stop station"))
    rows.append((Line2D([], [], linestyle="", marker=(3, 0, -90), markersize=7, markerfacecolor=colour, markeredgecolor=INK, markeredgewidth=0.5), "robot at the start, heading"))
    rows.append((Line2D([], [], color=BLUE, linewidth=1.8, marker="o", markersize=3.4), "narrowest place"))
    if shown.boundary_widths is not None:
        rows.append((Line2D([], [], color=QUIET, linewidth=0.9, linestyle="--"), "width without obstacles"))
    axis.legend(*zip(*rows, strict=True), loc="upper left", borderaxespad=0.0, handlelength=2.4, labelspacing=0.75, fontsize=8.2)
    if named < len(shown.robots):
        axis.text(0.0, 0.0, f"{named} of {len(shown.robots)} names fit on the map", fontsize=8.0, color=QUIET)


def _patch(kind: Any, colour: palette.Colour, edge: str) -> Any:
    return kind(facecolor=hexed(colour), edgecolor=edge, linewidth=0.7)
