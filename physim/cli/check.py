"""``physim check`` and ``physim preview``: a world looked at before it is run, or at every save."""

from __future__ import annotations

import sys
import time
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from physim.cli.options import AS_IT_IS, Changes, JsonFlag, Out, Output, World, Worlds
from physim.cli.output import Target, inputs
from physim.cli.progress import watch as on_each_save
from physim.cli.simulating import to_the_end
from physim.errors import PhysimError, WorldError
from physim.json_text import json_text

if TYPE_CHECKING:
    from physim.world.checks import ClearanceProfile, Findings


MOST_ROWS = 12
"""Robots in the table of room; of more those with least room."""


def check(
    *worlds: Worlds,
    changes: Changes = AS_IT_IS,
    no_run: bool = False,
    json: JsonFlag = False,
    watch: bool = False,
    out: Out,
) -> int:  # fmt: skip
    """Report all errors and warnings of worlds, each with file, line and column, and the room that
    each robot has on its path. Then run each world without errors once: if a robot touches
    something or does not arrive, that is a warning, too; if its controller fails, an error.

    options:
      --no-run  check without a trial run
      --watch  check again whenever a file is saved, until Ctrl-C

    exit codes:
      0    no errors; there may be warnings
      2    errors: each with file, line and column
      130  interrupted (Ctrl-C), which also ends --watch

    examples:
      physim check my_world.yaml
      physim check worlds/*.yaml --json
      physim check my_world.yaml --watch         keep it running beside the editor
      physim check ten_robots --seed 3 --set corridor.width=6.0
                                                 check the world that physim run would run
    """

    def once() -> int:
        told = {**changes.reading, "seed": changes.seed}
        found = [looked_at(world, run=not no_run, quiet=json, **told) for world in worlds]
        if json:
            values = {
                "format": "physim-check",
                "version": 2,
                "errors": sum(len(findings.errors) for findings, _ in found),
                "warnings": sum(len(findings.warnings) for findings, _ in found),
                "worlds": [{**findings.as_json(), "trial": trial} for findings, trial in found],
            }
            print(json_text(values), end="", file=out)
        else:
            print("\n".join(text_of(*one) for one in found), end="")
        return 0 if all(findings.ok for findings, _ in found) else 2

    def on_save() -> None:
        print(f"-- {time.strftime('%H:%M:%S')}")
        once()
        out.flush()

    if not watch:
        return once()
    files = [file for one in worlds for file in inputs(one) or (Path(one),)]  # there or to come
    return on_each_save(files, on_save)


def looked_at(
    world: str | Path, *, run: bool, quiet: bool, **changes: Any
) -> tuple[Findings, str | None]:
    """What a world file shows, and, where it is to ``run``, a trial: what that found comes last.

    And the line on the trial; None where there was none. ``changes`` are those of `check_world`.
    Ctrl-C raises KeyboardInterrupt.
    """
    from physim.world.checks import check_world

    findings = check_world(world, **changes)
    if not run or not findings.ok or findings.layout is None:
        return findings, None
    from physim.analysis.trial import try_world

    laid, trusted = findings.layout, changes.get("controller") is not None
    tried = partial(try_world, laid, trusted=trusted)
    trial = to_the_end(tried, "trying it", laid.world.time.duration, quiet)
    warnings = [one for one in trial.faults if one.severity == "warning"]
    errors = [one for one in trial.faults if one.severity == "error"]
    shown = replace(
        findings,
        errors=(*findings.errors, *map(findings.located, errors)),
        warnings=(*findings.warnings, *map(findings.located, warnings)),
    )
    return shown, trial.line


def text_of(findings: Findings, trial: str | None = None) -> str:
    """What was found in one world: errors, warnings, room, and a last line that sums up."""
    from physim.world.checks.findings import finding_lines

    lines: list[str] = []
    for title, group in (("errors", findings.errors), ("warnings", findings.warnings)):
        if group:
            lines += [f"{title}:", *(f"  {line}" for line in finding_lines(group)), ""]
    lines += [*_room(findings.clearance), *findings.notes, *filter(None, [trial])]
    lines.append(f"{findings.file}: {findings.count}")
    return "\n".join(lines) + "\n"


def _room(profiles: tuple[ClearanceProfile, ...]) -> list[str]:
    """Table of the room that each robot has on its path."""
    if not profiles:
        return []
    tightest = sorted(profiles, key=lambda p: p.narrowest[3] - p.circumscribed)[:MOST_ROWS]
    wide = min(max(5, *(len(p.robot) for p in tightest)), 30)
    lines = [
        "room on the paths [m]:",
        f"  {'robot':<{wide}}  from–to         least room  at station  radii         on its path",
    ]
    for p in sorted(tightest, key=lambda p: p.number):
        name = p.robot if len(p.robot) <= wide else p.robot[: wide - 1] + "…"
        span = f"{p.reached[0]:.1f}–{p.reached[1]:.1f}"
        radii = f"{p.inscribed:.2f} to {p.circumscribed:.2f}"
        lines.append(
            f"  {name:<{wide}}  {span:<14}  {p.narrowest[3]:<10.2f}  {p.narrowest[0]:<10.1f}  "
            f"{radii:<12}  {p.verdict}"
        )
    if more := len(profiles) - len(tightest):
        lines.append(f"  and {more} more with more room (--json has all)")
    return [*lines, ""]


def preview(
    world: World, /, *,
    output: Output | None = None,
    watch: bool = False,
    force: bool = False,
    changes: Changes = AS_IT_IS,
) -> int:  # fmt: skip
    """Draw one picture of a world: boundaries, safe and danger area, paths, robots at the start,
    the narrowest place, and the width along the path of the first robot.

    options:
      -o, --output FILE  picture, ending in .png or .svg (default: the world's file name with .png,
          here)
      --watch  draw again whenever the world is saved, until Ctrl-C
      --force  overwrite an existing picture

    exit codes:
      0    drawn
      2    bad input: every fault of the world with its place in the file
      130  interrupted (Ctrl-C), as --watch always ends

    examples:
      physim preview ten_robots
      physim preview my_world.yaml -o my_world.svg
      physim preview my_world.yaml --watch       keep the picture open beside the editor
    """
    from physim.drawing.preview import save_preview
    from physim.world.checks import check_world
    from physim.world.file import read_world
    from physim.world.file.files import find_world, stem_of
    from physim.world.layout.layout import lay_out

    file = find_world(world)
    path = output or Path(f"{stem_of(file)}.png")
    Target(path, force, inputs(world)).file(in_new=True)

    def draw() -> None:
        world_, document = read_world(world, **changes.reading)
        try:
            laid = lay_out(world_, changes.seed)
        except WorldError as error:
            raise document.error(error.faults) from None
        save_preview(laid, path, trusted=changes.controller is not None)

    def draw_and_tell() -> None:
        """Draw, and print what `physim check` finds; with faults the picture stays."""
        now = time.strftime("%H:%M:%S")
        try:
            draw()
        except PhysimError as error:
            print(error, file=sys.stderr)
            stays = f"{now}  {path} stays as it is until the faults are corrected"
            print(stays, file=sys.stderr, flush=True)
            return
        print(f"{now}  {path} drawn", flush=True)
        print(check_world(world, **changes.reading, seed=changes.seed), file=sys.stderr, flush=True)

    if watch:
        return on_each_save([file], draw_and_tell)
    draw()
    print(path)
    return 0
