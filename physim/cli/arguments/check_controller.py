"""Arguments of ``physim check-controller``."""

from __future__ import annotations

from physim.cli.arguments.commands import Commands, Wrapped, lazy
from physim.cli.arguments.types import number_from

EPILOG = """\
rules, each finding names the one that is broken:
  raises       decide raises nothing
  decision     it returns a Decision with commands within the limits
  repeats      the same settings, observation and memory give the same decision
  state        nothing is kept on the object, its class or module: that is memory
  order        whoever else is asked, and in whatever order, changes nothing
  memory       the memory handed over is not written into
  copies       memory can be copied and pickled, and a copy does as well
  observation  nothing is written into what is seen
  batch        the batch form, where there is one, decides as the plain form
  batch_order  and does so robot by robot, too

situations beside the worlds: nobody in sight, no wall in sight, at the end of the path, facing
backwards, overlapping

exit codes:
  0    nothing was found
  1    a line a finding: rule, world, robot, time, and what is wrong
  2    bad input: one line says what and where
  130  interrupted (Ctrl-C)

examples:
  physim check-controller my_module:MyController
  physim check-controller my_module:MyController --world my_world.yaml --seconds 20
  physim check-controller mode_switching --set controller.look_ahead=3.0 --json
"""


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    check = commands.add_parser(
        "check-controller",
        help="find out whether a controller keeps to what every run relies on",
        description="Let a controller decide for the first seconds of worlds and in awkward "
        "situations, ask it for the same decisions again in other ways, and tell what comes out "
        "otherwise. Worlds whose robots it refuses are told and left out.",
        epilog=EPILOG,
        formatter_class=Wrapped,
    )
    check.add_argument(
        "controller",
        metavar="CONTROLLER",
        help="a registered controller (physim list) or your own as module:Class",
    )
    check.add_argument(
        "--world",
        dest="worlds",
        action="append",
        metavar="WORLD",
        help="a world file, or the name of a shipped world, instead of all shipped worlds (may be "
        "repeated)",
    )
    check.add_argument(
        "--seconds", type=number_from(0.001, 1e6), metavar="S",
        help="simulated time of each world [s] (2)",
    )  # fmt: skip
    check.add_argument(
        "--set",
        dest="overrides",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="a setting of the controller, instead of those in the worlds, e.g. "
        "controller.look_ahead=3.0 (may be repeated)",
    )
    check.add_argument("--json", action="store_true", help="print everything as JSON instead")
    check.set_defaults(action=lazy("physim.cli.check_controller", "check_controller_command"))
