"""Controllers that break one rule each; all others they keep to."""

from __future__ import annotations

import functools
import logging
import random
import threading
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from pydantic import BaseModel

from physim import Column, Decision, Decisions, Mode, Observation, Scene, View
from tests.helpers import inside

ModeSwitching = inside("physim.controllers", "ModeSwitching")
IntArray, chord_factor = inside("physim.geometry", "IntArray", "chord_factor")

HOLD = 0.1
"""[s]"""


def steady(o: Observation, memory: Any = None, share: float = 0.5) -> Decision:
    """Straight on at a share of the top speed."""
    return Decision(v=share * o.limits[0], omega=0.0, hold=HOLD, memory=memory)


class Sound:
    """Counts its decisions in its memory and goes the slower the more there were."""

    def decide(self, observation: Observation, memory: Any) -> Decision:
        count = memory["count"] if memory else 0
        return steady(observation, {"count": count + 1, "pose": observation.pose}, 1 / (count + 2))


LOG = logging.getLogger(__name__)


@functools.cache
def half(speed: float) -> float:
    return 0.5 * speed


class WorksOutOnce:
    """Keeps what never changes again: a table by robot, cached values, a kernel."""

    def __init__(self) -> None:
        self.lengths: dict[int, float] = {}
        self.log = LOG

    @functools.cached_property
    def share(self) -> float:
        return 0.5

    def decide(self, observation: Observation, memory: Any) -> Decision:
        self.lengths.setdefault(observation.index, observation.path.length)
        self.log.debug("%s m, half of %s", self.lengths, half(observation.limits[0]))
        return steady(observation, share=chord_factor(self.share))


# raises


class RaisesLate:
    """At the fourth decision."""

    def decide(self, observation: Observation, memory: Any) -> Decision:
        count = memory or 0
        if count == 3:
            raise KeyError("four")
        return steady(observation, count + 1)


class NeedsOthers:
    def decide(self, observation: Observation, memory: Any) -> Decision:
        min(other.station for other in observation.others)
        return steady(observation)


class NeedsAWayOn:
    def decide(self, observation: Observation, memory: Any) -> Decision:
        o = observation
        1.0 / max(o.path.length - o.station, 0.0)
        return steady(o)


# decision


class Says:
    """Says a certain thing at every decision."""

    def __init__(self, decision: Any) -> None:
        self.decision = decision

    def decide(self, observation: Observation, memory: Any) -> Decision:
        decision: Decision = self.decision
        return decision


UNFIT = {
    "nothing": None,
    "NaN": Decision(0.0, float("nan"), HOLD),
    "too fast": Decision(1e3, 0.0, HOLD),
    "hold in the past": Decision(0.0, 0.0, -HOLD),
    "mode that is not declared": Decision(0.0, 0.0, HOLD, mode="fast"),
    "robot that there is not": Decision(0.0, 0.0, HOLD, considered=[-1]),
    "column that is not declared": Decision(0.0, 0.0, HOLD, report={"effort": 1.0}),
}


# repeats


class Throws:
    """Draws from where nothing of its own is kept."""

    def decide(self, observation: Observation, memory: Any) -> Decision:
        return steady(observation, share=random.random())


class RemembersAtRandom:
    """The commands repeat, what it remembers does not."""

    def decide(self, observation: Observation, memory: Any) -> Decision:
        return steady(observation, {"drawn": random.random()})


# state


class CountsOnItself:
    def __init__(self) -> None:
        self.count = 0

    def decide(self, observation: Observation, memory: Any) -> Decision:
        self.count += 1
        return steady(observation, share=1.0 / (1 + self.count))


class CountsOnTheClass:
    count = 0

    def decide(self, observation: Observation, memory: Any) -> Decision:
        type(self).count += 1
        return steady(observation, share=1.0 / (1 + self.count))


DECIDED: list[float] = []


class CountsInTheModule:
    def decide(self, observation: Observation, memory: Any) -> Decision:
        DECIDED.append(observation.time)
        return steady(observation, share=1.0 / (1 + len(DECIDED)))


class _Slotted:
    __slots__ = ("counter",)

    def __init__(self) -> None:
        self.counter = (k for k in range(1, 10**6))


class CountsOutOfSight(_Slotted):
    """By something that shows nothing of its state."""

    def decide(self, observation: Observation, memory: Any) -> Decision:
        return steady(observation, share=1.0 / (1 + next(self.counter)))


STATE: dict[type, str] = {
    CountsOnItself: "self.count from ",
    CountsOnTheClass: "CountsOnTheClass.count from ",
    CountsInTheModule: "broken.DECIDED",
    CountsOutOfSight: "asked the same again",
}
"""What the finding has to tell."""


# order


class FirstComeFirstServed:
    """The robot asked first at a time goes, the others wait; kept where nobody looks."""

    place = threading.local()

    def decide(self, observation: Observation, memory: Any) -> Decision:
        asked = self.place.__dict__.setdefault("asked", {})
        first = asked.get("time") != observation.time
        if first:
            asked["time"], asked["first"] = observation.time, observation.index
        return steady(observation, share=0.5 if asked["first"] == observation.index else 0.0)


class LooksAround:
    """Goes by how many were asked the last time, in whatever order."""

    place = threading.local()

    def decide(self, observation: Observation, memory: Any) -> Decision:
        kept = self.place.__dict__
        if observation.time == 0.0 or kept["time"] != observation.time:
            kept["before"] = kept["now"] if observation.time > 0.0 else set()
            kept["time"], kept["now"] = observation.time, set()
        kept["now"].add(observation.index)
        return steady(observation, share=1.0 / (2 + len(kept["before"])))


# memory


class WritesItsMemory:
    def decide(self, observation: Observation, memory: Any) -> Decision:
        memory = memory or {"count": 0}
        memory["count"] += 1
        return steady(observation, memory, 1.0 / (1 + memory["count"]))


# copies


class CannotBePickled:
    def decide(self, observation: Observation, memory: Any) -> Decision:
        return steady(observation, {"next": lambda: 0.5})


class Forgetful:
    """A memory that does not pickle all of itself."""

    def __init__(self, count: int = 0) -> None:
        self.count = count

    def __reduce__(self) -> tuple[type[Forgetful], tuple[()]]:
        return Forgetful, ()

    def __deepcopy__(self, memo: dict[int, Any]) -> Forgetful:
        return Forgetful(self.count)


class LosesItsMemory:
    def decide(self, observation: Observation, memory: Any) -> Decision:
        count = memory.count if memory else 0
        return steady(observation, Forgetful(count + 1), 1.0 / (2 + count))


# observation


class BendsThePath:
    def decide(self, observation: Observation, memory: Any) -> Decision:
        points = observation.path.points
        points.setflags(write=True)
        points[-1] += 1.0
        return steady(observation)


class OverridesTheFreeze:
    def decide(self, observation: Observation, memory: Any) -> Decision:
        object.__setattr__(observation, "v", 0.3)
        return steady(observation)


# decide_all

Decide = Callable[[View, IntArray], Decisions]


def steadily(view: View, due: IntArray) -> Decisions:
    """`steady` for all."""
    command = np.column_stack([0.5 * view.scene.limits[due, 0], np.zeros(len(due))])
    return Decisions.of(due, command, HOLD, report=np.full((len(due), 1), np.nan))


class Together:
    """Steady, all at once; made of a function."""

    modes = (Mode("steady", "#0072b2"),)
    columns = (Column("effort", "J"),)

    def __init__(self, decides: Decide = steadily) -> None:
        self.decides = decides

    def decide_all(self, view: View, due: IntArray, memory: Any) -> Decisions:
        return self.decides(view, due)


class Twofold(Together):
    """Steady, in both forms."""

    def decide(self, observation: Observation, memory: Any) -> Decision:
        return steady(observation)


class Nearly(Twofold):
    """Both forms differ in the last bits of a command, by no more than it declares."""

    agreement = 1e-8

    def __init__(self) -> None:
        super().__init__(turns_later)


class CountsTogether:
    """`Sound` for all at once, with a memory of two arrays."""

    def start(self, scene: Scene) -> dict[str, Any]:
        return {"count": np.zeros(scene.robots, dtype=np.int64), "pose": scene.start.copy()}

    def decide_all(self, view: View, due: IntArray, memory: Any) -> Decisions:
        found = steadily(view, due)
        command = found.command * (2.0 / (memory["count"][due] + 2.0))[:, None]
        memory["count"][due] += 1
        memory["pose"][due] = view.sensed.pose[[view.own_row(i) for i in due]]
        return found._replace(command=command, report=np.zeros((len(due), 0)))


def turns_later(view: View, due: IntArray) -> Decisions:
    found = steadily(view, due)
    if view.time > 0.25:
        found.command[due == 1, 1] = 1e-9
    return found


def tells_a_mode(view: View, due: IntArray) -> Decisions:
    return steadily(view, due)._replace(mode=np.zeros(len(due), dtype=np.int64))


def decides_for_others(view: View, due: IntArray) -> Decisions:
    return steadily(view, due)._replace(robot=due[::-1])


def says_nothing(view: View, due: IntArray) -> Decisions:
    return None  # type: ignore[return-value]


def fails(view: View, due: IntArray) -> Decisions:
    raise ZeroDivisionError("no way on")


FORMS = {
    turns_later: ("r2", 0.3, ["omega", "1e-09", "0.0"]),
    tells_a_mode: ("r1", 0.0, ["mode", "steady", "no mode"]),
    decides_for_others: ("r1", 0.0, ["robots", "[1, 0]", "[0, 1]"]),
    says_nothing: ("r1", 0.0, ["None", "Decisions"]),
    fails: ("r1", 0.0, ["ZeroDivisionError: no way on"]),
}
"""Robot, time [s] and the facts of the finding."""


def first_row_goes(view: View, due: IntArray) -> Decisions:
    """As `FirstRobotGoes`, as long as all are due at once."""
    found = steadily(view, due)
    found.command[1:, 0] = 0.0
    return found


class FirstRobotGoes(Twofold):
    def __init__(self) -> None:
        super().__init__(first_row_goes)

    def decide(self, observation: Observation, memory: Any) -> Decision:
        return steady(observation, share=0.0 if observation.index else 0.5)


def all_behind_the_first(view: View, due: IntArray) -> Decisions:
    """The slower the farther the first robot is away, however far."""
    found, sensed = steadily(view, due), view.sensed
    for k, i in enumerate(due.tolist()):
        rows = view.rows(i)
        here = sensed.pose[view.own_row(i), :2]
        gap = np.hypot(*(sensed.pose[rows, :2] - here).T).max()
        found.command[k, 0] /= 1.0 + gap
    return found


def mind_every_wall(view: View, due: IntArray) -> Decisions:
    """The slower the farther the farthest corner of a wall is away."""
    found, sensed = steadily(view, due), view.sensed
    for k, i in enumerate(due.tolist()):
        gap = np.hypot(*(view.scene.walls.vertices - sensed.pose[view.own_row(i), :2]).T).max()
        found.command[k, 0] /= 1.0 + gap
    return found


class FarSighted(ModeSwitching):
    """The paper's, with eyes twice as good as the world says."""

    def _prepared(self, scene: Scene) -> Any:
        return super()._prepared(replace(scene, sensing_range=2.0 * scene.sensing_range))


class Slower(ModeSwitching):
    """Inherits a decide_all that is not its own."""

    def decide(self, observation: Observation, memory: Any) -> Decision:
        return Decision(0.0, 0.0, HOLD)


def moves_the_robots(view: View, due: IntArray) -> Decisions:
    view.sensed.pose.flags.writeable = True
    view.sensed.pose[0, 0] += 1.0
    return steadily(view, due)


# settings and robots


class ShareSettings(BaseModel):
    share: float = 0.5


class Adjustable:
    """Drives at a share of the top speed; beyond 1 a run refuses it."""

    Settings = ShareSettings

    def __init__(self, settings: ShareSettings) -> None:
        self.share = settings.share

    def decide(self, observation: Observation, memory: Any) -> Decision:
        return steady(observation, share=self.share)


class Choosy:
    """Refuses robots by their name."""

    def __init__(self, *refused: str) -> None:
        self.refused = refused

    def robot_faults(self, robots: Any) -> Any:
        from physim import Fault

        return [
            Fault(("robots", i, "name"), f"does not drive {robot.name}")
            for i, robot in robots.items()
            if robot.name in self.refused
        ]

    def decide(self, observation: Observation, memory: Any) -> Decision:
        return steady(observation)
