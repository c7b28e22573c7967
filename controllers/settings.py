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
        description="[m] distance along the path from the robot's projection to its target, (3)",
    )
    safe_distance: Positive = Field(
        default=1.0, description="[m] L: width of the danger area along the boundaries"
    )
    update_period: Positive = Field(
        default=0.1,
        description="[s] duration of a plan of (5), and look-ahead time of (12) (paper: 0.1)",
    )
    dwell_times: Annotated[list[Positive], Field(min_length=1, max_length=LONGEST_PLAN)] = Field(
        default=[0.1],
        description="[s] tau_1, tau_2, ...: duration of each speed pair of a plan, (5); their sum "
        "is update_period",
    )
    judge_ahead: NotNegative = Field(
        default=0.5,
        description="[s] time ahead at which (5) judges a plan, with its last command held; at "
        "most update_period: at the end of the plan, as in the paper",
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
        description="whether safe mode may choose the forward speed, too; otherwise it drives at "
        "nu, and a robot that faces backwards turns round. Default: no in a formation, where (7) "
        "sets nu; yes without one, but then robots may stand for ever in bends tighter than they "
        "can turn",
    )
    arrival_tolerance: NotNegative = Field(
        default=0.06,
        description="[m] distance from its stop station along the path at which a robot has "
        "arrived; more than half of what it moves in update_period, or it might stop short",
    )
    distance_low: NotNegative = Field(
        default=0.5, description="[m] danger mode below this distance to a considered robot"
    )
    distance_high: NotNegative = Field(
        default=0.8, description="[m] safe mode again only above this distance"
    )
    time_low: NotNegative = Field(
        default=1.0, description="[s] danger mode below this collision time"
    )
    time_high: NotNegative = Field(
        default=2.0, description="[s] safe mode again only above this collision time"
    )
    boundary_low: NotNegative = Field(
        default=0.15, description="[m] danger mode below this distance to a boundary, safe above it"
    )
    boundary_time_high: NotNegative | None = Field(
        default=None,
        description="[s] collision time with a boundary up to which danger mode stays, from "
        "time_low to time_high; default time_high, with which a robot that stopped before a corner "
        "may stand there for ever",
    )
    avoidance: Literal["distance_first", "time_first", "distance", "time", "none"] = Field(
        default="distance_first",
        description="which rule applies in danger mode: distance_first is (12) below distance_low "
        "or boundary_low, else (13); time_first is (13) while a collision time is short, else "
        "(12); distance is (12) alone; time is (13) alone; none: no danger mode, as a baseline",
    )
    beta: Annotated[float, Field(gt=0.0, lt=1.0)] = Field(
        default=0.1,
        description="[-] the update interval is at most beta times the collision time, (14)",
    )
    event_triggered: bool = Field(
        default=True,
        description="whether a robot decides earlier if the collision time is short, (14); "
        "otherwise every decision holds for longest_interval, and beta has no effect",
    )
    longest_interval: Positive | None = Field(
        default=None,
        description="[s] longest time between two decisions; a longer one than update_period "
        "stretches the plan in time, so that a robot in no danger decides less often; default "
        "twice update_period",
    )
    horizon: Positive = Field(
        default=10.0, description="[s] collision times beyond this count as none (inf)"
    )
    collision_motion: Literal["arc", "translation"] = Field(
        default="arc",
        description="motion that collision times assume: arc keeps the present (nu, omega), "
        "translation keeps the present velocity vectors, without turning",
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
