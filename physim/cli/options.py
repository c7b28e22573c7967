"""Options that commands share, and kinds of values: each reads a text, or says what is allowed.

A command is a function: ``seconds: Positive = 2.0`` makes ``--seconds`` of an argument, and the
docstring tells its help. A reader raises ValueError with what is allowed in the text's place, for
example ``a number greater than 0``.
"""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, TextIO

from cyclopts import Parameter

from physim.drawing.printed import WIDTHS, printed_width
from physim.errors import nearest

LONGEST_QUOTE = 60
"""Characters of what was given that an error repeats."""
LARGEST_NUMBER = 10**15


def kind(read: Callable[[str], object], *names: str, **more: Any) -> Parameter:
    """A kind of values, as ``read`` makes them of a text; ``names`` where they are always these."""
    return Parameter(
        names or None, converter=lambda _, tokens: read(tokens[0].value), n_tokens=1, **more
    )


def quoted(text: str) -> str:
    """What was given, in quotes where it would not be seen as one word."""
    text = text[: LONGEST_QUOTE + 1]
    text = text if len(text) <= LONGEST_QUOTE else text[: LONGEST_QUOTE - 1] + "…"
    return text if text and re.fullmatch(r"[^\s\"']+", text) else f'"{text}"'


def one_of(given: str, allowed: Sequence[str]) -> str:
    """``one of ALLOWED``, and the one that is nearest to what was given."""
    return f"one of {', '.join(allowed)}{nearest(given[:LONGEST_QUOTE], list(allowed))}"


def whole(least: int, most: int, allowed: str = "", step: int = 1) -> Callable[[str], int]:
    """Reader of whole numbers between two bounds, both allowed, every ``step`` of them from 0."""

    def read(text: str) -> int:
        value = int(text) if text.isascii() and text.isdigit() and len(text) < 19 else -1
        if not least <= value <= most or value % step:
            raise ValueError(allowed or f"a whole number from {least} to {most}")
        return value

    return read


def real(
    least: float, most: float = sys.float_info.max, allowed: str = ""
) -> Callable[[str], float]:
    """Reader of numbers between two bounds, both allowed."""

    def read(text: str) -> float:
        value = _number(text)
        if not least <= value <= most:
            raise ValueError(allowed or f"a number from {least:.15g} to {most:.15g}")
        return value

    return read


WHOLE = whole(0, LARGEST_NUMBER, "a whole number from 0 to 10^15")


def print_width(text: str) -> float:
    """Read a width in print [in]."""
    return printed_width(text if text in WIDTHS else _number(text))


def seed_range(text: str) -> range:
    """Read seeds A:B, half-open."""
    first, _, last = text.partition(":")
    try:
        ends = (WHOLE(first), WHOLE(last))
    except ValueError:
        raise ValueError("A:B, two whole numbers from 0 to 10^15, as 1:101") from None
    if ends[1] <= ends[0]:
        raise ValueError("A:B with A below B: it goes from A to B - 1")
    return range(*ends)


def pair(text: str) -> tuple[float, float]:
    """Read X,Y [m], two finite numbers."""
    x, y = _numbers(text)
    if not (abs(x) <= LARGEST_NUMBER and abs(y) <= LARGEST_NUMBER):
        raise ValueError("X,Y, two numbers [m], as 14.5,-3")
    return x, y


def size(text: str) -> tuple[float, float] | Literal["fit"]:
    """Read LENGTH,WIDTH [m], two numbers greater than 0, or fit."""
    if text == "fit":
        return "fit"
    length, width = _numbers(text)
    if not (0.0 < length <= 1000.0 and 0.0 < width <= 1000.0):
        raise ValueError("LENGTH,WIDTH, two numbers above 0, at most 1000 [m], as 1.8,1.0, or fit")
    return length, width


def _numbers(text: str) -> tuple[float, float]:
    first, _, last = text.partition(",")
    return _number(first), _number(last)


def _number(text: str) -> float:
    """Number in plain digits, or NaN, which no bounds hold."""
    try:
        return float(text) if text.isascii() and "_" not in text else math.nan
    except ValueError:
        return math.nan


def path(text: str) -> Path:
    """Read the name of a file or folder."""
    if not text:  # Python's would be the working folder; mostly it is a variable that is not set
        raise ValueError("the name of a file or folder")
    if "\n" in text:  # it would end the lines that tell of it, and begin some of its own
        raise ValueError("the name of a file or folder in one line")
    return Path(text)


def json_file(text: str) -> Path:
    """Read the name of a file, or - for standard output."""
    if text.startswith("-") and text != "-":  # an option, most likely
        raise ValueError("the name of a file, or - for standard output")
    return path(text)


def record_file(text: str) -> Path:
    """File of a record that is named by itself or by the folder of its run."""
    given = path(text)
    return given / "record.h5" if given.is_dir() else given


def words(text: str) -> tuple[str, ...]:
    """Read NAME,..."""
    names = tuple(name.strip() for name in text.split(","))
    if "" in names:
        raise ValueError("NAME,... with a name before and behind each comma")
    return names


WORLD_HELP = (
    "a world file; the name of a shipped world, or of one in worlds/; or a run (its folder or its "
    "record.h5), to use its world"
)

Whole = Annotated[int, kind(WHOLE)]
Count = Annotated[int, kind(whole(1, 10_000))]
Positive = Annotated[float, kind(real(math.nextafter(0.0, 1.0), allowed="a number greater than 0"))]
Distance = Annotated[float, kind(real(0.0, allowed="a number of 0 or more"))]
Seconds = Annotated[float, kind(real(0.0, 1e9))]
Place = Annotated[tuple[float, float], kind(pair, allow_leading_hyphen=True)]

Seeds = Annotated[range, kind(seed_range)]
Words = Annotated[tuple[str, ...], kind(words)]
File = Annotated[Path, kind(path)]
RecordFile = Annotated[Path, kind(record_file)]
Output = Annotated[Path, kind(path, "-o", "--output")]
Workers = Annotated[int, kind(whole(1, 1024))]

World = Annotated[str, Parameter(help=WORLD_HELP, metavar="WORLD")]
Worlds = Annotated[str, Parameter(help=WORLD_HELP, metavar="WORLD...", required=True)]
RECORD_HELP = "a run: its folder or its record.h5"
Record = Annotated[RecordFile, Parameter(help=RECORD_HELP, metavar="RECORD")]
JSON_HELP = "write everything to FILE (-: standard output) as JSON"
JsonFile = Annotated[
    Path, kind(json_file, help=JSON_HELP, metavar="FILE", allow_leading_hyphen=True)
]
JsonFlag = Annotated[bool, Parameter(help="print everything as JSON instead")]
Out = Annotated[TextIO, Parameter(parse=False)]
"""Standard output, for the JSON of a command; what it prints otherwise goes by `print`"""


@Parameter(name="*")
@dataclass(frozen=True)
class Changes:
    """What the command line changes in a world before it is run.

    options:
      --seed N  seed, instead of the world's own
      --controller NAME  use this controller instead of the world's: a registered one (physim list),
          or your own as module:Class; robots with a controller of their own keep it
      --traceback  if your own code fails, show the full traceback
      --set KEY=VALUE  change one key of the world, e.g. robots.0.limits.v=1.2, or remove one, e.g.
          formation=null (may be repeated)
    """

    seed: Whole | None = None
    controller: str | None = None
    traceback: bool = False
    set: tuple[str, ...] = ()

    @property
    def reading(self) -> dict[str, Any]:
        """What `physim.world.file.read_world` takes of it."""
        return {"overrides": self.set, "controller": self.controller}

    @property
    def words(self) -> list[str]:
        """Controller and values as they are typed; not the seed."""
        named = ["--controller", self.controller] if self.controller else []
        return [*named, *(word for one in self.set for word in ("--set", one))]


AS_IT_IS = Changes()
