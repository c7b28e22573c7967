"""``physim falsify``: the worst that can happen within stated bounds."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

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
from physim.cli.progress import Bar
from physim.errors import PhysimError
from physim.files import write_text
from physim.terminal import INTERRUPTED, Interrupt, interrupts

if TYPE_CHECKING:
    from physim.campaigns.falsify.search import Hunt
    from physim.campaigns.falsify.shrink import Shrunk
    from physim.campaigns.falsify.space import Space

FAILED = 1
STANDS_IN = "constant"
"""The controller that is asked once in place of one's own"""
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
    """Look for the start in which robots come nearest to a contact, or touch hardest, by CMA-ES on
    the signed swept clearance, and of contacts on the closing speed. The first failure ends the
    search and is shrunk: fewest robots, shortest time, straightest walls, roundest numbers with
    which it still fails.

    options:
      --budget N  runs to search with at most (200)
      --vary WHAT  what is varied, of pose, heading, speed (pose,heading)
      --whole-budget  go on after the first failure, for the severest
      --random  search at random, to compare with
      --shrink N  runs to shrink a failure with at most (500); 0 leaves it as found
      --workers N  processes, 1 to 64 (as many as cores, at most 8); the result is the same
      -o, --output DIR  output folder (default: falsified/NAME-SEED)
      --force  overwrite an earlier search in DIR
      --no-video  make no video
      --quiet  print the result only

    bounds: pose: up to 1 m along x and y, or anywhere in the start region, clear of all else by
    0.3 m or what the world itself has; heading: any where it is random, else 0.5 rad to either
    side; speed: limits of v and omega, half to all of each, as far as the controller takes them

    written to DIR:
      worst.yaml     the world that fails, shrunk; or the one that came nearest to it
      as_found.yaml  the same before it was shrunk
      record.h5, video.mp4, story.txt
                     its run, and a paragraph of what happens

    exit codes:
      0    no failure found: that is no proof that there is none
      1    a failure found
      2    bad input
      130  interrupted (Ctrl-C): the worst so far is written

    examples:
      physim falsify doorway --budget 100
      physim falsify ten_robots --set time.duration=60.0 --vary pose,heading,speed
      physim falsify my_world.yaml --controller my_module:MyController --budget 5000
    """
    from physim.campaigns.cluster import executor
    from physim.campaigns.falsify.evaluate import accepted, by_executor
    from physim.campaigns.falsify.results import FILES, WORST, found_json, found_text
    from physim.campaigns.falsify.search import hunt

    check_json(json, force, inputs(world))
    space = _space(world, changes, vary, quiet)
    made = tuple(dict.fromkeys((*FILES, *OF_RUN)))
    folder = output or Path("falsified") / f"{space.world.stem}-{space.world.seed}"
    files = [folder / name for name in made]
    check_json(json, force, [*inputs(world), *files])
    Target(folder, force, inputs(world)).folder(files, "an earlier search")
    if not quiet:
        print("varied:\n" + "\n".join(f"  {line}" for line in space.lines()), flush=True)
    typed = ["physim", "falsify", world, "--budget", str(budget), "--vary", ",".join(vary)]
    typed += ["--whole-budget"] * whole_budget + ["--random"] * random
    typed += [] if changes.seed is None else ["--seed", str(changes.seed)]
    typed += changes.words
    with interrupts() as interrupt, alone(folder / WORST), executor(workers) as team:
        evaluate = by_executor(team, space.world, interrupt)
        accepts = accepted(changes.controller)
        with Bar("search", budget, "runs", quiet) as bar:
            found = hunt(
                space, evaluate, accepts, budget=budget, seed=space.world.seed or 0,
                at_random=random, whole_budget=whole_budget, stop=interrupt,
                progress=lambda hunt: bar.update(hunt.runs, lambda: _note(hunt)),
            )  # fmt: skip
        print(found_text(found), end="", flush=True)
        if found.world is None:
            return INTERRUPTED
        shrunk = _shrunk(found, evaluate, accepts, interrupt, shrink, quiet)
        remove(files)
        told = _write(
            folder, found, shrunk, interrupt, changes.controller, shlex.join(typed),
            None if no_video else folder / "video.mp4", quiet,
        )  # fmt: skip
        if not told:
            return INTERRUPTED
        print(told, end="")
        write_json(json, found_json(space, found, shrunk, told), out)
        names = sorted(file.name for file in files if file.exists())
        print(f"written to {folder}/: {', '.join(names)}")
        stopped = found.stopped or bool(interrupt.count)
    return INTERRUPTED if stopped else FAILED if found.failed else 0


def _space(given: str, changes: Changes, vary: tuple[str, ...], quiet: bool) -> Space:
    """The space around a world that a check accepts, with the kernels ready.

    A controller of one's own is not asked here: what it does to a process, it does to a worker.
    Raises PhysimError with every error of the check.
    """
    from physim.campaigns.falsify.space import Space
    from physim.cli.simulating import ready, tell
    from physim.parts.registry import CONTROLLER, shipped_parts
    from physim.world.checks.check import check_world
    from physim.world.file import read_world

    world, document = read_world(given, **changes.reading)
    tell(document.lines(document.warnings))
    if changes.seed is not None:
        world = world.changed(seed=changes.seed)
    shipped = world.controller.type in shipped_parts(CONTROLLER)
    stand_in = world if shipped else world.changed(controller={"type": STANDS_IN})
    ready(stand_in, document, changes, quiet)
    found = check_world(given, **changes.reading, seed=changes.seed)
    if found.errors:
        raise PhysimError(*map(str, found.errors))
    return Space(world, vary)


def _note(found: Hunt) -> str:
    if (worst := found.judged) is None or worst.clearance is None:
        return ""
    if worst.failed:
        return f"severest contact {worst.closing:.2f} m/s"
    return f"least clearance {worst.clearance:.4g} m"


def _shrunk(
    found: Hunt, evaluate: Any, accepts: Any, interrupt: Interrupt, most_runs: int, quiet: bool
) -> Shrunk | None:
    """The failure shrunk, where there is one."""
    from physim.campaigns.falsify.shrink import shrink

    if not found.failed or not most_runs or interrupt():
        return None
    if found.world is None or found.judged is None:
        return None
    with Bar("shrink", most_runs, "runs", quiet) as bar:
        return shrink(
            found.world, found.judged, evaluate, accepts, most_runs=most_runs, stop=interrupt,
            progress=lambda shrunk: bar.update(shrunk.runs),
        )  # fmt: skip


def _write(
    folder: Path, found: Hunt, shrunk: Shrunk | None, interrupt: Interrupt,
    controller: str | None, command: str, film: Path | None, quiet: bool,
) -> str:  # fmt: skip
    """Write the files; the paragraph. Empty where it was interrupted twice."""
    from physim.analysis.validation import validate
    from physim.campaigns.falsify.evaluate import StoppedError
    from physim.campaigns.falsify.results import (
        FOUND,
        STORY,
        WORST,
        named,
        run_written,
        shrunk_text,
        story,
        write_world,
    )
    from physim.cli.pictures import write_video
    from physim.cli.progress import checks_ready

    if found.world is None or found.judged is None:
        return ""
    said = [f"Found by: {command}"]
    world, result = named(found.world, WORST if shrunk is None else FOUND), found.judged
    if shrunk is not None:
        write_world(folder / FOUND, world, result, said, controller)
        world, result = named(shrunk.world, WORST), shrunk.judged
        said.append(f"{shrunk_text(found, shrunk).capitalize()}.")
    already = interrupt.count
    file = folder / WORST
    write_world(file, world, result, said, controller)
    try:
        record = run_written(file, result, controller, lambda: interrupt.count > already)
    except StoppedError:
        return ""
    with record:
        checks_ready(quiet)
        paragraph = story(record, validate(record, rerun=False))
        write_text(folder / STORY, paragraph)
        if film is not None:
            write_video(record, film, quiet, lambda: interrupt.count > already)
    head = "" if shrunk is None else f"{shrunk_text(found, shrunk)}\n"
    return f"{head}\n{paragraph}\n"
