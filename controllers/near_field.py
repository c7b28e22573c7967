"""What one decision knows of the robots and walls about it before any distance is worked out.

Worked out once a decision, it serves every distance and collision time (11) asked for in it: how
far apart the discs about the robots are and how they move. From that follows which few of them can
be nearest, or be met first; only of those exact values are worked out.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.collision import (
    BOUND_MARGIN,
    nearest_pass,
    nearly_straight,
    stays,
    swept_disc,
)
from physim.geometry.motion import Course, facing_course
from physim.geometry.shapes import FloatArray, IntArray
from physim.geometry.wall_tree import Sight

from .priority import Bodies

COLUMNS = 11
X, Y, APART, ROOM, VX, VY, SPEED, PULL, PASS, BOUND, REFINED = range(COLUMNS)
"""Columns of `NearField.table`"""


class NearField(NamedTuple):
    """The considered robots and the walls that are seen, from the robot of row ``me``."""

    me: int
    """its row of `Bodies`"""
    rows: IntArray
    """(n,) rows of `Bodies` that it considers"""
    table: FloatArray
    """(n or more, COLUMNS) of each: where it is from here, how far [m], room [m] between the discs
    (less BOUND_MARGIN), velocity [m/s], speed [m/s], acceleration [m/s^2], room when it passes
    (`note_passes`, before: -inf), and two places for notes on when it is met"""
    nearest: int
    """place in ``rows`` of the one with the least room; -1 without any"""
    sight: Sight
    """the walls"""
    listed: IntArray
    """(n or more,) for notes"""
    keep: float
    """1.0; 0.0 where collision times assume that nobody turns"""


@compiled
def look_about(bodies: Bodies, me: int, rows: IntArray, keep: float, table: FloatArray) -> int:
    """Fill in the table of a `NearField` and return its ``nearest``."""
    pose, command, facing = bodies.pose, bodies.command, bodies.facing
    radius, shape = bodies.shapes.radius, bodies.shape
    x, y, mine = pose[me, 0], pose[me, 1], radius[shape[me]]
    nearest, least = -1, np.inf
    for k in range(len(rows)):
        j = rows[k]
        dx = pose[j, 0] - x
        dy = pose[j, 1] - y
        apart = sqrt(dx * dx + dy * dy)
        room = apart - mine - radius[shape[j]] - BOUND_MARGIN
        v = command[j, 0]
        table[k, X] = dx
        table[k, Y] = dy
        table[k, APART] = apart
        table[k, ROOM] = room
        table[k, VX] = v * facing[j, 0]
        table[k, VY] = v * facing[j, 1]
        table[k, SPEED] = abs(v)
        table[k, PULL] = abs(v * keep * command[j, 1])
        table[k, PASS] = -np.inf
        if room < least:
            nearest, least = k, room
    return nearest


@compiled
def course_under(bodies: Bodies, row: int, v: float, omega: float) -> Course:
    """Course of a row of ``bodies`` under the command (v, omega)."""
    pose, facing = bodies.pose, bodies.facing
    radius = bodies.shapes.radius[bodies.shape[row]]
    return facing_course(
        pose[row, 0], pose[row, 1], facing[row, 0], facing[row, 1], v, omega, radius
    )


@compiled
def held_course(bodies: Bodies, near: NearField, k: int) -> Course:
    """Course of number k of the considered robots under the command it holds."""
    j = near.rows[k]
    return course_under(bodies, j, bodies.command[j, 0], near.keep * bodies.command[j, 1])


@compiled
def note_passes(bodies: Bodies, near: NearField, horizon: float) -> None:
    """Note how near each considered robot comes, up to the horizon, to where this one is now.

    It serves many candidates: one that goes round, or stands, does not leave the place by much.
    """
    x, y = bodies.pose[near.me, 0], bodies.pose[near.me, 1]
    mine = bodies.shapes.radius[bodies.shape[near.me]]
    for k in range(len(near.rows)):
        course = held_course(bodies, near, k)
        if nearly_straight(course):
            continue
        if stays(course):
            its_x, its_y, radius = swept_disc(course)
            apart = sqrt((its_x - x) * (its_x - x) + (its_y - y) * (its_y - y))
        else:
            apart = nearest_pass(course.x - x, course.y - y, course.vx, course.vy, horizon)
            radius = course.radius
        near.table[k, PASS] = apart - radius - mine - BOUND_MARGIN


@compiled
def leeway(course: Course) -> float:
    """How far [m] the reference point of a body ever is from where it is now; inf if anywhere."""
    if not stays(course):
        return np.inf
    return 2.0 * course.speed / abs(course.turn) if course.speed > 0.0 else 0.0
