"""Rules of validation, broken: what each ledger holds against what, and who is responsible."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tests.mutation.rules import called, found, given, instead, rule

BLAME = "physim.analysis.validation.responsibility:"
COMPARISON = "physim.analysis.validation.comparison:"
DECISIONS = "physim.analysis.validation.decisions:"
PREDICTION = "physim.analysis.validation.prediction:"
PUSHING = "physim.analysis.validation.motion:"


# Responsibility


@rule("validation")
def both_robots_are_responsible() -> None:
    """Whoever touches has to keep clear, ahead or behind."""
    instead(BLAME + "_has_to_consider", lambda a: True)


@rule("validation")
def priority_is_that_at_the_contact() -> None:
    """Who was behind is judged when they touch, not at the last decision."""

    def then(a: Any) -> float | None:
        if a.other >= a.record.robots:
            return None
        of = a.table.reference_station
        return float(of(a.other, a.step) - of(a.i, a.step))

    instead(BLAME + "_behind", then)


@rule("validation")
def the_faster_one_is_responsible() -> None:
    """Of two robots the one that drives faster has to keep clear."""

    def slower(a: Any) -> float | None:
        if a.other >= a.record.robots:
            return None
        speed = [abs(a.table.held(k, max(a.step - 1, 0))[0]) for k in (a.i, a.other)]
        return float(speed[0] - speed[1])

    instead(BLAME + "_behind", slower)


@rule("validation")
def nobody_is_pushed() -> None:
    """A robot is charged with what others push it into."""
    instead(BLAME + "pushed_by", lambda a: None)


@rule("validation")
def the_next_one_pushed() -> None:
    """The pusher is the robot that touches, not the one at the end of the chain of pushes."""
    depth = [0]

    def once(old: Any, a: Any) -> Any:
        if depth[0]:
            return None
        depth[0] += 1
        try:
            return old()
        finally:
            depth[0] -= 1

    called(BLAME + "_pusher", once)


@rule("validation")
def to_stand_is_not_to_move() -> None:
    """A robot stands when it did not move, whatever its command."""

    def still(a: Any) -> bool:
        if a.step < 1:
            return False
        before, now = (a.table.record.pose_at(step)[a.robot] for step in (a.step - 1, a.step))
        return bool(math.hypot(*(now - before)[:2]) < 1e-3 * a.table.record.dt)

    instead(BLAME + "stands", still)


# Predictions


@rule("validation")
def predictions_take_straight_lines() -> None:
    """A contact is foretold as if nobody turned."""
    given(
        PREDICTION + "pair_time",
        twist_a=lambda a: (a.twist_a[0], 0.0, 0.0), twist_b=lambda a: (a.twist_b[0], 0.0, 0.0),
    )  # fmt: skip


@rule("validation")
def predictions_are_those_of_the_start() -> None:
    """A contact is held against the first decision, not the last one before it."""
    found(DECISIONS + "DecisionTable.last_before", lambda step, a: None if step is None else 0)


@rule("validation")
def every_robot_moves_as_commanded() -> None:
    """A prediction is held against a contact although others pushed the robots meanwhile."""
    instead(PREDICTION + "Predictor._as_commanded", lambda a: True)


@rule("validation")
def a_touch_before_explains_everything() -> None:
    """Any prediction that is wrong is taken to be one of a touch that came first."""
    instead(PREDICTION + "Predictor._touched_then", lambda a: True)


@rule("validation")
def warned_is_by_the_last_decision_alone() -> None:
    """A contact lay ahead since the last decision, whatever those before it foretold."""

    def last(value: Any, a: Any) -> Any:
        return min(value, a.contact.touched - (a.contact.made or 0.0))

    found(PREDICTION + "Predictor.ahead", last)


# Ledgers


@rule("validation")
def motion_is_held_against_straight_lines() -> None:
    """A pose is held against straight motion from the one before, not the arc (1)."""

    def straight(a: Any) -> Any:
        pose, command = np.asarray(a.pose), np.asarray(a.command)
        out = pose.copy()
        out[:, 0] += a.t * command[:, 0] * np.cos(pose[:, 2])
        out[:, 1] += a.t * command[:, 0] * np.sin(pose[:, 2])
        out[:, 2] += a.t * command[:, 1]
        return out

    instead("physim.geometry.motion:arcs", straight)


@rule("validation")
def whoever_touches_goes_anywhere() -> None:
    """A robot in contact is held against nothing."""
    given(PUSHING + "Pushing.too_far", held=lambda a: np.zeros_like(a.held))


@rule("validation")
def distances_are_held_with_their_sign_lost() -> None:
    """An overlap in the record may be a gap by the shapes."""
    found(COMPARISON + "distance_at", lambda value, a: abs(value))


@rule("validation")
def rows_are_held_against_themselves() -> None:
    """Points, normals and depths of contacts are compared with what the record says."""

    def same(exact: Any, a: Any) -> Any:
        return {name: a.rows[name] for name in exact}

    found(COMPARISON + "_exact", same)


@rule("validation")
def travel_leaves_out_turning() -> None:
    """How far a point of a robot moves in a step is how far its reference point does."""
    instead(
        "physim.analysis.validation.analytic_contacts:travel_bound",
        lambda a: float(np.hypot(*(np.asarray(a.end) - np.asarray(a.start))[:2])),
    )


@rule("validation")
def steps_are_looked_at_where_they_end() -> None:
    """A contact that begins and ends within a step is not looked for."""
    instead("physim.analysis.validation.analytic_contacts:touch_in_step", lambda a: False)
