"""``physim run``: world in; record, video and summary out."""

from __future__ import annotations

import argparse
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path

from physim.cli.compiling import tell_compiling
from physim.cli.output import FILES, inputs, output_folder, write_text
from physim.cli.progress import Bar, Interrupt, interrupts
from physim.cli.video import write_video
from physim.control import Controller
from physim.errors import PhysimError, WorldError
from physim.record import Record
from physim.recording import LateError, record_run
from physim.registry import CONTROLLER, OBSERVER, make_by_defaults, make_part
from physim.scene import Scene
from physim.scene_builder import build_scene
from physim.simulation import Simulation
from physim.stages import Observer
from physim.summary import Summary, summarise, table
from physim.warm_up import is_warm, warm_up
from physim.world import World
from physim.world_file import located, read_world
from physim.world_file.nodes import Document

FAILED, INTERRUPTED = 1, 130
COMPILING = 25
"""[s] about, for all that a run needs"""


def run(options: argparse.Namespace) -> int:
    """Run a world; returns the exit code."""
    simulation = _set_up(options)
    observers = [_observer(name) for name in options.observers]
    scene = simulation.scene
    folder = options.output or Path("runs") / f"{scene.world.stem}-{scene.seed}"
    folder = output_folder(folder, options.force, *inputs(options.world))
    with interrupts() as interrupt:
        record, late = _simulate(simulation, folder, observers, options.quiet, interrupt)
        summary = summarise(record)
        write_text(folder / "summary.json", summary.to_json())
        stopped = bool(interrupt.count)
        if stopped:
            _say(f"interrupted at {simulation.time:g} s of simulated time", options)
        if not options.no_video:
            if stopped:
                _say("writing the video so far (Ctrl-C again cuts it short)", options)
            already = interrupt.count
            film = folder / "video.mp4"
            made = write_video(record, film, options.quiet, lambda: interrupt.count > already)
            if made != film:
                _say(f"{made.name} is cut short; {_again(folder)} makes the whole video", options)
        stopped = stopped or bool(interrupt.count)
    if options.quiet:
        for deep in summary.deep_contacts:
            print(f"WARNING  {deep.sentence(summary.bodies)}", file=sys.stderr)
    else:
        print(table(summary), end="")
        print(f"written to {folder}/: {', '.join(n for n in FILES if (folder / n).exists())}")
    if late is not None:
        raise late
    return _code(summary, stopped)


def _set_up(options: argparse.Namespace) -> Simulation:
    """Read and check the world; every fault with its place in the file."""
    world, document = read_world(
        options.world, overrides=options.overrides, controller=options.controller
    )
    return ready(world, document, options.seed, options)


def _observer(name: str) -> Observer:
    """An observer by name, or of a class of one's own."""
    try:
        made: Observer = make_by_defaults(OBSERVER, name, trusted=True)
    except PhysimError as error:
        raise PhysimError(f"--observer: {error}") from None
    return made


def ready(
    world: World, document: Document, seed: int | None, options: argparse.Namespace
) -> Simulation:
    """Simulation of a world that was read, with the kernels loaded or compiled."""
    try:
        scene = build_scene(world, seed)
    except WorldError as error:
        raise located(error.faults, document) from None

    def controller() -> Controller:
        choice, trusted = world.controller, options.controller is not None
        made: Controller = make_part(CONTROLLER, choice.type, choice.settings, trusted=trusted)
        return made

    simulation = Simulation(scene, controller=controller())
    _prepare(scene, controller(), options)
    return simulation


def _prepare(scene: Scene, controller: Controller, options: argparse.Namespace) -> None:
    """Compile the kernels where that is still to be done, and say so; load them otherwise."""
    cold = not is_warm()
    if cold:
        tell_compiling("controller and distances", COMPILING, options.quiet)
    seconds = warm_up(scene, controller)
    if cold:
        _say(f"compiled in {seconds:.0f} s and kept for later runs", options)


def _simulate(
    simulation: Simulation,
    folder: Path,
    observers: Sequence[Observer],
    quiet: bool,
    interrupt: Interrupt,
) -> tuple[Record, LateError | None]:
    """Record of the run; with it what failed in an observer after the last step."""
    scene = simulation.scene
    bar = Bar(scene.world.name, scene.steps * scene.dt, "s", quiet)

    def progress(now: Simulation, factor: float) -> None:
        bar.update(now.time, lambda: f"{factor:.0f} x real time")

    try:
        record = record_run(
            simulation, observers=observers, path=folder / "record.h5", progress=progress,
            stop=interrupt,
        )  # fmt: skip
        return record, None
    except LateError as error:
        return error.record, error
    finally:
        bar.close()


def _say(text: str, options: argparse.Namespace) -> None:
    if not options.quiet:
        print(text, file=sys.stderr, flush=True)


def _again(folder: Path) -> str:
    return f"physim video {shlex.quote(str(folder / 'record.h5'))}"


def _code(summary: Summary, stopped: bool) -> int:
    if stopped:
        return INTERRUPTED
    return 0 if all(one.held for one in summary.expectations) else FAILED
