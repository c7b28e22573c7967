"""Worlds tried on the command line: a trial with its bar, and what is said of a world imported."""

from __future__ import annotations

from pathlib import Path

from physim.analysis.trial import Fact, Trial, try_world
from physim.cli.progress import Bar, interrupts
from physim.errors import ControllerError, PhysimError
from physim.world import World
from physim.world.checks import Finding, check_world


def tried(world: World, quiet: bool, trusted: bool = False) -> Trial:
    """A trial of a world, see `try_world`; Ctrl-C raises KeyboardInterrupt."""
    bar = Bar("trying it", world.time.duration, "s", quiet)
    try:
        with interrupts() as interrupt, bar:
            progress = bar.simulated if bar.visible else None
            trial = try_world(world, trusted=trusted, stop=interrupt, progress=progress)
    except ControllerError as error:
        return Trial("tried, not to the end", (Fact(("controller",), str(error), ""),))
    except PhysimError as error:  # as of a record too large for the memory
        return Trial(f"not tried: {error}")
    if interrupt():
        raise KeyboardInterrupt
    return trial


def judge(output: Path, world: World, lanes: int, try_it: bool) -> None:
    """Say what checks and a trial have found; Ctrl-C only ends that, for the world is there."""
    try:
        for line in _doubts(output, lanes):
            print(line)
        if try_it:
            trial = tried(world, quiet=False)
            print(trial.line)
            for fact in trial.facts:
                print(f"  WARNING: {fact.fault}")
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
