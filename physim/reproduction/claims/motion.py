"""Figures 1, 2 and 7: path following of one robot; formation, speeds, deviations of a group."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.analysis import metrics
from physim.drawing.plots.curves import sharp_turns
from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.reproduction import decided
from physim.reproduction.claims import tolerances as tol
from physim.reproduction.study import Claim, Measures, Quantity, holds, steps


def measure_path_following(record: Record) -> Measures:
    """Deviations at sharp turns of the path and elsewhere, and the sense of the turns taken."""
    time, station = metrics.column_over_time(record, "station")
    size = np.abs(decided.deviations(record).values[:, 0])
    speeds = metrics.averaged_speeds(record)
    path = path_of(record, 0)
    turns = np.array(sharp_turns(path))
    gap = np.abs(station[:, :1] - turns).min(axis=1, initial=np.inf)
    settled = station[:, 0] - station[0, 0] > tol.START
    at, away = size[settled & (gap <= tol.AT_TURN)], size[settled & (gap > tol.AT_TURN)]
    left, right = _rotations(speeds, time, station[:, 0], path, turns)
    return {
        "finished": float(metrics.finished(record)),
        "deviation_rms": decided.deviation_rms(record),
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


SNAPSHOTS = 21.0
"""[s] between two snapshots (paper, Fig. 2a)"""


def measure_formation(record: Record) -> Measures:
    """Formation errors, speeds, deviations and how far the group is spread."""
    course = decided.formation_errors(record)
    if course is None:
        return {}
    speeds = metrics.averaged_speeds(record)
    size = np.abs(decided.deviations(record).values).max(axis=0)
    mean = np.nanmean(decided.deviations(record).values, axis=0)
    bends, straights = _by_place(record, course.values)
    return {
        "formation_error_peak": decided.formation_error_peak(record),
        "formation_error_final": decided.formation_error_final(record),
        "error_in_bends": bends,
        "error_on_straights": straights,
        "averaged_speed_min": _extreme(speeds.forward, largest=False),
        "averaged_speed_max": _extreme(speeds.forward, largest=True),
        "deviation_peak_least": float(size.min()),
        "deviation_peak_largest": float(size.max()),
        "deviation_left": float((mean > 0.0).sum()),
        "deviation_right": float((mean < 0.0).sum()),
        **_group(record),
        **_speeds_by_place(speeds, course),
        "rotation_agrees": _rotation_agrees(record, speeds),
    }


def claims_of_figure_2() -> tuple[Claim, ...]:
    """Figure 2: three robots."""
    return (
        Claim(
            "Three robots move as one group (Fig. 2a, snapshots every 21 s)",
            "progress collectively as a cohesive group",
            (
                Quantity("spread_start", "m", 1, "largest distance at the start"),
                Quantity("spread_largest", "m", 1, "at any snapshot"),
                Quantity("finished", "yes", label="all arrive:"),
            ),
            steps(
                lambda run: run["finished"] > 0
                and run["spread_largest"] <= tol.COHESIVE * run["spread_start"],
                lambda run: run["finished"] > 0,
            ),
            f"Cohesive is taken as at most {tol.COHESIVE:g} times the distance at the start.",
        ),
        *_errors("Fig. 2b", "increase at sharp path curvatures"),
        Claim(
            "Robots leave their paths by different distances, and stay near them (Fig. 2c)",
            "distances to the paths, no figure given",
            (
                Quantity("deviation_peak_least", "m", 2, "largest of the closest robot"),
                Quantity("deviation_peak_largest", "m", 2, "of the farthest"),
            ),
            holds(
                lambda run: run["deviation_peak_largest"] > run["deviation_peak_least"]
                and run["deviation_peak_largest"] <= tol.BOUNDED
            ),
        ),
    )  # fmt: skip


def claims_of_figure_7() -> tuple[Claim, ...]:
    """Figure 7: ten robots."""
    return (
        *_errors("Fig. 7a", "become nonzero in the curved parts"),
        Claim(
            "Formation errors are bounded (Fig. 7a)", "bounded, no figure given",
            (Quantity("formation_error_peak", "m", 2, "largest"),),
            holds(lambda run: tol.GROWTH <= run["formation_error_peak"] <= tol.BOUNDED),
            f"Bounded is taken as below {tol.BOUNDED:g} m, the range of neighbours.",
        ),
        Claim(
            "Averaged rotational speeds are positive when turning left, negative when turning "
            "right (Fig. 7b)", "left positive, right negative",
            (Quantity("rotation_agrees", "%", 1, "right sign in bends:"),),
            holds(lambda run: run["rotation_agrees"] >= tol.SAME_SIGN),
            "A window of 10 s reaches over the ends of short bends, where the sign may differ.",
        ),
        Claim(
            "Averaged forward speeds lie between 0.8 and 1.3 m/s (Fig. 7c)",
            "0.8 to 1.3 m/s",
            (
                Quantity("averaged_speed_min", "m/s", 2, "least"),
                Quantity("averaged_speed_max", "m/s", 2, "largest"),
            ),
            steps(
                lambda run: run["averaged_speed_min"] >= 0.8 - tol.SPEED
                and run["averaged_speed_max"] <= 1.3 + tol.SPEED,
                lambda run: run["averaged_speed_max"] <= 1.3 + tol.SPEED,
            ),
            "Safe mode keeps 0.92 to 1.3 m/s; only robots that give way in danger mode fall below.",
        ),
        Claim(
            "Robots falling behind drive faster than 1 m/s, those leading slower (Fig. 7c)",
            "faster than 1 m/s behind, slower in the lead",
            (
                Quantity("behind_is_faster", "%", 1, "of the time behind, faster:"),
                Quantity("ahead_is_slower", "%", 1, "of the time in the lead, slower:"),
            ),
            holds(
                lambda run: min(run["behind_is_faster"], run["ahead_is_slower"]) >= tol.SAME_SIGN
            ),
            f"Behind and in the lead mean a formation error larger than {tol.BEHIND:g} m.",
        ),
        Claim(
            "Deviations from the paths differ in magnitude and direction (Fig. 7d)",
            "different in magnitudes and direction",
            (
                Quantity("deviation_peak_least", "m", 2, "largest of the closest robot"),
                Quantity("deviation_peak_largest", "m", 2, "of the farthest"),
                Quantity("deviation_left", "robots", 0, "mostly left:"),
                Quantity("deviation_right", "robots", 0, "mostly right:"),
            ),
            holds(
                lambda run: run["deviation_peak_largest"] > 2.0 * run["deviation_peak_least"]
                and min(run["deviation_left"], run["deviation_right"]) > 0
            ),
            "Most of it is room kept from walls: paths lie in the danger area, targets do not.",
        ),
    )  # fmt: skip


def _errors(where: str, words: str) -> tuple[Claim, ...]:
    """The two claims about formation errors that both groups share."""
    return (
        Claim(
            f"Formation errors grow in bends ({where})", words,
            (
                Quantity("error_in_bends", "m", 2, "root mean square in bends"),
                Quantity("error_on_straights", "m", 2, "on straights"),
                Quantity("formation_error_peak", "m", 2, "largest error"),
            ),
            holds(
                lambda run: run["error_in_bends"] > run["error_on_straights"]
                and run["formation_error_peak"] >= tol.GROWTH
            ),
            "In bends means that some robot is in one; the paper's waypoints are unknown.",
        ),
        Claim(
            f"Formation errors converge to zero by the end ({where})", "0 m",
            (Quantity("formation_error_final", "m", 2, "largest at the end"),),
            holds(lambda run: run["formation_error_final"] <= tol.ZERO_AT_END),
            f"Zero is taken as at most {tol.ZERO_AT_END:g} m.",
        ),
    )  # fmt: skip


def _group(record: Record) -> Measures:
    """Largest distance of any two robots at the start and at the snapshots."""
    (time, gaps), _ = metrics.pair_distances(record)
    wanted = SNAPSHOTS * np.arange(float(int(time[-1] / SNAPSHOTS) + 1))
    at = np.abs(time[:, None] - wanted).argmin(axis=0)
    return {
        "finished": float(metrics.finished(record)),
        "spread_start": float(gaps[0].max()),
        "spread_largest": float(gaps[at].max()),
    }


def _by_place(record: Record, errors: FloatArray) -> tuple[float, float]:
    """Root mean square error [m] of all robots while one is in a bend of s*, and while none is."""
    _, station = metrics.column_over_time(record, "reference_station")
    bent: NDArray[np.bool_] = (
        np.abs(turning(record.reference.points, station, tol.BEND_SPAN)) > tol.BEND
    )
    some = bent.any(axis=1)
    return _rms(errors[some]), _rms(errors[~some])


def _rotation_agrees(record: Record, speeds: metrics.AveragedSpeeds) -> float:
    """Share of moments in bends of the own path at which the robot turns as the bend does."""
    time, station = metrics.column_over_time(record, "station")
    right = count = 0
    for robot in range(record.robots):
        where = np.interp(speeds.time, time, station[:, robot])
        turn = turning(path_of(record, robot), where, tol.BEND_SPAN)
        rotation = speeds.rotational[:, robot]
        bend = (np.abs(turn) > tol.BEND) & np.isfinite(rotation)
        right += int((np.sign(rotation) == np.sign(turn))[bend].sum())
        count += int(bend.sum())
    return right / count if count else np.nan


def _speeds_by_place(speeds: metrics.AveragedSpeeds, errors: metrics.Series) -> Measures:
    """Share of the time behind at which a robot is faster than 1 m/s, and the contrary."""
    forward = speeds.forward
    error = np.stack([np.interp(speeds.time, errors.time, e) for e in errors.values.T], axis=1)
    known = np.isfinite(forward)
    behind, ahead = known & (error > tol.BEHIND), known & (error < -tol.BEHIND)
    return {
        "behind_is_faster": float((forward[behind] > 1.0).mean()) if behind.any() else np.nan,
        "ahead_is_slower": float((forward[ahead] < 1.0).mean()) if ahead.any() else np.nan,
    }


def _extreme(values: FloatArray, largest: bool) -> float:
    known = values[np.isfinite(values)]
    return float(known.max() if largest else known.min()) if len(known) else np.nan


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if values.size else np.nan
