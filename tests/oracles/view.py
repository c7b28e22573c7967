"""What one robot may know when it decides, as plain data: the oracles' only input."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import shapely


@dataclass(frozen=True)
class Body:
    """One robot of a scene. World frame, SI units; ``parts`` are convex, in the robot's frame."""

    parts: tuple[np.ndarray, ...]
    pose: np.ndarray
    command: tuple[float, float]
    """held before this decision: v, omega"""
    path: np.ndarray
    station: float
    stop_station: float
    reference_station: float
    lead: float
    limits: tuple[float, float]
    speeds: tuple[float, ...] | None = None
    omegas: tuple[float, ...] | None = None
    outside: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    """stretches of the path, from station to station, outside the accessible area"""


@dataclass(frozen=True)
class Cluster:
    """What (7) needs; ``adjacency`` None: neighbours are those within ``range``."""

    active: bool
    gain: float
    speed: float
    v_min: float
    v_max: float
    range: float
    adjacency: np.ndarray | None = None


@dataclass(frozen=True)
class View:
    """Robot ``index`` with what it sees: robots and wall parts within range."""

    index: int
    me: Body
    cluster: Cluster
    neighbours: tuple[Body, ...]
    others: tuple[tuple[int, Body], ...]
    walls: tuple[np.ndarray, ...]


def view(robots: list[Body], walls: list[np.ndarray], cluster: Cluster, i: int) -> View:
    """Robot i of a scene with all that it may know, and nothing else."""
    me = robots[i]
    others = tuple(
        (j, other)
        for j, other in enumerate(robots)
        if j != i and np.hypot(*(other.pose - me.pose)[:2]) <= cluster.range
    )
    here = shapely.Point(me.pose[:2])
    seen = tuple(part for part in walls if shapely.distance(shape(part), here) <= cluster.range)
    mates = tuple(robots[j] for j in neighbours(robots, cluster, i)) if cluster.active else ()
    return View(i, me, cluster, mates, others, seen)


def neighbours(robots: list[Body], cluster: Cluster, i: int) -> list[int]:
    """N_i of (7): those listed, or those within range along s*."""
    if cluster.adjacency is not None:
        return [j for j in range(len(robots)) if j != i and cluster.adjacency[i][j]]
    here = robots[i].reference_station
    return [
        j
        for j, other in enumerate(robots)
        if j != i and abs(other.reference_station - here) <= cluster.range
    ]


def shape(part: np.ndarray) -> Any:
    """Shapely's segment or polygon."""
    return shapely.LineString(part) if len(part) == 2 else shapely.Polygon(part)
