"""``physim compare``: is A better than B?"""

from __future__ import annotations

import re
import sys
from json import dumps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from physim.cli.options import (
    LONGEST_QUOTE,
    File,
    JsonFile,
    Out,
    Output,
    Seeds,
    TeamSize,
    Words,
    kind,
    quoted,
)
from physim.cli.output import PAGE, Target, check_json, inputs, write_json
from physim.cli.sweeping import run_grid, spare, tell_fixed, usual_folder
from physim.errors import PhysimError, nearest
from physim.files import write_text
from physim.terminal import INTERRUPTED

if TYPE_CHECKING:
    from physim.campaigns.grid import Grid
    from physim.campaigns.outcomes import Outcomes

OWN = re.compile(r"([a-z][a-z0-9_]*):(more|less)")
"""A metric that a package registered, and which of its values are the better ones"""
By = Literal["controller", "settings", "world"]


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


def compare(
    a: File, b: File | None = None, /, *,
    seeds: Seeds | None = None,
    controller: Words = (),
    set: tuple[str, ...] = (),
    runs: File | None = None,
    workers: TeamSize | None = None,
    by: By | None = None,
    only: Annotated[Any, kind(measures)] = None,
    output: Output | None = None,
    json: JsonFile | None = None,
    explain: bool = False,
    force: bool = False,
    quiet: bool = False,
    out: Out,
) -> int:  # fmt: skip
    """Compare two controllers, settings or worlds on the same seeds: differences with intervals,
    tested, and corrected for how many are looked at. Seeds that only one has are left out.

    arguments:
      A  folder of a campaign (physim sweep); with --seeds a world
      [B]  another one, but with --by

    options:
      --seeds A:B  run the world A (or the worlds A and B) with the seeds A to B - 1 first, then
          compare
      --controller NAME,...  with --seeds: each of these controllers
      --set KEY=V1,V2  with --seeds: each of these values of a world (may be repeated)
      --runs DIR  with --seeds: folder of rows (sweeps/WORLD)
      --workers N  with --seeds: processes on this machine (as many as cores, at most 8)
      --by WHAT  compare the cells of A that differ in this alone: controller, settings or world
      --only NAME,...  only these rates and measures; metrics of your own as NAME:more or NAME:less,
          by what is better
      -o, --output FILE  write a page with all pairs as points
      --explain  tell how differences are estimated and tested
      --force  overwrite an existing FILE
      --quiet  print no table

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
    from physim.campaigns.compare import between
    from physim.campaigns.compare import by as pairs_by
    from physim.campaigns.compare import compare as compared
    from physim.campaigns.folder import Folder, read_part
    from physim.campaigns.grid import make_grid
    from physim.campaigns.measures import USUAL
    from physim.campaigns.outcomes import Outcomes
    from physim.campaigns.report.page import comparison_page
    from physim.campaigns.report.text import comparison_text, comparison_values
    from physim.campaigns.rows import PREFIX
    from physim.campaigns.sweep import read_until
    from physim.campaigns.unlike import with_unlike

    given = tuple(str(one) for one in (a, b) if one is not None)
    folders = [Path(one) for one in given]
    read: tuple[Path, ...] = ()
    if seeds is not None:
        folders, read = [runs or usual_folder(given)], inputs(*given)
    spare(json, "--json", *folders)
    spare(output, "-o", *folders)
    check_json(json, force, read if output is None else [*read, output])
    if output is not None:
        Target(output, force, read).file(ends=PAGE)
    needs = {"--controller": controller, "--set": set, "--runs": runs, "--workers": workers}
    _check(b, by, seeds is not None, [name for name, value in needs.items() if value])
    if seeds is not None:
        grid = make_grid(given, seeds, set, list(controller), paired=True)
        dimension = by or _what_differs(grid, given)
        if dimension not in _differing(grid):
            raise PhysimError(f"--by {dimension}: there is only one")
        tell_fixed(grid, quiet)
        tally, _ = run_grid(grid, folders[0], workers=workers, quiet=quiet)
        if tally.interrupted:
            return INTERRUPTED
        order = [cell.label for cell in grid.cells]
        pairs = pairs_by(Outcomes(read_part(folders[0], grid)), dimension, order)
        name = f"{', '.join(given)}, by {dimension}"
    elif by:
        pairs = pairs_by(outcomes(a), by, [cell.label for cell in Folder(a).cells()])
        name = f"{a}, by {by}"
    else:
        one, another = folders
        pairs = between(outcomes(one), outcomes(another), (str(one), str(another)))
        name = f"{a} and {b}"
    found = compared(pairs, only or USUAL)
    if seeds is None and b is not None:
        found = with_unlike(found, Folder(a), Folder(b))
    # whether the number of runs depends on their outcomes
    looked = seeds is None and any(read_until(one) is not None for one in folders)
    if output is not None:
        write_text(output, comparison_page(found, name, looked))
    if json is not None:
        values = comparison_values(found, looked)
        write_json(json, dumps(values, indent=2, ensure_ascii=False, allow_nan=False), out)
    if quiet:
        return 0
    sys.stdout.write(comparison_text(found, looked, explain))
    known = {finding.name for one in found for finding in one.findings}
    for asked in [name for name in only or () if name not in known]:
        measure = asked.removeprefix(PREFIX)
        sys.stdout.write(f"{measure}: not compared, as no seed has a value on both sides\n")
    if output is not None:
        sys.stdout.write(f"written to {output}\n")
    return 0


def _check(b: Path | None, by: str | None, with_seeds: bool, need_seeds: list[str]) -> None:
    """Raise PhysimError for options that do not go together."""
    if with_seeds:
        if by not in (None, "world") and b is not None:
            raise PhysimError("--by: two worlds are compared by world")
        return
    if need_seeds:
        raise PhysimError(f"{need_seeds[0]}: needs --seeds A:B, the seeds to run")
    if (b is None) == (by is None):
        given = "is missing" if b is None else "cannot be combined with B"
        raise PhysimError(
            f"--by: {given}; compare two folders, physim compare A B, the cells of one, "
            "physim compare A --by controller, or run a world for it, physim compare WORLD "
            "--seeds A:B --controller X,Y"
        )


def _differing(grid: Grid) -> list[str]:
    """What the cells of a grid differ in."""
    from physim.campaigns.outcomes import CELL

    columns = zip(*(cell.label for cell in grid.cells), strict=True)
    return [name for name, values in zip(CELL, columns, strict=True) if len(set(values)) > 1]


def _what_differs(grid: Grid, worlds: tuple[str, ...]) -> str:
    """The one thing that cells differ in. Raises PhysimError where there is none, or another."""
    several = _differing(grid)
    if len(several) != 1:
        what = f"{' and '.join(several)} differ: give --by" if several else "nothing to compare"
        raise PhysimError(
            f"{' '.join(worlds)}: {what}; compared are several --controller X,Y, --set KEY=V1,V2, "
            "or two worlds"
        )
    return several[0]


def outcomes(folder: Path) -> Outcomes:
    """Rows of a campaign. Raises PhysimError where there is none, or it has no rows yet."""
    from physim.campaigns.folder import Folder, read
    from physim.campaigns.outcomes import Outcomes, missing
    from physim.campaigns.report.text import missing_words
    from physim.cli.simulating import tell

    found = Outcomes(read(folder))
    if not len(found):
        raise PhysimError(f"{folder}: its campaign has no runs yet")
    if lacks := missing_words(missing(Folder(folder).asked(), found)):
        tell([f"{folder}: {lacks}"])
    return found
