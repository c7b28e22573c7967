"""Errors that a user can mend: each says what, where, what was given, and what is allowed."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from physim.escaping import escaped

MOST_FAULTS = 100
"""Causes of faults of one world that have a line each"""

Location = tuple[str | int, ...]
"""Where in a world a fault lies, e.g. ``("robots", 2, "pose", 0)``; ``()`` is the whole world."""


class PhysimError(Exception):
    """Bad input: the command line prints the message alone and exits with 2.

    Its arguments are the lines of the message; what would act on a terminal in them is escaped.
    """

    def __str__(self) -> str:
        """The lines of the message."""
        return "\n".join(escaped(str(line)) for line in self.args)


class MissingExtraError(PhysimError):
    """A package that only some need is not installed: says what needs it, and what to install."""

    def __init__(self, what: str, extra: str) -> None:
        super().__init__(f'{what} needs an extra: pip install "physim[{extra}]"')


class Notice(UserWarning):
    """What a user should know of what was read, though it could be; a line in the command line."""


@dataclass(frozen=True)
class Fault:
    """One thing wrong with a world: where in it, and what to do about it (one line)."""

    location: Location
    """where in the world, e.g. ``("robots", 2, "pose", 0)``; ``()`` is the whole world"""
    message: str
    """one line"""
    severity: Literal["error", "warning"] = "error"
    """a warning: what may be meant so, but is seldom"""
    of_key: bool = False
    """whether the key itself is wrong, not its value: then the place is that of the key"""

    def __str__(self) -> str:
        """``robots[2].pose: message``, without a file position."""
        return f"{dotted(self.location)}: {self.message}" if self.location else self.message


@dataclass(frozen=True)
class Position:
    """A place in a text file; line and column count from 1."""

    file: Path | str
    line: int
    column: int
    option: str = ""
    """of the command line, as ``--set time.step``, where that gives the value"""

    def __str__(self) -> str:
        """``file:line:column``, or the option."""
        return self.option or f"{self.file}:{self.line}:{self.column}"


class WorldError(PhysimError):
    """A world that cannot be run, with every fault found; the message has a line for each cause.

    ``positions`` holds the place in the file of each fault, where the world came from a file;
    otherwise it is empty.
    """

    def __init__(self, faults: list[Fault], positions: list[Position] | None = None) -> None:
        self.faults = tuple(faults)
        self.positions = tuple(positions or ())
        places = [str(one) for one in self.positions] or [""] * len(faults)
        super().__init__(
            *fault_lines(
                (place, dotted(fault.location), fault.message)
                for place, fault in zip(places, faults, strict=True)
            )
        )


class RecordError(PhysimError):
    """A record that cannot be read or written."""


class ControllerError(PhysimError):
    """A controller that is unknown, cannot be loaded, or gave a command that cannot be applied."""


def fault_lines(faults: Iterable[tuple[str, str, str]]) -> list[str]:
    """A line for each cause among faults: place, key and message of the first, how many more.

    Of one cause are those with the same message, whatever value was given, at keys that differ in
    the numbers of entries alone.
    """
    causes: dict[tuple[str, str], list[tuple[str, str, str]]] = {}
    for place, key, message in faults:
        cause = (re.sub(r"\[\d+\]", "[]", key), re.sub(r"; given [^;]*", "", message))
        causes.setdefault(cause, []).append((place, key, message))
    lines = []
    for (place, key, message), *others in causes.values():
        parts = (place, "" if names_key(place, key) else key, message)
        line = ": ".join(part for part in parts if part)
        if others:
            line += f" (and {len(others)} more like it, {_span(key, [one[1] for one in others])})"
        lines.append(line)
    if len(lines) > MOST_FAULTS:
        more = len(lines) - MOST_FAULTS + 1
        lines[MOST_FAULTS - 1 :] = [f"and {more} more; correct these first"]
    return lines


def _span(key: str, others: list[str]) -> str:
    """``robots[1] to robots[9]``: the first and last of other keys, to the number that differs."""
    split = [re.split(r"(?<=\])", one) for one in (key, *others)]  # each into as many parts
    alike = [len(set(parts)) == 1 for parts in zip(*split, strict=True)]
    differs = max((k for k, same in enumerate(alike) if not same), default=0)
    first, last = ("".join(parts[: differs + 1]) for parts in (split[1], split[-1]))
    return first if first == last else f"{first} to {last}"


def names_key(place: str, key: str) -> bool:
    """Whether a place is an option of the command line that says the key already."""
    return place in ("--controller", f"--{key}") or (
        place.startswith("--set ") and (place.endswith(f" {key}"))
    )


def plain_key(override: str) -> str:
    """Key of ``KEY=VALUE`` as it is written with dots: ``robots[0].pose`` is ``robots.0.pose``."""
    return re.sub(r"\[([0-9]+)\]", r".\1", override.partition("=")[0].strip())


def dotted(location: Location) -> str:
    """Write a location as the command line takes it: ``robots[2].pose[0]``."""
    text = ""
    for part in location:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            text += f".{part}" if text else part
    return text


def plural(count: int, one: str, many: str = "") -> str:
    """``1 robot``, ``2 robots``."""
    return f"{count} {one if count == 1 else many or one + 's'}"


def place_text(x: float, y: float, digits: int = 6) -> str:
    """``(1.5, 4)``: a point [m] with so many digits, and to the centimetre however far it is."""

    def one(value: float) -> str:
        if abs(value) < 10.0 ** (digits - 2):
            return f"{value:.{digits}g}"
        return f"{value:.2f}".rstrip("0").rstrip(".")

    return f"({one(x)}, {one(y)})"


FEWEST_LETTERS = 3
"""Of the beginning of a name by which it is known"""


def nearest(given: str, allowed: list[str]) -> str:
    """``; did you mean "x"?`` for the closest of ``allowed``, else the first that begins so."""
    import difflib

    close = difflib.get_close_matches(given, allowed, n=1, cutoff=0.6)
    if not close and len(given) >= FEWEST_LETTERS:
        close = [name for name in allowed if name.startswith(given)]
    return f'; did you mean "{close[0]}"?' if close else ""
