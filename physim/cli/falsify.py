"""``physim falsify``: the worst that can happen within stated bounds."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

from physim.cli.options import (
    AS_IT_IS,
    Changes,
    JsonFile,
    Out,
    Output,
    Workers,
    World,
    kind,
    one_of,
    whole,
    words,
)
from physim.cli.output import FILES as OF_RUN
from physim.cli.output import Target, alone, check_json, inputs, remove, write_json
from physim.cli.pictures import files_written, write_video
from physim.cli.progress import Bar
from physim.cli.simulating import tell
from physim.errors import PhysimError
from physim.files import write_text
from physim.terminal import INTERRUPTED, interrupts

FAILED = 1
VARIED = ("pose", "heading", "speed")


def kinds(text: str) -> tuple[str, ...]:
    """Read what is to be varied. Raises ValueError with what is allowed."""
    found = words(text)
    for one in found:
        if one not in VARIED:
            raise ValueError(one_of(one, VARIED))
    return found


def falsify(
    world: World, /, *,
    budget: Annotated[int, kind(whole(1, 1_000_000))] = 200,
    vary: Annotated[tuple[str, ...], kind(kinds)] = ("pose", "heading"),
    whole_budget: bool = False,
    random: bool = False,
    shrink: Annotated[int, kind(whole(0, 100_000))] = 500,
    workers: Workers | None = None,
    output: Output | None = None,
    json: JsonFile | None = None,
    force: bool = False,
    changes: Changes = AS_IT_IS,
    no_video: bool = False,
    quiet: bool = False,
    out: Out,
) -> int:  # fmt: skip
    """Search for the start from which robots come nearest to a contact, or touch hardest. CMA-ES
    minimises the signed clearance over the whole motion and, once there is contact, maximises the
    closing speed. The first failure ends the search and is shrunk: to the fewest robots, shortest
    time, straightest walls and roundest numbers that still fail.

    options:
      --budget N  maximum number of runs of the search (200)
      --vary WHAT  what to vary: some of pose, heading, speed (pose,heading)
      --whole-budget  continue after the first failure, to find the severest
      --random  search at random, as a baseline
      --shrink N  maximum number of runs to shrink a failure (500); 0: do not shrink it
      --workers N  processes (as many as cores, at most 8); the result is the same
      -o, --output DIR  output folder (default: falsified/NAME-SEED)
      --force  overwrite an earlier search in DIR
      --no-video  make no video
      --quiet  print only the result

    bounds: pose: up to 1 m along x and y, or anywhere in the start region; at least 0.3 m from
    everything else, or the least distance of the world's own start if that is less; heading: any if
    the world draws it, else up to 0.5 rad to either side; speed: limits of v and omega, each from
    half to all of its value, if the controller accepts them

    written to DIR:
      worst.yaml     the world that fails, shrunk; or the one that came nearest to it
      as_found.yaml  the same before it was shrunk
      record.h5, video.mp4, story.txt
                     its run, and a paragraph that says what happens

    exit codes:
      0    no failure found (there may still be one)
      1    failure found
      2    bad input
      130  interrupted (Ctrl-C): the worst so far is written

    examples:
      physim falsify doorway --budget 100
      physim falsify ten_robots --set time.duration=60.0 --vary pose,heading,speed
      physim falsify my_world.yaml --controller my_module:MyController --budget 5000
    """
    from physim.analysis.validation import validate
    from physim.campaigns.cluster import executor
    from physim.campaigns.falsify import results
    from physim.campaigns.falsify.evaluate import StoppedError, accepted, by_executor
    from physim.campaigns.falsify.search import hunt
    from physim.campaigns.falsify.shrink import Shrunk
    from physim.campaigns.falsify.shrink import shrink as shrink_world
    from physim.campaigns.falsify.space import Space
    from physim.world.checks import check_world

    check_json(json, force, inputs(world))
    checked = check_world(world, **changes.reading, seed=changes.seed)
    if checked.layout is None or checked.errors:
        raise PhysimError("\n".join(map(str, checked.errors)))
    if checked.document is not None:
        tell(checked.document.lines(checked.document.warnings))
    space = Space(checked.layout.world, vary)
    folder = output or Path("falsified") / f"{space.world.stem}-{space.world.seed}"
    names = list(dict.fromkeys((*results.FILES, *OF_RUN)))
    files = [folder / name for name in names]
    check_json(json, force, files)
    Target(folder, force, inputs(world)).folder(files, "an earlier search")
    if not quiet:
        print("varied:\n" + "\n".join(f"  {line}" for line in space.lines()), flush=True)
    typed = ["physim", "falsify", world, "--budget", str(budget), "--vary", ",".join(vary)]
    typed += ["--whole-budget"] * whole_budget + ["--random"] * random
    typed += [] if changes.seed is None else ["--seed", str(changes.seed)]
    command = shlex.join([*typed, *changes.words])
    with interrupts() as interrupt, alone(folder / results.WORST), executor(workers) as team:
        evaluate = by_executor(team, space.world, interrupt)
        accepts = accepted(changes.controller)
        with Bar("search", budget, "runs", quiet) as bar:
            found = hunt(
                space, evaluate, accepts, budget=budget, seed=space.world.seed or 0,
                at_random=random, whole_budget=whole_budget, stop=interrupt,
                progress=lambda hunt: bar.update(hunt.runs, lambda: hunt.note),
            )  # fmt: skip
        print(results.found_text(found), end="", flush=True)
        if found.world is None or found.judged is None:
            return INTERRUPTED
        shrunk: Shrunk | None = None
        if found.failed and shrink and not interrupt():
            with Bar("shrink", shrink, "runs", quiet) as bar:
                shrunk = shrink_world(
                    found.world, found.judged, evaluate, accepts, most_runs=shrink,
                    stop=interrupt, progress=lambda shrunk: bar.update(shrunk.runs),
                )  # fmt: skip
        remove(files)
        already = interrupt.count

        def stop() -> bool:
            return interrupt.count > already

        try:
            record = results.write_found(folder, found, shrunk, command, changes.controller, stop)
        except StoppedError:
            return INTERRUPTED
        with record:
            paragraph = results.story(record, validate(record, rerun=False))
            write_text(folder / results.STORY, paragraph)
            if not no_video:
                write_video(record, folder / results.VIDEO, quiet, stop)
        told = "" if shrunk is None else f"{results.shrunk_text(found, shrunk)}\n"
        told += f"\n{paragraph}\n"
        print(told, end="")
        write_json(json, results.found_json(space, found, shrunk, told), out)
        print(files_written(folder, names))
        stopped = found.stopped or bool(interrupt.count)
    return INTERRUPTED if stopped else FAILED if found.failed else 0
