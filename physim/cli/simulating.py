"""Runs on the command line: a progress bar, Ctrl-C, warnings."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from physim.cli.options import Changes
from physim.cli.progress import Bar
from physim.errors import WorldError
from physim.terminal import interrupts

if TYPE_CHECKING:
    from physim.parts.controller import Controller
    from physim.simulation.loop import Simulation


def tell(lines: Iterable[str]) -> None:
    """Say what is to be noted, a line each, even to those who want quiet.

    The run may not be the one that they expect.
    """
    for line in lines:
        print(f"WARNING  {line}", file=sys.stderr, flush=True)


def ready(given: str, changes: Changes, quiet: bool, path: Path | None = None) -> Simulation:
    """Simulation of a world with changes.

    A run too large for the disk of ``path``, or, where that is None, for memory, is refused. A
    robot that counts from the start as beyond a wall is told of: it might be said to have arrived.
    """
    from physim.parts.declarations import Declared
    from physim.parts.registry import made_controller
    from physim.simulation.loop import Simulation
    from physim.simulation.recorder import check_room
    from physim.world.checks.starts import check_walled_off
    from physim.world.file import read_world
    from physim.world.layout.scene_builder import build_scene

    world, document = read_world(given, **changes.reading)
    tell(document.lines(document.warnings))
    try:
        scene = build_scene(world, changes.seed)
    except WorldError as error:
        raise document.error(error.faults) from None
    tell(document.lines(check_walled_off(scene.layout)))

    def controller() -> Controller:
        return made_controller(world, trusted=changes.controller is not None)

    Declared.of(controller())  # refuses what cannot be
    check_room(scene, world.time.record_every, path)
    return Simulation(scene, controller=controller())


Found = TypeVar("Found")


def to_the_end(run: Callable[..., Found], title: str, seconds: float, quiet: bool) -> Found:
    """What ``run(stop=..., progress=...)`` gives, with a bar of the ``seconds`` simulated.

    Ctrl-C raises KeyboardInterrupt, after the step that is under way: in the middle of it the
    engine would swallow it.
    """
    with interrupts() as interrupt, Bar(title, seconds, "s at most", quiet) as bar:
        how: dict[str, Any] = {"progress": bar.simulated} if bar.visible else {}
        found = run(stop=interrupt, **how)
    if interrupt():
        raise KeyboardInterrupt
    return found
