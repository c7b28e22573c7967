"""The dynamic window approach: the best command among those that can be reached, and stopped from.

Fox, Burgard and Thrun: The dynamic window approach to collision avoidance (IEEE RAM 4(1), 1997).
Terms are named by the symbols of the source. Of the commands that the accelerations allow within
one period (V_d), those are admissible (V_a) from which the robot comes to a stand before it meets
anything on its arc; of these the one with the largest

    G = alpha heading + beta dist + gamma velocity

is taken. ``heading`` is 1 - |angle to the target| / pi once the turn has been braked, ``dist`` the
way to the first contact, and ``velocity`` the speed, the last two as shares of ``far`` and of the
preferred speed.

Departures: physim bounds no accelerations of robots that have no drive, so ``acceleration`` and
``turn_acceleration`` are the method's own, and robots with a drive are not driven;
``dist`` is that of the exact collision time of the footprint with walls and with others that keep
their twists, less the ``margin``; a command is held for a period before it can be braked; G is not
smoothed over the window, the margin serves for that; robots never go backwards. There is no half
of avoiding: only ``priority: ahead`` leaves out who is behind. Where no command is admissible the
robot brakes.
"""

from __future__ import annotations

from math import atan2, hypot, pi
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray, IntArray, Rows2
from physim.parts.declarations import STANDARD_COLUMNS, Rule

from .avoidance import NearField, smallest_time
from .navigation import (
    PREFERRED,
    STILL,
    STOP,
    Asked,
    Navigating,
    NavigationSettings,
    Team,
    sight_of,
    turn_to,
)
from .priority import Bodies
from .settings import NotNegative, Positive

if TYPE_CHECKING:
    from physim.simulation.observation import View

ADMISSIBLE = 1
"""Numbers of the rules: the preferred speed straight to the target is 0"""
BRAKE = 2


class DwaSettings(NavigationSettings):
    """Keys under ``controller:`` for ``type: dwa``."""

    acceleration: Positive = Field(
        default=0.5, description="[m/s²] of the speed, forwards and braking (RHINO: 0.5)"
    )
    turn_acceleration: Positive = Field(
        default=pi / 3.0, description="[rad/s²] of the turn (RHINO: 60 degrees/s²)"
    )
    heading: NotNegative = Field(default=2.0, description="[-] alpha, weight of the heading (2.0)")
    dist: NotNegative = Field(default=0.2, description="[-] beta, weight of the free way (0.2)")
    velocity: NotNegative = Field(default=0.2, description="[-] gamma, weight of the speed (0.2)")
    far: Positive = Field(default=3.0, description="[m] a free way beyond counts as this")
    speeds: Annotated[int, Field(ge=2, le=20)] = Field(
        default=3, description="[-] speeds to choose from within the window"
    )
    turns: Annotated[int, Field(ge=3, le=61)] = Field(
        default=11, description="[-] rotational speeds to choose from within the window"
    )
    horizon: Positive = Field(
        default=5.0, description="[s] collision times beyond this count as none"
    )


class Window(NamedTuple):
    """`DwaSettings` as the kernels take them."""

    acceleration: float
    turn_acceleration: float
    heading: float
    dist: float
    velocity: float
    far: float
    speeds: int
    turns: int
    horizon: float


@compiled
def can_stop(
    window: Window, period: float, margin: float, v: float, omega: float, time: float
) -> bool:
    """Whether a command, held for a ``period``, is admissible: braked before a contact at ``time``.

    In V_a: v² / 2 a and omega² / 2 a_omega are at most the way and the angle that are left.
    """
    if time == np.inf:
        return True
    left = time - period
    way, angle = v * left - margin, abs(omega) * left
    stops = v == 0.0 or v * v <= 2.0 * window.acceleration * way
    return stops and (omega == 0.0 or omega * omega <= 2.0 * window.turn_acceleration * angle)


@compiled
def goodness(
    window: Window, period: float, nu: float, error: float, v: float, omega: float, way: float
) -> float:
    """G of a command with so much free ``way`` [m]; the target is ``error`` [rad] to the left."""
    braked = omega * period + 0.5 * omega * abs(omega) / window.turn_acceleration
    off = abs(atan2(np.sin(error - braked), np.cos(error - braked)))
    free = min(way, window.far) / window.far
    pace = v / nu if nu > 0.0 else 0.0
    return window.heading * (1.0 - off / pi) + window.dist * free + window.velocity * pace


@compiled
def put_dwa(
    team: Team,
    bodies: Bodies,
    asked: Asked,
    window: Window,
    command: Rows2,
    rule: IntArray,
    time: FloatArray,
) -> None:
    """Decide for all that are asked: commands, numbers of rules, and collision times [s]."""
    period, pair = team.update_period, np.empty(2)
    for k in range(asked.size):
        i, me = asked.robot[k], asked.row[k]
        others = asked.start[k + 1] - asked.start[k]
        near = NearField(me, asked.near[asked.start[k] :], others, sight_of(team, bodies, me), 1.0)
        wx, wy = asked.preferred[k, 0], asked.preferred[k, 1]
        held_v, held_omega = bodies.twist[me, 0], bodies.twist[me, 1]
        nu = hypot(wx, wy)
        error = turn_to(wx, wy, bodies.pose[me, 2]) if nu > STILL else 0.0
        change, turn_change = window.acceleration * period, window.turn_acceleration * period
        slowest = min(max(0.0, held_v - change), team.limits[i, 0])
        fastest = max(slowest, min(held_v + change, nu))
        most = team.limits[i, 1]
        low = min(max(held_omega - turn_change, -most), most)
        high = max(min(held_omega + turn_change, most), low)
        best, best_v, best_omega, best_time = -np.inf, slowest, 0.0, np.inf
        for m in range(window.speeds):
            v = fastest - (fastest - slowest) * m / (window.speeds - 1)
            for n in range(window.turns):
                omega = low + (high - low) * n / (window.turns - 1)
                if abs(omega) < 1e-9:
                    omega = 0.0
                if goodness(window, period, nu, error, v, omega, window.far) <= best:
                    continue  # whatever its way is
                pair[0], pair[1] = v, omega
                xi = smallest_time(bodies, near, pair, window.horizon, -1.0)
                if not can_stop(window, period, team.margin, v, omega, xi):
                    continue
                way = v * xi if v > 0.0 else 0.0
                value = goodness(window, period, nu, error, v, omega, way)
                if value > best:
                    best, best_v, best_omega, best_time = value, v, omega, xi
        rule[k] = ADMISSIBLE if best_time < np.inf else 0
        if best == -np.inf:
            best_omega = low if low > 0.0 else min(high, 0.0)
            pair[0], pair[1] = best_v, best_omega
            best_time = smallest_time(bodies, near, pair, window.horizon, -1.0)
            rule[k] = BRAKE
        command[k, 0], command[k, 1], time[k] = best_v, best_omega, best_time


class Dwa(Navigating):
    """The dynamic window approach of Fox, Burgard and Thrun, for polygons."""

    Settings = DwaSettings
    settings: DwaSettings
    rules = (
        PREFERRED,
        Rule("admissible", "best command that can be stopped from in time"),
        Rule("brake", "no command can be stopped from in time: brakes"),
        STOP,
    )
    columns = (*STANDARD_COLUMNS[:2], STANDARD_COLUMNS[4])

    def avoid(
        self, view: View, team: Team, bodies: Bodies, asked: Asked, memory: dict[str, NDArray[Any]]
    ) -> tuple[FloatArray, IntArray, FloatArray]:
        """Choose within the dynamic window about the command that is held."""
        s, many = self.settings, asked.size
        left = np.hypot(*(asked.target - bodies.pose[asked.row, :2]).T)  # of one beside its stop
        missing = team.stop_station[asked.robot] - view.sensed.station[asked.robot]
        left = np.where(missing > team.arrival_tolerance, missing, left)
        speed = np.hypot(*asked.preferred.T)
        slower = np.sqrt(s.acceleration * left) / np.maximum(speed, STILL)
        asked.preferred[:] *= np.minimum(1.0, slower)[:, None]  # so that it stops in time
        window = Window(
            s.acceleration, s.turn_acceleration, s.heading, s.dist, s.velocity, s.far, s.speeds,
            s.turns, s.horizon,
        )  # fmt: skip
        command, rule, time = np.empty((many, 2)), np.empty(many, np.int64), np.empty(many)
        put_dwa(team, bodies, asked, window, command, rule, time)
        return command, rule, time[:, None]
