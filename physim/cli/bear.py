"""``physim bear``: how much a world can bear."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from physim.cli.options import Out, Output, Seeds, Workers, World, kind, real
from physim.cli.progress import Bar
from physim.cli.simulating import tell
from physim.errors import PhysimError, plain_key
from physim.files import write_text
from physim.json_text import json_text
from physim.terminal import INTERRUPTED, interrupts

if TYPE_CHECKING:
    from physim.statistics import Decision

VALUES, PICTURES = "bear.json", ("bear.png", "bear.svg")

Share = Annotated[
    float,
    kind(real(math.ulp(0.0), math.nextafter(1.0, 0.0), "a share above 0 and below 1, as 0.95")),
]
Number = Annotated[
    float, kind(real(-1e12, 1e12, "a number from -1e12 to 1e12"), allow_leading_hyphen=True)
]
Width = Annotated[float, kind(real(1e-12, 1e12, "a number above 0"))]


def bear(
    world: World, /, *,
    vary: str,
    target: Share,
    most: Number,
    least: Number = 0.0,
    precision: Width | None = None,
    rate: Literal['contact_free', 'finished', 'rate'] = 'contact_free',
    seeds: Seeds = range(1000),
    confidence: Share = 0.95,
    controller: str | None = None,
    set: tuple[str, ...] = (),
    workers: Workers | None = None,
    output: Output | None = None,
    json: bool = False,
    quiet: bool = False,
    out: Out,
) -> int:  # fmt: skip
    """Find how much a world can bear: the strength of noise, delay, loss or any other number at
    which the rate of contact-free runs falls below a target. A bisection chooses strengths from
    --least to --most; at each, seed after seed is run until the rate is surely at least the target
    or surely below it. The result is a bracket around the limit. Repeat the command to continue
    after an interruption; another --target or more --seeds use the runs that are there.

    options:
      --vary KEY  number to vary: a key of the world, e.g. formation.gain or robots.0.limits.v; or
          TYPE.SETTING of a registered stage (physim list), e.g. noise.position: the one of that
          type in the world, else one that is added with this setting alone
      --target RATE  rate of good runs to keep, e.g. 0.95
      --most X  greatest strength
      --least X  least strength (0)
      --precision X  how near the ends of the bracket are to be (default: a 32nd of what lies
          between --least and --most; whole numbers where the key takes no others)
      --rate WHICH  good runs: contact_free, finished, or rate (both) (contact_free)
      --seeds A:B  seeds A to B - 1, the most that are run at each strength (0:1000)
      --confidence SHARE  probability with which all intervals hold together (0.95)
      --controller NAME  use this controller instead of the world's: a registered one (physim list),
          or your own as module:Class
      --set KEY=VALUE  change another key of the world (may be repeated)
      --workers N  processes (as many as cores, at most 8); the result is the same
      -o, --output DIR  folder (default: bear/WORLD-KEY)
      --json  print the result as JSON instead
      --quiet  print no progress and no result

    written to DIR:
      bear.png, bear.svg  the rate with its intervals over the strength
      bear.json           the strengths that were tried, and the bracket
      results.csv, ...    the runs, as physim sweep writes them (for physim report, physim replay)

    exit codes:
      0    found out, whatever it is
      2    bad input; nothing that was written is lost
      130  interrupted (Ctrl-C, SIGTERM): finished runs are kept; the same command continues

    examples:
      physim bear ten_robots --vary noise.position --most 0.5 --target 0.95
      physim bear my_world.yaml --vary delay.steps --most 40 --target 0.9 --rate finished
      physim bear crossing --vary robots.0.limits.v --least 0.5 --most 3 --target 0.99
    """
    from physim.campaigns.bear import Borne, each_confidence, named, next_strength, unit_of, varied
    from physim.campaigns.cluster import executor
    from physim.campaigns.grid import make_grid
    from physim.campaigns.report.borne import borne_text, borne_values, picture
    from physim.campaigns.sweep import sweep_until
    from physim.drawing.plots.style import save_figure
    from physim.statistics import Goal
    from physim.world.file.files import stem_of
    from physim.world.layout.scene_builder import TO_DRAW

    over = varied(world, vary, least, most, precision, set, controller)
    with named(vary, over.key):
        grid = make_grid(
            [world], seeds, [*set, over.axis], [] if controller is None else [controller]
        )
    own = [line for line in grid.warnings if line.startswith(f"--set {over.key}:")]
    tell(line for line in grid.warnings if line not in own)
    tell(line.replace(f"--set {over.key}", f"--vary {vary}", 1) for line in own[:1])
    if grid.fixed:
        raise PhysimError(
            f"{stem_of(world)}: nothing is random in it, so that a strength has no rate; {TO_DRAW}"
        )
    strengths, goal = over.strengths, Goal(rate, ">", target)
    folder = output or Path("bear") / f"{stem_of(world)}-{plain_key(vary)}"
    now = ""

    def turn(known: Mapping[int, Decision]) -> int | None:
        nonlocal now
        k = next_strength(known, len(strengths) - 1)
        now = "" if k is None else f"{vary} = {strengths[k]:g}"
        return k

    steps = 2 + math.ceil(math.log2(len(strengths)))
    with interrupts() as interrupt, Bar("bear", steps * len(seeds), "runs at most", quiet) as bar:
        tally, known = sweep_until(
            grid, folder, partial(executor, workers), goal, turn=turn, stop=interrupt,
            confidence=each_confidence(confidence, len(strengths)),
            progress=lambda tally: bar.update(tally.known, lambda: f"{now}, {tally.note}"),
        )  # fmt: skip
    name, _, driver = grid.cells[0].label
    found = Borne(name, driver, vary, goal, confidence, strengths, known, tally.interrupted,
                  unit_of(vary))  # fmt: skip
    values = json_text(borne_values(found))
    write_text(folder / VALUES, values)
    for name in PICTURES:
        save_figure(folder / name, name.rpartition(".")[2], partial(picture, found))
    if json:
        print(values, end="", file=out)
    elif not quiet:
        print(borne_text(found), end="")
        print(f"{tally.known:,} runs ({tally.before:,} were there before); written to {folder}")
    return INTERRUPTED if tally.interrupted else 0
