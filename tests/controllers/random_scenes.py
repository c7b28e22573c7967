"""Random scenes and settings, drawn so that every branch of the controller is met often."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import shapely

from tests.controllers.scenes import History
from tests.helpers import inside
from tests.oracles import paths
from tests.oracles.motion import arc, placed
from tests.oracles.view import Body, Cluster, shape

AVOIDANCE = inside("physim.controllers", "AVOIDANCE")
ModeSwitchingSettings = inside("physim.controllers", "ModeSwitchingSettings")

BOX = [np.array([[-0.9, -0.5], [0.9, -0.5], [0.9, 0.5], [-0.9, 0.5]])]
ELL = [
    np.array([[-0.8, -0.5], [0.8, -0.5], [0.8, -0.1], [-0.8, -0.1]]),
    np.array([[-0.8, -0.1], [-0.3, -0.1], [-0.3, 0.7], [-0.8, 0.7]]),
]
ARROW = [
    np.array([[1.0, 0.0], [-0.3, 0.0], [-0.6, -0.5]]),
    np.array([[1.0, 0.0], [-0.6, 0.5], [-0.3, 0.0]]),
]


def convex_part(rng: np.random.Generator, radius: float, at: tuple[float, float]) -> np.ndarray:
    """Random convex polygon, counter-clockwise, inscribed in an ellipse about a point."""
    n = int(rng.integers(3, 7))
    angles = np.sort((np.arange(n) + rng.uniform(0.1, 0.9, n)) * 2.0 * np.pi / n)
    reach = radius * np.array([1.0, rng.uniform(0.4, 1.0)])
    return np.array(at) + reach * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def footprint(rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    kind = rng.integers(5)
    if kind < 3:
        return tuple((BOX, ELL, ARROW)[kind])
    return (convex_part(rng, rng.uniform(0.4, 1.1), rng.uniform(-0.3, 0.3, 2)),)


def offset_line(line: np.ndarray, offset: np.ndarray | float) -> np.ndarray:
    """Line moved to the left, corner by corner."""
    along = np.gradient(line, axis=0)
    left = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    return line + np.broadcast_to(offset, len(line))[:, None] * left


def random_road(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Centreline (n, 2) with bends, and the closed outline of a corridor about it."""
    while True:
        n = int(rng.integers(3, 6))
        heading = rng.uniform(-np.pi, np.pi) + np.cumsum(rng.uniform(-0.8, 0.8, n))
        steps = np.stack([np.cos(heading), np.sin(heading)], axis=1)
        steps *= rng.uniform(2.5, 7.0, n)[:, None]
        road = rng.uniform(-40.0, 40.0, 2) + np.vstack([[0.0, 0.0], np.cumsum(steps, axis=0)])
        width = rng.choice([rng.uniform(1.5, 2.6), rng.uniform(2.6, 5.0), rng.uniform(5.0, 9.0)])
        widths = 0.5 * width * rng.uniform(0.8, 1.3, len(road))
        longer = road.copy()
        longer[0] -= 2.0 * (road[1] - road[0]) / np.hypot(*(road[1] - road[0]))
        longer[-1] += 2.0 * (road[-1] - road[-2]) / np.hypot(*(road[-1] - road[-2]))
        sides = [offset_line(longer, side * widths) for side in (1.0, -1.0)]
        outline = np.vstack([sides[0], sides[1][::-1], sides[0][:1]])
        if shapely.Polygon(outline).is_valid:
            return road, outline


def random_walls(
    rng: np.random.Generator, road: np.ndarray, outline: np.ndarray
) -> list[list[np.ndarray]]:
    pieces = 6 if len(road) == 3 else 1  # many walls, or few
    ends = np.arange(pieces * (len(outline) - 1) + 1) / pieces
    line = np.stack([np.interp(ends, np.arange(len(outline)), xy) for xy in outline.T], axis=1)
    walls = [[line[k : k + 2]] for k in range(len(line) - 1)]
    for _ in range(rng.integers(3)):
        middle = road[rng.integers(len(road))] + rng.uniform(-3.0, 3.0, 2)
        if rng.random() < 0.3:
            walls.append([part + middle for part in ELL])
        else:
            walls.append([convex_part(rng, rng.uniform(0.3, 1.0), middle)])
    return walls


def random_cluster(rng: np.random.Generator, n: int) -> Cluster:
    adjacency = None
    if rng.random() < 0.3:
        drawn = np.triu(rng.integers(0, 2, (n, n)), 1)
        adjacency = drawn + drawn.T
    active = bool(rng.random() < 0.75)
    v_min, v_max = np.sort(rng.choice([0.0, 0.3, 0.8, 1.0, 1.3], 2))
    return Cluster(
        active=active,
        gain=float(rng.choice([0.02, 0.05, 0.5])),
        speed=float(rng.choice([1.0, 0.7])) if active else 1.0,
        v_min=float(v_min),
        v_max=float(v_max),
        range=float(rng.uniform(3.0, 12.0)),
        adjacency=adjacency,
    )


def random_robot(
    rng: np.random.Generator,
    road: np.ndarray,
    area: shapely.Polygon,
    middle: float,
    taken: list[float],
) -> Body:
    """A robot on its way along a road; ``taken`` are the stations along s* of those before."""
    path = offset_line(road, rng.normal(0.0, 0.8) + rng.normal(0.0, 0.3, len(road)))
    length = paths.lengths(path)[-1]
    station = float(np.clip(middle + rng.normal(0.0, 3.0), 0.0, length))
    stop_station = length - rng.uniform(0.0, 1.0)
    end = rng.random()
    if end < 0.1:  # about to arrive
        stop_station = station + rng.normal(0.0, 0.1)
    elif end < 0.25:  # before its last waypoint
        station, stop_station = length - rng.uniform(0.1, 1.2), length + 0.3
    on_path, ahead = paths.point_at(path, station)
    if rng.random() < 0.1:  # far from its path
        on_path = paths.point_at(road, rng.uniform(0.0, paths.lengths(road)[-1]))[0]
    turned = rng.normal(0.0, 0.3) if rng.random() < 0.7 else rng.uniform(-np.pi, np.pi)
    place = on_path + rng.normal(0.0, 0.3, 2)
    while not area.contains(shapely.Point(place)):
        place = paths.point_at(road, station)[0] + rng.normal(0.0, 0.3, 2)
    reference_station = station + rng.normal(0.0, 0.5) + rng.choice([0.0, 6.0], p=[0.9, 0.1])
    if taken and rng.random() < 0.3:
        reference_station = taken[-1]
    return Body(
        parts=footprint(rng),
        pose=np.array([*place, np.arctan2(*ahead[::-1]) + turned]),
        command=random_command(rng),
        path=path,
        station=station,
        stop_station=stop_station,
        reference_station=float(reference_station),
        lead=float(rng.normal(0.0, 4.0)),
        limits=(float(rng.choice([0.9, 1.5, 2.0])), 1.6),
        speeds=(-0.5, 0.0, 0.5, 1.0) if rng.random() < 0.15 else None,
        omegas=(-0.3, 0.0, 0.3) if rng.random() < 0.15 else None,
        outside=stretches_outside(path, area),
    )


def is_clear(robot: Body, others: list[Body], walls: list[list[np.ndarray]]) -> bool:
    """Whether a robot touches neither others nor walls."""
    shapes = [shapely.union_all([shape(placed(p, r.pose)) for p in r.parts]) for r in others]
    shapes += [shape(part) for body in walls for part in body]
    mine = shapely.union_all([shape(placed(part, robot.pose)) for part in robot.parts])
    return not shapely.intersects(mine, np.array(shapes)).any()


def stretches_outside(path: np.ndarray, area: shapely.Polygon) -> np.ndarray:
    """Stretches (M, 2) of a path, from station to station, that lie outside an area."""
    ends = list(paths.lengths(path))
    for a, b, begin in zip(path, path[1:], ends[: len(path) - 1], strict=False):
        crossings = shapely.intersection(shapely.LineString([a, b]), area.exterior)
        ends += [begin + np.hypot(*(c - a)) for c in shapely.get_coordinates(crossings)]
    ends.sort()
    stretches = [
        [begin, end]
        for begin, end in zip(ends, ends[1:], strict=False)
        if end - begin > 1e-9
        and not area.contains(shapely.Point(paths.point_at(path, (begin + end) / 2.0)[0]))
    ]
    return np.array(stretches).reshape(-1, 2)


def random_command(rng: np.random.Generator) -> tuple[float, float]:
    if rng.random() < 0.2:
        return 0.0, 0.0
    omega = rng.choice([0.0, rng.uniform(-1.6, 1.6)])
    return float(rng.uniform(-1.0, 1.3)), float(omega)


def later(rng: np.random.Generator, robot: Body) -> Body:
    """The robot at the next moment: moved a little, and sometimes thrown about."""
    far = rng.random() < 0.3
    moved = arc(robot.pose, np.array(robot.command), 0.1)
    moved = moved + rng.normal(0.0, 0.4 if far else 0.01, 3)
    gone = rng.normal(0.1, 0.3 if far else 0.02)
    return dataclasses.replace(
        robot,
        pose=moved,
        command=random_command(rng),
        station=max(robot.station + gone, 0.0),
        reference_station=robot.reference_station + gone,
    )


def random_history(rng: np.random.Generator, moments: int = 3) -> History:
    """One to four robots in a corridor; in one scene of five they may overlap at the start."""
    road, outline = random_road(rng)
    area = shapely.Polygon(outline)
    walls = random_walls(rng, road, outline)
    middle = rng.uniform(0.0, paths.lengths(road)[-1])
    tries = 1 if rng.random() < 0.2 else 8
    robots: list[Body] = []
    for _ in range(rng.integers(1, 5)):
        taken = [other.reference_station for other in robots]
        for _ in range(tries):
            robot = random_robot(rng, road, area, middle, taken)
            if is_clear(robot, robots, walls):
                break
        robots.append(robot)
    course = [robots]
    for _ in range(moments - 1):
        course.append([later(rng, robot) for robot in course[-1]])
    return History(walls, random_cluster(rng, len(robots)), road, course)


def random_settings(rng: np.random.Generator) -> ModeSwitchingSettings:
    period = float(rng.choice([0.05, 0.1, 0.3]))
    cuts = np.sort(rng.uniform(0.2, 0.8, rng.integers(3)))
    dwell = (period * np.diff([0.0, *cuts, 1.0])).tolist()
    distance_low, time_low = rng.choice([0.0, 0.2, 0.5, 1.0]), rng.choice([0.0, 0.5, 1.0, 3.0])
    turn = float(rng.uniform(0.3, 1.6))
    sets = [[-turn, 0.0, turn], [0.0, turn, -0.5 * turn], [-turn, -turn / 2, 0.0, turn / 2, turn]]
    speeds = [[-1.0, 0.0, 1.0], [0.0, 1.0], [1.0, -0.5, 0.5]]
    drawn: dict[str, Any] = {
        "look_ahead": float(rng.uniform(0.5, 3.0)),
        "safe_distance": float(rng.uniform(0.3, 1.5)),
        "update_period": period,
        "dwell_times": dwell,
        "judge_ahead": float(rng.choice([0.0, 0.06, 0.5, 1.0])),
        "speeds": speeds[rng.integers(3)],
        "omegas": sets[rng.integers(3 if len(dwell) < 3 else 2)],
        "reverse_in_safe_mode": [True, None, False][np.searchsorted([0.3, 0.65], rng.random())],
        "arrival_tolerance": float(rng.choice([0.0, 0.06, 0.2])),
        "distance_low": float(distance_low),
        "distance_high": float(distance_low + rng.choice([0.0, 0.3, 1.0])),
        "time_low": float(time_low),
        "time_high": float(time_low + rng.choice([0.0, 1.0, 2.0])),
        "boundary_low": float(rng.choice([0.0, 0.15, 0.4])),
        "beta": float(rng.choice([0.05, 0.5, 0.9])),
        "event_triggered": bool(rng.random() < 0.85),
        "horizon": float(rng.choice([1.0, 4.0, 10.0])),
        "collision_motion": "arc" if rng.random() < 0.75 else "translation",
        "avoidance": str(rng.choice(AVOIDANCE, p=[0.35, 0.35, 0.1, 0.1, 0.1])),
        "longest_interval": [None, period, 2.0 * period, 0.4 * period][rng.integers(4)],
    }
    share = [None, 0.0, 0.5, 1.0][rng.integers(4)]
    if share is not None:
        low, high = drawn["time_low"], drawn["time_high"]
        drawn["boundary_time_high"] = low + share * (high - low)
    drawn["horizon"] = max(drawn["horizon"], drawn["time_high"])
    return ModeSwitchingSettings.model_validate(drawn)
