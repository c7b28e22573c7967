"""Edits that make work grow with the number of robots, or do it more than once."""

from __future__ import annotations

from tests.sabotage.edit import Edit

FILE = "tests/test_work.py"
LINES = f"{FILE}::test_a_decision_takes_as_many_lines_among_many_as_among_few"

EDITS = (
    Edit(
        "work",
        "controllers/priority.py",
        "considered_by_rank",
        "end_within(ranking.along, here, reach)",
        "len(ranking.order)",
        "a decision looks ahead no farther than its range",
        LINES,
    ),
    Edit(
        "work",
        "controllers/batch.py",
        "decide_all",
        "if a != ranked_from or b != ranked_to:",
        "if True:",
        "robots are ranked once a step",
        LINES,
    ),
    Edit(
        "work",
        "controllers/batch.py",
        "row_of",
        "if i < len(number) and number[i] == i:",
        "if False:",
        "a robot finds its row without a search",
        LINES,
    ),
    Edit(
        "work",
        "physim/simulation/decisions.py",
        "decide",
        "nominal[due] = decisions.command",
        "for k, i in enumerate(due.tolist()):\n"
        "        np.copyto(nominal[i : i + 1], decisions.command[k : k + 1])",
        "commands of all that decided are taken at once",
        f"{FILE}::test_a_step_takes_as_many_calls_for_a_thousand_robots_as_for_ten",
    ),
    Edit(
        "work",
        "physim/geometry/in_range.py",
        "window_along",
        "wide = reach * (1.0 + MARGIN) + MARGIN",
        "wide = np.inf",
        "a window holds only those about a robot",
        f"{FILE}::test_a_window_holds_no_more_of_a_longer_row",
    ),
    Edit(
        "work",
        "physim/simulation/observation.py",
        "Views._others",
        "self._robots.__getitem__",
        "Views._robots.func(self).__getitem__",
        "everybody is made once a step",
        f"{FILE}::test_everybody_is_made_once_a_step_however_many_see_it",
    ),
    Edit(
        "work",
        "physim/simulation/observation.py",
        "Views.observation",
        "return Observation.partly(values, partial(self._field, i))",
        "values.update({name: self._field(i, name) for name in self._makers})\n"
        "        return Observation.partly(values, partial(self._field, i))",
        "what is not asked for is not made",
        f"{FILE}::test_what_is_not_asked_for_is_not_made",
    ),
)
