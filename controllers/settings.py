"""Settings of the paper's controller: every threshold by name, with its default.

The text of the paper gives few of these numbers; what it states is marked, the rest is ours.
"""

from __future__ import annotations

from math import pi
from typing import Annotated, Literal, NamedTuple

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from physim.geometry.shapes import FloatArray

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Number = Annotated[float, Field(allow_inf_nan=False)]
Multiple = Annotated[float, Field(ge=-1.0, le=1.0, allow_inf_nan=False)]
Speed = Annotated[
    Positive, Field(description="[m/s] nu in a world without formation; formation.speed in others")
]

AVOIDANCE = ("distance_first", "time_first", "distance", "time", "none")
"""Which of (12) and (13) serves in danger mode; the kernels take the place in this list."""
DISTANCE_FIRST, TIME_FIRST, DISTANCE_ALONE, TIME_ALONE, NO_AVOIDANCE = range(5)

LONGEST_PLAN = 3
"""Dwell times at most: 15 speed pairs make 15^3 = 3375 plans."""


class Rules(NamedTuple):
    """The numbers of `ModeSwitchingSettings`, as the kernels take them."""

    look_ahead: float
    safe_distance: float
    update_period: float
    judge_ahead: float
    arrival_tolerance: float
    distance_low: float
    distance_high: float
    time_low: float
    time_high: float
    boundary_low: float
    boundary_time_high: float
    beta: float
    event_triggered: bool
    longest_interval: float
    avoidance: int
    horizon: float
    dwell: FloatArray
    dwells: int
    translation_only: bool


class ModeSwitchingSettings(BaseModel):
    """Keys under ``controller:`` for ``type: mode_switching``."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    speed: Speed = 1.0
    look_ahead: Positive = Field(
        default=2.0,
        description="[m] the target lies this far along the path from the projection, (3)",
    )
    safe_distance: Positive = Field(
        default=1.0, description="[m] L: width of the danger area along the boundaries"
    )
    update_period: Positive = Field(
        default=0.1,
        description="[s] what a plan of (5) takes, and how far ahead (12) looks (paper: 0.1)",
    )
    dwell_times: Annotated[list[Positive], Field(min_length=1, max_length=LONGEST_PLAN)] = Field(
        default=[0.1],
        description="[s] tau_1, tau_2, ...: how long each speed pair of a plan holds, (5); they "
        "add up to update_period",
    )
    judge_ahead: NotNegative = Field(
        default=0.5,
        description="[s] how far ahead (5) judges a plan, its last command held; update_period "
        "or less: at the end of the plan, as in the paper",
    )
    speeds: Annotated[list[Multiple], Field(min_length=1, max_length=9)] = Field(
        default=[-1.0, 0.0, 1.0],
        description="[-] forward speeds to choose from, as multiples of nu, between -1 and 1 "
        "(paper: -1, 0, 1)",
    )
    omegas: Annotated[list[Number], Field(min_length=1, max_length=15)] = Field(
        default=[-pi / 2, -pi / 4, 0.0, pi / 4, pi / 2],
        description="[rad/s] rotational speeds to choose from, (6)",
    )
    reverse_in_safe_mode: bool | None = Field(
        default=None,
        description="whether safe mode may choose among speeds, too; otherwise it drives at nu, "
        "and a robot that faces backwards turns round. Left out: not in a formation, where (7) "
        "sets nu; without one, yes, and robots may stand for ever in bends tighter than they turn",
    )
    arrival_tolerance: NotNegative = Field(
        default=0.06,
        description="[m] a robot this near its stop station along the path has arrived; above "
        "half of what it moves in update_period, or one free to stand still might stop short",
    )
    distance_low: NotNegative = Field(
        default=0.5, description="[m] danger mode below this distance to a considered robot"
    )
    distance_high: NotNegative = Field(
        default=0.8, description="[m] back to safe mode only above this"
    )
    time_low: NotNegative = Field(
        default=1.0, description="[s] danger mode below this collision time"
    )
    time_high: NotNegative = Field(default=2.0, description="[s] back to safe mode only above this")
    boundary_low: NotNegative = Field(
        default=0.15, description="[m] danger mode below this distance to a boundary, safe above it"
    )
    boundary_time_high: NotNegative | None = Field(
        default=None,
        description="[s] a boundary ahead keeps danger mode up to this collision time; left out: "
        "up to time_high, by which a robot that had to stop before a corner may stand there for "
        "ever. From time_low to time_high",
    )
    avoidance: Literal["distance_first", "time_first", "distance", "time", "none"] = Field(
        default="distance_first",
        description="which rule applies in danger mode: (12) below distance_low or boundary_low, "
        "else (13); (13) while a collision time is short, else (12); (12) alone; (13) alone; or "
        "none: no danger mode, to compare with",
    )
    beta: Annotated[float, Field(gt=0.0, lt=1.0)] = Field(
        default=0.1,
        description="[-] the update interval is at most beta times the collision time, (14)",
    )
    event_triggered: bool = Field(
        default=True,
        description="whether a short collision time brings the next decision forward, (14); "
        "otherwise every decision holds for longest_interval, whatever beta",
    )
    longest_interval: Positive | None = Field(
        default=None,
        description="[s] longest time between two decisions, to which a plan is stretched: at "
        "update_period (14) only shortens intervals, above it adapts them; twice update_period "
        "where it is not given",
    )
    horizon: Positive = Field(
        default=10.0, description="[s] collision times beyond this count as none (inf)"
    )
    collision_motion: Literal["arc", "translation"] = Field(
        default="arc",
        description="motion that collision times assume: present (nu, omega) kept, or present "
        "velocity vectors kept without turning",
    )

    @model_validator(mode="after")
    def _consistent(self) -> ModeSwitchingSettings:
        if abs(sum(self.dwell_times) - self.update_period) > 1e-9:
            raise ValueError(
                f"dwell_times add up to {sum(self.dwell_times):g} s; they must add up to "
                f"update_period, {self.update_period:g} s"
            )
        for name in ("distance", "time"):
            low, high = getattr(self, f"{name}_low"), getattr(self, f"{name}_high")
            if high < low:
                raise ValueError(
                    f"{name}_high is {high:g}, below {name}_low {low:g}; hysteresis needs "
                    f"{name}_high >= {name}_low"
                )
        ahead = self.boundary_time_high
        if ahead is not None and not self.time_low <= ahead <= self.time_high:
            raise ValueError(
                f"boundary_time_high is {ahead:g} s; allowed: from time_low, {self.time_low:g} s, "
                f"to time_high, {self.time_high:g} s"
            )
        if self.horizon < self.time_high:
            raise ValueError(
                f"horizon is {self.horizon:g} s, below time_high {self.time_high:g} s: no "
                "collision time would ever be long enough to leave danger mode; make horizon at "
                "least time_high"
            )
        if 0.0 not in self.omegas:
            raise ValueError("omegas has no 0: the robot could never go straight")
        return self

    def forward_only(self, in_formation: bool) -> bool:
        """Whether safe mode leaves the speed at nu rather than choose among `speeds`."""
        may_reverse = self.reverse_in_safe_mode
        return in_formation if may_reverse is None else not may_reverse

    def rules(self) -> Rules:
        """Return the same numbers for the kernels."""
        return Rules(
            look_ahead=self.look_ahead,
            safe_distance=self.safe_distance,
            update_period=self.update_period,
            judge_ahead=self.judge_ahead,
            arrival_tolerance=self.arrival_tolerance,
            distance_low=self.distance_low,
            distance_high=self.distance_high,
            time_low=self.time_low,
            time_high=self.time_high,
            boundary_low=self.boundary_low,
            boundary_time_high=(
                self.time_high if self.boundary_time_high is None else self.boundary_time_high
            ),
            beta=self.beta,
            event_triggered=self.event_triggered,
            longest_interval=self.longest_interval or 2.0 * self.update_period,
            avoidance=AVOIDANCE.index(self.avoidance),
            horizon=self.horizon,
            dwell=np.array(self.dwell_times),
            dwells=len(self.dwell_times),
            translation_only=self.collision_motion == "translation",
        )


class PathFollowingSettings(BaseModel):
    """Keys under ``controller:`` for ``type: path_following``."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    speed: Speed = 1.0
