"""What a check found: errors and warnings with their places, and how much room each path has."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from physim.errors import Fault, Position, dotted, fault_lines, plural
from physim.escaping import escaped
from physim.world.faults import describe

if TYPE_CHECKING:
    from physim.world.checks.room import ClearanceProfile
    from physim.world.file import Document
    from physim.world.scene import Layout


MOST_ALIKE = 5
"""Findings of one kind that are reported one by one."""


@dataclass(frozen=True)
class Finding:
    """One thing wrong, or doubtful, in a world file."""

    file: str
    """or the option of the command line that gave the value, as ``--set time.step``"""
    line: int | None
    """from 1; None where there is no file to point into"""
    column: int | None
    """from 1"""
    key: str
    """where in the world: ``robots[2].pose``; empty for the whole of it"""
    message: str

    @classmethod
    def of(cls, fault: Fault, position: Position | None, file: str) -> Finding:
        """A fault at its place; signs of the file's name that cannot be printed are replaced."""
        file = escaped(file)
        if position is None:
            message = fault.message.removeprefix(f"{file}: ")
            return cls(file, None, None, dotted(fault.location), message)
        if (place := str(position)).startswith("--"):
            return cls(escaped(place), None, None, dotted(fault.location), fault.message)
        return cls(file, position.line, position.column, dotted(fault.location), fault.message)

    def __str__(self) -> str:
        """``file:line:column: key: message``."""
        (line,) = finding_lines([self])
        return line

    def as_json(self) -> dict[str, Any]:
        """Return the finding as JSON holds it."""
        return asdict(self)


def finding_lines(findings: Iterable[Finding]) -> list[str]:
    """A line for each cause among findings, as `physim.errors.fault_lines` puts it."""
    return fault_lines(
        (
            one.file if one.line is None else f"{one.file}:{one.line}:{one.column}",
            one.key,
            one.message,
        )
        for one in findings
    )


@dataclass(frozen=True)
class Findings:
    """Everything that a check of one world file found, in the order of the file."""

    file: str
    errors: tuple[Finding, ...] = ()
    """what makes the world unfit to run, or to mean what it says"""
    warnings: tuple[Finding, ...] = ()
    """what may be meant so, but is seldom"""
    notes: tuple[str, ...] = ()
    """what the errors and warnings hold for, where the file alone does not say it"""
    clearance: tuple[ClearanceProfile, ...] = ()
    """room along the path of each robot whose path and footprint are sound"""
    layout: Layout | None = field(default=None, repr=False)
    """where everything of the world lies, if that could be worked out"""
    document: Document | None = field(default=None, repr=False)
    """the text that was checked; None where it could not be read"""

    @property
    def ok(self) -> bool:
        """Whether there is no error; there may be warnings."""
        return not self.errors

    def located(self, fault: Fault) -> Finding:
        """A fault found by other means, as by a run, at its place in the file."""
        position = None if self.document is None else self.document.position(fault.location)
        return Finding.of(fault, position, self.file)

    @property
    def count(self) -> str:
        """How many errors and warnings there are, in words."""
        return ", ".join(
            plural(len(some), word) if some else f"no {word}s"
            for some, word in ((self.errors, "error"), (self.warnings, "warning"))
        )

    def __repr__(self) -> str:
        """File and number of findings; as text, all of them, a line each."""
        return f"<Findings of {describe(self.file)}: {self.count}>"

    def __str__(self) -> str:
        """A line for each cause, as the command line has them, without the room on the paths."""
        kinds = (("error", self.errors), ("warning", self.warnings))
        said = [f"{kind}: {line}" for kind, some in kinds for line in finding_lines(some)]
        return "\n".join([*said, *self.notes, f"{self.file}: {self.count}"])

    def as_json(self) -> dict[str, Any]:
        """Return the findings as JSON holds them."""
        return {
            "file": self.file,
            "errors": [finding.as_json() for finding in self.errors],
            "warnings": [finding.as_json() for finding in self.warnings],
            "notes": list(self.notes),
            "clearance": [profile.as_json() for profile in self.clearance],
        }
