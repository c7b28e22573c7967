"""Collision times at the decisions over time (Figs. 3c, 6d), and what they were worth.

Of many robots a row each, in shades of the shortest of each stretch. Predictions stand
against actual contacts.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from physim.analysis.metrics import Figures
from physim.analysis.metrics.distances import pair_collision_times
from physim.contacts import Kind, Phase
from physim.drawing.plots.distances import mark_contacts
from physim.drawing.plots.frame import (
    POSES_ONLY,
    USUAL,
    Paper,
    finished,
    framed,
    mark,
    name_rows,
    names_of,
    nothing,
    row_ends,
    short,
    thinned,
    time_axis,
)
from physim.drawing.plots.style import BAND, INK, NARROW, QUIET, robot_mark
from physim.geometry.shapes import FloatArray, IntArray
from physim.record import Record

CLASSES = (0.2, 0.5, 1.0, 2.0, 3.0, 5.0)
"""[s] between two shades"""
SHADES = ("#440154", "#46327e", "#365c8d", "#277f8e", "#4ac16d", "#a0da39", "#f4e96b")
"""of the colour map viridis, the shortest times darkest"""
MOST_SHADED = 250
"""Rows, each of which can be seen."""
MOST_ROWS = 40
"""Robots whose rows are named, each with its shortest collision time."""


def stretches(record: Record, rows: Any, count: int) -> tuple[FloatArray, IntArray, IntArray]:
    """Edges (count + 1,) [steps] of equal stretches of the run, and which decisions hold in them.

    These are pairs of numbers, (n,) each: of a row, and of a stretch in which it is in force. A
    decision holds until the next of its robot, which may be longer than a stretch.
    """
    edges = np.linspace(record.begun_at, max(record.steps_run, record.begun_at + 1), count + 1)
    last_step = np.maximum(rows["next_step"] - 1, rows["step"])
    first, last = (
        np.clip(np.searchsorted(edges, step, side="right") - 1, 0, count - 1)
        for step in (rows["step"], last_step)
    )
    held = last - first + 1
    row = np.repeat(np.arange(len(rows)), held)
    within = np.arange(len(row)) - np.repeat(np.cumsum(held) - held, held)
    return edges, row, np.repeat(first, held) + within


def least_of_stretches(record: Record, rows: Any, count: int) -> tuple[FloatArray, FloatArray]:
    """Edges (count + 1,) [steps] of equal stretches of the run, and shortest times (N, count) [s].

    NaN where no decision in force foresaw a collision. ``rows`` are decisions that did.
    """
    edges, row, place = stretches(record, rows, count)
    least = np.full((record.robots, count), np.inf)
    np.minimum.at(least, (rows["robot"][row], place), rows["collision_time"][row])
    return edges, np.where(np.isfinite(least), least, np.nan)


def draw_rows(axis: Any, record: Record, rows: Any, count: int) -> list[Any]:
    """Draw the rows; returns handles for the shades that occur.

    Of more than `MOST_SHADED` robots several share a row, which shows the shortest of them.
    """
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    edges, least = least_of_stretches(record, rows, count)
    each = -(-record.robots // MOST_SHADED)
    first = np.arange(0, record.robots, each)
    least = np.fmin.reduceat(least, first, axis=0)
    shade = np.where(np.isnan(least), np.nan, np.searchsorted(CLASSES, least, side="right"))
    axis.grid(False)
    axis.pcolormesh(
        edges * record.dt, np.append(first, record.robots) - 0.5, np.ma.masked_invalid(shade),
        cmap=ListedColormap(SHADES), vmin=-0.5, vmax=len(SHADES) - 0.5, rasterized=True,
    )  # fmt: skip
    axis.set_ylim(record.robots - 0.5, -0.5)
    few = record.robots <= MOST_ROWS
    name_rows(axis, record, MOST_ROWS if few else 20, 7.5, most=10)
    if each > 1:
        axis.set_ylabel(f"robot (a row: shortest of {each})")
    if few:
        shortest = np.fmin.reduce(least, axis=1)
        words = [f"{value:.2f} s" if np.isfinite(value) else None for value in shortest]
        row_ends(axis, "least", words, (shortest == np.fmin.reduce(shortest)).tolist(), "least")
    words_of = [f"{low:g} to {high:g} s" for low, high in pairwise(CLASSES)]
    words_of = [f"below {CLASSES[0]:g} s", *words_of, f"{CLASSES[-1]:g} s and more"]
    handles = [
        Patch(facecolor=colour, label=label)
        for k, (colour, label) in enumerate(zip(SHADES, words_of, strict=True))
        if (shade == k).any()
    ]
    if np.isnan(least).any():
        handles.append(Patch(facecolor="none", edgecolor=QUIET, linewidth=0.5, label="none ahead"))
    return handles


FLOOR = 0.01
"""[s] Least collision time on the axis; smaller ones, and contact, lie on it, as its tick says."""
EDGE = 0.92
"""Share of `FLOOR` at which the axis ends where something lies on it: no other tick is below"""
LARGEST = 1000.0
"""[s] A longer collision time is a controller's word for none."""
TICKS = tuple(float(f"{digit}e{power}") for power in range(-2, 3) for digit in (1, 2, 5))
MOST_SINGLE = 4
"""Robots whose decisions can be told apart without a row each."""
STRETCHES = 240
"""Stretches of the run of which many robots have one value each."""


def collision_times(record: Record, paper: Paper = USUAL) -> Any:
    """Figure: collision times [s] of the decisions that foresaw one, over time [s], log axis.

    A mark a decision. Of more than `MOST_SINGLE` robots, below: a row a robot in shades of its
    shortest, with the least of the run at the end. The shortest of all is marked.
    """
    if record.judged is not None:
        return _seen_times(record, paper)
    times = record.column("collision_time", absent=np.nan)
    rows = record.updates[times <= LARGEST]
    shortest = Figures(record).collision_time if len(rows) else None
    many = record.robots > MOST_SINGLE and shortest is not None
    more = min(4.6, 0.45 + 0.2 * record.robots) if many else 0.0
    figure = framed(record, "Collision times at decisions", "Figs. 3c, 6d", paper=paper,
                    height=2.6 + more, width=5.6 if many else NARROW)  # fmt: skip
    if many:
        axis, below = figure.subplots(2, 1, sharex=True, height_ratios=(2.0, more))
    else:
        axis = below = figure.subplots()
    time_axis(below, record)
    axis.set_ylabel("collision time [s]")
    if shortest is None:
        unknown = len(times) and np.isnan(times).all()
        why = "the controller reports none" if unknown else "no decision foresaw a collision"
        nothing(axis, why)
        return figure
    handles = _decisions(axis, record, rows)
    _seconds(axis, shortest.value, float(rows["collision_time"].max()))
    handles += mark_contacts([axis], record)
    if many:
        handles += draw_rows(below, record, rows, STRETCHES)
    text = f"{shortest.value:.3g} s ({names_of(record, [shortest.a])})"
    mark(axis, shortest.time, max(shortest.value, FLOOR), text, below=True)
    return finished(figure, handles)


def _seen_times(record: Record, paper: Paper) -> Any:
    """Of a log: the least of all pairs that go on as seen, a robot in each."""
    title = "Collision times of robots that go on as seen"
    figure = framed(record, title, paper=paper, height=2.6, width=NARROW)
    axis = figure.subplots()
    time_axis(axis, record)
    axis.set_ylabel("collision time [s]")
    (time, least), _ = pair_collision_times(record)
    shortest = Figures(record).seen_collision_time
    if shortest is None:
        nothing(axis, "nothing headed for a collision")
        return figure
    least = np.where(np.isfinite(least), np.maximum(least, FLOOR), np.nan)
    axis.plot(time, least, color=BAND, linewidth=0.9, label="least of all pairs")
    _seconds(axis, shortest.value, float(np.nanmax(least)))
    mark_contacts([axis], record)
    who = names_of(record, list(shortest.bodies))
    mark(axis, shortest.time, max(shortest.value, FLOOR), f"{shortest.value:.3g} s ({who})",
         below=True)  # fmt: skip
    return finished(figure, axis.get_legend_handles_labels()[0])


def _seconds(axis: Any, shortest: float, longest: float) -> None:
    """Logarithmic axis of a decade or more, from below the shortest time to above the longest."""
    floored = shortest < FLOOR
    low = EDGE * FLOOR if floored else min(0.5 * shortest, 0.5)
    high = max(1.25 * longest, 10.0 * low)
    axis.set_ylim(low, high)  # first: the scale would look for limits of its own
    axis.set_yscale("log")
    ticks = [tick for tick in TICKS if low <= tick <= high]
    words = [f"{tick:g}" for tick in ticks]
    if floored:
        words[0] = f"\N{LESS-THAN OR EQUAL TO} {words[0]}"
    axis.set_yticks(ticks, words)
    axis.minorticks_off()


def _decisions(axis: Any, record: Record, rows: Any) -> list[Any]:
    """A mark a decision, in the colours of the robots; of a crowd in one."""
    kinds = [(short(record.names[k]), rows["robot"] == k, *robot_mark(k))
             for k in range(record.robots)]  # fmt: skip
    if record.robots > MOST_NAMED:
        kinds = [(f"decisions of {record.robots} robots", rows["robot"] >= 0, BAND, "o")]
    handles = []
    for label, which, colour, marker in kinds:
        mine = np.sort(rows[which], order="step")
        if len(mine):
            time, values = thinned(mine["step"] * record.dt, mine["collision_time"])
            handles += axis.plot(
                time, np.maximum(values, FLOOR), marker, color=colour, markersize=2.4,
                markeredgewidth=0.0, rasterized=True, linestyle="none", label=label,
            )  # fmt: skip
    return handles


MOST_NAMED = 12
"""Robots that have marks of their own; those of more are alike."""


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
    times = record.column("collision_time", absent=np.nan)
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


def prediction(record: Record, paper: Paper = USUAL) -> Any:
    """Figure: predicted against actual time to contact of every decision before a contact."""
    known = predictions(record)
    figure = framed(record, "Predicted and actual contact", paper=paper, height=3.6)
    axis = figure.subplots()
    axis.set_xlabel("actual time to the next contact [s]")
    axis.set_ylabel("predicted: collision time at the decision [s]")
    if not len(known.robot):
        contacts = record.contacts
        began = contacts[contacts["kind"] == Kind.PHYSICAL]
        why = "no contact was foreseen" if len(began) else "no contact"
        if len(began) and np.isnan(record.column("collision_time", absent=np.nan)).all():
            why = "the controller reports\nno collision times"
        if record.judged is not None:
            why = POSES_ONLY
        elif len(contacts) and not len(began):
            why = "no contact at a sample,\ncontacts between samples only"
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
    beyond = int((known.predicted > 1.25 * most).sum())
    if beyond:
        axis.set_title(f"{beyond} predictions lie above", loc="right", fontsize=8.5, color=QUIET)
    return finished(figure, axis.get_legend_handles_labels()[0])


def _scatter(axis: Any, record: Record, known: Predictions) -> None:
    """One mark a robot, of many the same; full where the command was held until the contact."""
    robots = np.unique(known.robot)
    kinds = [(short(record.names[k]), known.robot == k, robot_mark(k)) for k in robots.tolist()]
    if len(robots) > MOST_NAMED:
        everyone = np.ones(len(known.robot), dtype=bool)
        kinds = [(f"{len(robots)} robots", everyone, (BAND, "o"))]
    for label, mine, (colour, marker) in kinds:
        for kept in (0, 1):
            rows = mine & (known.kept == kept)
            axis.plot(
                known.actual[rows], known.predicted[rows], marker, color=colour, markersize=4.0,
                markerfacecolor=colour if kept else "none", markeredgewidth=0.8, linestyle="none",
                label=label if kept == int(known.kept[mine].any()) else None,
            )  # fmt: skip
    if known.kept.any() and not known.kept.all():
        axis.plot([], [], "o", color=INK, markersize=4.0, label="command held until contact")
