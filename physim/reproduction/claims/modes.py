"""Figure 8 and the words below the figures: modes, communication, computing, time to finish."""

from __future__ import annotations

import numpy as np

from physim.analysis import metrics
from physim.record import Record
from physim.reproduction.claims import tolerances as tol
from physim.reproduction.study import Claim, Measures, Quantity, holds, steps

SAFE_ONES = (5, 8, 10)
"""Robots that are more in safe mode (paper), counted from 1."""
ROBOTS = 10


def measure_modes(record: Record) -> Measures:
    """Shares of safe mode of Robots 5, 8 and 10 and of the others."""
    found = metrics.share_of_modes(record, danger=False)
    if found is None or len(found.robots) != ROBOTS:
        return {}
    share = np.array([np.nan if one is None else one for one in found.robots])
    calm = np.isin(np.arange(1, ROBOTS + 1), SAFE_ONES)
    both = (share > 0.0) & (share < 1.0)
    return {
        "safe_least_of_5_8_10": float(share[calm].min()),
        "safe_least_of_others": float(share[~calm].min()),
        "safe_largest_of_others": float(share[~calm].max()),
        "others_in_danger": float((share[~calm] < tol.MOST_OF_TIME).sum()),
        "both_modes": float(both.sum()),
    }


def claims_of_figure_8() -> tuple[Claim, ...]:
    """What Figure 8 and the words about it say."""
    return (
        Claim(
            "Robots switch between safe and danger mode", "both modes",
            (Quantity("both_modes", "of 10 robots use both", 0),),
            holds(lambda run: run["both_modes"] == ROBOTS),
        ),
        Claim(
            "Robots 5, 8 and 10 spend more time in safe mode than in danger mode",
            "more than half",
            (Quantity("safe_least_of_5_8_10", "%", 1, "least share of safe mode of the three:"),),
            holds(lambda run: run["safe_least_of_5_8_10"] > tol.MOST_OF_TIME),
        ),
        Claim(
            "Robots 5, 8 and 10 spend more of their time in safe mode than any other robot",
            "more than the rest",
            (
                Quantity("safe_least_of_5_8_10", "%", 1, "least of the three"),
                Quantity("safe_largest_of_others", "%", 1, "largest of the others"),
            ),
            holds(lambda run: run["safe_least_of_5_8_10"] > run["safe_largest_of_others"]),
        ),
        Claim(
            "The other robots spend more time in danger mode than in safe mode",
            "less than half safe",
            (
                Quantity("others_in_danger", "of 7 robots", 0),
                Quantity("safe_least_of_others", "%", 1, "least share of safe mode"),
            ),
            steps(
                lambda run: run["others_in_danger"] == ROBOTS - len(SAFE_ONES),
                lambda run: run["others_in_danger"] > 0,
            ),
            "The paper's paths and five thresholds are unknown; ours keep robots in safe mode "
            "longer.",
        ),
    )  # fmt: skip


FEW = 0.5
"""[-] "Low": at most this share of what deciding at every physics step would take."""


def measure_effort(record: Record) -> Measures:
    """Messages, collision-time evaluations, update intervals and the time to finish.

    As if every robot had decided at every physics step, with the neighbours that it considered:
    each decision counts as often as it held steps.
    """
    rows = record.updates
    held = np.minimum(rows["next_step"], record.steps_run) - rows["step"]
    messages, evaluations = metrics.messages(record) or 0, metrics.evaluations(record)
    planned = rows["next_step"] - rows["step"]
    every_step = float((rows["considered"] * held).sum())
    every_evaluation = float(np.nansum(record.column("evaluations", absent=np.nan) * held))
    _, first = np.unique(rows["robot"], return_index=True)
    distance = (record.stop_station - rows["station"][first]).max()
    time = metrics.time_to_finish(record)
    return {
        "messages": float(messages),
        "messages_share": messages / every_step if every_step else np.nan,
        "evaluations": np.nan if evaluations is None else float(evaluations),
        "evaluations_share": evaluations / every_evaluation if evaluations else np.nan,
        "shorter_intervals": float((planned < planned.max()).mean()),
        "time_to_finish": np.nan if time is None else time,
        "time_at_steady_speed": float(distance),
        "mean_speed": metrics.mean_speed(record) or np.nan,
    }


def claims_in_words() -> tuple[Claim, ...]:
    """Claims that the paper makes in words about the ten robots, without a figure."""
    return (
        Claim(
            "Event-triggered updates keep communication low (messages: one for each "
            "considered robot and decision)", "low, no figure given",
            (
                Quantity("messages", "messages", 0),
                Quantity("messages_share", "%", 1, "of those for updates at every physics step:"),
            ),
            holds(lambda run: run["messages_share"] <= FEW),
            f"Low is taken as at most {FEW:.0%} of the messages at every step of 0.01 s; a fixed "
            "interval of 0.2 s needs about as few.",
        ),
        Claim(
            "Event-triggered updates keep computing low (collision-time evaluations)",
            "low, no figure given",
            (
                Quantity("evaluations", "evaluations", 0),
                Quantity("evaluations_share", "%", 1, "of those for updates at every step:"),
            ),
            holds(lambda run: run["evaluations_share"] <= FEW),
            "As for messages.",
        ),
        Claim(
            "Collision times adapt the update interval (14)", "no figure given",
            (Quantity("shorter_intervals", "%", 2, "intervals shorter than the longest:"),),
            holds(lambda run: run["shorter_intervals"] > 0.0),
            "Intervals are beta times the shortest collision time, 0.2 s at most; where it is "
            "long, as most of the time, they are 0.2 s. One more decision falls on arrival.",
        ),
        Claim(
            "Less conservative, shorter operation time", "no figure given",
            (
                Quantity("time_to_finish", "s", 1, "time to finish"),
                Quantity("time_at_steady_speed", "s", 1, "longest path at 1 m/s"),
            ),
            steps(
                lambda run: run["time_to_finish"]
                <= tol.IN_TIME * run["time_at_steady_speed"],
                lambda run: not np.isnan(run["time_to_finish"]),
            ),
            f"Short is taken as at most {tol.IN_TIME:g} times the longest path at the steady "
            "speed; the paper gives no time and compares with no other method.",
        ),
    )  # fmt: skip
