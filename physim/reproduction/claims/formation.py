"""Figures 2 and 7: formation errors, averaged speeds, deviations of a group."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim import metrics
from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.reproduction.claims import tolerances as tol
from physim.reproduction.claims.claim import Claim, Quantity, holds, steps
from physim.reproduction.claims.following import path_of, turning
from physim.reproduction.study import Measures

SNAPSHOTS = 21.0
"""[s] between two snapshots (paper, Fig. 2a)"""


def measure_formation(record: Record) -> Measures:
    """Formation errors, speeds, deviations and how far the group is spread."""
    course = metrics.formation_errors(record)
    if course is None:
        return {}
    peak, final = metrics.formation_error_peak(record), metrics.formation_error_final(record)
    speeds = metrics.averaged_speeds(record)
    size = np.abs(metrics.deviations(record).values).max(axis=0)
    mean = np.nanmean(metrics.deviations(record).values, axis=0)
    bends, straights = _by_place(record, course.values)
    return {
        "formation_error_peak": np.nan if peak is None else peak.value,
        "formation_error_final": np.nan if final is None else final.value,
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
