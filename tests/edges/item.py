"""The items and their trials, found by the files of `tests.edges.items`."""

from __future__ import annotations

import pkgutil
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from tests.edges import items
from tests.edges.shell import Shell

Try = Callable[[Shell], None]


@dataclass(frozen=True)
class Item:
    """What is to hold: its number, its module's name, one line, and the trials by name."""

    number: str
    name: str
    line: str
    trials: dict[str, Try]

    def run(self, trial: str) -> None:
        """Run one trial in a new folder; raises AssertionError where it fails."""
        with tempfile.TemporaryDirectory() as folder:
            self.trials[trial](Shell(Path(folder)))


def all_items() -> list[Item]:
    """Every item, by number: whole numbers first, then words."""
    return sorted(_items(), key=lambda item: (_rank(item.number), item.name))


def _items() -> Iterator[Item]:
    for module in pkgutil.iter_modules(items.__path__):
        found = import_module(f"{items.__name__}.{module.name}")
        trials = {
            name.removeprefix("try_"): value
            for name, value in vars(found).items()
            if name.startswith("try_")
        }
        assert trials, f"{module.name} tries nothing"
        line = (found.__doc__ or "").partition("\n")[0]
        yield Item(str(found.NUMBER), module.name, line, trials)


def _rank(number: str) -> tuple[int, str]:
    return (int(number), "") if number.isdecimal() else (1000, number)
