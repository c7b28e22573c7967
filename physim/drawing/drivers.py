"""Who drives whom in a run with several controllers.

Each controller has a letter, which stands behind the names of its robots (``r5·C``) and before what
is its own: its modes, and the safe area. A run with one controller has none of this.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from pydantic import ValidationError

from physim.errors import PhysimError
from physim.parts.declarations import NO_NUMBER

if TYPE_CHECKING:
    from physim.record import Record
    from physim.record.setup import Part

MOST_DRIVERS = 6
"""Controllers that a legend lists"""
MOST_LETTERS = 3
"""Controllers that are named in one line by their letters, with a figure or without"""
MOST_MODES = 8
"""Modes that are explained; of more, those that the run has."""


class Driver(NamedTuple):
    """One of several controllers of a run."""

    letter: str
    name: str
    robots: tuple[int, ...]
    words: str
    """``A mode_switching: r1, r2``, with its settings where another one has that name"""
    modes: tuple[int, ...]
    """numbers of the modes to explain: all that it declares, if its robots ever gave one"""
    keeps: bool
    """whether it keeps the distance from walls by which safe and danger area are drawn"""

    def __str__(self) -> str:
        """``A mode_switching``."""
        return f"{self.letter} {self.name}"


def drivers_of(record: Record) -> tuple[Driver, ...]:
    """Controllers of a run; none where there is only one."""
    setup = record.setup
    if len(setup.controllers) < 2:
        return ()
    names = [part.name for part, _ in setup.controllers]
    found = []
    for k, (part, robots) in enumerate(setup.controllers):
        letter = chr(ord("A") + k) if k < 26 else str(k + 1)
        words = f"{letter} {part.name}: {setup.who(robots)}"
        if names.count(part.name) > 1 and part.set_to:
            words += f" ({part.set_to})"
        keeps = settings_of(part).get("safe_distance") == record.safe_distance > 0.0
        modes = _modes(record, part, robots)
        found.append(Driver(letter, part.name, robots, words, modes, keeps))
    return tuple(found)


def marks_of(drivers: Sequence[Driver], robots: int) -> list[str]:
    """What stands behind the name of each robot: ``·A``; nothing in a run with one controller."""
    marks = [""] * robots
    for driver in drivers:
        for robot in driver.robots:
            if robot < robots:  # the world inside a record need not be that of its robots
                marks[robot] = f"·{driver.letter}"
    return marks


def owner_of(drivers: Sequence[Driver]) -> str:
    """What stands behind ``safe area``: `` of A``; nothing where it is that of all controllers."""
    letters = [driver.letter for driver in drivers if driver.keeps]
    if len(letters) in (0, len(drivers)):
        return ""
    return f" of {', '.join(letters[:MOST_LETTERS])}{', …' * (len(letters) > MOST_LETTERS)}"


def key_of(drivers: Sequence[Driver]) -> str:
    """``A mode_switching, B path_following``."""
    more = len(drivers) - MOST_DRIVERS
    words = ", ".join(map(str, drivers[:MOST_DRIVERS]))
    return f"{words} and {more} more" if more > 0 else words


def settings_of(part: Part) -> dict[str, Any]:
    """Settings of a controller, those that the world does not give as they are by default.

    Only those that the world gives, where nobody has registered the controller; none where it
    refuses them, as in a record of another version: they may be anything.
    """
    model = getattr(_class_of(part), "Settings", None)
    try:
        made = None if model is None else model.model_validate(part.settings)
    except ValidationError:
        return {}
    return dict(part.settings) if made is None else dict(made.model_dump())


def _modes(record: Record, part: Part, robots: Sequence[int]) -> tuple[int, ...]:
    updates = record.updates
    given = set(updates["mode"][np.isin(updates["robot"], robots)].tolist()) - {NO_NUMBER}
    declared = [str(getattr(one, "name", "")) for one in getattr(_class_of(part), "modes", ())]
    known = {k for k, mode in enumerate(record.modes) if mode.name in declared}
    return tuple(sorted(given | known if given and len(given | known) <= MOST_MODES else given))


def _class_of(part: Part) -> type[Any] | None:
    """Class of a controller; None where nobody has registered it."""
    from physim.parts.registry import CONTROLLER, find_part

    try:
        return find_part(CONTROLLER, part.name)
    except PhysimError:
        return None
