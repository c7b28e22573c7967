"""Edits of `physim.authoring.templates`."""

from __future__ import annotations

from tests.sabotage.edit import Edit

EDITS = (
    Edit(
        "templates",
        "physim/authoring/templates/text.py",
        "lanes_of",
        "(width - 2.0 * EDGE) / LANE",
        "width / LANE",
        "lanes keep away from the walls",
        "tests/templates/test_templates.py::test_lanes_are_as_many_as_the_width_has_room_for",
    ),
    Edit(
        "templates",
        "physim/authoring/templates/text.py",
        "places",
        "offsets[i % lanes],",
        "offsets[0],",
        "neighbours stand in lanes of their own",
        "tests/templates/test_templates.py::"
        "test_every_number_of_robots_stands_apart_on_a_sound_road",
    ),
    Edit(
        "templates",
        "physim/authoring/templates/text.py",
        "fitted",
        "if straight > LONGEST:",
        "if False:",
        "more robots than fit are refused",
        "tests/templates/test_templates.py::test_one_more_than_fit_are_refused",
    ),
    Edit(
        "templates",
        "physim/authoring/templates/text.py",
        "most_robots",
        "places(width, robots + 1)[0].x + FRONT <= LONGEST",
        "places(width, robots + 1)[0].x <= LONGEST",
        "as many robots as are offered fit",
        "tests/templates/test_templates.py::test_the_command_offers_what_there_is",
    ),
    Edit(
        "templates",
        "physim/authoring/templates/roads.py",
        "rounded",
        "side = 1.0 if turn > 0.0 else -1.0",
        "side = 1.0",
        "a road bends to both sides",
        "tests/templates/test_templates.py::"
        "test_every_number_of_robots_stands_apart_on_a_sound_road",
    ),
)
