"""``physim falsify``: the worst that can happen within stated bounds."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from physim.cli.output import (
    alone,
    inputs,
    new_json,
    remove_earlier,
    write_json,
    write_text,
)
from physim.cli.output import writing as writing_to
from physim.cli.parser import Options, changes, command, flag, option
from physim.cli.progress import Bar, Interrupt, announce_compiling, interrupts
from physim.cli.signals import INTERRUPTED
from physim.cli.values import PATH, WORLD_HELP, Value, not_among, whole_from
from physim.errors import PhysimError

if TYPE_CHECKING:
    from physim.campaigns.falsify.search import Hunt
    from physim.campaigns.falsify.shrink import Shrunk
    from physim.campaigns.falsify.space import Space
    from physim.record import Record

FAILED = 1
COMPILING = 15
"""[s] about, for what tells who was responsible"""
STANDS_IN = "constant"
"""The controller that is asked once in place of one's own"""
VARIED = ("pose", "heading", "speed")


def _kinds(text: str) -> tuple[str, ...]:
    """Read what is to be varied. Raises ValueError with what is allowed."""
    kinds = tuple(word.strip() for word in text.split(","))
    for kind in kinds:
        if kind not in VARIED:
            raise ValueError(not_among(kind, list(VARIED)).partition("must be ")[2])
    return kinds


@command("falsify", "the worst that can happen: searched, shrunk, told")
@click.argument("world", metavar="WORLD", help=WORLD_HELP)
@option("--budget", type=whole_from(1, 1_000_000), default=200, metavar="N",
        help="runs to search with at most (200)")  # fmt: skip
@option("--vary", type=Value(_kinds), default="pose,heading", metavar="WHAT",
        help="what is varied, of pose, heading, speed (pose,heading)")  # fmt: skip
@flag("--whole-budget", "go on after the first failure, for the severest")
@flag("--random", "search at random, to compare with")
@option("--shrink", type=whole_from(0, 100_000), default=500, metavar="N",
        help="runs to shrink a failure with at most (500); 0 leaves it as found")  # fmt: skip
@option("--workers", type=whole_from(1, 64), metavar="N",
        help="processes, 1 to 64 (as cores, at most 8); the result is the same")  # fmt: skip
@option("-o", "--output", type=PATH, metavar="DIR",
        help="output folder (default: falsified/NAME-SEED)")  # fmt: skip
@option("--json", type=PATH, metavar="FILE",
        help="write what was found to FILE (-: standard output) as JSON")  # fmt: skip
@flag("--force", "overwrite an earlier search in DIR")
@changes()
@flag("--no-video", "make no video")
@flag("--quiet", "print the result only")  # fmt: skip
def falsify(options: Options) -> int:
    """Look for the start in which robots come nearest to a contact, or touch hardest, by CMA-ES on
    the signed swept clearance, and of contacts on the closing speed. The first failure ends the
    search and is shrunk: fewest robots, shortest time, straightest walls, roundest numbers with
    which it still fails.

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
    from physim.campaigns.falsify.results import found_json, found_text
    from physim.campaigns.falsify.search import hunt

    new_json(options.json, options.force, *inputs(options.world))
    space = _space(options)
    folder = _folder(options, space)
    if not options.quiet:
        print("varied:\n" + "\n".join(f"  {line}" for line in space.lines()), flush=True)
    with interrupts() as interrupt, _alone(folder), executor(options.workers) as workers:
        evaluate = by_executor(workers, space.world, interrupt)
        accepts = accepted(options.controller)
        with Bar("search", options.budget, "runs", options.quiet) as bar:
            found = hunt(
                space, evaluate, accepts, budget=options.budget, seed=space.world.seed or 0,
                at_random=options.random, whole_budget=options.whole_budget, stop=interrupt,
                progress=lambda hunt: bar.update(hunt.runs, lambda: _note(hunt)),
            )  # fmt: skip
        print(found_text(found), end="", flush=True)
        if found.world is None:
            return INTERRUPTED
        shrunk = _shrunk(found, evaluate, accepts, interrupt, options)
        told = _write(folder, space, found, shrunk, interrupt, options)
        if not told:
            return INTERRUPTED
        print(told, end="")
        write_json(options, found_json(space, found, shrunk, told))
        names = [file.name for file in sorted(folder.iterdir()) if file.name in _files()]
        print(f"written to {folder}/: {', '.join(names)}")
        stopped = found.stopped or bool(interrupt.count)
    return INTERRUPTED if stopped else FAILED if found.failed else 0


def _space(options: Options) -> Space:
    """The space around a world that a check accepts, with the kernels ready.

    A controller of one's own is not asked here: what it does to a process, it does to a worker.
    Raises PhysimError with every error of the check.
    """
    from physim.campaigns.falsify.space import Space
    from physim.cli.simulating import ready, tell_warnings
    from physim.parts.registry import CONTROLLER, shipped_parts
    from physim.world.checks.check import check_world
    from physim.world.file import read_world

    world, document = read_world(
        options.world, overrides=options.overrides, controller=options.controller
    )
    tell_warnings(document)
    if options.seed is not None:
        world = world.changed(seed=options.seed)
    shipped = world.controller.type in shipped_parts(CONTROLLER)
    ready(
        world if shipped else world.changed(controller={"type": STANDS_IN}), document, None, options
    )
    found = check_world(
        options.world, overrides=options.overrides, controller=options.controller,
        seed=options.seed,
    )  # fmt: skip
    if found.errors:
        raise PhysimError("\n".join(str(one) for one in found.errors))
    return Space(world, options.vary)


def _files() -> tuple[str, ...]:
    from physim.campaigns.falsify.results import FILES
    from physim.cli.output import FILES as OF_RUN

    return tuple(dict.fromkeys((*FILES, *OF_RUN)))


def _folder(options: Options, space: Space) -> Path:
    """Make the output folder. Raises PhysimError where it holds an earlier search."""
    world = space.world
    folder: Path = options.output or Path("falsified") / f"{world.stem}-{world.seed}"
    earlier = [folder / name for name in _files() if os.path.lexists(folder / name)]
    alone(options.json, *(folder / name for name in _files()))
    what = "an earlier search"
    remove_earlier(folder, earlier, options.force, *inputs(options.world), what=what, later=True)
    with writing_to(folder):
        folder.mkdir(parents=True, exist_ok=True)
    return folder


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Keep others from the folder. RecordError where another search is writing to it."""
    from physim.campaigns.falsify.results import WORST
    from physim.record.lock import WriteLock

    with writing_to(folder):
        lock = WriteLock(folder / WORST)
    try:
        yield
    finally:
        lock.release()


def _note(found: Hunt) -> str:
    if (worst := found.judged) is None or worst.clearance is None:
        return ""
    if worst.failed:
        return f"severest contact {worst.closing:.2f} m/s"
    return f"least clearance {worst.clearance:.4g} m"


def _shrunk(
    found: Hunt, evaluate: Any, accepts: Any, interrupt: Interrupt, options: Options
) -> Shrunk | None:
    """The failure shrunk, where there is one."""
    from physim.campaigns.falsify.shrink import shrink

    if not found.failed or not options.shrink or interrupt() or found.world is None:
        return None
    if found.judged is None:
        return None
    with Bar("shrink", options.shrink, "runs", options.quiet) as bar:
        return shrink(
            found.world, found.judged, evaluate, accepts, most_runs=options.shrink, stop=interrupt,
            progress=lambda shrunk: bar.update(shrunk.runs),
        )  # fmt: skip


def _write(
    folder: Path,
    space: Space,
    found: Hunt,
    shrunk: Shrunk | None,
    interrupt: Interrupt,
    options: Options,
) -> str:
    """Write the files; the paragraph. Empty where it was interrupted twice."""
    from physim.campaigns.falsify.evaluate import StoppedError
    from physim.campaigns.falsify.results import (
        FOUND,
        STORY,
        WORST,
        named,
        run_written,
        shrunk_text,
        write_world,
    )
    from physim.cli.pictures import write_video

    if found.world is None or found.judged is None:
        return ""
    with writing_to(folder):
        for name in _files():
            (folder / name).unlink(missing_ok=True)
    said = [f"Found by: {_command(options)}"]
    world, result = named(found.world, WORST if shrunk is None else FOUND), found.judged
    if shrunk is not None:
        write_world(folder / FOUND, world, result, said, options.controller)
        world, result = named(shrunk.world, WORST), shrunk.judged
        said.append(f"{shrunk_text(found, shrunk).capitalize()}.")
    already = interrupt.count
    file = folder / WORST
    write_world(file, world, result, said, options.controller)
    try:
        record = run_written(file, result, options.controller, lambda: interrupt.count > already)
    except StoppedError:
        return ""
    with record:
        paragraph = _story(record, options)
        write_text(folder / STORY, paragraph)
        if not options.no_video:
            film = folder / "video.mp4"
            write_video(record, film, options.quiet, lambda: interrupt.count > already)
    head = "" if shrunk is None else f"{shrunk_text(found, shrunk)}\n"
    return f"{head}\n{paragraph}\n"


def _story(record: Record, options: Options) -> str:
    from physim.analysis.validation import is_warm, validate
    from physim.campaigns.falsify.results import story
    from physim.cli.warming import finish

    if not is_warm():
        finish(options.quiet)
    if not is_warm():
        announce_compiling("the checks of the validation", COMPILING, options.quiet)
    return story(record, validate(record, rerun=False))


def _command(options: Options) -> str:
    """The command as it may be typed again."""
    words = ["physim", "falsify", options.world, "--budget", str(options.budget)]
    words += ["--vary", ",".join(options.vary)]
    words += ["--whole-budget"] * options.whole_budget + ["--random"] * options.random
    for name, value in (("--seed", options.seed), ("--controller", options.controller)):
        words += [] if value is None else [name, str(value)]
    for override in options.overrides:
        words += ["--set", override]
    return shlex.join(words)
