"""What the arguments of many commands need: where they are added, late imports, shared options."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

from physim.cli.arguments.types import whole

if TYPE_CHECKING:
    Commands = argparse._SubParsersAction[Any]
else:
    Commands = argparse._SubParsersAction


class Wrapped(argparse.RawDescriptionHelpFormatter):
    """Keeps the lines of a text that has several, and wraps one that is a single line."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        if "\n" in text:
            return super()._fill_text(text, width, indent)
        return argparse.HelpFormatter._fill_text(self, text, width, indent)


def lazy(module: str, name: str) -> Callable[[argparse.Namespace], int]:
    """Import the command's module only when it is asked for: ``--help`` stays fast."""

    def action(options: argparse.Namespace) -> int:
        code: int = getattr(import_module(module), name)(options)
        return code

    return action


def add_changes(command: argparse.ArgumentParser, each: str = "the world") -> None:
    """Add the options that change a world before it is run: seed, controller and values."""
    command.add_argument("--seed", type=whole, metavar="N", help="seed, instead of the world's own")
    command.add_argument(
        "--controller",
        metavar="NAME",
        help="a registered controller (physim list) or your own as module:Class",
    )
    add_overrides(command, each)


def add_overrides(command: argparse.ArgumentParser, each: str = "the world") -> None:
    """Add ``--set``."""
    command.add_argument(
        "--set",
        dest="overrides",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help=f"change one value of {each}, e.g. robots.0.limits.v=1.2, or leave one out, e.g. "
        "formation=null (may be repeated)",
    )
