"""What every controller keeps to, and what breaks it: rule, world, robot, time and what is wrong.

A controller is tried on the decisions of a trial by asking for them again, robot by robot;
`decide_all` besides on what was sensed in that trial.
"""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from enum import StrEnum
from typing import Any

import numpy as np

from physim.errors import ControllerError
from physim.geometry.shapes import IntArray, read_only
from physim.geometry.walls import build_wall_tree
from physim.parts.controller import DecidesAll, DecidesOne, Sensed
from physim.parts.declarations import Declared, agreement_of
from physim.parts.user_code import broken_by, place_of
from physim.simulation.checks import next_steps, taken_decisions, widened
from physim.simulation.forms import AskedAlone, asked_together, first_memory
from physim.simulation.observation import View
from physim.testing.contents import (
    Contents,
    Difference,
    StateWatch,
    contents,
    difference,
    is_shared,
)
from physim.testing.trial import (
    Answer,
    Query,
    Trial,
    TrialStep,
    ask,
    other_answer,
    own_arrays,
    rows_of,
    values_of,
)
from physim.world.scene import Scene


class Rule(StrEnum):
    """What every controller keeps to."""

    RAISES = "raises"
    """it raises no exception when it decides"""
    DECISION = "decision"
    """it returns a decision that a run can take: numbers, within limits, fit for the record"""
    REPEATS = "repeats"
    """the same settings, observation and memory give the same decision"""
    STATE = "state"
    """a decision leaves something for the next one only in its memory: its object, class and module
    do not change"""
    ORDER = "order"
    """a decision does not depend on which other robots decide, or in which order"""
    MEMORY = "memory"
    """it does not change the memory that it gets"""
    COPIES = "copies"
    """memory can be deep-copied and pickled, and a copy gives the same decision"""
    OBSERVATION = "observation"
    """it does not change the observation"""
    FORMS = "forms"
    """`decide` and `decide_all`, if it has both, give the same decisions: bit for bit, or within
    the ``agreement`` that the controller declares"""
    PORTIONS = "portions"
    """`decide_all` gives a robot the same decision, whichever others are due, in any order"""
    SIGHT = "sight"
    """it does not use what a robot cannot know: robots and walls out of range, except the stations
    of formation neighbours"""


@dataclass(frozen=True)
class Finding:
    """One rule that a controller breaks in one world: where this is seen first."""

    rule: Rule
    world: str
    """name or file, or that of a situation (`physim.testing.situations`)"""
    robot: str
    time: float
    """[s]"""
    text: str
    """one line"""
    place: str = ""
    """``file:line`` of the method that decides, where its source is known"""

    def __str__(self) -> str:
        """``rule: world, robot at time s: text (file:line)``."""
        place = f" ({self.place})" if self.place else ""
        return f"{self.rule}: {self.world}, {self.robot} at {self.time:g} s: {self.text}{place}"

    def as_json(self) -> dict[str, Any]:
        """Return the finding as JSON holds it."""
        return {**asdict(self), "rule": str(self.rule)}


class FindingLog:
    """Findings of one world as they come: the first of each rule, and how many more there were."""

    def __init__(self, world: str, place: str = "") -> None:
        self.world, self.place = world, place
        self._found: dict[Rule, tuple[Finding, int]] = {}

    def add(self, rule: Rule, robot: str, time: float, text: str) -> None:
        """Take down a finding; ``text`` is brought onto one line."""
        if rule in self._found:
            first, more = self._found[rule]
            self._found[rule] = first, more + 1
            return
        line = " ".join(text.split())
        if self.place:  # said once, behind the finding
            line = line.removesuffix(f" ({self.place})")
        place = "" if ".py:" in line else self.place  # of an error, its text says where
        self._found[rule] = Finding(rule, self.world, robot, time, line, place), 0

    def __contains__(self, rule: Rule) -> bool:
        """Whether a rule is broken."""
        return rule in self._found

    def findings(self) -> tuple[Finding, ...]:
        """One finding a rule, in the order in which they were made."""
        return tuple(
            replace(one, text=f"{one.text} (and {more} more)") if more else one
            for one, more in self._found.values()
        )


BELONGS = "what a decision leaves for the next belongs in its memory"


MakePlain = Callable[[], DecidesOne]
"""Makes one more instance, with the same settings, as it decides for one robot."""


def check_one_by_one(
    trial: Trial, asked_all_along: DecidesOne, make: MakePlain, found: FindingLog
) -> None:
    """Report what a trial shows, then ask for its decisions again under other conditions.

    ``asked_all_along`` is the controller that made them; ``make`` makes others.
    """
    for one in trial.asked:
        if one.answer.fault:
            rule = Rule.RAISES if one.answer.raised else Rule.DECISION
            _report(found, rule, one, one.answer.fault)
        if one.observation_change is not None:
            text = f"decide modifies its observation: {_changed(one.observation_change)}"
            _report(found, Rule.OBSERVATION, one, text)
        if one.memory_change is not None:
            text = f"decide modifies the memory it is given: {_changed(one.memory_change)}"
            _report(found, Rule.MEMORY, one, f"{text}; return a new one")
        if one.copy_error:
            _report(found, Rule.COPIES, one, f"its memory cannot be deep-copied: {one.copy_error}")
    again, asked = _Repeated(trial, make, found), trial.asked
    again.watching_state(asked_all_along)
    text = (
        "a new instance, given the memory, decides differently from the one asked all along "
        f"({{}}); {BELONGS}"
    )
    again.all(Rule.STATE, asked, text, None)
    text = "asked with the robots in reverse order it decides differently: {}"
    queries = [one for step in trial.steps for one in reversed(step.asked)]
    again.all(Rule.ORDER, queries, text, make())
    for i in range(trial.scene.robots):
        text = "asked for this robot alone it decides differently: {}"
        again.all(Rule.ORDER, [one for one in asked if one.robot == i], text, make())
    again.from_pickled_memory()


@dataclass
class _Repeated:
    """Asks for the decisions of a run again; what comes out differently is a finding."""

    trial: Trial
    make: MakePlain
    found: FindingLog
    shares_state: bool = False
    """whether something was seen to change that all instances share"""

    def watching_state(self, controller: DecidesOne) -> None:
        """The same one again, looking after each decision at what it keeps.

        It has been asked all this before: what it only had to work out once is there by now.
        """
        alone = controller if isinstance(controller, AskedAlone) else None
        watch = StateWatch(controller if alone is None else alone.controller)
        before = watch.look()
        for one in self._copyable(self.trial.asked):
            answer = self._ask(controller, one)
            after = watch.look()
            if (change := difference(before, after)) is not None:
                text = f"decide changes {_changed(change)}; {BELONGS}"
                _report(self.found, Rule.STATE, one, text)
                self.shares_state = self.shares_state or is_shared(change.place)
            text = f"asked the same again it decides differently ({{}}); {BELONGS}"
            self._compare(Rule.STATE, one, answer, text)
            before = after

    def all(
        self, rule: Rule, queries: list[Query], text: str, controller: DecidesOne | None
    ) -> None:
        """Ask one controller for all decisions again, or, without one, a new one for each."""
        for one in self._copyable(queries):
            answer = self._ask(self.make() if controller is None else controller, one)
            self._compare(rule, one, answer, text)

    def from_pickled_memory(self) -> None:
        """A new instance with the memory pickled and unpickled."""
        for one in (one for one in self._copyable(self.trial.asked) if one.memory is not None):
            try:
                memory = pickle.loads(pickle.dumps(one.memory))
            except Exception as error:
                text = f"its memory cannot be pickled: {type(error).__name__}: {error}"
                _report(self.found, Rule.COPIES, one, text)
                continue
            answer = self._ask(self.make(), one, memory)
            text = "from its memory pickled and unpickled it decides differently: {}"
            self._compare(Rule.COPIES, one, answer, text)

    def _copyable(self, queries: list[Query]) -> list[Query]:
        """Those whose memory is there to be handed over again."""
        return [one for one in queries if not one.copy_error]

    def _ask(self, controller: DecidesOne, one: Query, memory: Any = None) -> Answer:
        """Ask for a decision again, from a copy of its memory unless another one is given.

        A controller that modifies its observation gets a copy of that, too.
        """
        seen = copy.deepcopy(one.observation) if Rule.OBSERVATION in self.found else one.observation
        memory = copy.deepcopy(one.memory) if memory is None else memory
        return ask(controller, self.trial.scene, seen, memory)

    def _compare(self, rule: Rule, one: Query, answer: Answer, text: str) -> None:
        """Report an answer that is other than that of the run, by the rule that explains it.

        New instances that do not agree with each other explain it best: it does not repeat.
        """
        change = other_answer(one.answer.values, answer.values)
        if not change:
            return
        first, second = (self._ask(self.make(), one) for _ in range(2))
        apart = other_answer(first.values, second.values)
        if apart and not self.shares_state:
            text = (
                "new instances with the same settings decide differently on the same "
                f"observation and memory: {apart}"
            )
            _report(self.found, Rule.REPEATS, one, text)
        elif apart or (rule is Rule.ORDER and Rule.STATE in self.found):
            _report(self.found, Rule.STATE, one, text.format(change))
        else:
            _report(self.found, rule, one, text.format(change))


def _report(found: FindingLog, rule: Rule, one: Query, text: str) -> None:
    found.add(rule, one.observation.name, one.time, text)


def _changed(change: Difference) -> str:
    return f"{change.place} from {change.before} to {change.after}"


def check_all(trial: Trial, controller: DecidesAll, found: FindingLog) -> None:
    """Hold `decide_all` against the decisions of a trial, then against itself.

    Asked robot by robot, and from a table in which each has only the rows that it may know.
    """
    has_both, agreement = isinstance(controller, DecidesOne), agreement_of(controller)
    if not has_both and (Rule.RAISES in found or Rule.DECISION in found):
        return
    by_more = f" by more than {agreement:g}, its agreement," if agreement else ""
    forms = _Asking(trial, controller, found, Rule.FORMS if has_both else Rule.PORTIONS)
    portions = _Asking(trial, controller, found, Rule.PORTIONS)
    in_sight = replace(trial, scene=without_unseen_walls(trial))
    sight = _Asking(in_sight, controller, found, Rule.SIGHT)
    rng = np.random.default_rng(0)
    for step in trial.steps:
        rows = forms.decide(step, [step.due])
        if rows is None:
            return
        one_by_one = [step.due[k : k + 1] for k in reversed(range(len(step.due)))]
        alone = portions.decide(step, one_by_one)
        little = replace(step, sensed=what_each_may_know(trial.scene, step.sensed, rng))
        seen = sight.decide(little, [step.due])
        for one in step.asked:
            row, i = rows[one.robot], one.robot
            plain = {name: one.answer.values.get(name) for name in row}
            change = other_answer(plain, row, agreement)
            if change and not one.answer.fault:
                whom = "decide" if has_both else "it does for this robot alone"
                forms.report(f"decide_all decides differently{by_more} from {whom}: {change}", i)
            if alone and (change := other_answer(row, alone[i], agreement)):
                text = f"asked robot by robot, last first, decide_all decides differently{by_more}"
                portions.report(f"{text}: {change}", i)
            if seen and (change := other_answer(row, seen[i], agreement)):
                text = (
                    "without what the robot may not know (view.others(i) and view.walls(i) are "
                    "within range, of view.neighbours(i) it knows the stations) decide_all decides "
                    "differently"
                )
                sight.report(f"{text}{by_more}: {change}", i)


def without_unseen_walls(trial: Trial) -> Scene:
    """The scene with pieces of walls that no robot saw in the whole trial beyond all that is there.

    Their numbers, and what joins where, are as before: the pieces in sight tell that.
    """
    scene, walls, x = trial.scene, trial.scene.walls, [trial.scene.start[:, 0]]
    hidden, view = np.ones(len(walls.part_start) - 1, np.bool_), None
    for step in trial.steps:
        view = View(scene, step.sensed, view)
        x.append(step.sensed.pose[:, 0])
        for i in range(scene.robots):
            hidden[view.walls(i)] = False
    every = np.concatenate([*x, walls.vertices[:, 0]])
    vertices = walls.vertices.copy()
    vertices[np.repeat(hidden, np.diff(walls.part_start)), 0] += (
        np.ptp(every) + scene.sensing_range + 10.0
    )
    elsewhere = walls._replace(vertices=read_only(vertices))
    moved = replace(scene, walls=elsewhere, wall_tree=build_wall_tree(elsewhere))
    vars(moved)["pieces"] = scene.pieces
    return moved


def what_each_may_know(scene: Scene, sensed: Sensed, rng: np.random.Generator) -> Sensed:
    """The same with rows of its own for each observer, in any order of observers.

    Those out of range are left out, or, of formation neighbours, moved elsewhere out of range.
    """
    view, robots = View(scene, sensed), len(sensed.first)
    rows, first, end, count = [], np.zeros(robots, np.int64), np.zeros(robots, np.int64), 0
    pose, command, velocity = [], [], []
    for i in rng.permutation(robots).tolist():
        own, others = view.own_row(i), view.others(i)
        known = np.union1d(np.append(others, own), view.neighbours(i))
        here, there = sensed.pose[own, :2], sensed.pose[known].copy()
        far = ~np.isin(known, np.append(others, own))
        angle = rng.uniform(-np.pi, np.pi, len(known))
        away = (scene.sensing_range + rng.uniform(1.0, 9.0, len(known)))[:, None]
        moved = here + away * np.column_stack((np.cos(angle), np.sin(angle)))
        there[far] = np.column_stack((moved, angle))[far]
        rows.append(known)
        pose.append(there)
        command.append(np.where(far[:, None], 0.0, sensed.command[known]))
        velocity.append(np.where(far[:, None], 0.0, sensed.velocity[known]))
        first[i], count = count, count + len(known)
        end[i] = count
    taken = np.concatenate(rows)
    return own_arrays(
        sensed._replace(
            robot=sensed.robot[taken], pose=np.concatenate(pose), command=np.concatenate(command),
            velocity=np.concatenate(velocity), age=sensed.age[taken], first=first, end=end,
            reference_station=sensed.reference_station[taken],
        )
    )  # fmt: skip


class _Asking:
    """`decide_all` given what was sensed in a run, step by step, until it fails."""

    def __init__(self, trial: Trial, controller: DecidesAll, found: FindingLog, rule: Rule) -> None:
        self.trial, self.controller, self.found, self.rule = trial, controller, found, rule
        self.time, self.failed = 0.0, False
        self.view: View | None = None
        self.memory = first_memory(controller, trial.scene)
        self.declared = Declared.of(controller)
        written = type(controller).decide_all
        if not written.__module__.startswith("physim."):  # an inherited one is not the author's
            self.found.place = place_of(written).strip(" ()")

    def report(self, text: str, robot: int, rule: Rule | None = None) -> None:
        """Take down a finding."""
        self.found.add(rule or self.rule, self.trial.scene.names[robot], self.time, text)

    def decide(self, step: TrialStep, portions: list[IntArray]) -> dict[int, Contents] | None:
        """Values of each decision of a step by robot.

        None from the step on at which it fails, which is a finding.
        """
        self.time = step.time
        rows: dict[int, Contents] = {}
        for due in portions:
            if self.failed or not self._decide(step, due, rows):
                self.failed = True
                return None
        return rows

    def _decide(self, step: TrialStep, due: IntArray, rows: dict[int, Contents]) -> bool:
        """Put the values of robots ``due`` into ``rows``; whether there are any."""
        sensed, asked, scene = own_arrays(step.sensed), due.copy(), self.trial.scene
        self.view = View(scene, sensed, self.view)
        try:
            decisions = asked_together(self.controller, self.view, asked, self.memory)
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            self.report(f"decide_all fails: {broken_by(error)}", due[0])
            return False
        given, after = (contents(pair, "") for pair in ((step.sensed, due), (sensed, asked)))
        if change := difference(given, after):
            text = "decide_all modifies what is sensed, or the list of robots it is asked for"
            self.report(f"{text}, at {change.place}", due[0], Rule.OBSERVATION)
        try:
            decisions = taken_decisions(decisions, due, len(self.declared.columns))
            decisions = widened(decisions, scene)
            next_steps(scene, step.sensed.step, decisions, self.declared)
        except ControllerError as error:
            self.report(f"decide_all: {error}", due[0])
            return False
        rows |= {robot: values_of(row, self.declared) for robot, row in rows_of(decisions).items()}
        return True
