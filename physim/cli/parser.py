"""The parser of all commands; their arguments are in `physim.cli.arguments`."""

from __future__ import annotations

import argparse
import re
import sys
from typing import NoReturn

DESCRIPTION = """\
Run corridor worlds of polygon robots on real rigid-body physics, and see what happened.

  physim list                     shipped worlds and controllers
  physim run ten_robots           run one: record, video and summary in runs/
  physim new my_world             write a world to begin with, then run it
  physim validate ten_robots      judge its safety: contacts, exact checks, who was responsible
"""


class Parser(argparse.ArgumentParser):
    """Argument parser whose errors are one line, with the way to the help."""

    def error(self, message: str) -> NoReturn:
        """Print one line, with the nearest option or command, and exit with 2."""
        from physim.errors import nearest

        unknown = re.match(r"unrecognized arguments: (-\S+)|.*invalid choice: '(\w+)'", message)
        close = nearest(unknown[1] or unknown[2], sorted(_words(self))) if unknown else ""
        print(f"{self.prog}: {message}{close} (see {self.prog} --help)", file=sys.stderr)
        sys.exit(2)


def build_parser() -> argparse.ArgumentParser:
    """Parser of all commands; each sets ``action`` to the function that does it."""
    from physim._version import VERSION
    from physim.cli.arguments import add_commands

    raw = argparse.RawDescriptionHelpFormatter
    parser = Parser("physim", description=DESCRIPTION, formatter_class=raw)
    parser.add_argument("--version", action="version", version=f"physim {VERSION}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    add_commands(commands)
    return parser


def _words(parser: argparse.ArgumentParser) -> set[str]:
    """Every option, value of a choice and command of a parser and of its commands."""
    words = {option for action in parser._actions for option in action.option_strings}
    for action in parser._actions:
        words |= {str(choice) for choice in action.choices or ()}
        if isinstance(action, argparse._SubParsersAction):
            for name, command in action.choices.items():
                words |= {name} | _words(command)
    return words
