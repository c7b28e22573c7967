"""Figures 3 and 6: distances and collision times, and that nothing touches."""

from __future__ import annotations

import numpy as np

from physim import metrics
from physim.metrics.pair_times import shortest_pair_collision_time
from physim.record import Record
from physim.reproduction.claims import tolerances as tol
from physim.reproduction.claims.claim import Claim, Quantity, holds, near
from physim.reproduction.study import Measures

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
