"""Arguments of every command, a module each; they import nothing heavy, so ``--help`` is fast."""

from __future__ import annotations

from importlib import import_module

from physim.cli.arguments.commands import Commands

IN_ORDER = (
    "listing",
    "run",
    "new",
    "importing",
    "check",
    "check_controller",
    "preview",
    "summary",
    "plot",
    "video",
    "validate",
    "crashtest",
    "reproduce",
    "schema",
)
"""Modules of this package, in the order in which the help tells their commands."""


def add_commands(commands: Commands) -> None:
    """Add every command."""
    for name in IN_ORDER:
        import_module(f"{__name__}.{name}").add(commands)
