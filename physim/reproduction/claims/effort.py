"""The words below the figures: communication, computing, time to finish."""

from __future__ import annotations

import numpy as np

from physim import metrics
from physim.record import Record
from physim.reproduction.claims import tolerances as tol
from physim.reproduction.claims.claim import Claim, Quantity, holds, steps
from physim.reproduction.study import Measures

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
    every_evaluation = float(np.nansum(record.column("evaluations") * held))
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
