"""What a controller sees and says: `Observation` in, `Decision` out.

A controller of one's own is a class with one method::

    class Steady:
        def decide(self, observation, memory):
            return Decision(v=1.0, omega=0.0, hold=0.1)

It is asked again ``hold`` seconds later (rounded down to physics steps, at least one). ``memory``
is whatever the last decision returned, None at first.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, runtime_checkable

import numpy as np

from physim.geometry.shapes import FloatArray, IntArray

if TYPE_CHECKING:
    from physim.errors import Fault
    from physim.geometry.path import Path
    from physim.scene import Scene
    from physim.world import Robot


NO_MODE = -1
"""In tables, the mode of a decision that gave none."""
LONGEST_HOLD = 10**9
"""[steps] a hold of inf: never again"""


class Mode(IntEnum):
    """Control mode of a robot, as recorded."""

    SAFE = 0
    """follows its path by (5) and (7)"""
    DISTANCE = 1
    """danger: avoids by distance, (12)"""
    TIME = 2
    """danger: avoids by collision time, (13)"""
    ARRIVED = 3
    """at its stop station, command (0, 0)"""


@dataclass(frozen=True)
class Seen:
    """Another robot within range, as Robot i perceives it."""

    index: int
    pose: FloatArray
    """(3,) x, y [m], heading [rad], world frame"""
    footprint: tuple[FloatArray, ...]
    """convex parts (n, 2) [m] in that robot's frame"""
    v: float
    """held command [m/s]"""
    omega: float
    """held command [rad/s]"""
    station: float
    """[m] along the reference path"""
    time: float
    """[s] when this was seen"""


@dataclass(frozen=True)
class Neighbour:
    """A formation neighbour: its station is broadcast, so it may be beyond the range."""

    index: int
    station: float
    """[m] along the reference path"""
    lead: float
    """[m] its desired lead over Robot 1"""
    time: float
    """[s] when it was sent"""


@dataclass(frozen=True)
class Observation:
    """All that Robot i may know when it decides. World frame, SI units.

    Arrays are read-only, or copies of its own (the path).
    """

    time: float
    """[s]"""
    index: int
    name: str
    pose: FloatArray
    """(3,) own x, y, heading (unwrapped)"""
    v: float
    """held command before this decision [m/s]"""
    omega: float
    footprint: tuple[FloatArray, ...]
    """own convex parts (n, 2) [m], robot's frame"""
    limits: tuple[float, float]
    """largest |v| [m/s], |omega| [rad/s]"""
    path: Path
    station: float
    """[m] own projection q_i along the own path, continuous in time"""
    stop_station: float
    """[m] along the own path"""
    reference_station: float
    """[m] own projection along the reference path"""
    lead: float
    """[m] own desired lead over Robot 1"""
    neighbours: tuple[Neighbour, ...]
    others: tuple[Seen, ...]
    """robots within ``range``, by index"""
    walls: tuple[FloatArray, ...]
    """parts of boundaries (2, 2) and obstacles (n, 2) within ``range``, in the world's order"""
    range: float
    """[m]"""
    dt: float
    """[s] physics step: no command holds for less"""
    formation: FormationView
    speeds: tuple[float, ...] | None = None
    """forward speeds set for this robot in the world, multiples of nu; None: the controller's"""
    omegas: tuple[float, ...] | None = None
    """rotational speeds set for this robot in the world [rad/s]; None: the controller's"""


@dataclass(frozen=True)
class FormationView:
    """The settings of (7) that every robot of the cluster knows."""

    active: bool
    gain: float
    speed: float
    v_min: float
    v_max: float


@dataclass(frozen=True)
class Decision:
    """A command and how long it holds.

    ``v`` [m/s] along the heading, ``omega`` [rad/s] counter-clockwise: finite and within the
    robot's limits, or the run stops. ``hold`` [s] until the next decision, rounded down to physics
    steps, at least one (0: every step; inf: never again). ``mode`` goes to the record and the
    video; a controller that has no modes leaves it out, and none are reported. A run is finished
    when every robot's is `Mode.ARRIVED`. ``memory`` comes back at the
    next decision. ``report`` names further values for the record.
    """

    v: float
    omega: float
    hold: float
    mode: Mode | None = None
    memory: Any = None
    report: Report = field(default_factory=lambda: Report())


@dataclass(frozen=True)
class Report:
    """What a decision rested on; NaN or 0 where a controller has no such value."""

    target: tuple[float, float] = (np.nan, np.nan)
    """[m] point steered to"""
    distance: float = np.nan
    """[m] smallest distance to a considered robot"""
    boundary_distance: float = np.nan
    """[m] smallest distance to a boundary or obstacle"""
    collision_time: float = np.nan
    """[s] smallest collision time under the new command; inf when there is none"""
    considered: int = 0
    """robots considered: the messages that the decision needed"""
    evaluations: int = 0
    """collision times worked out"""


@runtime_checkable
class Controller(Protocol):
    """Decides for one robot from what that robot sees."""

    def decide(self, observation: Observation, memory: Any) -> Decision:
        """Choose the command to hold from now on."""
        ...


@runtime_checkable
class ChecksRobots(Protocol):
    """A controller that can say before a run which robots it cannot drive.

    It is asked when a world is read, so that `physim check`, `preview` and `run` refuse alike.
    """

    def robot_faults(self, robots: Mapping[int, Robot]) -> Iterable[Fault]:
        """Faults of these robots, by number, under the controller's settings; or none.

        ``Fault(("controller", key), message)`` points at a setting, and
        ``Fault(("robots", i, "limits", "omega"), message)`` at a value of Robot i.
        """
        ...


class Snapshot(NamedTuple):
    """All robots at one step: what every robot due at that step decides from."""

    step: int
    pose: FloatArray
    """(N, 3)"""
    command: FloatArray
    """(N, 2) held before this step"""
    station: FloatArray
    """(N,) own projection on the own path"""
    reference_station: FloatArray
    """(N,) projection on s*"""


class Decisions(NamedTuple):
    """Decisions of the robots that were due, one row each, in the order of ``robot``."""

    robot: IntArray
    command: FloatArray
    """(M, 2)"""
    hold: FloatArray
    """(M,) [s]"""
    mode: IntArray
    """(M,) `Mode`, or NO_MODE"""
    report: FloatArray
    """(M, 7) target x, y, distance, boundary distance, collision time, considered, evaluations"""


class BatchController(Protocol):
    """Decides for all robots that are due, in one call; keeps its memory in arrays."""

    def decide_due(self, snapshot: Snapshot, due: IntArray) -> Decisions:
        """Decide for robots ``due`` (increasing indices) from one snapshot."""
        ...


@runtime_checkable
class Batched(Protocol):
    """A controller that has a batch form too; both must decide alike."""

    def batch(self, scene: Scene) -> BatchController:
        """Set up the batch form for a scene."""
        ...


__all__ = [
    "NO_MODE",
    "BatchController",
    "Batched",
    "ChecksRobots",
    "Controller",
    "Decision",
    "Decisions",
    "FormationView",
    "Mode",
    "Neighbour",
    "Observation",
    "Report",
    "Seen",
    "Snapshot",
]
