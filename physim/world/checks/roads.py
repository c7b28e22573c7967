"""What is to be known of a road that was drawn by the seed: the checks hold for that one."""

from __future__ import annotations

import shapely

from physim.errors import plural
from physim.world.scene import Layout


def road_notes(laid: Layout) -> list[str]:
    """A line about the drawn road, if there is one."""
    world = laid.world
    line, width = laid.centreline, laid.widths
    if not world.is_road_drawn or line is None or width is None:
        return []
    length = float(shapely.LineString(line).length)
    return [
        f"road drawn by seed {world.seed}: {length:.1f} m long, {width.min():.4g} to "
        f"{width.max():.4g} m wide, {plural(len(world.obstacles), 'obstacle')}, passage of "
        f"{world.passage:.4g} m; other seeds draw other roads"
    ]
