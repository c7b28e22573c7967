"""A policy learned by trial, as a correction of path following.

The command that takes a robot towards its preferred velocity (`navigation`) is corrected by a
linear policy of what others and walls near it come to: how near they are, and how soon and how
closely it would meet them if it held that command. Each is a sum over the nearest ones, so their
number and order do not matter. Weights are a file. ``python -m benchmarks.train_policy`` made those
that ship, in worlds of its own, with the polygons and contacts of the simulation.

Features of a row of `Arrays.others` at p, which moves with w seen from a robot that holds its
command: it is nearest after t = -p w / |w|^2, cut to 0 to `LONGEST`, and its gap g then is about
g - |p| + |p + w t|. near = exp(-g / a), threat = exp(-gap then / b - t / c), and both times cosine
and sine of the direction to it; threat times the sine of the angle between p and w, which says on
what side it passes. Rows of walls have the same but the last. The sums, a constant and the turn of
the command are f. v = v' clip(1 + f w_v, `BACKWARDS`, 1) and omega = omega' + omega_max f w_omega,
within limits.

No source: the form is ours, near to social forces with learned weights.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physim.errors import ControllerError
from physim.geometry.shapes import FloatArray, IntArray
from physim.parts.declarations import Rule

from .navigation import (
    PREFERRED,
    STOP,
    Asked,
    Navigating,
    NavigationSettings,
    Team,
    project_and_turn,
)
from .priority import Bodies
from .settings import Positive

if TYPE_CHECKING:
    from physim.simulation.arrays import Arrays
    from physim.simulation.observation import View

LONGEST = 4.0
"""[s]"""
BACKWARDS = -0.5
OTHERS, WALLS = 6, 6
"""Rows of the nearest others and walls that count"""
SCALES = ("near", "gap", "time", "wall_near", "wall_gap", "wall_time")
"""[m] a and b, [s] c, of others and of walls"""
FEATURES = (
    "one", "turn", "near", "near_ahead", "near_left", "threat", "threat_ahead", "threat_left",
    "threat_side", "wall_near", "wall_near_ahead", "wall_near_left", "wall_threat",
    "wall_threat_ahead", "wall_threat_left",
)  # fmt: skip
CHANGED = 0.05
"""Share of the greatest commands by which a correction counts as one"""


class Policy(NamedTuple):
    """Numbers that are learned."""

    scales: FloatArray
    """(6,) in the order of `SCALES`"""
    weights: FloatArray
    """(2, 15) of v and omega, in the order of `FEATURES`"""

    @staticmethod
    def of(file: Path) -> Policy:
        """Read a policy. Raises ControllerError."""
        try:
            found = json.loads(file.read_text(encoding="utf-8"))
            scales = np.array([found["scales"][name] for name in SCALES], np.float64)
            rows = [[found[key][name] for name in FEATURES] for key in ("v", "omega")]
            policy = Policy(scales, np.array(rows, np.float64))
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise ControllerError(
                f"policy {file} cannot be read ({type(error).__name__}: {error}); it must be a "
                "file that python -m benchmarks.train_policy wrote"
            ) from None
        if not (np.isfinite(policy.weights).all() and (scales > 0.0).all()):
            raise ControllerError(f"policy {file}: numbers must be finite, scales above 0")
        return policy


class LearnedSettings(NavigationSettings):
    """Keys under ``controller:`` for ``type: learned``."""

    policy: str = Field(
        default="shipped", description="file of weights, JSON; shipped: those that ship with physim"
    )
    turning_time: Positive = Field(
        default=0.4, description="[s] in which a robot turns to its preferred velocity"
    )


class Learned(Navigating):
    """A learned correction of path following, by what is near and what would be met."""

    Settings = LearnedSettings
    settings: LearnedSettings
    rules = (PREFERRED, Rule("corrected", "takes its preferred velocity, corrected"), STOP)

    def __init__(
        self, settings: LearnedSettings | None = None, policy: Policy | None = None
    ) -> None:
        super().__init__(settings)
        file = self.settings.policy
        shipped = Path(__file__).with_suffix(".json")
        self._policy = policy or Policy.of(shipped if file == "shipped" else Path(file))

    def avoid(
        self, view: View, team: Team, bodies: Bodies, asked: Asked, memory: dict[str, NDArray[Any]]
    ) -> tuple[FloatArray, IntArray, FloatArray]:
        """Correct what takes each robot towards its preferred velocity."""
        limits, heading = team.limits[asked.robot], bodies.pose[asked.row, 2]
        plain, turning = np.empty_like(limits), self.settings.turning_time
        for k, (ux, uy) in enumerate(asked.preferred.tolist()):
            v_max, omega_max = limits[k].tolist()
            plain[k] = project_and_turn(ux, uy, heading[k], v_max, omega_max, turning)
        seen = view.arrays(OTHERS, WALLS, (), np.float64)
        found = features(self._policy.scales, plain, limits, asked.robot, seen)
        change = (found[:, None] * self._policy.weights).sum(axis=2)  # the same for few and many
        command = np.empty_like(plain)
        command[:, 0] = plain[:, 0] * np.clip(1.0 + change[:, 0], BACKWARDS, 1.0)
        turn = plain[:, 1] + limits[:, 1] * change[:, 1]
        command[:, 1] = np.clip(turn, -limits[:, 1], limits[:, 1])
        rule = np.where((np.abs(command - plain) > CHANGED * limits).any(axis=1), 1, 0)
        return command, rule, np.empty((len(plain), 0))


def features(
    scales: FloatArray,
    plain: FloatArray,
    limits: FloatArray,
    robot: IntArray,
    seen: Arrays,
) -> FloatArray:
    """`FEATURES` (M, 15) of robots (M,) under commands ``plain`` (M, 2), from what all see."""
    own, near, walls, v = seen.own[robot], seen.others[robot], seen.walls[robot], plain[:, :1]
    vx, vy = near[..., 4] + own[:, :1] - v, near[..., 5] + own[:, 1:2]
    met = _met(
        scales[:3], near[..., 0], near[..., 1], vx, vy, near[..., 6], seen.others_mask[robot]
    )
    still = np.zeros_like(walls[..., 0])
    hit = _met(
        scales[3:], walls[..., 0], walls[..., 1], still - v, still, walls[..., 2],
        seen.walls_mask[robot],
    )  # fmt: skip
    one, turn = np.ones(len(v)), plain[:, 1] / limits[:, 1]
    return np.stack((one, turn, *met, *hit[:-1]), axis=1)


def _met(
    scales: FloatArray,
    x: FloatArray,
    y: FloatArray,
    vx: FloatArray,
    vy: FloatArray,
    gap: FloatArray,
    mask: NDArray[np.bool_],
) -> list[FloatArray]:
    """Sums (M,) over rows (M, K): near, threat, each alone, ahead and left; and the side."""
    far, speed = np.maximum(np.hypot(x, y), 1e-9), np.maximum(np.hypot(vx, vy), 1e-9)
    t = np.clip(-(x * vx + y * vy) / speed**2, 0.0, LONGEST)
    then = np.maximum(gap - far + np.hypot(x + vx * t, y + vy * t), 0.0)
    near = np.where(mask, np.exp(-np.maximum(gap, 0.0) / scales[0]), 0.0)
    threat = np.where(mask & (t > 0.0), np.exp(-then / scales[1] - t / scales[2]), 0.0)
    c, s, side = x / far, y / far, (x * vy - y * vx) / (far * speed)
    each = near, near * c, near * s, threat, threat * c, threat * s, threat * side
    return [one.sum(axis=1) for one in each]
