"""The figures of a run that claims are judged by, each from its record alone."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
import shapely

from physim.analysis import metrics
from physim.analysis.metrics.distances import shortest_pair_collision_time
from physim.geometry.shapes import FloatArray
from physim.record import Record

Measures = Mapping[str, float]
"""Figures of one run by name; nan where one has no meaning for it."""

SHARP = 0.5
"""[rad] A path that turns by more at a point has a sharp turn there."""
AT_TURN = 2.0
"""[m] A robot is at a turn of its path within the look-ahead of it: there the target is round the
corner."""
START = 5.0
"""[m] After this distance a robot has come out of its random heading."""
BEND, BEND_SPAN = 0.3, 10.0
"""[rad], [m] A path bends where its heading changes by more within this length, half before and
half behind the place."""
BEHIND = 0.5
"""[m] A robot is behind or in the lead when its formation error is larger than this."""
SNAPSHOTS = 21.0
"""[s] between two snapshots (paper, Fig. 2a)"""
FIRST_SECONDS = 5.0
"""[s] in which alone the paper looked at collisions"""
MOST_OF_TIME = 0.5
"""[-] more time in one mode than in the other"""
SAFE_ONES, ROBOTS = (5, 8, 10), 10
"""Robots that are more in safe mode (paper), counted from 1, and how many there are."""


def measures(record: Record) -> Measures:
    """All figures of a run that claims are judged by; absent where they have no meaning."""
    return {
        **_path_following(record), **_formation(record), **_distances(record), **_space(record),
        **_modes(record), **_effort(record),
    }  # fmt: skip


def figures(record: Record, *names: str, absent: float = math.nan) -> dict[str, float]:
    """Metrics by name, as the summary has them; ``absent`` where one has no meaning for the run."""
    found = metrics.measure(record, names)
    values = {name: found[name].value if name in found else None for name in names}
    return {name: absent if value is None else float(value) for name, value in values.items()}


def corners(points: FloatArray, sharp: float) -> FloatArray:
    """Stations [m] at which a line (P, 2) turns by more than ``sharp`` [rad] at a point."""
    leg = np.diff(points, axis=0)
    heading = np.unwrap(np.arctan2(leg[:, 1], leg[:, 0]))
    return np.asarray(np.cumsum(np.hypot(*leg.T))[:-1][np.abs(np.diff(heading)) > sharp])


def turning(points: FloatArray, station: FloatArray, span: float) -> FloatArray:
    """Change of heading [rad] of a line (P, 2) within ``span`` about stations, left positive."""
    legs = np.diff(points, axis=0)
    ends = np.cumsum(np.hypot(*legs.T))[:-1]
    heading = np.unwrap(np.arctan2(legs[:, 1], legs[:, 0]))
    before, after = (
        heading[np.searchsorted(ends, station + side, side="right")]
        for side in (-span / 2.0, span / 2.0)
    )
    return np.asarray(after - before)


def _path_of(record: Record, robot: int) -> FloatArray:
    """Waypoints (n, 2) [m] of a robot's own path."""
    first, end = record.paths.start[robot : robot + 2]
    return np.asarray(record.paths.points[first:end])


def _path_following(record: Record) -> Measures:
    """Deviations of the first robot at sharp turns of its path and elsewhere, and how it turns."""
    time, station = metrics.column_over_time(record, "station")
    size = np.abs(metrics.deviations(record).values[:, 0])
    path = _path_of(record, 0)
    turns = corners(path, SHARP)
    gap = np.abs(station[:, :1] - turns)
    near = gap.min(axis=1, initial=np.inf) <= AT_TURN
    settled = station[:, 0] - station[0, 0] > START
    speeds = metrics.Figures(record).averaged
    passed = np.abs(speeds.time[:, None] - time[gap.argmin(axis=0)]).argmin(axis=0)
    rotation, is_left = speeds.rotational[passed, 0], turning(path, turns, 1e-6) > 0.0
    return {
        **figures(record, "finished", "deviation_rms"),
        "deviation_at_turns": float(size[settled & near].max(initial=0.0)),
        "deviation_elsewhere": float(size[settled & ~near].max(initial=0.0)),
        "rotation_left_least": float(rotation[is_left].min(initial=np.inf)),
        "rotation_right_largest": float(rotation[~is_left].max(initial=-np.inf)),
    }


def _formation(record: Record) -> Measures:
    """Formation errors, speeds, deviations and how far the group is spread."""
    course = metrics.formation_errors(record)
    if course is None:
        return {}
    speeds, deviation = metrics.Figures(record).averaged, metrics.deviations(record).values
    size, mean = np.abs(deviation).max(axis=0), np.nanmean(deviation, axis=0)
    _, station = metrics.column_over_time(record, "reference_station")
    in_bend = (np.abs(turning(record.reference.points, station, BEND_SPAN)) > BEND).any(axis=1)
    forward = speeds.forward
    error = np.stack([np.interp(speeds.time, course.time, e) for e in course.values.T], axis=1)
    behind, ahead = (
        forward[np.isfinite(forward) & (sign * error > BEHIND)] for sign in (1.0, -1.0)
    )
    (moments, gaps), _ = metrics.pair_distances(record)
    wanted = SNAPSHOTS * np.arange(float(int(moments[-1] / SNAPSHOTS) + 1))
    at = np.abs(moments[:, None] - wanted).argmin(axis=0)
    return {
        **figures(
            record, "formation_error_peak", "formation_error_final", "averaged_speed_min",
            "averaged_speed_max",
        ),
        "error_in_bends": _root_mean_square(course.values[in_bend]),
        "error_on_straights": _root_mean_square(course.values[~in_bend]),
        "deviation_peak_least": float(size.min()),
        "deviation_peak_largest": float(size.max()),
        "deviation_left": float((mean > 0.0).sum()),
        "deviation_right": float((mean < 0.0).sum()),
        "spread_start": float(gaps[0].max()),
        "spread_largest": float(gaps[at].max()),
        "behind_is_faster": float((behind > 1.0).mean()) if len(behind) else np.nan,
        "ahead_is_slower": float((ahead < 1.0).mean()) if len(ahead) else np.nan,
        "rotation_agrees": _rotation_agrees(record, speeds),
    }  # fmt: skip


def _rotation_agrees(record: Record, speeds: metrics.AveragedSpeeds) -> float:
    """Share of moments in bends of the own path at which the robot turns as the bend does."""
    time, station = metrics.column_over_time(record, "station")
    right = count = 0
    for robot in range(record.robots):
        where = np.interp(speeds.time, time, station[:, robot])
        turn = turning(_path_of(record, robot), where, BEND_SPAN)
        rotation = speeds.rotational[:, robot]
        bend = (np.abs(turn) > BEND) & np.isfinite(rotation)
        right += int((np.sign(rotation) == np.sign(turn))[bend].sum())
        count += int(bend.sum())
    return right / count if count else np.nan


def _root_mean_square(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if values.size else np.nan


def _distances(record: Record) -> Measures:
    """Extremes of distances and collision times, contacts, and where robots start."""
    if record.robots < 2:
        return {}
    between = shortest_pair_collision_time(record)
    run = metrics.Figures(record)
    times = [one.time for one in (*run.episodes, *run.grazes)]
    low, high = record.accessible[0].min(axis=0), record.accessible[0].max(axis=0)
    reach = ((record.pose[0, :, :2] - low) / (high - low)).max(axis=0)
    heading = np.sort(np.mod(record.pose[0, :, 2], 2.0 * np.pi))
    gaps = np.diff(np.append(heading, heading[0] + 2.0 * np.pi))
    decided = figures(record, "shortest_collision_time", absent=np.inf)
    return {
        **figures(record, "shortest_distance", "farthest_distance"),
        "collision_time_decided": decided["shortest_collision_time"],
        "collision_time_pairs": np.inf if between is None else between.value,
        "contacts": float(len(times)),
        "contacts_early": float(sum(time <= FIRST_SECONDS for time in times)),
        "start_right": float(reach[0]),
        "start_top": float(reach[1]),
        "start_headings": float(np.degrees(2.0 * np.pi - gaps.max())),  # the arc that all need
    }


def _space(record: Record) -> Measures:
    """Areas, how near the safe one comes to walls, width along the first robot's path."""

    def area(rings: Sequence[FloatArray]) -> shapely.Geometry:  # even-odd
        polygons = [shapely.make_valid(shapely.Polygon(ring)) for ring in rings]
        return functools.reduce(shapely.symmetric_difference, polygons, shapely.Polygon())

    whole, safe = area(record.accessible), area(record.safe)
    lines = [
        shapely.LineString(record.walls.vertices[a:b]) for a, b in pairwise(record.walls.part_start)
    ]
    outlines = map(np.concatenate, record.footprints)
    longest = max(float(np.hypot(*(p[:, None] - p).T).max()) for p in outlines)
    width = figures(record, "width_min", "width_max")
    return {
        "safe_share": safe.area / whole.area if whole.area > 0.0 else np.nan,
        "safe_gap": float(shapely.distance(safe, shapely.union_all(lines))),
        "safe_distance": record.safe_distance,
        **width,
        "abreast_min": float(np.floor(width["width_min"] / longest)),
        "abreast_max": float(np.floor(width["width_max"] / longest)),
    }


def _modes(record: Record) -> Measures:
    """Shares of safe mode of Robots 5, 8 and 10 and of the others."""
    found = metrics.Figures(record).metric("safe_share")
    if found is None or found.robots is None or len(found.robots) != ROBOTS:
        return {}
    share = np.array([np.nan if one is None else one for one in found.robots])
    calm = np.isin(np.arange(1, ROBOTS + 1), SAFE_ONES)
    return {
        "safe_least_of_5_8_10": float(share[calm].min()),
        "safe_least_of_others": float(share[~calm].min()),
        "safe_largest_of_others": float(share[~calm].max()),
        "others_in_danger": float((share[~calm] < MOST_OF_TIME).sum()),
        "both_modes": float(((share > 0.0) & (share < 1.0)).sum()),
    }


def _effort(record: Record) -> Measures:
    """Messages, collision-time evaluations, update intervals and the time to finish.

    Shares are of what it would be if every robot had decided at every physics step, with the
    neighbours that it considered: each decision counts as often as it held steps.
    """
    rows = record.updates
    held = np.minimum(rows["next_step"], record.steps_run) - rows["step"]
    planned = rows["next_step"] - rows["step"]
    every_message = float((rows["considered"] * held).sum()) or np.nan
    every_evaluation = np.nansum(record.column("evaluations", absent=np.nan) * held) or np.nan
    _, first = np.unique(rows["robot"], return_index=True)
    found = figures(
        record, "messages", "collision_time_evaluations", "time_to_finish", "mean_speed"
    )
    evaluations = found.pop("collision_time_evaluations")
    return {
        **found,
        "messages_share": found["messages"] / every_message,
        "evaluations": evaluations,
        "evaluations_share": float(evaluations / every_evaluation),
        "shorter_intervals": float((planned < planned.max()).mean()),
        "time_at_steady_speed": float((record.stop_station - rows["station"][first]).max()),
    }
