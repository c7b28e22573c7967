"""``physim compare``: is A better than B?"""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from physim.cli.options import (
    LONGEST_QUOTE,
    File,
    JsonFile,
    Out,
    Output,
    kind,
    quoted,
)
from physim.cli.output import PAGE, Target, check_json, write_json
from physim.cli.report import spare
from physim.cli.simulating import tell
from physim.errors import PhysimError, nearest
from physim.files import write_text
from physim.json_text import json_text

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
    for name in map(str.strip, text.split(",")):
        own = OWN.fullmatch(name)
        if name in DIRECTIONS:
            found[name] = DIRECTIONS[name]
        elif own and own[1] not in DIRECTIONS and PREFIX + own[1] not in found:
            found[PREFIX + own[1]] = 1 if own[2] == "more" else -1
        else:
            close = nearest(name.partition(":")[0][:LONGEST_QUOTE], list(DIRECTIONS))
            raise ValueError(
                f"some of {','.join(DIRECTIONS)}, or NAME:more, NAME:less of a metric of your own "
                f"by what is better, with commas between, each once; given: {quoted(name)}{close}"
            )
    return found


def compare(
    a: File, b: File | None = None, /, *,
    by: By | None = None,
    only: Annotated[Any, kind(measures)] = None,
    output: Output | None = None,
    json: JsonFile | None = None,
    explain: bool = False,
    force: bool = False,
    quiet: bool = False,
    out: Out,
) -> int:  # fmt: skip
    """Compare two controllers, settings or worlds on the same seeds. Each difference has an
    interval and a test, corrected for the number of comparisons. Seeds that only one of the two has
    are left out.

    arguments:
      A  folder of a campaign (physim sweep)
      [B]  folder of another campaign; not with --by

    options:
      --by WHAT  compare the cells of A that differ only in this: controller, settings or world
      --only NAME,...  compare only these rates and measures; metrics of your own as NAME:more or
          NAME:less, for which is better
      -o, --output FILE  write a page that draws each pair as a point
      --explain  say how differences are estimated and tested
      --force  overwrite an existing FILE
      --quiet  print no table

    Rates (rate: contact-free and finished; contact_free; finished) are compared by McNemar's exact
    test. Measures (least_distance, time_to_finish, deviation_peak, formation_error_peak) are
    compared by the sign test, which counts the seeds with which each of the two is better. p values
    are corrected by Holm's method.

    exit codes:
      0    compared, whatever the result
      2    bad input: one message says what and where
      130  interrupted (Ctrl-C)

    examples:
      physim sweep ten_robots --seeds 1:101 --controller mode_switching,path_following
      physim compare sweeps/ten_robots --by controller
      physim compare runs/before runs/after -o compared.html
      physim compare runs/study --by settings --only rate,time_to_finish --json -
    """
    from physim.campaigns.compare import between
    from physim.campaigns.compare import by as pairs_by
    from physim.campaigns.compare import compare as compared
    from physim.campaigns.folder import Folder, read
    from physim.campaigns.measures import USUAL
    from physim.campaigns.outcomes import Outcomes, missing
    from physim.campaigns.report.page import comparison_page
    from physim.campaigns.report.text import comparison_text, comparison_values, missing_words
    from physim.campaigns.rows import PREFIX
    from physim.campaigns.sweep import read_until
    from physim.campaigns.unlike import with_unlike

    folders = [one for one in (a, b) if one is not None]
    spare(json, "--json", *folders)
    spare(output, "-o", *folders)
    check_json(json, force, [] if output is None else [output])
    if output is not None:
        Target(output, force).file(ends=PAGE)
    if (b is None) == (by is None):
        raise PhysimError(
            f"--by: {'is missing' if b is None else 'cannot be combined with B'}; compare two "
            "folders, physim compare A B, or the cells of one, physim compare A --by controller"
        )
    found = []
    for folder in folders:
        found.append(Outcomes(read(folder)))
        if not len(found[-1]):
            raise PhysimError(f"{folder}: its campaign has no runs yet")
        if lacks := missing_words(missing(Folder(folder).asked(), found[-1])):
            tell([f"{folder}: {lacks}"])
    if by:
        name, order = f"{a}, by {by}", [cell.label for cell in Folder(a).cells()]
        made = compared(pairs_by(found[0], by, order), only or USUAL)
    else:
        name = f"{a} and {b}"
        made = compared(between(found[0], found[1], (str(a), str(b))), only or USUAL)
        made = with_unlike(made, *map(Folder, folders))
    # whether the number of runs depends on their outcomes
    looked = any(read_until(one) is not None for one in folders)
    if output is not None:
        write_text(output, comparison_page(made, name, looked))
    if json is not None:
        values = comparison_values(made, looked)
        write_json(json, json_text(values), out)
    if quiet:
        return 0
    print(comparison_text(made, looked, explain), end="")
    known = {finding.name for one in made for finding in one.findings}
    for asked in [name for name in only or () if name not in known]:
        measure = asked.removeprefix(PREFIX)
        print(f"{measure}: not compared, as no seed has a value on both sides")
    if output is not None:
        print(f"written to {output}")
    return 0
