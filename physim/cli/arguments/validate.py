"""Arguments of ``physim validate``."""

from __future__ import annotations

from pathlib import Path

from physim.cli.arguments.commands import Commands, Wrapped, add_changes, lazy
from physim.cli.arguments.types import seed_range

EPILOG = """\
exit codes:
  0    contact-free and as the world expects, and physics and geometry agree at every step
  1    contacts, or not as the world expects
  2    bad input: one message says what and where
  3    the checks disagree: something is wrong with physics, geometry or the record
  130  interrupted (Ctrl-C): with --seeds, the seeds so far are told and written

examples:
  physim validate runs/ten_robots-21/record.h5
  physim validate runs/ten_robots-21/record.h5 --rerun --world ten_robots
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
        formatter_class=Wrapped,
    )
    validate.add_argument(
        "given", metavar="WORLD|RECORD",
        help="record.h5 of a run; or a world file or the name of a shipped world, to run and judge",
    )  # fmt: skip
    validate.add_argument(
        "--json",
        type=Path,
        metavar="FILE",
        help="write everything to FILE (-: standard output) as JSON",
    )
    validate.add_argument("--force", action="store_true", help="write over an existing FILE")
    validate.add_argument(
        "--world", metavar="WORLD", help="check that the record was made from WORLD"
    )
    validate.add_argument(
        "--seeds", type=seed_range, metavar="A:B",
        help="run the world with each of the seeds A to B - 1, and tell how many are contact-free",
    )  # fmt: skip
    validate.add_argument(
        "--rerun", action="store_true",
        help="simulate the world inside RECORD again: does it give this very run?",
    )  # fmt: skip
    add_changes(validate)
    validate.add_argument("--quiet", action="store_true", help="print the verdict alone")
    validate.set_defaults(action=lazy("physim.cli.validate", "validate_command"))
