"""What a search leaves behind: worlds that anybody can run, and the record of the worst."""

from __future__ import annotations

import os
import shlex
from collections.abc import Callable, Sequence
from pathlib import Path

from physim.campaigns.falsify.evaluate import StoppedError, controller_of, never
from physim.campaigns.falsify.robustness import Judged, judged
from physim.errors import PhysimError
from physim.record import Record
from physim.simulation.loop import Simulation
from physim.simulation.recorder import SaveAt
from physim.simulation.run import record_run
from physim.world import World
from physim.world.file import read_world
from physim.world.yaml_text import write_atomically

WORST, FOUND, RECORD, VIDEO, STORY = FILES = (
    "worst.yaml", "as_found.yaml", "record.h5", "video.mp4", "story.txt",
)  # fmt: skip
"""The worst world, shrunk where it fails; that world before it was shrunk; its run, its film, and
a paragraph about it."""
COLUMNS = 98


def headline(result: Judged) -> str:
    """What happens, in a line: who touch when, or how near who come."""
    if result.touched is not None:
        one, other = result.touched.pair
        return f"{one} and {other} touch at {result.touched.time:.2f} s"
    one, other = result.pair
    if not one:
        return "nothing comes near anything"
    return f"nothing touches; {one} and {other} come within {result.clearance:.4g} m at " \
           f"{result.time:.2f} s"  # fmt: skip


def write_world(
    path: Path, world: World, result: Judged, said: Sequence[str], controller: str | None
) -> None:
    """Write a world with a head that says what happens in it, how it was found, how to see it.

    ``said`` are further lines of the head. Raises PhysimError where it cannot be written.
    """
    named = ["--controller", controller] if controller and ":" in controller else []
    run = shlex.join(["physim", "run", path.name, *named])
    head = headline(result)
    lines = [
        f"{head[:1].upper() if head.startswith('nothing') else head[:1]}{head[1:]}.",
        *said,
        f"To see it: {run}",
    ]
    head = "".join(f"# {line}\n" for line in lines)
    write_atomically(path, head + world.to_yaml())


def run_written(
    path: Path, expected: Judged, controller: str | None, stop: Callable[[], bool] = never
) -> Record:
    """Read a world that was written and run it once more; its record goes beside it.

    Raises PhysimError where that run is not what the search saw: then something in it, as a
    controller of one's own, is not decided by world and seed. Raises StoppedError as told.
    """
    world, _ = read_world(path, controller=controller)
    simulation = Simulation(world, controller=controller_of(world))
    record = record_run(
        simulation, save=SaveAt(every=1), path=path.with_name(RECORD), overwrite=True, stop=stop
    )
    if record.ended == "interrupted":
        record.close()
        os.unlink(path.with_name(RECORD))
        raise StoppedError
    result = judged(record)
    if result != expected:
        record.close()
        raise PhysimError(
            f"{path}: run once more, {headline(result)}; the search saw that {headline(expected)}. "
            "Something in this run is not decided by its world and seed: is there anything random, "
            "or remembered from run to run, in the controller?"
        )
    return record
