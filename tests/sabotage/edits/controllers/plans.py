"""Edits of `physim.controllers.mode_switching`: plans of `decide_one`, and when a robot decides again."""

from __future__ import annotations

from tests.sabotage.edit import Edit

WHOLE = "tests/controllers/test_mode_switching.py::test_every_decision_agrees_with_the_oracle"

EDITS = (
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "interval *= rules.dwell[dwell] / rules.update_period",
        "interval *= 1.0",
        "every pair of a plan holds for the longest interval",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "interval *= rules.dwell[dwell] / rules.update_period",
        "interval = rules.dwell[dwell]",
        "a plan is not stretched",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "if pair[0] > 0.0:\n        hold = min(hold",
        "if False:\n        hold = min(hold",
        "no decision on arrival at the stop",
        "tests/controllers/test_timing.py::test_near_the_stop_the_next_decision_is_when_the_robot_comes_to_it",
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "hold = min(hold, (own.stop_station - own.station) / pair[0])",
        "hold = min(hold, own.stop_station - own.station)",
        "arrival at the stop expected at 1 m/s",
        "tests/controllers/test_timing.py::test_near_the_stop_the_next_decision_is_when_the_robot_comes_to_it",
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "interval = rules.longest_interval\n    if mode == SAFE:",
        "interval = rules.update_period\n    if mode == SAFE:",
        "the longest interval ignored",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "if rules.event_triggered:\n        hold",
        "if True:\n        hold",
        "event_triggered ignored",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "goes_on = mode == SAFE and hold == interval and dwell + 1 < len(rules.dwell)",
        "goes_on = mode == SAFE and dwell + 1 < len(rules.dwell)",
        "a plan goes on though it was cut short",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "goes_on = mode == SAFE and hold == interval and dwell + 1 < len(rules.dwell)",
        "goes_on = hold == interval and dwell + 1 < len(rules.dwell)",
        "a plan goes on after danger mode",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "goes_on = mode == SAFE and hold == interval and dwell + 1 < len(rules.dwell)",
        "goes_on = False",
        "every decision makes a new plan",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "pair = plan[dwell]",
        "pair = plan[0]",
        "the first pair of a plan again and again",
        WHOLE,
    ),
)
