"""Errors and warnings as they are found, before they get their places in the file."""

from __future__ import annotations

from dataclasses import dataclass, field

from physim.errors import Fault, Location

MOST_ALIKE = 5
"""Findings of one kind that are told one by one."""


@dataclass
class Told:
    """What the checks have said so far."""

    errors: list[Fault] = field(default_factory=list)
    warnings: list[Fault] = field(default_factory=list)

    def error(self, location: Location, message: str) -> None:
        """Say what makes the world unfit."""
        self.errors.append(Fault(location, message))

    def warn(self, location: Location, message: str) -> None:
        """Say what is seldom meant."""
        self.warnings.append(Fault(location, message))
