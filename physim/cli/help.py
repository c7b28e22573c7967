"""Help: one screen of all commands, and a page a command, as plain text."""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Iterable
from typing import TYPE_CHECKING, cast

from physim.cli.commands import GROUPS, HELP, tables

if TYPE_CHECKING:
    from cyclopts import App, Argument, Group

HEAD = "Usage: physim [-h] [--version] COMMAND ...  Simulate robots; judge the runs.\n"
TAIL = """\
exit: 0 success, 1 contact, 2 bad input, 3 disagreement, 70 bug, 130 interrupted
First step: physim run three_robots. Help on a command: physim COMMAND --help
"""
WIDTH = 78
"""Characters of a line"""
LONGEST_NAME = 28
"""Characters of an option beside which its help still stands"""


def overview() -> str:
    """All commands by job, on one screen."""
    text = HEAD
    for title, group in GROUPS.items():
        for name, (_, line) in group.items():
            text += f"{title:<8}{name:<18}{line}\n"
            title = ""
    return text + TAIL


def page(name: str, app: App) -> str:
    """Help of a command: its arguments, its options by sections, and the rest of its docstring."""
    arguments = [
        one for one in app.assemble_argument_collection() if one.parse and not one.children
    ]
    places = [one for one in arguments if one.index is not None]
    usage = " ".join(["Usage: physim", name, "[OPTIONS]", *map(_written, places)])
    what, *rest = inspect.cleandoc(app.default_command.__doc__ or "").split("\n\n")
    told = [block for block in rest if not tables(block)]
    parts = [usage, textwrap.fill(what, WIDTH)]
    if places:
        parts.append(_table("Positional arguments", places))
    sections: dict[str, list[Argument]] = {}
    for one in arguments:
        if one.index is None:
            (group,) = cast("tuple[Group]", one.parameter.group)
            sections.setdefault(group.name, []).append(one)
    for title, members in sections.items():
        parts.append(_table(title, members))
    return "\n\n".join([*parts, *told]) + "\n"


def _table(title: str, arguments: Iterable[Argument]) -> str:
    """A section: in the left column what is typed, in the right one its help."""
    rows = []
    for one in arguments:
        needed = "  [required]" if one.required and one.index is None else ""
        rows.append((_written(one), f"{one.parameter.help}{needed}"))
    if title == "Options":
        rows.append((", ".join(HELP), "show this message and exit"))
    wide = max(len(left) for left, _ in rows if len(left) <= LONGEST_NAME)
    lines = [f"{title}:"]
    for left, right in rows:
        told = textwrap.wrap(right, WIDTH - wide - 4)
        if len(left) > LONGEST_NAME:
            lines.append(f"  {left}")
        else:
            lines.append(f"  {left:<{wide}}  {told.pop(0)}")
        lines += [" " * (wide + 4) + line for line in told]
    return "\n".join(lines)


def _written(argument: Argument) -> str:
    """``-o, --output FILE``, ``--rerun / --no-rerun``, ``WORLD...``."""
    value = argument.parameter.metavar or "|".join(argument.get_choices(force=True) or ())
    if argument.index is not None:
        return value
    between = ", " if argument.names[0].count("-") == 1 else " / "
    return f"{between.join(argument.names)} {value}".rstrip()
