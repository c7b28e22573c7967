"""What a search leaves behind: worlds that anybody can run, the record of the worst, and what was
found in words and as values.
"""

from __future__ import annotations

import os
import shlex
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from physim.analysis.validation import Validation
from physim.analysis.validation.told import sentences, wrapped
from physim.campaigns.falsify.evaluate import Judged, StoppedError, judged
from physim.campaigns.falsify.search import Hunt
from physim.campaigns.falsify.shrink import Shrunk, size_of
from physim.campaigns.falsify.space import Space
from physim.campaigns.pool import never
from physim.errors import PhysimError, plural
from physim.escaping import escaped
from physim.files import write_text
from physim.json_text import json_text
from physim.parts.registry import made_controller
from physim.record import Record
from physim.simulation.loop import Simulation
from physim.simulation.recorder import SaveAt
from physim.simulation.run import record_run
from physim.world import World
from physim.world.file import read_world

WORST, FOUND, RECORD, VIDEO, STORY = FILES = (
    "worst.yaml", "as_found.yaml", "record.h5", "video.mp4", "story.txt",
)  # fmt: skip
"""The worst world, shrunk where it fails; that world before it was shrunk; its run, its film, and
a paragraph about it."""


def headline(result: Judged) -> str:
    """What happens, in a line: who touch when, or how near who come."""
    if result.touched is not None:
        return f"{' and '.join(result.touched.pair)} touch at {result.touched.time:.2f} s"
    if not any(result.pair):
        return "nothing comes near anything"
    pair, within = " and ".join(result.pair), f"{result.clearance:.4g} m at {result.time:.2f} s"
    return f"nothing touches; {pair} come within {within}"


def write_found(
    folder: Path,
    found: Hunt,
    shrunk: Shrunk | None,
    command: str,
    controller: str | None,
    stop: Callable[[], bool] = never,
) -> Record:
    """Write the worst world, and where it was shrunk also as it was found; returns its run.

    ``command`` is what it was found by, ``controller`` the one that the command line named.
    Raises PhysimError as `_run_written`, StoppedError as told.
    """
    assert found.world is not None
    assert found.judged is not None
    said, world, result, file = [f"Found by: {command}"], found.world, found.judged, folder / WORST
    if shrunk is not None:
        _write_world(folder / FOUND, world, result, said, controller)
        said.append(f"{shrunk_text(found, shrunk).capitalize()}.")
        world, result = shrunk.world, shrunk.judged
    _write_world(file, world, result, said, controller)
    return _run_written(file, result, controller, stop)


def _write_world(
    path: Path, world: World, result: Judged, said: Sequence[str], controller: str | None
) -> None:
    """Write a world with a head that says what happens in it, how it was found, how to see it.

    It is named after the file, too: its runs go to a folder of their own.
    """
    own = ["--controller", controller] if controller and ":" in controller else []
    run = shlex.join(["physim", "run", str(path), *own])
    lines = (f"{headline(result)}.".replace("nothing", "Nothing", 1), *said, f"To see it: {run}")
    head = "".join(f"# {escaped(line)}\n" for line in lines)
    named = world.changed(name=f"{world.name}, {path.stem.replace('_', ' ')}")
    write_text(path, head + named.to_yaml())


def _run_written(
    path: Path, expected: Judged, controller: str | None, stop: Callable[[], bool]
) -> Record:
    """Read a world that was written and run it once more; its record goes beside it.

    Raises PhysimError where that run is not what the search saw: then something in it, as a
    controller of one's own, is not decided by world and seed. Raises StoppedError as told.
    """
    world, _ = read_world(path, controller=controller)
    simulation = Simulation(world, controller=made_controller(world, trusted=True))
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


def story(record: Record, found: Validation) -> str:
    """What a record shows, ending in a newline: its first contact, or where two came nearest.

    ``found`` is its validation.
    """
    touches = sorted((*found.contacts, *found.grazes), key=lambda one: one.time)
    said = [f"{headline(judged(record)).replace('nothing', 'Nothing', 1)}."]
    if touches:
        said = sentences(touches[0], found.names, found.run.considered)
        if more := len(touches) - 1:
            after = found.run.seconds - touches[0].time
            said.append(f"{plural(more, 'more contact')} in the {after:.2f} s after it.")
    return "\n".join(wrapped(" ".join(said), "", "")) + "\n"


def found_text(found: Hunt) -> str:
    """What the search found, what it had to leave out, and what that means."""
    lines, worst = [], found.judged
    if found.stopped:
        lines.append(f"interrupted after {found.runs} of {found.budget} runs")
    if worst is not None and worst.failed:
        hard = f", the severest contact at {worst.closing:.2f} m/s"
        times = f"; {found.failures} of {found.runs} runs failed" if found.failures > 1 else ""
        lines.append(f"failure in run {found.run}: {headline(worst)}{hard}{times}")
    elif worst is not None:
        lines.append(
            f"no failure in {found.runs} runs; least clearance {worst.clearance:.4g} m "
            f"({' and '.join(worst.pair)} at {worst.time:.2f} s, run {found.run}), of the world "
            f"itself {found.first:.4g} m. This is no proof that there is none."
        )
    if found.repaired:
        lines.append(
            f"{found.repaired} of {found.runs} starts were moved to where they are allowed before "
            "they were run"
        )
    if found.refused or found.broken:
        lines.append(
            f"{found.refused} worlds refused and {found.broken} runs broken off, which count as "
            f"nothing; the first: {found.reason}"
        )
    return "".join(f"{line}\n" for line in lines)


def shrunk_text(found: Hunt, shrunk: Shrunk) -> str:
    """How much smaller the world has become, and with how many runs."""
    if found.world is None:
        return ""
    before, after = size_of(found.world), size_of(shrunk.world)
    changed = [
        f"{key.replace('_', ' ')} {before[key]:g} to {after[key]:g}"
        for key in before
        if before[key] != after[key]
    ]
    least = "" if shrunk.is_least else "; not to the end, for want of runs"
    return f"shrunk with {shrunk.runs} runs: {', '.join(changed) or 'numbers only'}{least}"


def found_json(space: Space, found: Hunt, shrunk: Shrunk | None, told: str) -> str:
    """What was found, as values; lengths [m], times [s], angles [rad]."""
    tree = {
        "format": "physim-falsify",
        "version": 1,
        "world": space.world.name,
        "seed": space.world.seed,
        "bounds": [one._asdict() for one in space.dimensions],
        "least_gap_at_start_m": float(space.starts.gap.min()),
        "budget": found.budget,
        "runs": found.runs,
        "failed": found.failed,
        "failures": found.failures,
        "repaired": found.repaired,
        "refused": found.refused,
        "broken_off": found.broken,
        "interrupted": found.stopped,
        "clearance_of_the_world_itself_m": found.first,
        "worst_by_run": found.history,
        "worst": None if found.judged is None else _values(found.judged),
        "worst_run": found.run,
        "shrunk": None
        if shrunk is None
        else {
            "runs": shrunk.runs,
            "taken": shrunk.taken,
            "to_the_end": shrunk.is_least,
            "worst": _values(shrunk.judged),
        },
        "story": told.strip(),
    }
    return json_text(tree)


def _values(judged: Judged) -> dict[str, Any]:
    """A judged run; distances [m], times [s]."""
    touched = None
    if judged.touched is not None:
        kind, pair, time, modes = judged.touched
        touched = {"kind": kind, "pair": pair, "time_s": time, "modes": modes}
    return {
        "clearance_m": judged.clearance,
        "closing_speed_m_per_s": judged.closing if judged.failed else None,
        "pair": judged.pair,
        "time_s": judged.time,
        "touched": touched,
    }
