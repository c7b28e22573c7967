"""Figure 1: one robot follows its path."""

from __future__ import annotations

import numpy as np

from physim import metrics
from physim.geometry.shapes import FloatArray
from physim.plots.deviation import sharp_turns
from physim.record import Record
from physim.reproduction.claims import tolerances as tol
from physim.reproduction.claims.claim import Claim, Quantity, holds, steps
from physim.reproduction.study import Measures


def measure_path_following(record: Record) -> Measures:
    """Deviations at sharp turns of the path and elsewhere, and the sense of the turns taken."""
    time, station = metrics.column_over_time(record, "station")
    size = np.abs(metrics.deviations(record).values[:, 0])
    speeds = metrics.averaged_speeds(record)
    path = path_of(record, 0)
    turns = np.array(sharp_turns(path))
    gap = np.abs(station[:, :1] - turns).min(axis=1, initial=np.inf)
    settled = station[:, 0] - station[0, 0] > tol.START
    at, away = size[settled & (gap <= tol.AT_TURN)], size[settled & (gap > tol.AT_TURN)]
    left, right = _rotations(speeds, time, station[:, 0], path, turns)
    rms = metrics.deviation_rms(record)
    return {
        "finished": float(metrics.finished(record)),
        "deviation_rms": rms.value if rms is not None else np.nan,
        "deviation_at_turns": float(at.max(initial=0.0)),
        "deviation_elsewhere": float(away.max(initial=0.0)),
        "rotation_left_least": float(left.min(initial=np.inf)),
        "rotation_right_largest": float(right.max(initial=-np.inf)),
    }


def claims_of_figure_1() -> tuple[Claim, ...]:
    """What Figure 1 and the words about it say."""
    return (
        Claim(
            "One robot follows its path closely, to the end (Fig. 1a)", "closely",
            (
                Quantity("deviation_rms", "m", 2, "root mean square deviation"),
                Quantity("finished", "yes", label="arrives:"),
            ),
            steps(
                lambda run: run["finished"] > 0 and run["deviation_rms"] <= tol.FOLLOWS,
                lambda run: run["finished"] > 0,
            ),
            f"Closely is taken as at most {tol.FOLLOWS} m; the paper's path is unknown.",
        ),
        Claim(
            "Deviations are large at sharp turns only (Fig. 1b)",
            "large whenever there are sharp turns",
            (
                Quantity("deviation_at_turns", "m", 2, "largest at turns"),
                Quantity("deviation_elsewhere", "m", 2, "elsewhere"),
            ),
            holds(
                lambda run: run["deviation_elsewhere"]
                <= tol.SHARP_TURNS_ONLY * run["deviation_at_turns"]
            ),
            f"At a turn means within {tol.AT_TURN:g} m of it; the first {tol.START:g} m, on which "
            "the robot comes out of its random heading, do not count.",
        ),
        Claim(
            "The averaged rotational speed is positive on left turns and negative on right "
            "turns (Fig. 1c)", "above zero left, below zero right",
            (
                Quantity("rotation_left_least", "rad/s", 3, "left turns at least"),
                Quantity("rotation_right_largest", "rad/s", 3, "right turns at most"),
            ),
            holds(
                lambda run: run["rotation_left_least"] > 0.0 > run["rotation_right_largest"]
            ),
        ),
    )  # fmt: skip


def _rotations(
    speeds: metrics.AveragedSpeeds,
    time: FloatArray,
    station: FloatArray,
    path: FloatArray,
    turns: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Averaged rotational speeds [rad/s] while passing left and right turns."""
    along = np.cumsum(np.concatenate(([0.0], np.hypot(*np.diff(path, axis=0).T))))
    leg = np.diff(path, axis=0)
    found: tuple[list[float], list[float]] = ([], [])
    for turn in turns:
        k = int(np.argmin(np.abs(along - turn)))
        left = leg[k - 1, 0] * leg[k, 1] - leg[k - 1, 1] * leg[k, 0] > 0.0
        passed = time[int(np.argmin(np.abs(station - turn)))]
        at = int(np.argmin(np.abs(speeds.time - passed)))
        found[0 if left else 1].append(float(speeds.rotational[at, 0]))
    return np.array(found[0]), np.array(found[1])


def path_of(record: Record, robot: int) -> FloatArray:
    """Waypoints (n, 2) [m] of a robot's own path."""
    first, end = record.paths.start[robot : robot + 2]
    return np.asarray(record.paths.points[first:end])


def turning(points: FloatArray, station: FloatArray, span: float) -> FloatArray:
    """Change of heading [rad] of a polyline within ``span`` about stations, left positive."""
    legs = np.diff(points, axis=0)
    ends = np.cumsum(np.hypot(*legs.T))[:-1]
    heading = np.unwrap(np.arctan2(legs[:, 1], legs[:, 0]))
    before, after = (
        heading[np.searchsorted(ends, station + side, side="right")]
        for side in (-span / 2.0, span / 2.0)
    )
    return np.asarray(after - before)
