"""``physim compare``: is A better than B?"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from physim.cli.output import (
    alone,
    inputs,
    new_json,
    new_page,
    spare,
    write_json,
    write_text,
)
from physim.cli.parser import Options, command, flag, option
from physim.cli.signals import INTERRUPTED
from physim.cli.sweeping import names_of, run_grid, tell_fixed, usual_folder
from physim.cli.values import LONGEST_QUOTE, PATH, OneOf, Value, quoted, seed_range, whole_from
from physim.errors import PhysimError, nearest
from physim.escaping import escaped

if TYPE_CHECKING:
    from physim.campaigns.compare import Arm, Comparison
    from physim.campaigns.outcomes import Outcomes

OWN = re.compile(r"([a-z][a-z0-9_]*):(more|less)")
"""A metric that a package registered, and which of its values are the better ones"""
DIMENSIONS = ["controller", "settings", "world"]


def measures(text: str) -> dict[str, int]:
    """Read names of rates and measures: columns and directions, 1 where more is better, else -1.

    Raises ValueError with those that there are.
    """
    from physim.campaigns.measures import DIRECTIONS
    from physim.campaigns.rows import PREFIX

    found = {}
    for name in (part.strip() for part in text.split(",")):
        own = OWN.fullmatch(name)
        if own and own[1] in DIRECTIONS:
            raise ValueError(f'"{own[1]}" without :{own[2]}, as its direction is known')
        elif own and PREFIX + own[1] in found:
            raise ValueError(f'"{own[1]}" once, as :more or as :less')
        elif own:
            found[PREFIX + own[1]] = 1 if own[2] == "more" else -1
        elif name in DIRECTIONS:
            found[name] = DIRECTIONS[name]
        else:
            close = nearest(name[:LONGEST_QUOTE], list(DIRECTIONS))
            raise ValueError(
                f"some of {','.join(DIRECTIONS)}, or NAME:more, NAME:less of a metric of your own "
                f"by what is better, with commas between; given: {quoted(name)}{close}"
            )
    return found


@command("compare", "is A better than B? differences on the same seeds")
@click.argument(
    "a", metavar="A", type=PATH, help="folder of a campaign (physim sweep); with --seeds a world"
)
@click.argument("b", metavar="[B]", type=PATH, required=False, help="another one, but with --by")
@option(
    "--seeds", type=Value(seed_range), metavar="A:B",
    help="run the world A (or the worlds A and B) with the seeds A to B - 1 first, then compare",
)  # fmt: skip
@option("--controller", metavar="NAME,...", help="with --seeds: each of these controllers")
@option(
    "--set", "axes", multiple=True, metavar="KEY=V1,V2",
    help="with --seeds: each of these values of a world (may be repeated)",
)  # fmt: skip
@option("--runs", type=PATH, metavar="DIR", help="with --seeds: folder of rows (sweeps/WORLD)")
@option(
    "--workers", type=whole_from(1, 1024), metavar="N",
    help="with --seeds: processes on this machine (as many as cores, at most 8)",
)  # fmt: skip
@option(
    "--by",
    type=OneOf(DIMENSIONS),
    metavar="WHAT",
    help="compare the cells of A that differ in this alone: controller, settings or world",
)
@option(
    "--only",
    type=Value(measures),
    metavar="NAME,...",
    help="only these rates and "
    "measures; metrics of your own as NAME:more or NAME:less, by what is better",
)
@option("-o", "--output", type=PATH, metavar="FILE", help="write a page with all pairs as points")
@option("--json", type=PATH, metavar="FILE", help="write all to FILE (-: standard output) as JSON")
@flag("--explain", "tell how differences are estimated and tested")
@flag("--force", "overwrite an existing FILE")
@flag("--quiet", "print no table")  # fmt: skip
def compare(options: Options) -> int:
    """Compare two controllers, settings or worlds on the same seeds: differences with intervals,
    tested, and corrected for how many are looked at. Seeds that only one has are left out.

    Rates (rate: contact-free and finished; contact_free; finished) are compared by McNemar's exact
    test, measures (least_distance, time_to_finish, deviation_peak, formation_error_peak) by the
    sign test: with how many seeds is which the better one? p values are corrected after Holm.

    With --seeds the runs are made first, as physim sweep makes them, in a folder that goes on where
    it was left; compared is what is given several of: controllers, values, or two worlds. A is the
    one that was given first, B the other.

    exit codes:
      0    compared, whatever came out
      2    bad input: one message says what and where
      130  interrupted (Ctrl-C, SIGTERM): the same command goes on

    examples:
      physim compare ten_robots --seeds 1:101 --controller mode_switching,path_following
      physim compare ten_robots --seeds 1:101 --set formation.gain=0.02,0.1 -o gains.html
      physim compare runs/study --by controller
      physim compare runs/before runs/after -o compared.html
      physim compare runs/study --by settings --only rate,time_to_finish --json -
    """
    from physim.campaigns.compare import by
    from physim.campaigns.compare import compare as compared
    from physim.campaigns.folder import Folder
    from physim.campaigns.measures import USUAL
    from physim.campaigns.unlike import with_unlike

    spare(options.json, *_folders(options), option="--json")
    spare(options.output, *_folders(options))
    read = inputs(*_given(options)) if options.seeds is not None else ()
    new_json(options.json, options.force, *read)
    alone(options.json, options.output)
    if options.output is not None:
        new_page(options.output, options.force, *read)
    _check(options)
    if options.seeds is not None:
        made = _made(options)
        if made is None:
            return INTERRUPTED
        pairs, name = made
    elif options.by:
        order = [cell.label for cell in Folder(options.a).cells()]
        pairs = by(outcomes(options.a), options.by, order)
        name = f"{options.a}, by {options.by}"
    else:
        pairs, name = _two(options.a, options.b), f"{options.a} and {options.b}"
    found = compared(pairs, options.only or USUAL)
    if options.seeds is None and options.b is not None:
        found = with_unlike(found, Folder(options.a), Folder(options.b))
    _write_out(options, found, name)
    return 0


def _write_out(options: Options, found: list[Comparison], name: str) -> None:
    """Write page, JSON and table of what was found in the pairs called ``name``."""
    from physim.campaigns.report.page import comparison_page
    from physim.campaigns.report.text import comparison_text, comparison_values
    from physim.campaigns.rows import PREFIX

    looked = options.seeds is None and any(map(_looked_at, _folders(options)))
    if options.output is not None:
        write_text(options.output, comparison_page(found, name, looked))
    if options.json is not None:
        values = comparison_values(found, looked)
        write_json(options, json.dumps(values, indent=2, ensure_ascii=False, allow_nan=False))
    if options.quiet:
        return
    sys.stdout.write(comparison_text(found, looked, options.explain))
    known = {finding.name for one in found for finding in one.findings}
    for asked in [name for name in options.only or () if name not in known]:
        measure = escaped(asked.removeprefix(PREFIX))
        sys.stdout.write(f"{measure}: not compared, as no seed has a value on both sides\n")
    if options.output is not None:
        sys.stdout.write(f"written to {options.output}\n")


def _check(options: Options) -> None:
    """Raise PhysimError for options that do not go together."""
    if options.seeds is not None:
        if options.by is not None and options.b is not None and options.by != "world":
            raise PhysimError("--by: two worlds are compared by world")
        return
    given = {"--controller": options.controller, "--set": options.axes, "--runs": options.runs,
             "--workers": options.workers}  # fmt: skip
    for one, value in given.items():
        if value:
            raise PhysimError(f"{one}: needs --seeds A:B, the seeds to run")
    if (options.b is None) == (options.by is None):
        given_words = "is missing" if options.b is None else "cannot be combined with B"
        raise PhysimError(
            f"--by: {given_words}; compare two folders, physim compare A B, the cells of one, "
            f"physim compare A --by {DIMENSIONS[0]}, or run a world for it, physim compare WORLD "
            "--seeds A:B --controller X,Y"
        )


def _given(options: Options) -> tuple[str, ...]:
    return tuple(str(one) for one in (options.a, options.b) if one is not None)


def _folders(options: Options) -> tuple[Path, ...]:
    """Folders of the campaigns that are compared, or are made first."""
    if options.seeds is not None:
        return (options.runs or usual_folder(_given(options)),)
    return tuple(map(Path, _given(options)))


def _made(options: Options) -> tuple[list[tuple[Arm, Arm, str]], str] | None:
    """Make the runs, and what of them is to be compared; None when that was interrupted."""
    from physim.campaigns.compare import by
    from physim.campaigns.folder import read_part
    from physim.campaigns.grid import make_grid
    from physim.campaigns.outcomes import CELL, Outcomes

    worlds = _given(options)
    names = names_of(options.controller)
    grid = make_grid(worlds, range(*options.seeds), options.axes, names, paired=True)
    several = [
        name
        for name, values in zip(
            CELL,
            zip(*(cell.label for cell in grid.cells), strict=True), strict=True,
        )
        if len(set(values)) > 1
    ]  # fmt: skip
    if options.by is None and len(several) != 1:
        what = f"{' and '.join(several)} differ: give --by" if several else "nothing to compare"
        raise PhysimError(
            f"{' '.join(worlds)}: {what}; compared are several --controller X,Y, --set KEY=V1,V2, "
            "or two worlds"
        )
    dimension = options.by or several[0]
    if dimension not in several:
        raise PhysimError(f"--by {dimension}: there is only one")
    (folder,) = _folders(options)
    tell_fixed(grid, options.quiet)
    tally, _ = run_grid(grid, folder, workers=options.workers, quiet=options.quiet)
    if tally.interrupted:
        return None
    pairs = by(Outcomes(read_part(folder, grid)), dimension, [cell.label for cell in grid.cells])
    return pairs, f"{', '.join(worlds)}, by {dimension}"


def outcomes(folder: Path) -> Outcomes:
    """Rows of a campaign. Raises PhysimError where there is none, or it has no rows yet."""
    from physim.campaigns.folder import Folder, read
    from physim.campaigns.outcomes import Outcomes, missing
    from physim.campaigns.report.text import missing_words
    from physim.cli.simulating import tell_notices

    found = Outcomes(read(folder))
    if not len(found):
        raise PhysimError(f"{folder}: its campaign has no runs yet")
    if lacks := missing_words(missing(Folder(folder).asked(), found)):
        tell_notices([escaped(f"{folder}: {lacks}")])
    return found


def _two(a: Path, b: Path) -> list[tuple[Arm, Arm, str]]:
    from physim.campaigns.compare import between

    return between(outcomes(a), outcomes(b), (str(a), str(b)))


def _looked_at(folder: Path) -> bool:
    """Whether the number of runs depends on their outcomes."""
    from physim.campaigns.sweep import read_until

    return read_until(folder) is not None
