"""Check a world file: everything that is wrong with it, at once, without running it."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence

import numpy as np
import shapely

from physim.errors import Fault, Position, WorldError
from physim.escaping import escaped
from physim.world.checks.blind_followers import check_blind_followers
from physim.world.checks.blocked_ways import check_blocked_ways
from physim.world.checks.boundaries import check_boundaries, check_obstacles
from physim.world.checks.danger import (
    check_always_danger,
    check_safe_area,
    check_turning_room,
    chosen,
    setting,
)
from physim.world.checks.findings import Diagnostics, Finding, Findings
from physim.world.checks.formation import check_formation, check_formation_speed
from physim.world.checks.measured import check_measured
from physim.world.checks.neighbourhood import check_neighbours
from physim.world.checks.paths import (
    check_passage,
    check_paths,
    check_reference,
    check_room,
    check_width,
)
from physim.world.checks.rings import check_rings
from physim.world.checks.roads import road_notes
from physim.world.checks.room import ClearanceProfile, clearance_profiles
from physim.world.checks.safe_stops import check_safe_stops
from physim.world.checks.shared_stops import check_shared_stops
from physim.world.checks.standing import stops
from physim.world.checks.start_stations import check_far_starts, check_start_stations
from physim.world.checks.starts import (
    check_expected,
    check_footprints,
    check_headings,
    check_random_headings,
    check_scale,
    check_start_used,
)
from physim.world.checks.stops import StopLimits, check_stops, check_tolerance
from physim.world.file.files import world_document
from physim.world.file.loading import Validated, in_order, placed, validate
from physim.world.file.nodes import Document, collector_paused
from physim.world.layout.layout import lay_out
from physim.world.model import World
from physim.world.scene import Layout

MOST_REPORTED = 100
"""Errors, and likewise warnings, of one world that are reported one by one."""


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
    what would run but cannot be meant, as a path through a wall. Raises TypeError for a `World`,
    which has no lines to point at.
    """
    if isinstance(path, World):
        raise TypeError(f"check_world takes a world file, not {path!r}; save it to one")
    try:
        if seed is not None:
            overrides = [*overrides, f"seed={seed}"]
        with collector_paused():
            document = world_document(path)
            checked = validate(document, overrides=overrides, controller=controller)
    except WorldError as error:
        return _refused(error, str(path))
    document = checked.document
    found = Diagnostics(errors=checked.faults, warnings=[*document.warnings, *checked.warnings])
    profiles = _check_geometry(checked, found)
    return Findings(
        file=escaped(document.source),
        errors=_located(found.errors, document, document.faults),
        warnings=_located(found.warnings, document),
        notes=tuple(found.notes),
        clearance=profiles,
        world=checked.world,
        document=document,
    )


def _refused(error: WorldError, file: str) -> Findings:
    """Findings of a file that could not be read at all."""
    positions = error.positions or (None,) * len(error.faults)
    return Findings(
        file=escaped(file),
        errors=tuple(
            Finding.of(fault, position, str(position.file) if position is not None else file)
            for fault, position in zip(error.faults, positions, strict=True)
        ),
    )


@np.errstate(all="ignore")  # see build_scene
def _check_geometry(checked: Validated, found: Diagnostics) -> tuple[ClearanceProfile, ...]:
    """Everything that lies in where things are, of a world whose values are sound."""
    world = checked.world
    if world is None:
        return ()
    mistaken = check_scale(world, found)
    try:
        laid = lay_out(world)
        profiles = _check_layout(laid, checked, found)
        found.errors = laid.world.of_the_road(found.errors)
        found.warnings = laid.world.of_the_road(found.warnings)
        found.notes += road_notes(laid)
        return profiles
    except WorldError as error:  # in other units, the rest follows from that
        own = [fault for fault in error.faults if fault.location in mistaken]
        found.errors += own or error.faults
        return ()
    except shapely.errors.ShapelyError as error:
        reason = " ".join(str(error).split())[:100]
        found.error((), f"the geometry is beyond what can be computed ({reason})")
        return ()


def _check_layout(
    laid: Layout, checked: Validated, found: Diagnostics
) -> tuple[ClearanceProfile, ...]:
    safe_distance, low, speed = (
        setting(laid, checked.controller, key) for key in ("safe_distance", "boundary_low", "speed")
    )
    check_footprints(laid, found)
    check_boundaries(laid, found)
    check_obstacles(laid, found)
    check_start_used(checked.world, found)
    check_reference(laid, found)
    check_random_headings(laid, found)
    check_expected(laid, found)
    check_headings(laid, found)
    check_start_stations(laid, found)
    check_far_starts(laid, found)
    astray = check_paths(laid, found)
    profiles = clearance_profiles(laid, safe_distance)
    too_wide = check_width(laid, found)
    fitting = tuple(profile for profile in profiles if profile.number not in too_wide)
    check_room(laid, fitting, astray, found)
    check_passage(laid, fitting, found)
    check_safe_area(laid, safe_distance, found)
    check_always_danger(profiles, low, found)
    check_turning_room(laid, profiles, found)
    at = stops(laid)
    time, distance = (
        setting(laid, checked.controller, key) for key in ("time_low", "distance_low")
    )
    check_stops(laid, at, StopLimits(speed, time, low, distance), found)
    look_ahead = setting(laid, checked.controller, "look_ahead")
    check_safe_stops(laid, at, safe_distance, look_ahead, found)
    check_tolerance(laid, found)
    avoidance, usual = chosen(laid, checked.controller, "avoidance"), speed or 1.0
    check_formation(laid, usual, avoidance is not None, found)  # who avoids so drives by (7), too
    check_formation_speed(laid, avoidance is not None, found)
    check_neighbours(laid, found)
    check_rings(laid, found)
    check_measured(laid, found)
    check_shared_stops(laid, at, found)
    check_blocked_ways(laid, at, usual, distance or 0.0, found)
    if avoidance not in (None, "none"):
        check_blind_followers(laid, at, usual, distance or 0.0, time or 0.0, found)
    return profiles


def _located(
    faults: list[Fault], document: Document, others: Iterable[tuple[Fault, Position]] = ()
) -> tuple[Finding, ...]:
    """Each fault once, at its place, in the order of the file, and ``others`` that have theirs."""
    source = document.source
    pairs = in_order([*others, *placed(dict.fromkeys(faults), document)])
    found = [Finding.of(fault, position, source) for fault, position in pairs]
    if len(found) > MOST_REPORTED:
        left = len(found) - MOST_REPORTED + 1
        more = Finding(source, None, None, "", f"and {left} more; correct these first")
        found = [*found[: MOST_REPORTED - 1], more]
    return tuple(found)
