"""The parser of all commands; their arguments are in `physim.cli.arguments`."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any, NoReturn

from physim.cli import mistakes

DESCRIPTION = """\
Run worlds of polygon robots in corridors on real rigid-body physics, and see
what happened.

see a run:
  physim list                        worlds and controllers that come with it
  physim run three_robots            run one: record, video, summary in runs/
make a world of your own:
  physim new my_world                one to begin with, every key explained
  physim import plan.svg -o my.yaml  one from a track, map, drawing, polygons
  physim check my_world.yaml         its faults, and the room on each path
  physim preview my_world.yaml       a picture of it, before anything runs
look at what a run recorded (RECORD is runs/NAME-SEED/record.h5):
  physim summary RECORD              contacts, distances, collision times
  physim plot RECORD                 the same as pictures
  physim video RECORD                the video again, slower or faster
judge a controller, and what its runs show:
  physim check-controller my:Mine    does it keep to what every run relies on?
  physim validate RECORD             contacts, exact checks, responsibility
  physim crashtest                   does the engine agree with the analysis?
  physim reproduce                   the figures of the paper, measured again
"""

EPILOG = """\
exit codes:
  0    done, and nothing is wrong
  1    ran, but an expectation failed or there was contact (run, validate)
  2    bad input, or no place to write to: a line a fault says where and what
  3    the checks disagree with each other (validate, crashtest)
  70   a fault in physim itself, after its traceback: please report it
  130  interrupted (Ctrl-C)

physim COMMAND --help tells the options of a command, its exit codes and examples.
"""


class Parser(argparse.ArgumentParser):
    """Argument parser whose errors are one line, with the way to the help."""

    def error(self, message: str) -> NoReturn:
        """Print one line and exit with 2."""
        mistakes.refuse(mistakes.told(message, self), self.prog)

    def parse_known_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: Any = None
    ) -> tuple[Any, list[str]]:
        """As argparse does, but each command itself refuses what it does not know."""
        found, extra = super().parse_known_args(args, namespace)
        if extra:
            mistakes.refuse(mistakes.unknown(extra, self), self.prog)
        return found, extra


class TopParser(Parser):
    """The parser of the commands: what stands before a command is its own."""

    def parse_known_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: Any = None
    ) -> tuple[Any, list[str]]:
        """Refuse options of commands that stand before the command."""
        import sys

        args = sys.argv[1:] if args is None else list(args)
        own = mistakes.options_of(self)
        if args and args[0].startswith("-") and not any(o.startswith(args[0]) for o in own):
            option = mistakes.shown(args[0].partition("=")[0])
            told = f"{option}: stands before the command; write physim COMMAND ... {option}"
            mistakes.refuse(told, self.prog)
        return super().parse_known_args(args, namespace)


def build_parser() -> argparse.ArgumentParser:
    """Parser of all commands; each sets ``action`` to the function that does it, else None."""
    from physim._version import __version__
    from physim.cli.arguments import add_commands

    raw = argparse.RawDescriptionHelpFormatter
    parser = TopParser("physim", description=DESCRIPTION, epilog=EPILOG, formatter_class=raw)
    parser.add_argument("--version", action="version", version=f"physim {__version__}")
    parser.set_defaults(action=None)
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", parser_class=Parser)
    add_commands(commands)
    return parser
