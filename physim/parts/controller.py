"""What a controller sees and says: `Observation` in, `Decision` out; or all robots at once.

A controller of one's own is a class with one of two methods, or with both::

    class Steady:
        def decide(self, observation, memory):
            return Decision(v=1.0, omega=0.0, hold=0.1)

    class SteadyTogether:
        def decide_all(self, view, due, memory):
            ...  # `Decisions` of the robots that are due, in one call

It is asked again ``hold`` seconds later (rounded down to physics steps, at least one). ``memory``
is whatever the last decision returned, at first what a method ``start(scene)`` gave, else None; of
`decide_all` it is named arrays.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from physim.errors import ControllerError, nearest
from physim.escaping import escaped
from physim.geometry.shapes import FloatArray, IntArray
from physim.parts.declarations import NO_NUMBER, Column, Mode, Rule
from physim.parts.drive import NO_DRIVES, Reach, clip_pairs

if TYPE_CHECKING:
    from physim.errors import Fault
    from physim.geometry.path import Path
    from physim.simulation.observation import View
    from physim.world import Robot


LATER = frozenset(("footprint", "path", "neighbours", "others", "walls", "vehicle"))
"""Fields of an `Observation` that are made when they are asked for."""
FASTEST = 1.0e4
"""[m/s, rad/s] No command is beyond, whatever disturbances make of it; limits end at 1000."""
LONGEST_HOLD = 10**9
"""[steps] a hold of inf: never again"""


@dataclass(frozen=True)
class ObservedRobot:
    """Another robot within range, or another body that moves, as Robot i perceives it."""

    index: int
    """number of that body, from 0; those of robots first"""
    pose: FloatArray
    """(3,) x, y [m], heading [rad], world frame"""
    footprint: tuple[FloatArray, ...]
    """convex parts (n, 2) [m] in that robot's frame"""
    v: float
    """held command [m/s]"""
    omega: float
    """held command [rad/s]"""
    velocity: FloatArray
    """(3,) real motion over the last step: vx, vy [m/s], omega [rad/s], world frame"""
    station: float
    """[m] along the reference path"""
    time: float
    """[s] time of this pose and velocity, as far as it is known"""
    kind: Literal["robot", "mover", "obstacle"] = "robot"
    """``mover``: it follows a timed path and never gives way; ``obstacle``: it can be pushed; both
    have no command, and the station of the nearest point of the reference path"""
    lateral: float = 0.0
    """held command [m/s], left positive; of an omnidirectional robot"""


@dataclass(frozen=True)
class Neighbour:
    """A formation neighbour: its station is broadcast, so it may be beyond the range."""

    index: int
    """number of that robot, from 0"""
    station: float
    """[m] along the reference path"""
    lead: float
    """[m] its desired lead over Robot 1"""
    time: float
    """[s] when it was sent; of a station that was not heard, when the robot was seen there"""


@dataclass(frozen=True)
class Wall:
    """A piece of a wall: a segment of a boundary, or a convex part of an obstacle."""

    index: int
    """among all pieces of the world"""
    points: FloatArray
    """(n, 2) [m] corners, world frame: two of a segment, else counter-clockwise"""
    before: int | None
    """index of the piece that joins at the first point of a segment; None: there is none"""
    after: int | None
    """the same at its last point"""
    free: Literal["left", "right", "outside"] | None
    """where robots may be: left or right of a segment, seen from its first point to its last, or
    outside a part of an obstacle; None: on both sides"""


@dataclass(frozen=True)
class Observation:
    """All that Robot i may know when it decides. World frame, SI units.

    Arrays are read-only. What takes time to find out (`LATER`) is made when it is first asked for;
    whenever that is, it is what was true when the robot decided. What each field means stands below
    it in the source, and on the page docs/reference/controllers.md.
    """

    time: float
    """[s] now"""
    index: int
    """number of this robot, from 0"""
    name: str
    """its name in the world"""
    pose: FloatArray
    """(3,) own x, y, heading (unwrapped)"""
    v: float
    """held command before this decision [m/s]"""
    omega: float
    """held command before this decision [rad/s]"""
    velocity: FloatArray
    """(3,) real motion over the last step, which may differ from the command: vx, vy [m/s], omega
    [rad/s], world frame; 0 at the start"""
    footprint: tuple[FloatArray, ...]
    """own convex parts (n, 2) [m], robot's frame"""
    limits: tuple[float, float]
    """largest |v| [m/s], |omega| [rad/s]"""
    path: Path
    """own path: ``target(station, ahead)``, ``point``, ``direction``, ``project``, ``length``"""
    station: float
    """[m] own projection q_i along the own path, continuous in time"""
    stop_station: float
    """[m] where to stop along the own path"""
    reference_station: float
    """[m] own projection along the reference path"""
    lead: float
    """[m] own desired lead over Robot 1"""
    neighbours: tuple[Neighbour, ...]
    """formation neighbours, by index"""
    others: tuple[ObservedRobot, ...]
    """robots within ``range``, by index; then movers and obstacles that can be pushed"""
    walls: tuple[Wall, ...]
    """pieces of boundaries and obstacles within ``range`` of the reference point, in the world's
    order"""
    range: float
    """[m] distance from the own reference point within which it senses robots and walls"""
    dt: float
    """[s] physics step; a command holds for at least one"""
    formation: FormationView
    """settings of the formation that all its robots know"""
    vehicle: Vehicle
    """what its drive does: steering, speeds, and what it can come to"""
    speeds: tuple[float, ...] | None = None
    """forward speeds set for this robot in the world, multiples of nu; None: the controller's"""
    omegas: tuple[float, ...] | None = None
    """rotational speeds set for this robot in the world [rad/s]; None: the controller's"""
    lateral: float = 0.0
    """held command before this decision [m/s], left positive; of an omnidirectional robot"""

    @classmethod
    def partly(cls, values: dict[str, Any], view: View) -> Observation:
        """Return one with these fields already; ``view`` makes each of the others, and is kept."""
        one = cls.__new__(cls)
        one.__dict__.update(values, _view=view)
        return one

    def __getattr__(self, name: str) -> Any:
        """Make a field that is not there yet, and keep it."""
        if name not in LATER or "_view" not in self.__dict__:
            names = [one.name for one in fields(self)]
            raise AttributeError(f"Observation has no attribute {name!r}{nearest(name, names)}")
        value = self.__dict__[name] = self._view.later(self.index, name)
        return value

    def __getstate__(self) -> dict[str, Any]:
        """Every field, made by now: what a copy is made of."""
        return {one.name: getattr(self, one.name) for one in fields(self)}

    def __repr__(self) -> str:
        """Whose, when and where; what is made when asked for is not made for that."""
        x, y, heading = self.pose
        return (
            f'<Observation {self.index} "{escaped(self.name)}" at {self.time:g} s: pose '
            f"({x:.3f}, {y:.3f}, {heading:.3f}), station {self.station:.3f} of "
            f"{self.stop_station:.3f} m>"
        )


@dataclass(frozen=True)
class FormationView:
    """The settings of (7) that every robot of the cluster knows."""

    active: bool
    """whether the world has a formation"""
    gain: float
    """[1/s] alpha of (7)"""
    speed: float
    """[m/s] steady speed of the formation"""
    v_min: float
    """[m/s] least speed that (7) may give"""
    v_max: float
    """[m/s] greatest speed that (7) may give"""


@dataclass(frozen=True)
class Decision:
    """A command and how long it holds.

    A command that is not finite, or beyond what the robot's limits and drive allow, stops the run.
    Mode, rule, considered robots and report go to the record.
    """

    v: float
    """[m/s] along the heading"""
    omega: float
    """[rad/s] counter-clockwise"""
    hold: float
    """[s] until the next decision, rounded down to whole physics steps, but at least one step; inf:
    never decide again"""
    mode: str | Mode | None = None
    """a declared `Mode`, or its name"""
    memory: Any = None
    """given to the next decision of this robot; any value that can be pickled"""
    rule: str | Rule | None = None
    """a declared `Rule`, or its name"""
    considered: Sequence[int] = ()
    """indices of the robots and other bodies that the decision took into account"""
    report: Mapping[str, float] = field(default_factory=dict)
    """numbers by the names of the declared columns"""
    lateral: float = 0.0
    """[m/s] to the left; of an omnidirectional robot"""


@runtime_checkable
class DecidesOne(Protocol):
    """Decides for one robot from what that robot sees.

    A method ``start(scene)`` may give the first memory of each robot, a sequence of N.
    """

    def decide(self, observation: Observation, memory: Any) -> Decision:
        """Choose the command to hold from now on."""
        ...


@runtime_checkable
class DecidesAll(Protocol):
    """Decides for all robots that are due, in one call.

    A method ``start(scene)`` may give the memory before the first decision: a mapping of named
    arrays with a row for each robot.
    """

    def decide_all(self, view: View, due: IntArray, memory: dict[str, NDArray[Any]]) -> Decisions:
        """Decide for robots ``due`` (increasing indices) from what each may know; write ``memory``.

        Robot i may know the rows ``view.own_row(i)`` and ``view.others(i)``, of its formation
        neighbours, ``view.neighbours(i)``, the stations, and the pieces ``view.walls(i)`` of walls.
        Its rows of memory are its own. Keys of ``memory`` are those that ``start`` gave.
        """
        ...


Controller = DecidesOne | DecidesAll
"""Either form, or both, which must decide alike: a run asks `decide_all`.

It may declare ``modes``, ``rules`` and ``columns``, tuples of `Mode`, `Rule` and `Column`; and how
near both forms agree, ``agreement``, see `physim.parts.declarations.Declared`.
"""


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


@dataclass(frozen=True)
class Vehicle:
    """A robot as its drive moves it: what it does, and what it can come to."""

    drive: str
    """name of the drive: unicycle, car, omni or another's"""
    v: float
    """[m/s] of the last step; the command that it holds may be another"""
    omega: float
    """[rad/s]"""
    lateral: float
    """[m/s] left positive"""
    steering: float
    """[rad] of its steered wheels, left positive; 0 of a robot without any"""
    braking: float
    """[m/s²] by which it can slow down; inf of one that stops at once"""
    sideways: float
    """[m/s] greatest lateral speed; 0 of a robot that only goes the way it faces"""
    _reach: Callable[[float], tuple[float, ...]] = field(repr=False, compare=False)

    def reachable(self, time: float) -> Reach:
        """Least and greatest v, omega and curvature to which it can come within a time [s]."""
        a, b, c, d, e, f = self._reach(time)
        return Reach((a, b), (c, d), (e, f))

    def clipped(self, v: float, omega: float, time: float) -> tuple[float, float]:
        """(v, omega) or, where it cannot come to that within a time [s], the nearest that it can.

        Of a car the curvature omega / v counts more than omega: it keeps to the way, slower.
        """
        pair = np.array([[v, omega]])
        clip_pairs(pair, 1, np.array(self._reach(time)))
        return float(pair[0, 0]), float(pair[0, 1])

    def __reduce__(self) -> tuple[Any, ...]:
        """Copies know what can be reached at once, and no more."""
        plain = (self.drive, self.v, self.omega, self.lateral, self.steering)
        return Vehicle, (*plain, self.braking, self.sideways, _no_reach)


def _no_reach(time: float) -> tuple[float, ...]:
    """Stand-in of a copy. Raises ControllerError."""
    raise ControllerError("a copy of an observation does not know what its robot can reach")


class Snapshot(NamedTuple):
    """All that moves at one sample, as it is. Arrays never change once they are handed out.

    Of N robots; of all B bodies that move, robots first, then movers, then obstacles that can be
    pushed, the arrays ``moving_…``, which are the same ones where there are robots alone.
    """

    step: int
    """number of the sample"""
    pose: FloatArray
    """(N, 3) x, y [m], heading [rad], world frame"""
    command: FloatArray
    """(N, columns) nominal commands held before this step: v [m/s], omega [rad/s] and, in worlds
    with an omnidirectional robot, lateral [m/s]"""
    velocity: FloatArray
    """(N, 3) what the bodies did over the last step: vx, vy [m/s], omega [rad/s], world frame; 0 at
    the start"""
    station: FloatArray
    """(N,) [m] own projection on the own path"""
    deviation: FloatArray
    """(N,) [m] from the own path, left positive"""
    reference_station: FloatArray
    """(N,) [m] projection on s*"""
    moving_pose: FloatArray
    """(B, 3) x, y [m], heading [rad], world frame"""
    moving_velocity: FloatArray
    """(B, 3) over the last step: vx, vy [m/s], omega [rad/s], world frame; 0 at the start"""
    moving_command: FloatArray
    """(B, 2) as ``command``, 0 of what is no robot"""
    moving_station: FloatArray
    """(B,) [m] as ``reference_station``, of what is no robot that of the nearest point of s*"""
    drive: FloatArray = NO_DRIVES
    """(N, 4) what each robot's drive does: v [m/s], omega [rad/s], lateral [m/s], steering [rad];
    (0, 4) in worlds without drives"""


class Sensed(NamedTuple):
    """What robots know at one step: rows of bodies, of which observer i has ``rows(i)``.

    Movers and obstacles that can be pushed have rows, too: their numbers ``robot`` follow those of
    the N robots, their command is 0, and their station on s* is that of the nearest point of it.

    Where all know the same, every observer has all rows, and nothing is copied. Among its rows
    every observer has one of itself. Arrays must not be written to.

    Pose and velocity are *seen*, command and reference station are *told* by the robot itself. A
    robot that is told of but not seen has a row whose pose and velocity are NaN: it is still a
    formation neighbour, and no body to avoid. What is neither seen nor told of has no row.
    """

    step: int
    """number of the sample"""
    robot: IntArray
    """(M,) index of the robot, or other body that moves, that the row is about"""
    pose: FloatArray
    """(M, 3) x, y [m], heading [rad], world frame"""
    command: FloatArray
    """(M, columns) nominal command held before this step, as in `Snapshot`"""
    velocity: FloatArray
    """(M, 3) real motion over the last step: vx, vy [m/s], omega [rad/s], world frame"""
    reference_station: FloatArray
    """(M,) [m] along s*"""
    age: FloatArray
    """(M,) [s] how old pose and velocity are"""
    first: IntArray
    """(N,) first row of each observer"""
    end: IntArray
    """(N,) one past its last row"""
    station: FloatArray
    """(N,) [m] own projection of each observer on its own path"""
    heard: FloatArray
    """(M,) [s] how old command and reference station are; inf: nothing was told, and both are
    estimated from pose and velocity"""
    drive: FloatArray = NO_DRIVES
    """(N, 4) what the drive of each observer does, which it alone may know; as in `Snapshot`"""

    def rows(self, i: int) -> slice:
        """Rows of observer i."""
        return slice(int(self.first[i]), int(self.end[i]))


class Decisions(NamedTuple):
    """Decisions of the robots that were due, one row each, in the order of ``robot``."""

    robot: IntArray
    """(M,) which robots"""
    command: FloatArray
    """(M, 2 or columns) nominal v [m/s], omega [rad/s], lateral [m/s]; 0 where that is left out"""
    hold: FloatArray
    """(M,) [s]"""
    mode: IntArray
    """(M,) number of the declared mode, or `physim.parts.declarations.NO_NUMBER`"""
    rule: IntArray
    """(M,) number of the declared rule, or `physim.parts.declarations.NO_NUMBER`"""
    report: FloatArray
    """(M, C) declared columns"""
    considered: IntArray
    """(E,) robots considered, those of row k from ``considered_start[k]`` on"""
    considered_start: IntArray
    """(M + 1,)"""

    @classmethod
    def of(
        cls,
        robot: IntArray,
        command: FloatArray,
        hold: FloatArray | float,
        *,
        mode: IntArray | int = NO_NUMBER,
        rule: IntArray | int = NO_NUMBER,
        report: FloatArray | None = None,
        considered: Sequence[Sequence[int]] = (),
    ) -> Decisions:
        """Decisions of the robots ``robot`` (M,), one number for all of them where it is one.

        ``considered`` lists the robots that each took into account; without it, nobody.
        """
        many = len(robot)
        listed = [np.asarray(one, dtype=np.int64) for one in considered or [()] * many]
        return cls(
            robot,
            command,
            np.full(many, hold, dtype=np.float64),
            np.full(many, mode),
            np.full(many, rule),
            np.zeros((many, 0)) if report is None else report,
            np.concatenate([np.zeros(0, dtype=np.int64), *listed]),
            np.cumsum([0, *map(len, listed)]),
        )


__all__ = [
    "LONGEST_HOLD",
    "ChecksRobots",
    "Column",
    "Controller",
    "DecidesAll",
    "DecidesOne",
    "Decision",
    "Decisions",
    "FormationView",
    "Mode",
    "Neighbour",
    "Observation",
    "ObservedRobot",
    "Rule",
    "Sensed",
    "Snapshot",
    "Wall",
]
