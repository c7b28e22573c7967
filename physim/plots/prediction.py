"""Predicted against actual contact: what the collision times at decisions were worth."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from physim.contacts import Kind, Phase
from physim.geometry.shapes import FloatArray, IntArray
from physim.plots.frame import framed, nothing, short
from physim.plots.style import INK, QUIET, robot_mark
from physim.record import Record

MOST_NAMED = 12
"""Robots in the legend."""


class Predictions(NamedTuple):
    """Decisions after which their robot came into contact, M of them."""

    robot: IntArray
    predicted: FloatArray
    """(M,) [s] collision time at the decision"""
    actual: FloatArray
    """(M,) [s] from the decision to the robot's next physical contact"""
    kept: IntArray
    """(M,) 1 where the decision's command was the applied one until the contact, else 0"""


def predictions(record: Record) -> Predictions:
    """Decisions with a finite collision time, each with the next contact of its robot.

    Decisions that are made in contact are left out, and so are those after the last contact.
    """
    times = record.column("collision_time")
    rows = record.updates[np.isfinite(times) & (times > 0.0)]
    found: list[tuple[int, float, float, int]] = []
    contacts = record.contacts
    began = contacts[(contacts["phase"] == Phase.BEGAN) & (contacts["kind"] == Kind.PHYSICAL)]
    for robot in range(record.robots):
        mine = rows[rows["robot"] == robot]
        changed = np.sort(record.commands["step"][record.commands["robot"] == robot])
        hits = np.unique(began["step"][(began["a"] == robot) | (began["b"] == robot)])
        place = np.searchsorted(hits, mine["step"], side="right")
        for row, k in zip(mine[place < len(hits)], place[place < len(hits)], strict=True):
            actual = float((hits[k] - row["step"]) * record.dt)
            between = np.searchsorted(changed, (row["step"], hits[k]))
            kept = int(row["next_step"] >= hits[k] and between[0] == between[1])
            found.append((robot, float(row["collision_time"]), actual, kept))
    columns = np.array(found, dtype=np.float64).reshape(-1, 4).T
    return Predictions(columns[0].astype(np.int64), columns[1], columns[2], columns[3].astype(int))


def prediction(record: Record) -> Any:
    """Figure: predicted against actual time to contact of every decision before a contact."""
    known = predictions(record)
    figure = framed(record, "Predicted and actual contact", width=4.4, height=4.3)
    axis = figure.subplots()
    axis.set_xlabel("actual time to the next contact [s]")
    axis.set_ylabel("predicted: collision time at the decision [s]")
    if not len(known.robot):
        contacts = record.contacts
        began = contacts[contacts["kind"] == Kind.PHYSICAL]
        why = "no contact was foreseen" if len(began) else "no contact"
        if len(began) and np.isnan(record.column("collision_time")).all():
            why = "the controller reports\nno collision times"
        if len(contacts) and not len(began):
            why = "no contact at a sample,\ngrazes between samples only"
        nothing(axis, why)
        return figure
    _scatter(axis, record, known)
    most = 1.05 * float(known.actual.max())
    axis.plot((0.0, most), (0.0, most), color=QUIET, linewidth=0.9, label="as predicted")
    # The contact is seen at the first sample after it: up to one step late.
    axis.fill_between((0.0, most), (-record.dt, most - record.dt), (0.0, most), color=QUIET,
                      alpha=0.25, linewidth=0.0, label="within one step")  # fmt: skip
    axis.set(xlim=(0.0, most), ylim=(0.0, 1.25 * most))
    axis.set_aspect("auto")
    axis.legend(loc="upper left")
    beyond = int((known.predicted > 1.25 * most).sum())
    if beyond:
        axis.set_title(f"{beyond} predictions lie above", loc="right", fontsize=8.5, color=QUIET)
    return figure


def _scatter(axis: Any, record: Record, known: Predictions) -> None:
    """One mark a robot; full where the command was held until the contact."""
    robots = np.unique(known.robot)
    for k, robot in enumerate(robots):
        colour, marker = robot_mark(int(robot))
        label = short(record.names[robot]) if k < MOST_NAMED else None
        for kept in (0, 1):
            rows = (known.robot == robot) & (known.kept == kept)
            axis.plot(
                known.actual[rows], known.predicted[rows], marker, color=colour, markersize=4.0,
                markerfacecolor=colour if kept else "none", markeredgewidth=0.8,
                label=label if kept == int(known.kept[known.robot == robot].any()) else None,
                clip_on=True,
            )  # fmt: skip
    if known.kept.any() and not known.kept.all():
        axis.plot([], [], "o", color=INK, markersize=4.0, label="command held until contact")
