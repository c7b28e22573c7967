"""What the batch form keeps to, tried on what was sensed in a run of the plain form."""

from __future__ import annotations

from typing import Any

from physim.control import BatchController, Batched
from physim.control_decisions import broken
from physim.control_loop import check_told
from physim.declared import Declared
from physim.errors import ControllerError
from physim.geometry.shapes import IntArray
from physim.testing.answers import other_answer, rows_of, unreadable, values_of
from physim.testing.contents import Contents, contents, difference
from physim.testing.findings import FindingLog, Rule
from physim.testing.runs import Trial, TrialStep, own


def check_batch(trial: Trial, controller: Batched, found: FindingLog) -> None:
    """Hold the batch form against the plain one, then against itself asked robot by robot."""
    whole = _BatchDriver(trial, controller, found, Rule.BATCH)
    alone = _BatchDriver(trial, controller, found, Rule.BATCH_ORDER)
    for step in trial.steps:
        rows = whole.decide(step, [step.due])
        if rows is None:
            return
        others = alone.decide(step, [step.due[k : k + 1] for k in reversed(range(len(step.due)))])
        for one in step.asked:
            row = rows[one.robot]
            change = other_answer({name: one.answer.values.get(name) for name in row}, row)
            if change and not one.answer.fault:
                text = "the batch form decides otherwise than the plain one"
                whole.report(f"{text}: {change}", one.robot)
            if others is not None and (change := other_answer(row, others[one.robot])):
                text = "asked robot by robot, last first, the batch form decides otherwise"
                alone.report(f"{text}: {change}", one.robot)


class _BatchDriver:
    """A batch form that is given what was sensed in a run, step by step, until it fails."""

    def __init__(self, trial: Trial, controller: Batched, found: FindingLog, rule: Rule) -> None:
        self.trial = trial
        self.controller = controller
        self.found = found
        self.rule = rule
        self.time = 0.0
        self.failed = False
        self.batch: BatchController | None = None
        self.memory: dict[str, Any] = {}
        self.declared = Declared.of(controller)

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
        sensed, asked = own(step.sensed), due.copy()
        try:
            if self.batch is None:
                self.batch = self.controller.batch(self.trial.scene)
                self.memory = self.batch.memory()
            decisions = self.batch.decide_due(sensed, asked, self.memory)
        except (Exception, SystemExit) as error:
            self.report(str(broken(error, "the batch form fails")), due[0])
            return False
        given, after = (contents(pair, "") for pair in ((step.sensed, due), (sensed, asked)))
        if change := difference(given, after):
            text = "the batch form modifies what is sensed, or the list of robots it is asked for"
            self.report(f"{text}, at {change.place}", due[0], Rule.OBSERVATION)
        fault = unreadable(decisions, due)
        if not fault:
            try:
                check_told(self.trial.scene, self.time, decisions, self.declared)
            except ControllerError as error:
                fault = f"returned what no record may hold: {error}"
        if fault:
            self.report(f"decide_due {fault}", due[0])
            return False
        rows |= {robot: values_of(row, self.declared) for robot, row in rows_of(decisions).items()}
        return True
