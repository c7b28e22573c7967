"""What the plain form keeps to, tried on the decisions of one run by asking for them again."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from physim.control import Controller
from physim.testing.answers import Answer, ask, differs
from physim.testing.candidate import Make
from physim.testing.contents import Difference, difference
from physim.testing.findings import Found, Rule
from physim.testing.runs import Asked, Run
from physim.testing.state import Watch, is_shared

BELONGS = "what a decision leaves for the next belongs into its memory"


def check_plain(run: Run, asked_all_along: Controller, make: Make, found: Found) -> None:
    """Tell what a run shows, then ask for its decisions again in other ways.

    ``asked_all_along`` is the controller that made them; ``make`` makes others.
    """
    _of_the_run(run, found)
    again = _Again(run, make, found)
    again.with_an_eye_on(asked_all_along)
    again.by_new_instances()
    again.in_other_orders()
    again.from_pickled_memory()


def _of_the_run(run: Run, found: Found) -> None:
    """Findings that the run itself shows."""
    for one in run.asked:
        if one.answer.fault:
            rule = Rule.RAISES if one.answer.raised else Rule.DECISION
            _tell(found, rule, one, one.answer.fault)
        if one.seen_changed is not None:
            told = f"decide writes into what it sees: {_changed(one.seen_changed)}"
            _tell(found, Rule.OBSERVATION, one, told)
        if one.memory_changed is not None:
            told = f"decide writes into the memory it is given: {_changed(one.memory_changed)}"
            _tell(found, Rule.MEMORY, one, f"{told}; return a new one")
        if one.uncopied:
            _tell(found, Rule.COPIES, one, f"its memory cannot be deep-copied: {one.uncopied}")


@dataclass
class _Again:
    """Asks for the decisions of a run again; what comes out otherwise is a finding."""

    run: Run
    make: Make
    found: Found
    shares_state: bool = False
    """whether something was seen to change that all instances share"""

    def with_an_eye_on(self, controller: Controller) -> None:
        """The same one again, looking after each decision at what it keeps.

        It has been asked all this before: what it only had to work out once is there by now.
        """
        watch = Watch(controller)
        before = watch.look()
        for one in self._copyable():
            answer = self._ask(controller, one)
            after = watch.look()
            if (change := difference(before, after)) is not None:
                told = f"decide changes {_changed(change)}; {BELONGS}"
                _tell(self.found, Rule.STATE, one, told)
                self.shares_state = self.shares_state or is_shared(change.place)
            told = f"asked all this again it decides otherwise ({{}}); {BELONGS}"
            self._compare(Rule.STATE, one, answer, told)
            before = after

    def by_new_instances(self) -> None:
        """A new instance for every single decision, with nothing but the memory."""
        told = (
            "a new instance, given the memory, decides otherwise than the one asked all along "
            f"({{}}); {BELONGS}"
        )
        for one in self._copyable():
            answer = self._ask(self.make(), one)
            self._compare(Rule.STATE, one, answer, told)

    def in_other_orders(self) -> None:
        """One instance asked with the robots in reverse; and one for each robot alone."""
        controller = self.make()
        for step in self.run.steps:
            for one in self._copyable(reversed(step.asked)):
                answer = self._ask(controller, one)
                told = "asked with the robots in reverse order it decides otherwise: {}"
                self._compare(Rule.ORDER, one, answer, told)
        for i in range(self.run.scene.robots):
            controller = self.make()
            for one in self._copyable(one for one in self.run.asked if one.robot == i):
                answer = self._ask(controller, one)
                told = "asked for this robot alone it decides otherwise: {}"
                self._compare(Rule.ORDER, one, answer, told)

    def from_pickled_memory(self) -> None:
        """A new instance with the memory pickled and unpickled."""
        for one in self._copyable():
            if one.memory is None:
                continue
            try:
                memory = pickle.loads(pickle.dumps(one.memory))
            except Exception as error:
                told = f"its memory cannot be pickled: {type(error).__name__}: {error}"
                _tell(self.found, Rule.COPIES, one, told)
                continue
            answer = self._ask_from(self.make(), one, memory)
            told = "from its memory pickled and unpickled it decides otherwise: {}"
            self._compare(Rule.COPIES, one, answer, told)

    def _copyable(self, asked: Iterable[Asked] | None = None) -> Iterable[Asked]:
        """Those decisions whose memory is there to be handed over again."""
        return [one for one in (self.run.asked if asked is None else asked) if not one.uncopied]

    def _ask(self, controller: Controller, one: Asked) -> Answer:
        """Ask for a decision again, from a copy of its memory."""
        return self._ask_from(controller, one, copy.deepcopy(one.memory))

    def _ask_from(self, controller: Controller, one: Asked, memory: Any) -> Answer:
        """Ask from a memory; a controller that writes into what it sees gets copies of that."""
        seen = one.observation
        if Rule.OBSERVATION in self.found:
            seen = copy.deepcopy(seen)
        return ask(controller, self.run.scene, seen, memory)

    def _compare(self, rule: Rule, one: Asked, answer: Answer, told: str) -> None:
        """Tell an answer that is other than that of the run, by the rule that explains it.

        New instances that do not agree with each other explain it best: it does not repeat.
        """
        change = differs(one.answer.values, answer.values)
        if not change:
            return
        first, second = (self._ask(self.make(), one) for _ in range(2))
        apart = differs(first.values, second.values)
        if apart and not self.shares_state:
            told = (
                "new instances with the same settings decide otherwise from the same "
                f"observation and memory: {apart}"
            )
            _tell(self.found, Rule.REPEATS, one, told)
        elif apart or (rule is Rule.ORDER and Rule.STATE in self.found):
            _tell(self.found, Rule.STATE, one, told.format(change))
        else:
            _tell(self.found, rule, one, told.format(change))


def _tell(found: Found, rule: Rule, one: Asked, text: str) -> None:
    found.add(rule, one.observation.name, one.time, text)


def _changed(change: Difference) -> str:
    return f"{change.place} from {change.before} to {change.after}"
