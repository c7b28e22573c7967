"""Arguments of ``physim validate``."""

from __future__ import annotations

import argparse
from pathlib import Path

from physim.cli.arguments.commands import Commands, lazy
from physim.cli.arguments.types import seed_range, whole

EPILOG = """\
exit codes:
  0    contact-free, and physics and geometry agree at every step
  1    contacts
  2    bad input: one message says what and where
  3    the checks disagree: something is wrong with physics, geometry or the record
  130  interrupted (Ctrl-C)

examples:
  physim validate runs/ten_robots-21/record.h5
  physim validate three_robots --controller path_following
  physim validate my_world.yaml --seeds 1:101 --json seeds.json
"""


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    validate = commands.add_parser(
        "validate",
        help="judge a run: physical contacts, exact checks, who was responsible",
        description="Hold the physical contacts of a run against exact distances and collision "
        "times, and report every contact: who, where, and who was responsible.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    validate.add_argument(
        "given", metavar="WORLD|RECORD", help="a record.h5, or a world to run and judge"
    )
    validate.add_argument("--json", type=Path, metavar="FILE", help="write everything as JSON")
    validate.add_argument(
        "--seeds", type=seed_range, metavar="A:B", help="repeat over seeds A to B - 1"
    )
    validate.add_argument("--world", metavar="W", help="check that the record was made from W")
    validate.add_argument("--seed", type=whole, metavar="N", help="seed of a world")
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
    validate.set_defaults(action=lazy("physim.cli.validate", "validate_command"))
