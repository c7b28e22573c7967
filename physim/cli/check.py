"""``physim check``."""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

from physim.cli.parser import Options, changes, command, flag
from physim.cli.watching import watch
from physim.errors import WorldError

if TYPE_CHECKING:
    from physim.checking import ClearanceProfile, Finding, Findings

MOST_ROWS = 12
"""Robots in the table of room; of more, those with least room."""


@command("check", "find every fault of a world before running it")
@click.argument(
    "worlds",
    nargs=-1,
    required=True,
    metavar="WORLD...",
    help="a world file, or the name of a shipped world",
)
@changes("every world")
@flag("--json", "print everything as JSON instead")
@flag("--watch", "check again whenever a file is saved, until Ctrl-C")  # fmt: skip
def check_command(options: Options) -> int:
    """Read worlds strictly and look at their geometry: all errors and warnings at once, each with
    file, line and column, and the room that each robot has on its path.

    exit codes:
      0    no errors; there may be warnings
      2    errors: each with file, line and column
      130  interrupted (Ctrl-C), the way to end --watch

    examples:
      physim check my_world.yaml
      physim check worlds/*.yaml --json
      physim check my_world.yaml --watch         keep it running beside the editor
      physim check ten_robots --seed 3 --set corridor.width=6.0
                                                 as physim run with these would read it
    """
    return _check_on_save(options) if options.watch else _check_once(options)


def _check_on_save(options: Options) -> int:
    """Check now and after each save, until Ctrl-C."""

    def check() -> None:
        print(f"-- {time.strftime('%H:%M:%S')}")
        _check_once(options)
        sys.stdout.flush()

    return watch([_file(world) for world in options.worlds], check)


def _file(world: str) -> Path:
    """File of a world; where there is none yet, the one that is waited for."""
    from physim.world_file.shipped import find_world

    try:
        return find_world(world)
    except WorldError:
        return Path(world)


def _check_once(options: Options) -> int:
    """Check worlds once and print what is found; returns the exit code."""
    from physim.checking import check_world

    found = [
        check_world(
            world, overrides=options.overrides, controller=options.controller, seed=options.seed
        )
        for world in options.worlds
    ]
    if options.json:
        print(json.dumps(json_of(found), indent=1))
    else:
        print("\n".join(text_of(findings) for findings in found), end="")
    return 0 if all(findings.ok for findings in found) else 2


def json_of(found: list[Findings]) -> dict[str, object]:
    """Everything that was found, as JSON holds it."""
    return {
        "format": "physim-check",
        "version": 1,
        "errors": sum(len(findings.errors) for findings in found),
        "warnings": sum(len(findings.warnings) for findings in found),
        "worlds": [findings.as_json() for findings in found],
    }


def text_of(findings: Findings) -> str:
    """What was found in one world: errors, warnings, room, and a last line that sums up."""
    lines: list[str] = []
    for title, group in (("errors", findings.errors), ("warnings", findings.warnings)):
        if group:
            lines += [f"{title}:", *(f"  {one}" for one in map(str, group)), ""]
    lines += _room(findings.clearance)
    lines.append(f"{findings.file}: {_count(findings.errors, 'error')}, "
                 f"{_count(findings.warnings, 'warning')}")  # fmt: skip
    return "\n".join(lines) + "\n"


def _count(group: tuple[Finding, ...], what: str) -> str:
    return f"{len(group) or 'no'} {what}{'' if len(group) == 1 else 's'}"


def _room(profiles: tuple[ClearanceProfile, ...]) -> list[str]:
    """Table of the room that each robot has on its path."""
    if not profiles:
        return []
    listed = profiles
    if len(profiles) > MOST_ROWS:
        tightest = sorted(profiles, key=lambda p: p.narrowest[3] - p.circumscribed)
        listed = tuple(sorted(tightest[:MOST_ROWS], key=lambda p: p.number))
    wide = max(5, *(len(profile.robot) for profile in listed))
    wide = min(wide, 30)
    lines = ["room on the paths [m]:"]
    lines.append(
        f"  {'robot':<{wide}}  path   least room  at station  radii         in danger  on its path"
    )
    for p in listed:
        name = p.robot if len(p.robot) <= wide else p.robot[: wide - 1] + "…"
        share = "-" if p.danger_share is None else f"{100.0 * p.danger_share:.0f} %"
        radii = f"{p.inscribed:.2f} to {p.circumscribed:.2f}"
        lines.append(
            f"  {name:<{wide}}  {p.station[-1]:<6.1f} {p.narrowest[3]:<11.2f} "
            f"{p.narrowest[0]:<11.1f} {radii:<13} {share:<9}  {p.verdict}"
        )
    if len(listed) < len(profiles):
        lines.append(f"  and {len(profiles) - len(listed)} more with more room (--json has all)")
    return [*(line.rstrip() for line in lines), ""]
