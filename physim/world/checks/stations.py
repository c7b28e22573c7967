"""Where robots are on their paths, at the start and at the end: stations, as a run has them."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray
from physim.world.layout.robots import shared
from physim.world.scene import Layout


def lines_of(laid: Layout) -> list[Any]:
    """Paths of the N robots as shapely lines; robots of the same path share one."""
    return shared(shapely.LineString, laid.paths)


def stations_on(line: Any, laid: Layout) -> FloatArray:
    """(N,) [m] stations along a line that is nearest to the robots' starts."""
    return np.asarray(shapely.line_locate_point(line, shapely.points(laid.start[:, :2])))


def leads(laid: Layout) -> FloatArray:
    """(N,) [m] wanted lead of each robot over the first; 0 without a formation."""
    plan = laid.world.formation
    if plan is None:
        return np.zeros(len(laid.names))
    if plan.spacing == "initial":
        at = stations_on(shapely.LineString(laid.reference), laid)
        return np.asarray(at - at[0])
    return np.array(plan.spacing, dtype=np.float64)


def spans(laid: Layout) -> FloatArray:
    """(N, 2) [m] station of each robot's path at the start, and its stop station."""
    lines, lead = lines_of(laid), leads(laid)
    begin = shapely.line_locate_point(lines, shapely.points(laid.start[:, :2]))
    stop = np.maximum(shapely.length(lines) - (lead.max() - lead), 0.0)
    return np.stack([begin, stop], axis=1)
