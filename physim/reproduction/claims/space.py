"""Figures 3a and 4: safe and danger area, corridor width."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely

from physim import metrics
from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.reproduction.claims import tolerances as tol
from physim.reproduction.claims.claim import Claim, Quantity, holds, steps
from physim.reproduction.study import Measures


def measure_space(record: Record) -> Measures:
    """Areas, how near the safe one comes to walls, width along the first robot's path."""
    whole, safe = (_area(rings) for rings in (record.accessible, record.safe))
    lines = [
        shapely.LineString(record.walls.vertices[a:b]) for a, b in pairwise(record.walls.part_start)
    ]
    course = metrics.corridor_width(record)
    least, largest = float(np.nanmin(course.width)), float(np.nanmax(course.width))
    longest = max(_diameter(parts) for parts in record.footprints)
    return {
        "safe_share": safe.area / whole.area if whole.area > 0.0 else np.nan,
        "safe_gap": float(shapely.distance(safe, shapely.union_all(lines))),
        "safe_distance": record.safe_distance,
        "width_min": least,
        "width_max": largest,
        "abreast_min": float(np.floor(least / longest)),
        "abreast_max": float(np.floor(largest / longest)),
    }


def claims_of_figure_3a() -> tuple[Claim, ...]:
    """Figure 3a: areas."""
    return (
        Claim(
            "The accessible space is parted into a safe area, at least L from every "
            "boundary, and a danger area (Fig. 3a)", "safe green, danger red",
            (
                Quantity("safe_share", "%", 1, "safe"),
                Quantity("safe_gap", "m", 3, "nearest to a boundary"),
                Quantity("safe_distance", "m", 1, "L"),
            ),
            holds(
                lambda run: 0.0 < run["safe_share"] < 1.0
                and run["safe_gap"] >= (1.0 - tol.SAFE_AREA) * run["safe_distance"]
            ),
            "L is ours; the paper's value is unknown.",
        ),
    )  # fmt: skip


def claims_of_figure_4() -> tuple[Claim, ...]:
    """Figure 4: corridor width along Robot 1's path."""
    return (
        _width("width_min", "narrowest", 5.3),
        _width("width_max", "widest", 13.4),
        Claim(
            "At the narrowest place two robots pass side by side, at the widest up to four "
            "(Fig. 4)", "2 and 4",
            (
                Quantity("abreast_min", "", 0, "narrowest:"),
                Quantity("abreast_max", "", 0, "widest:"),
            ),
            steps(
                lambda run: run["abreast_min"] == 2 and run["abreast_max"] == 4,
                lambda run: run["abreast_min"] >= 2 and run["abreast_max"] >= 4,
            ),
            "Counted with the longest robot at any heading; no one robot size gives both reported "
            "numbers by division (5.3 / 2 is less than 13.4 / 5), and the paper's shapes are "
            "unknown.",
        ),
    )  # fmt: skip


def _width(key: str, word: str, reported: float) -> Claim:
    return Claim(
        f"Corridor width along Robot 1's path, {word} place (Fig. 4)", f"{reported} m",
        (Quantity(key, "m", 2),),
        holds(lambda run: abs(run[key] - reported) <= tol.WIDTH),
        "Shortest distance to the left plus shortest distance to the right wall, every 0.1 m.",
    )  # fmt: skip


def _area(rings: Sequence[FloatArray]) -> shapely.Geometry:
    """Even-odd area of rings."""
    area: shapely.Geometry = shapely.Polygon()
    for ring in rings:
        area = shapely.symmetric_difference(area, shapely.make_valid(shapely.Polygon(ring)))
    return area


def _diameter(parts: Sequence[FloatArray]) -> float:
    """Largest distance [m] of two points of a footprint: its width at the worst heading."""
    points = np.concatenate(parts)
    return float(np.hypot(*(points[:, None] - points).T).max())
