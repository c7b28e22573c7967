"""Figures 3, 3a, 4 and 6: safe and danger area, corridor width, distances, collision times."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely

from physim.analysis import metrics
from physim.analysis.metrics.distances import shortest_pair_collision_time
from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.reproduction.claims import tolerances as tol
from physim.reproduction.study import Claim, Measures, Quantity, holds, near, steps


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


FIRST_SECONDS = 5.0
"""[s] in which alone the paper looked at collisions"""
ALWAYS = 1.0
"""[-] share of the seeds that must meet what the paper says is always so"""
LOST = (
    "The paper's shapes, waypoints and thresholds are unknown, and with them its exact figure: met "
    f"is within {tol.SAME:.0%}, partly met within a factor of {tol.ORDER:.1f}."
)


def measure_distances(record: Record) -> Measures:
    """Extremes of distances and collision times, contacts, and where robots start."""
    if record.robots < 2:
        return {}
    decided = metrics.shortest_collision_time(record)
    between = shortest_pair_collision_time(record)
    shortest, farthest = metrics.shortest_distance(record), metrics.farthest_pair(record)
    times = [one.time for one in metrics.contact_episodes(record)]
    times += [one.time for one in metrics.grazes(record)]
    return {
        "shortest_distance": np.nan if shortest is None else shortest.value,
        "farthest_distance": np.nan if farthest is None else farthest.value,
        "collision_time_decided": np.inf if decided is None else decided.value,
        "collision_time_pairs": np.inf if between is None else between.value,
        "contacts": float(len(times)),
        "contacts_early": float(sum(time <= FIRST_SECONDS for time in times)),
        **_start(record),
    }


def claims_of_figure_3() -> tuple[Claim, ...]:
    """Figure 3: three robots."""
    return (
        _always_apart("Fig. 3b"),
        Claim(
            "Shortest distance between robots (Fig. 3b)", "0.2875 m",
            (Quantity("shortest_distance", "m", 4),),
            near("shortest_distance", 0.2875, tol.SAME, tol.ORDER), LOST,
        ),
        _always_time("Fig. 3c"),
        _shortest_time("Fig. 3c", 0.102),
    )  # fmt: skip


def claims_of_figure_6() -> tuple[Claim, ...]:
    """Figure 6: ten robots."""
    return (
        Claim(
            "Ten robots start in the lower left corner with random headings (Fig. 6a)",
            "lower left corner, random",
            (
                Quantity("start_right", "%", 0, "starts reach over, of the area's width"),
                Quantity("start_top", "%", 0, "of its height"),
                Quantity("start_headings", "°", 0, "headings spread over"),
            ),
            holds(
                lambda run: max(run["start_right"], run["start_top"]) <= 0.5
                and run["start_headings"] >= 180.0
            ),
            "Lower left is taken as the left and lower half; the paper's start poses are unknown.",
        ),
        _always_apart("Fig. 6c"),
        Claim(
            "No two robots are ever more than 21.5 m apart (Fig. 6c)", "21.5 m at most",
            (Quantity("farthest_distance", "m", 2, "farthest"),),
            holds(lambda run: run["farthest_distance"] <= tol.FARTHEST), needed=ALWAYS,
        ),
        _always_time("Fig. 6d"),
        _shortest_time("Fig. 6d", 0.06),
        Claim(
            "There are no collisions", "none; looked for in the first 5 s only",
            (
                Quantity("contacts", "", 0, "contacts in the whole run:"),
                Quantity("contacts_early", "", 0, "in the first 5 s:"),
            ),
            holds(lambda run: run["contacts"] == 0),
            "Contacts with robots and with walls, at every physics step and between steps.",
            needed=ALWAYS,
        ),
    )  # fmt: skip


def _always_apart(where: str) -> Claim:
    return Claim(
        f"Distances between robots are always positive ({where})", "> 0 m",
        (Quantity("shortest_distance", "m", 3, "shortest"),),
        holds(lambda run: run["shortest_distance"] > 0.0), needed=ALWAYS,
    )  # fmt: skip


def _always_time(where: str) -> Claim:
    return Claim(
        f"Collision times are always positive ({where})", "> 0 s",
        _times(),
        holds(lambda run: min(run["collision_time_pairs"], run["collision_time_decided"]) > 0.0),
        "Of all pairs under their present commands, and of the decisions, walls included.",
        needed=ALWAYS,
    )  # fmt: skip


def _shortest_time(where: str, reported: float) -> Claim:
    return Claim(
        f"Shortest collision time ({where})", f"{reported:g} s",
        _times(), near("collision_time_pairs", reported, tol.SAME, tol.ORDER),
        f"{LOST} Ours is judged over all pairs; a longer one is safer.",
    )  # fmt: skip


def _times() -> tuple[Quantity, ...]:
    return (
        Quantity("collision_time_pairs", "s", 3, "all pairs"),
        Quantity("collision_time_decided", "s", 3, "decisions"),
    )


def _start(record: Record) -> Measures:
    """How far starts reach over the accessible area, and the arc that all headings need [deg]."""
    low, high = record.accessible[0].min(axis=0), record.accessible[0].max(axis=0)
    reach = ((record.pose[0, :, :2] - low) / (high - low)).max(axis=0)
    heading = np.sort(np.mod(record.pose[0, :, 2], 2.0 * np.pi))
    gaps = np.diff(np.append(heading, heading[0] + 2.0 * np.pi))
    return {
        "start_right": float(reach[0]),
        "start_top": float(reach[1]),
        "start_headings": float(np.degrees(2.0 * np.pi - gaps.max())),
    }
