"""``physim run``: world in; record, video and summary out."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from physim.cli.output import FILES, SUMMARY, inputs, run_folder, write_text
from physim.cli.page import make_page
from physim.cli.parser import Options, changes, command, flag, option
from physim.cli.pictures import write_video
from physim.cli.progress import Bar, Interrupt, interrupts
from physim.cli.signals import INTERRUPTED
from physim.cli.values import PATH, WORLD_HELP
from physim.errors import PhysimError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from physim.analysis.summary import Summary
    from physim.parts.stages import Observer
    from physim.record import Record
    from physim.simulation.loop import Simulation
    from physim.simulation.run import LateError

FAILED = 1


@command("run", "run a world: record, video and summary")
@click.argument("world", metavar="WORLD", help=WORLD_HELP)
@option("-o", "--output", type=PATH, metavar="DIR", help="output folder (default: runs/NAME-SEED)")
@flag("--force", "overwrite an earlier run in DIR")
@changes()
@option(
    "--observer",
    "observers",
    multiple=True,
    metavar="NAME",
    help="attach a registered observer (physim list) or your own, as module:Class (may be "
    "repeated)",
)
@flag("--no-video", "make no video")
@flag("--page", "write DIR/page.html, too: the run in a browser, to watch, scrub and ask why")
@flag("--full", "print every figure, as physim summary does")
@flag("--quiet", "print neither progress nor table")  # fmt: skip
def run(options: Options) -> int:
    """Run a world and write DIR/record.h5, DIR/video.mp4 and DIR/summary.json.

    exit codes:
      0    ran, and everything under "expect:" in the world held
      1    ran, but an expectation failed
      2    bad input: one line a fault says what and where
      130  interrupted (Ctrl-C): the record so far is whole, and so is its video; a second Ctrl-C
           cuts the video short, which is then kept as video.cut_short.mp4

    settings under controller: belong to the type beside them, and are left out with a warning where
    --controller names another; without a type, or by --set controller.KEY=VALUE, they are for
    whatever runs

    keys for --set: worlds/README.md lists them all; physim new writes a world with each explained

    examples:
      physim run ten_robots
      physim run ten_robots --page
      physim run ten_robots --seed 3 --no-video -o /tmp/seed3
      physim run my_world.yaml --set time.duration=20.0 --set controller.beta=0.3
      physim run my_world.yaml --controller my_module:MyController
      physim run my_world.yaml --observer my_module:MyObserver
    """
    from physim.analysis.summary import summarise, table
    from physim.cli.simulating import ready, tell_warnings
    from physim.cli.warming import finish
    from physim.world.file import read_world

    world, document = read_world(
        options.world, overrides=options.overrides, controller=options.controller
    )
    tell_warnings(document)
    place = (options.output or Path("runs")) / "record.h5"
    simulation = ready(world, document, options.seed, options, place)
    observers = [_observer(name) for name in options.observers]
    scene = simulation.scene
    folder = options.output or Path("runs") / f"{scene.world.stem}-{scene.seed}"
    with run_folder(folder, options.force, *inputs(options.world)), interrupts() as interrupt:
        record, late = _simulate(simulation, folder, observers, options.quiet, interrupt)
        summary = summarise(record)
        write_text(folder / SUMMARY, summary.to_json())
        stopped, already = bool(interrupt.count), interrupt.count
        if stopped:
            _say(f"interrupted at {simulation.time:g} s of simulated time", options)
        if not options.no_video:
            if stopped:
                _say("writing the video so far (Ctrl-C again cuts it short)", options)
            film = folder / "video.mp4"
            made = write_video(record, film, options.quiet, lambda: interrupt.count > already)
            if made != film:
                again = f"physim video {shlex.quote(str(folder / 'record.h5'))}"
                _say(f"{made.name} is cut short; {again} makes the whole video", options)
        if options.page and interrupt.count == already:
            make_page([record], folder / "page.html", options.quiet)
        stopped = stopped or bool(interrupt.count)
    if options.quiet:
        for sentence in summary.warnings:
            print(f"WARNING  {sentence}", file=sys.stderr)
    else:
        print(table(summary, brief=not options.full), end="")
        print(f"written to {folder}/: {', '.join(n for n in FILES if (folder / n).exists())}")
    if not stopped:
        finish(options.quiet)
    if late is not None:
        raise late
    return _code(summary, stopped)


def _observer(name: str) -> Observer:
    """An observer by name, or of a class of one's own."""
    from physim.parts.registry import OBSERVER, make_by_defaults

    try:
        made: Observer = make_by_defaults(OBSERVER, name, trusted=True)
    except PhysimError as error:
        raise PhysimError(f"--observer: {error}") from None
    return made


def _simulate(
    simulation: Simulation,
    folder: Path,
    observers: Sequence[Observer],
    quiet: bool,
    interrupt: Interrupt,
) -> tuple[Record, LateError | None]:
    """Record of the run; with it what failed in an observer after the last step."""
    from physim.simulation.run import LateError, record_run

    scene = simulation.scene
    try:
        with Bar(scene.world.name, scene.steps * scene.dt, "s", quiet) as bar:
            record = record_run(
                simulation, observers=observers, path=folder / "record.h5",
                progress=bar.simulated if bar.visible else None, stop=interrupt,
            )  # fmt: skip
        return record, None
    except LateError as error:
        return error.record, error


def _say(text: str, options: Options) -> None:
    if not options.quiet:
        print(text, file=sys.stderr, flush=True)


def _code(summary: Summary, stopped: bool) -> int:
    if stopped:
        return INTERRUPTED
    return 0 if all(one.held for one in summary.expectations) else FAILED
