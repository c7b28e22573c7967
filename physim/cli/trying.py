"""What is said of a world just imported: by its checks, and by a run of it.

A run tells whether all robots arrive, and without contact.
"""

from __future__ import annotations

from pathlib import Path

from physim.analysis.metrics.contacts import contact_episodes
from physim.analysis.metrics.progress import absent
from physim.cli.parser import Options
from physim.cli.progress import Bar, interrupts
from physim.errors import PhysimError, plural
from physim.escaping import escaped
from physim.parts.registry import CONTROLLER, make_part
from physim.record import Record
from physim.simulation.loop import Simulation
from physim.simulation.run import is_warm, record_run
from physim.world import World
from physim.world.checks import Finding, check_world
from physim.world.layout.scene_builder import build_scene

MOST_STEPS = 100_000
"""Steps of a run that are tried, of ten robots at most as many: some 8 s"""
MOST_POINTS = 10_000
"""Points of walls of a world that is tried: reading more takes long enough"""
MOST_NAMED = 3
"""Robots that have not arrived which are named"""


def judge(options: Options, world: World) -> None:
    """Say what checks and a run have found; Ctrl-C only ends that, for the world is there."""
    try:
        for line in _doubts(options.output, options.lanes or 1):
            print(line)
        for line in () if options.untried else tried(world, options.quiet):
            print(line)
    except KeyboardInterrupt:
        print("interrupted: neither checked nor tried to the end")


def _doubts(world: Path, lanes: int) -> list[str]:
    """What `physim check` says of a world just written, what concerns the whole group first."""
    found = check_world(world)
    order = ("formation", "robots")

    def rank(finding: Finding) -> int:
        return next((k for k, key in enumerate(order) if finding.key.startswith(key)), len(order))

    lines = [f"  error: {one}" for one in found.errors]
    lines += [f"  {one}" for one in sorted(found.warnings, key=rank)]
    said = (*found.errors, *found.warnings)
    if lanes > 1 and any(one.key.startswith("formation") for one in said):
        lines.append("  --lanes 1 has fewer places where paths come close")
    return ["physim check reports:", *lines] if lines else []


def tried(world: World, quiet: bool) -> list[str]:
    """Lines on a run of ``world``, which Ctrl-C ends; why there is none where it takes long."""
    steps = round(world.time.duration / world.time.step)
    solids = [getattr(one, "outline", one) for one in world.obstacles or ()]
    points = sum(len(line) for line in (*(world.boundaries or ()), *solids))
    if steps * max(len(world.robots) / 10.0, 1.0) > MOST_STEPS or points > MOST_POINTS:
        what = f"{steps:,} steps of {plural(len(world.robots), 'robot')}"
        if points > MOST_POINTS:
            what += f" between walls of {points:,} points"
        return [f"not tried: {what} take long; physim run shows if all arrive"]
    if not is_warm():
        return ["not tried: nothing is compiled yet; physim run does it, and shows if all arrive"]
    controller = make_part(CONTROLLER, world.controller.type, world.controller.settings)
    simulation = Simulation(build_scene(world), controller=controller)
    bar = Bar("trying it", world.time.duration, "s", quiet)
    try:
        with interrupts() as interrupt, bar:
            record = record_run(simulation, stop=interrupt, progress=bar.simulated)
    except PhysimError as error:  # the world is written, and may be right all the same
        return [f"not tried: {error}"]
    with record:
        return [f"tried for {record.steps_run * record.dt:.1f} s: {_found(record)}"]


def _found(record: Record) -> str:
    """What a run has shown: who has not arrived, and contacts."""
    left = absent(record)
    if record.ended == "interrupted":
        said = "interrupted"
    elif not left:
        said = "all robots arrive"
    else:
        named = [
            f"{escaped(record.names[one.robot])} {one.short:.2f} m short"
            for one in left[:MOST_NAMED]
        ]
        more = f" and {len(left) - MOST_NAMED} more" if len(left) > MOST_NAMED else ""
        do = "does" if len(left) == 1 else "do"
        said = f"WARNING: {len(left)} of {record.robots} robots {do} not arrive, "
        said += f"{', '.join(named)}{more}"
    met = contact_episodes(record)
    if not met:
        return f"{said}; no contact"
    first = met[0]
    bodies = " and ".join(escaped(record.bodies[k].name) for k in (first.a, first.b))
    return (
        f"{said}; WARNING: {plural(len(met), 'contact')}, the first after {first.time:.1f} s, of "
        f"{bodies}"
    )
