"""What the arguments of every command need: the place they are added to, and late imports."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    Commands = argparse._SubParsersAction[Any]
else:
    Commands = argparse._SubParsersAction


def lazy(module: str, name: str) -> Callable[[argparse.Namespace], int]:
    """Import the command's module only when it is asked for: ``--help`` stays fast."""

    def action(options: argparse.Namespace) -> int:
        code: int = getattr(import_module(module), name)(options)
        return code

    return action
