"""A second process that compiles, once after an installation or an edit.

The first, which is to run, compiles the decisions. Meanwhile the second one, on another core,
compiles nearly all else that a run needs, which the first then loads from disk; and while the first
runs, what validate and reproduce need. It ends with the command, if not before.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
from contextlib import suppress
from multiprocessing.connection import Connection

from physim.campaigns.pool import WARMING, begun_apart, settle, worker_count
from physim.cli.progress import announce_compiling
from physim.compiled import is_kept
from physim.geometry.clearance import fill

WORLD = "three_robots"
CONTROLLER = "constant"
"""Makes no decision that would have to be compiled."""
SECONDS = 0.2
"""[s] simulated"""


class SecondProcess:
    """Compiles what the first one does not; ``controller`` names the one that is to run."""

    def __init__(self, controller: str) -> None:
        context = multiprocessing.get_context("spawn")
        self._line, theirs = context.Pipe()
        work = context.Process(
            target=compile_rest, args=(theirs, controller), name=WARMING, daemon=True
        )
        with begun_apart():
            work.start()
        theirs.close()

    def wait(self) -> None:
        """Say that the decisions are on disk; return when all else that a run needs is there, too.

        Or when nothing more comes.
        """
        with suppress(EOFError, OSError):
            self._line.send(None)
            self._line.recv()


def second_process(controller: str) -> SecondProcess | None:
    """A second process that compiles; None where it would not help."""
    if worker_count() < 2 or not is_kept(fill):
        return None
    try:
        return SecondProcess(controller)
    except OSError:  # there may be no room for one
        return None


def compile_rest(line: Connection, controller: str) -> None:
    """What the second process does; it prints nothing, and what fails is left to the first."""
    from physim.frontend import without_collector

    silent = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silent, 1)
    os.dup2(silent, 2)
    with suppress(KeyboardInterrupt, EOFError), without_collector():
        settle()
        warm_up_motion_alone()
        line.send(None)
        line.recv()
        warm_up_checks(controller)


def warm_up_motion_alone() -> None:
    """Compile what a run needs beside its decisions."""
    from physim.simulation.run import warm_up_motion
    from physim.world.file import load_world
    from physim.world.layout.scene_builder import build_scene

    warm_up_motion(build_scene(load_world(WORLD).changed(controller={"type": CONTROLLER})))


def warm_up_checks(controller: str) -> None:
    """Compile what validate and reproduce need; crashtest needs much that nothing else does."""
    from physim.analysis.metrics.distances import shortest_pair_collision_time
    from physim.analysis.validation import validate
    from physim.simulation.run import simulate
    from physim.world.file import load_world

    world = load_world(WORLD, overrides=[f"time.duration={SECONDS}"])
    with simulate(world.changed(controller={"type": controller})) as record:
        validate(record, rerun=False)
        shortest_pair_collision_time(record)


def checks_ready(quiet: bool) -> None:
    """See that the kernels of a validation are compiled, or say that they are to be."""
    from physim.analysis import validation

    if not validation.is_warm():
        finish(quiet)
    if not validation.is_warm():
        announce_compiling("the checks of the validation", quiet)


def finish(quiet: bool) -> None:
    """Wait for the second process, if there is one; Ctrl-C ends it."""
    for process in multiprocessing.active_children():
        if process.name == WARMING:
            if not quiet:
                text = "compiling what validate and reproduce need, too ..."
                print(text, file=sys.stderr, flush=True)
            with suppress(KeyboardInterrupt):
                process.join()
