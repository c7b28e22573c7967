"""``physim check``."""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path

from physim.checking import ClearanceProfile, Finding, Findings, check_world
from physim.errors import WorldError
from physim.world_file.shipped import find_world

INTERRUPTED = 130
MOST_ROWS = 12
"""Robots in the table of room; of more, those with least room."""


def check_command(options: argparse.Namespace) -> int:
    """Check worlds and print what is found; returns the exit code."""
    return _watched(options) if options.watch else told(options)


def _watched(options: argparse.Namespace) -> int:
    """Check now and after each save, until Ctrl-C."""
    from physim.cli.progress import interrupts
    from physim.cli.watching import watch

    def check() -> None:
        print(f"-- {time.strftime('%H:%M:%S')}")
        told(options)
        sys.stdout.flush()

    with interrupts() as interrupt:
        watch([_file(world) for world in options.worlds], check, interrupt)
    print("interrupted", file=sys.stderr)
    return INTERRUPTED


def _file(world: str) -> Path:
    """File of a world; where there is none yet, the one that is waited for."""
    try:
        return find_world(world)
    except WorldError:
        return Path(world)


def told(options: argparse.Namespace) -> int:
    """Check worlds once and print what is found; returns the exit code."""
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
    shown = profiles
    if len(profiles) > MOST_ROWS:
        tightest = sorted(profiles, key=lambda p: p.narrowest[3] - p.circumscribed)
        shown = tuple(sorted(tightest[:MOST_ROWS], key=lambda p: p.number))
    wide = max(5, *(len(profile.robot) for profile in shown))
    wide = min(wide, 30)
    lines = ["room on the paths [m]:"]
    lines.append(
        f"  {'robot':<{wide}}  path   least room  at station  radii         in danger  on its path"
    )
    for p in shown:
        name = p.robot if len(p.robot) <= wide else p.robot[: wide - 1] + "…"
        share = "-" if p.danger_share is None else f"{100.0 * p.danger_share:.0f} %"
        radii = f"{p.inscribed:.2f} to {p.circumscribed:.2f}"
        lines.append(
            f"  {name:<{wide}}  {p.station[-1]:<6.1f} {p.narrowest[3]:<11.2f} "
            f"{p.narrowest[0]:<11.1f} {radii:<13} {share:<9}  {p.verdict}"
        )
    if len(shown) < len(profiles):
        lines.append(f"  and {len(profiles) - len(shown)} more with more room (--json has all)")
    return [*(line.rstrip() for line in lines), ""]
