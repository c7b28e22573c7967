"""``physim run``: world in; record, video and summary out."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path

from physim.cli.options import AS_IT_IS, Changes, Output, Positive, Seconds, World, record_file
from physim.cli.output import SUMMARY, inputs, run_folder
from physim.cli.page import make_page
from physim.cli.pictures import files_written, write_video
from physim.cli.progress import Bar
from physim.cli.simulating import ready, tell
from physim.errors import PhysimError
from physim.files import write_text
from physim.terminal import INTERRUPTED, interrupts

FAILED = 1


def run(
    world: World, /, *,
    output: Output | None = None,
    force: bool = False,
    changes: Changes = AS_IT_IS,
    observer: tuple[str, ...] = (),
    keep_states: Positive | None = None,
    keep_sensed: bool = False,
    from_: Seconds | None = None,
    no_video: bool = False,
    page: bool = False,
    full: bool = False,
    quiet: bool = False,
) -> int:  # fmt: skip
    """Run a world and write DIR/record.h5, DIR/video.mp4 and DIR/summary.json.

    options:
      -o, --output DIR  output folder (default: runs/NAME-SEED)
      --force  overwrite an earlier run in DIR
      --observer NAME  attach a registered observer (physim list) or your own, as module:Class (may
          be repeated)
      --keep-states S  keep the state of the run every S seconds, so that other runs can start there
          (default: as often as physim branch needs to start at once)
      --keep-sensed  keep what each robot sensed when it decided
      --from T  start from the state at T [s] that a record kept (give it as WORLD); you may change
          --controller, and with --set any key that moves no body
      --no-video  make no video
      --page  also write DIR/page.html, which shows the run in a browser
      --full  print every figure, as physim summary does
      --quiet  print no progress and no table

    exit codes:
      0    ran, and the run met everything under "expect:" in the world
      1    ran, but did not meet an expectation
      2    bad input: one line for each fault says what and where
      130  interrupted (Ctrl-C): record and video end there and are complete; a second Ctrl-C
           stops the video, too, which is then kept as video.cut_short.mp4

    settings under "controller:" in the world belong to its type: with another --controller they are
    not used, and a warning says so; settings without a type, and those of --set
    controller.KEY=VALUE, are used in any case

    keys for --set: physim new writes a world with a comment on every key

    examples:
      physim run ten_robots
      physim run ten_robots --page
      physim run ten_robots --seed 3 --no-video -o /tmp/seed3
      physim run my_world.yaml --set time.duration=20.0 --set controller.beta=0.3
      physim run my_world.yaml --controller my_module:MyController
      physim run my_world.yaml --observer my_module:MyObserver
      physim run ten_robots --keep-states 10 -o kept
      physim run kept/record.h5 --from 60 --controller path_following -o branch
    """
    from physim.analysis.summary import summarise, table
    from physim.parts.registry import OBSERVER, make_by_defaults
    from physim.record import Record
    from physim.simulation.branching import check_changes, taken_over
    from physim.simulation.kept_states import state_at
    from physim.simulation.loop import Simulation
    from physim.simulation.recorder import SaveAt
    from physim.simulation.run import LateError, record_run

    def say(text: str) -> None:
        if not quiet:
            print(text, file=sys.stderr, flush=True)

    simulation = ready(world, changes, quiet, (output or Path("runs")) / "record.h5")
    if from_ is not None:
        with Record.load(record_file(world)) as kept:
            before = Simulation(kept.world, state=state_at(kept, from_))
        check_changes(before.scene.world, simulation.scene.world)
        simulation.restore(taken_over(before, simulation))
    try:
        observers = [make_by_defaults(OBSERVER, name, trusted=True) for name in observer]
    except PhysimError as error:
        raise PhysimError(f"--observer: {error}") from None
    scene = simulation.scene
    folder = output or Path("runs") / f"{scene.world.stem}-{scene.seed}"
    late = None
    with run_folder(folder, force, *inputs(world)), interrupts() as interrupt:
        try:
            with Bar(scene.world.name, scene.steps * scene.dt, "s at most", quiet) as bar:
                record = record_run(
                    simulation, observers=observers, path=folder / "record.h5",
                    save=SaveAt(states=keep_states or "usual", sensed=keep_sensed),
                    progress=bar.simulated if bar.visible else None, stop=interrupt,
                )  # fmt: skip
        except LateError as error:  # in an observer, after the last step
            record, late = error.record, error
        summary = summarise(record)
        write_text(folder / SUMMARY, summary.to_json())
        already = interrupt.count
        if already:
            say(f"interrupted at {simulation.time:g} s of simulated time")
        if not no_video:
            if already:
                say("writing the video so far (Ctrl-C again cuts it short)")
            film = folder / "video.mp4"
            made = write_video(record, film, quiet, lambda: interrupt.count > already)
            if made != film:
                again = f"physim video {shlex.quote(str(folder / 'record.h5'))}"
                say(f"{made.name} is cut short; {again} makes the whole video")
        if page and interrupt.count == already:
            make_page([record], folder / "page.html", quiet)
        stopped = bool(interrupt.count)
    if quiet:
        tell(summary.warnings)
    else:
        print(table(summary, brief=not full), end="")
        print(files_written(folder))
    if late is not None:
        raise late
    if stopped:
        return INTERRUPTED
    return 0 if all(one.held for one in summary.expectations) else FAILED
