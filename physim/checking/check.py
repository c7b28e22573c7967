"""Check a world file: everything that is wrong with it, at once, without running it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace

import shapely

from physim.checking.clearance import ClearanceProfile
from physim.checking.danger import (
    check_always_danger,
    check_safe_area,
    check_turning_room,
    setting,
)
from physim.checking.findings import Finding, Findings, printable
from physim.checking.formation import check_formation
from physim.checking.formation_speed import check_formation_speed
from physim.checking.ground import ground_of
from physim.checking.paths import (
    check_passage,
    check_paths,
    check_reference,
    check_room,
    check_width,
    own_paths,
    profiles_of,
)
from physim.checking.scale import check_scale
from physim.checking.sketch import Sketch, sketch_of
from physim.checking.starts import (
    check_expected,
    check_headings,
    check_start_used,
    check_starts,
    check_step,
    placed_by_seed,
    sound_outlines,
)
from physim.checking.telling import Told
from physim.errors import Fault, WorldError
from physim.world_file import read_document
from physim.world_file.collector import collector_paused
from physim.world_file.file_text import file_text
from physim.world_file.loading import Judged, in_order, judge, placed
from physim.world_file.nodes import Document
from physim.world_file.shipped import find_world

MOST_TOLD = 100
"""Errors, and likewise warnings, of one world that are told one by one."""


def check_world(
    path: str | os.PathLike[str],
    *,
    overrides: Sequence[str] = (),
    controller: str | None = None,
    seed: int | None = None,
) -> Findings:
    """Check a world file, or a shipped world by its name; never raises for a bad world.

    ``overrides``, ``controller`` and ``seed`` are as the command line gives them; the world is
    checked as a run with them would read it. What `physim run` refuses is among the errors; so is
    what would run but cannot be meant, as a path through a wall.
    """
    try:
        found = find_world(path)
        if seed is not None:
            overrides = [*overrides, f"seed={seed}"]
        with collector_paused():
            document = read_document(file_text(found), str(found))
            judged = judge(document, overrides=overrides, controller=controller)
    except WorldError as error:
        return _refused(error, str(path))
    told = Told(errors=judged.faults, warnings=[*judged.document.doubts, *judged.doubts])
    profiles = _check_geometry(judged, told)
    document = judged.document
    errors = [*zip(document.faults, document.fault_positions, strict=True)]
    errors += placed(_distinct(told.errors), document)
    source = document.source
    return Findings(
        file=printable(source),
        errors=_capped([Finding.of(fault, at, source) for fault, at in in_order(errors)], source),
        warnings=_capped(_warnings(told.warnings, document), source),
        clearance=profiles,
        world=judged.world,
    )


def _refused(error: WorldError, file: str) -> Findings:
    """Findings of a file that could not be read at all."""
    positions = error.positions or (None,) * len(error.faults)
    return Findings(
        file=printable(file),
        errors=tuple(
            Finding.of(fault, position, str(position.file) if position is not None else file)
            for fault, position in zip(error.faults, positions, strict=True)
        ),
    )


def _check_geometry(judged: Judged, told: Told) -> tuple[ClearanceProfile, ...]:
    """Everything that lies in where things are; what cannot be read is passed over."""
    sketch = sketch_of(judged.values)
    if not sketch.has_formation and (speed := setting(judged, "speed")) is not None:
        sketch = replace(sketch, speed=speed)
    try:
        return _checked(sketch, judged, told)
    except shapely.errors.ShapelyError as error:
        reason = " ".join(str(error).split())[:100]
        told.error((), f"the geometry is beyond what can be computed ({reason})")
        return ()


def _checked(sketch: Sketch, judged: Judged, told: Told) -> tuple[ClearanceProfile, ...]:
    outlines = sound_outlines(sketch, told)
    check_step(sketch, outlines, told)
    ground = ground_of(sketch, told)
    paths = own_paths(sketch, told)
    sketch = placed_by_seed(sketch, judged.world, ground, outlines, paths, told)
    check_start_used(judged.world, told)
    check_reference(sketch, told)
    check_starts(sketch, ground, outlines, told)
    check_expected(sketch, judged.values, outlines, told)
    check_headings(sketch, paths, told)
    check_paths(sketch, paths, ground, told)
    safe_distance = setting(judged, "safe_distance")
    profiles = profiles_of(sketch, paths, outlines, ground, safe_distance)
    too_wide = check_width(sketch, outlines, told)
    fitting = tuple(profile for profile in profiles if profile.number not in too_wide)
    check_room(sketch, fitting, ground, told)
    check_passage(sketch, paths, fitting, ground, told)
    check_safe_area(ground, safe_distance, told)
    check_always_danger(sketch, profiles, setting(judged, "boundary_low"), told)
    check_turning_room(sketch, profiles, ground, told)
    check_formation(sketch, paths, outlines, told)
    check_formation_speed(sketch, judged.values, told)
    check_scale(sketch, judged.values, outlines, told)
    return profiles


def _distinct(faults: list[Fault]) -> list[Fault]:
    """Faults without those told twice."""
    return list(dict.fromkeys(faults))


def _warnings(faults: list[Fault], document: Document) -> list[Finding]:
    told = in_order(placed(_distinct(faults), document))
    return [Finding.of(fault, position, document.source) for fault, position in told]


def _capped(findings: list[Finding], source: str) -> tuple[Finding, ...]:
    if len(findings) <= MOST_TOLD:
        return tuple(findings)
    left = len(findings) - MOST_TOLD + 1
    more = Finding(source, None, None, "", f"and {left} more; mend these first")
    return (*findings[: MOST_TOLD - 1], more)
