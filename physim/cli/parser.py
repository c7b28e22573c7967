"""Arguments of every command, and the help that teaches them."""

from __future__ import annotations

import argparse
import re
import sys
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

DESCRIPTION = """\
Run corridor worlds of polygon robots on real rigid-body physics, and see what happened.

  physim list                     shipped worlds and controllers
  physim run ten_robots           run one: record, video and summary in runs/
  physim run my_world.yaml        run your own
  physim validate ten_robots      judge its safety: contacts, exact checks, who was responsible
"""

RUN_EPILOG = """\
exit codes:
  0    ran, and everything under "expect:" in the world held
  1    ran, but an expectation failed
  2    bad input: one message says what and where
  130  interrupted (Ctrl-C): record and video so far are complete and readable

examples:
  physim run ten_robots
  physim run ten_robots --seed 3 --no-video -o /tmp/seed3
  physim run my_world.yaml --set time.duration=20.0 --set controller.beta=0.3
  physim run my_world.yaml --controller my_module:MyController
"""

CRASHTEST_EPILOG = """\
exit codes:
  0    no case is unexplained
  2    bad input
  3    engine and analysis disagree: every unexplained case is told and written as a world
  130  interrupted (Ctrl-C): the cases so far are told

examples:
  physim crashtest
  physim crashtest --cases 100000 --seed 1 --json crashtest.json
"""

LARGEST_NUMBER = 10**15

VALIDATE_EPILOG = """\
exit codes:
  0    contact-free, and physics and geometry agree at every step
  1    contacts
  2    bad input: one message says what and where
  3    the checks disagree: something is wrong with physics, geometry or the record
  130  interrupted (Ctrl-C)

examples:
  physim validate runs/ten_robots-7/record.h5
  physim validate three_robots --controller path_following
  physim validate my_world.yaml --seeds 1:101 --json seeds.json
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

    raw = argparse.RawDescriptionHelpFormatter
    parser = Parser("physim", description=DESCRIPTION, formatter_class=raw)
    parser.add_argument("--version", action="version", version=f"physim {VERSION}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)

    run = commands.add_parser(
        "run",
        help="run a world: record, video and summary",
        description="Run a world and write DIR/record.h5, DIR/video.mp4 and DIR/summary.json.",
        epilog=RUN_EPILOG,
        formatter_class=raw,
    )
    run.add_argument("world", metavar="WORLD", help="a world file, or the name of a shipped world")
    run.add_argument(
        "-o", "--output", type=Path, metavar="DIR", help="output folder (default: runs/NAME-SEED)"
    )
    run.add_argument("--force", action="store_true", help="write over an earlier run in DIR")
    run.add_argument("--seed", type=_whole, metavar="N", help="seed, instead of the world's own")
    run.add_argument(
        "--controller",
        metavar="NAME",
        help="a registered controller (physim list) or your own as module:Class",
    )
    run.add_argument(
        "--set",
        dest="overrides",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="change one value of the world, e.g. robots.0.limits.v=1.2 (may be repeated)",
    )
    run.add_argument("--no-video", action="store_true", help="leave the video out")
    run.add_argument("--quiet", action="store_true", help="no progress bar and no table")
    run.set_defaults(action=_lazy("physim.cli.run", "run"))

    video = commands.add_parser(
        "video", help="make the video of a record", description="Make the video of a record."
    )
    video.add_argument("record", metavar="RECORD", type=Path, help="record.h5 of a run")
    video.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="default: video.mp4 beside the record"
    )
    video.add_argument("--force", action="store_true", help="write over an existing file")
    video.add_argument("--fps", type=_whole, default=25, metavar="N", help="frames a second (25)")
    video.add_argument(
        "--speed",
        type=_positive,
        metavar="X",
        help="simulated seconds a second of video (default: chosen to last at most 80 s)",
    )
    video.add_argument("--quiet", action="store_true", help="no progress bar")
    video.set_defaults(action=_lazy("physim.cli.video", "video"))

    summary = commands.add_parser(
        "summary",
        help="summarise a record",
        description="Contacts, distances, collision times, formation errors and modes of a record.",
    )
    summary.add_argument("record", metavar="RECORD", type=Path, help="record.h5 of a run")
    summary.add_argument("--json", action="store_true", help="print JSON instead of a table")
    summary.set_defaults(action=_lazy("physim.cli.summary", "summary"))

    _add_validate(commands)
    _add_crashtest(commands)
    _add_plot(commands)

    listing = commands.add_parser(
        "list",
        help="list shipped worlds and controllers",
        description="List the shipped worlds and the registered controllers, a line each.",
    )
    listing.add_argument("--json", action="store_true", help="print JSON instead of a table")
    listing.set_defaults(action=_lazy("physim.cli.listing", "listing"))
    return parser


def _add_validate(commands: Any) -> None:
    """Arguments of ``physim validate``."""
    validate = commands.add_parser(
        "validate",
        help="judge a run: physical contacts, exact checks, who was responsible",
        description="Hold the physical contacts of a run against exact distances and collision "
        "times, and report every contact: who, where, and who was responsible.",
        epilog=VALIDATE_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    validate.add_argument(
        "given", metavar="WORLD|RECORD", help="a record.h5, or a world to run and judge"
    )
    validate.add_argument("--json", type=Path, metavar="FILE", help="write everything as JSON")
    validate.add_argument(
        "--seeds", type=_range, metavar="A:B", help="repeat over seeds A to B - 1"
    )
    validate.add_argument("--world", metavar="W", help="check that the record was made from W")
    validate.add_argument("--seed", type=_whole, metavar="N", help="seed of a world")
    validate.add_argument(
        "--controller", metavar="NAME", help="controller of a world, as in physim run"
    )
    validate.add_argument(
        "--set",
        dest="overrides",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="change one value of a world, as in physim run (may be repeated)",
    )
    validate.add_argument("--quiet", action="store_true", help="print the verdict alone")
    validate.set_defaults(action=_lazy("physim.cli.validate", "validate_command"))


def _add_crashtest(commands: Any) -> None:
    crash = commands.add_parser(
        "crashtest",
        help="throw random shapes at each other: engine against analysis",
        description="Throw random footprints at each other and at walls, at constant (v, omega), "
        "and compare the first physical contact of each throw with its collision time. Every case "
        "on which they differ for no known reason is written as a world that physim run replays.",
        epilog=CRASHTEST_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    crash.add_argument(
        "--cases", type=_whole, default=10_000, metavar="N", help="number of throws (10000)"
    )
    crash.add_argument("--seed", type=_whole, default=0, metavar="S", help="of the throws (0)")
    crash.add_argument("--json", type=Path, metavar="FILE", help="write the figures as JSON")
    crash.add_argument(
        "-o", "--output", type=Path, metavar="DIR",
        help="folder for the worlds of unexplained cases (default: crashtest-SEED)",
    )  # fmt: skip
    crash.add_argument("--quiet", action="store_true", help="no progress bar and no table")
    crash.set_defaults(action=_lazy("physim.cli.crashtest", "crashtest"))


def _add_plot(commands: Any) -> None:
    plot = commands.add_parser(
        "plot",
        help="draw pictures of a record",
        description="Draw distances and collision times over time, and predicted against actual "
        "times to contact, from a record.",
    )
    plot.add_argument("record", metavar="RECORD", type=Path, help="record.h5 of a run")
    plot.add_argument(
        "--only", metavar="NAMES",
        help="pictures to draw, with commas between: distances, prediction (default: all)",
    )  # fmt: skip
    plot.add_argument(
        "-o", "--output", type=Path, metavar="DIR", help="default: the folder of the record"
    )
    plot.add_argument("--format", choices=("png", "svg", "pdf"), default="png", help="(png)")
    plot.add_argument("--force", action="store_true", help="write over existing pictures")
    plot.set_defaults(action=_lazy("physim.cli.plot", "plot"))


def _lazy(module: str, name: str) -> Any:
    """Import the command's module only when it is asked for: ``--help`` stays fast."""

    def action(options: argparse.Namespace) -> int:
        code: int = getattr(import_module(module), name)(options)
        return code

    return action


def _words(parser: argparse.ArgumentParser) -> set[str]:
    """Every option and command of a parser and of its commands."""
    words = {option for action in parser._actions for option in action.option_strings}
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, command in action.choices.items():
                words |= {name} | _words(command)
    return words


def _whole(text: str) -> int:
    value = int(text) if text.isascii() and text.isdigit() and len(text) < 19 else -1
    if not 0 <= value <= LARGEST_NUMBER:
        raise argparse.ArgumentTypeError(f'"{text}" is not a whole number from 0 to 10^15')
    return value


def _range(text: str) -> tuple[int, int]:
    first, colon, last = text.partition(":")
    if not colon or not first or not last:
        raise argparse.ArgumentTypeError(f'"{text}" is not A:B, two whole numbers')
    ends = (_whole(first), _whole(last))
    if ends[1] <= ends[0]:
        message = f'"{text}" holds no seed: A:B goes from A to B - 1'
        raise argparse.ArgumentTypeError(message)
    return ends


def _positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f'"{text}" is not a number greater than 0')
    return value
