"""``physim branch``: a run goes on from a moment of another, with something changed."""

from __future__ import annotations

import math
import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from physim.cli.options import Output, Record, Seconds
from physim.cli.output import BOTH, BOTH_PAGE, SUMMARY, run_folder
from physim.cli.page import make_page
from physim.cli.pictures import files_written, write_video
from physim.cli.progress import Bar
from physim.cli.simulating import tell, to_the_end
from physim.errors import PhysimError
from physim.files import write_text
from physim.terminal import INTERRUPTED, interrupts

if TYPE_CHECKING:
    from physim.analysis.parting import Parting
    from physim.record import Origin
    from physim.record import Record as Opened
    from physim.simulation.loop import Simulation

FAILED = 1
AFTER = 10.0
"""[s] for which the film of both goes on after the two parted, or touched something at first"""
OFF_GRID = 1e-6
"""of a step, by which a time may lie beside one, since it is written in decimals"""


def branch(
    record: Record, /, *,
    at: Annotated[Seconds, Parameter(required=True)],
    set: tuple[str, ...] = (),
    controller: str | None = None,
    original: str | None = None,
    output: Output | None = None,
    force: bool = False,
    no_video: bool = False,
    full: bool = False,
    traceback: bool = False,
    quiet: bool = False,
) -> int:  # fmt: skip
    """Go on from a moment of a run, with something changed, and show both runs side by side.

    options:
      --at T  simulated time [s] from which the branch goes on; it must be a step of the run
      --set KEY=VALUE  change a key of the world from there on (may be repeated); only keys that
          move and reshape no body: controller, robots.N.controller, formation, sensing, filters,
          disturbances, expect, time.duration, time.record_every, name
      --controller NAME  use this controller from there on: a registered one (physim list), or your
          own as module:Class; robots with a controller of their own keep it
      --original NAME  the controller of RECORD, if that is your own class: physim runs your code
          only if you name it
      -o, --output DIR  output folder (default: runs/NAME-SEED-at-T)
      --force  overwrite an earlier run in DIR
      --no-video  make no videos
      --full  print every figure, as physim summary does
      --traceback  if your own code fails, show the full traceback
      --quiet  print no progress and no table

    DIR has the branch as physim run writes a run: record.h5, which says from which record it comes
    and what was changed, video.mp4 and summary.json. both.html shows the original and the branch
    from T on; both.mp4 shows them until 10 s after they parted, or after the first contact of
    either, if that is later (physim video makes a film of other times). Without a change the branch
    is the original, bit for bit.

    exit codes:
      0    ran, and the branch met everything under "expect:" in the world
      1    ran, but did not meet an expectation
      2    bad input: one line for each fault says what and where
      130  interrupted (Ctrl-C): the record ends there and is complete; a video that is cut short is
           kept as NAME.cut_short.mp4

    examples:
      physim branch runs/ten_robots-21 --at 82.2 --controller path_following
      physim branch runs/ten_robots-21 --at 82.2 --set controller.horizon=6 -o longer
      physim branch mine/record.h5 --at 3 --original my_module:Mine --controller my_module:Better
    """
    from physim.record import Record as Opened
    from physim.simulation.recorder import SaveAt
    from physim.simulation.run import record_run

    with Opened.load(record) as before:
        simulation, origin = branched(before, at, set, controller, original, quiet)
        scene = simulation.scene
        folder = output or Path("runs") / f"{scene.world.stem}-{scene.seed}-at-{at:g}"
        with run_folder(folder, force, record), interrupts() as interrupt:
            with Bar(scene.world.name, scene.steps * scene.dt, "s at most", quiet) as bar:
                after = record_run(
                    simulation, path=folder / "record.h5",
                    save=SaveAt(states="usual", sensed="sensed" in before.tables),
                    progress=bar.simulated if bar.visible else None, stop=interrupt, origin=origin,
                )  # fmt: skip
            # not needed before: the branch is to begin at once
            from physim.analysis.parting import parting
            from physim.analysis.summary import summarise, table

            summary = summarise(after)
            write_text(folder / SUMMARY, summary.to_json())
            parted, until = parting(before, after), math.inf
            if not no_video and not interrupt():
                write_video(after, folder / "video.mp4", quiet, interrupt)
            if not no_video and not interrupt():
                until = _shown_until(before, after, parted)
                write_video(before, folder / BOTH, quiet, interrupt, beside=after, end=until)
            if not interrupt():
                make_page([before, after], folder / BOTH_PAGE, quiet)
    if quiet:
        tell(summary.warnings)
    else:
        print(table(summary, brief=not full), end="")
        print(f"the two runs part: {parted or 'nowhere while both last'}")
        print(files_written(folder))
        if until < max(before.time[-1], after.time[-1]):
            print(
                f"{BOTH} shows {after.begun:.2f} to {until:.2f} s; a film of all: physim video "
                f"{record.parent} {folder}"
            )
    if interrupt():
        at_once = after.ended == "interrupted"
        where = f"at {simulation.time:g} s of simulated time" if at_once else "before all is shown"
        print(f"interrupted {where}", file=sys.stderr)
        return INTERRUPTED
    return 0 if all(one.held for one in summary.expectations) else FAILED


def _shown_until(before: Opened, after: Opened, parted: Parting | None) -> float:
    """Where the film of both ends [s]: what is to be seen has happened."""
    from physim.analysis.metrics import Figures

    seen = [after.begun] if parted is None else [parted.time]
    touches = [
        one.time
        for run in (before, after)
        for one in (*Figures(run).episodes, *Figures(run).grazes)
        if one.time > after.begun
    ]
    return max([*seen, *sorted(touches)[:1]]) + AFTER


def branched(
    record: Opened,
    at: float,
    changes: tuple[str, ...],
    controller: str | None,
    original: str | None,
    quiet: bool,
) -> tuple[Simulation, Origin]:
    """The simulation of a record at a time [s] with changes, and what its record says of that.

    Raises PhysimError, one line, where it cannot be.
    """
    from physim.parts.given import given_settings
    from physim.parts.registry import made_controller
    from physim.record import Origin
    from physim.simulation.again import simulation_at
    from physim.simulation.branching import check_changes, scene_with, taken_over
    from physim.simulation.loop import Simulation
    from physim.world.file import read_world

    assert record.path is not None
    step, dt, end = round(at / record.dt), record.dt, record.steps_run
    if abs(at / dt - step) > OFF_GRID:
        raise PhysimError(
            f"--at {at:.15g}: is between two steps of {dt:g} s; nearest: {step * dt:.10g}"
        )
    if not record.begun_at <= step <= end:
        raise PhysimError(
            f"--at {at:.15g}: is outside the run, which goes from {record.begun:g} to "
            f"{end * dt:.10g} s"
        )
    name = record.controller_name
    if original is not None and original != name:
        raise PhysimError(f"--original {original}: the controller of {record.path} is {name}")
    own = original or (controller if controller == name else None)
    if ":" in name and own is None:
        raise PhysimError(
            f"{record.path}: its controller is the class {name}; no code is run because a record "
            f"names it: if you trust the class, give --original {name}"
        )
    mine = None
    if own is not None:
        mine = made_controller(read_world(record.path, controller=own)[0], trusted=True)
    run = partial(simulation_at, record, step, controller=mine)
    before: Simulation = to_the_end(run, f"{record.name}, again", step * dt, quiet)
    digest = record.digest()
    after, changed = before, {}
    if changes or controller not in (None, name):
        named = controller or own
        world, document = read_world(record.path, overrides=changes, controller=named)
        tell(document.lines(document.warnings))
        changed = check_changes(before.scene.world, world)
        if controller == name:  # an object that was given from Python has another name in its world
            changed.pop("controller.type", None)
        made = made_controller(world, trusted=named is not None)
        if type(made) is type(mine) and given_settings(made) == given_settings(mine):
            made = mine  # which keeps its memory
        after = Simulation(scene_with(before.scene, world), controller=made)
        after.restore(taken_over(before, after))
    if after.finished or after.scene.steps <= step:
        raise PhysimError(
            f"--at {at:.15g}: nothing is left of the run from there on; give an earlier time, or a "
            "longer one by --set time.duration=SECONDS"
        )
    return after, Origin(digest, changed)
