"""What the plain form keeps to, tried on the decisions of one run by asking for them again."""

from __future__ import annotations

import copy
import pickle
from dataclasses import dataclass
from typing import Any

from physim.control import Controller
from physim.testing.answers import Answer, Make, ask, other_answer
from physim.testing.contents import Difference, difference
from physim.testing.findings import FindingLog, Rule
from physim.testing.runs import Query, Trial
from physim.testing.state import StateWatch, is_shared

BELONGS = "what a decision leaves for the next belongs in its memory"


def check_plain(trial: Trial, asked_all_along: Controller, make: Make, found: FindingLog) -> None:
    """Report what a trial shows, then ask for its decisions again in other ways.

    ``asked_all_along`` is the controller that made them; ``make`` makes others.
    """
    _of_the_trial(trial, found)
    again = _Repeated(trial, make, found)
    again.watching_state(asked_all_along)
    again.by_new_instances()
    again.in_other_orders()
    again.from_pickled_memory()


def _of_the_trial(trial: Trial, found: FindingLog) -> None:
    """Findings that the run itself shows."""
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


@dataclass
class _Repeated:
    """Asks for the decisions of a run again; what comes out otherwise is a finding."""

    trial: Trial
    make: Make
    found: FindingLog
    shares_state: bool = False
    """whether something was seen to change that all instances share"""

    def watching_state(self, controller: Controller) -> None:
        """The same one again, looking after each decision at what it keeps.

        It has been asked all this before: what it only had to work out once is there by now.
        """
        watch = StateWatch(controller)
        before = watch.look()
        for one in self._copyable(self.trial.asked):
            answer = self._ask(controller, one)
            after = watch.look()
            if (change := difference(before, after)) is not None:
                text = f"decide changes {_changed(change)}; {BELONGS}"
                _report(self.found, Rule.STATE, one, text)
                self.shares_state = self.shares_state or is_shared(change.place)
            text = f"asked all this again it decides otherwise ({{}}); {BELONGS}"
            self._compare(Rule.STATE, one, answer, text)
            before = after

    def by_new_instances(self) -> None:
        """A new instance for every single decision, with nothing but the memory."""
        text = (
            "a new instance, given the memory, decides otherwise than the one asked all along "
            f"({{}}); {BELONGS}"
        )
        self._ask_all(Rule.STATE, self.trial.asked, text)

    def in_other_orders(self) -> None:
        """One instance asked with the robots in reverse; and one for each robot alone."""
        queries = [one for step in self.trial.steps for one in reversed(step.asked)]
        text = "asked with the robots in reverse order it decides otherwise: {}"
        self._ask_all(Rule.ORDER, queries, text, self.make())
        for i in range(self.trial.scene.robots):
            queries = [one for one in self.trial.asked if one.robot == i]
            text = "asked for this robot alone it decides otherwise: {}"
            self._ask_all(Rule.ORDER, queries, text, self.make())

    def _ask_all(
        self, rule: Rule, queries: list[Query], text: str, controller: Controller | None = None
    ) -> None:
        """Ask one controller for all decisions again, or, without one, a new one for each."""
        for one in self._copyable(queries):
            answer = self._ask(self.make() if controller is None else controller, one)
            self._compare(rule, one, answer, text)

    def from_pickled_memory(self) -> None:
        """A new instance with the memory pickled and unpickled."""
        for one in self._copyable(self.trial.asked):
            if one.memory is None:
                continue
            try:
                memory = pickle.loads(pickle.dumps(one.memory))
            except Exception as error:
                text = f"its memory cannot be pickled: {type(error).__name__}: {error}"
                _report(self.found, Rule.COPIES, one, text)
                continue
            answer = self._ask(self.make(), one, memory)
            text = "from its memory pickled and unpickled it decides otherwise: {}"
            self._compare(Rule.COPIES, one, answer, text)

    def _copyable(self, queries: list[Query]) -> list[Query]:
        """Those whose memory is there to be handed over again."""
        return [one for one in queries if not one.copy_error]

    def _ask(self, controller: Controller, one: Query, memory: Any = None) -> Answer:
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
                "new instances with the same settings decide otherwise from the same "
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
