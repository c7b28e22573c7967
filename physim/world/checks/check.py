"""Check a world file: what is wrong with it, or seldom meant, without running it.

Values first; where these are sound the geometry; where that is sound what could run, but cannot be
meant. How robots behave is shown by a run, see `physim.analysis.trial`.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np
import shapely

from physim.errors import Fault, WorldError
from physim.escaping import escaped
from physim.world.checks import formation, ground, paths, starts
from physim.world.checks.findings import Finding, Findings
from physim.world.checks.room import ClearanceProfile, clearance_profiles
from physim.world.checks.scale import check_scale
from physim.world.file import Document, read_world
from physim.world.layout.layout import lay_out
from physim.world.model import World
from physim.world.scene import Layout

CHECKS: tuple[Callable[[Layout], Iterable[Fault]], ...] = (
    ground.check_folds,
    ground.check_obstacles,
    starts.check_footprints,
    starts.check_start_used,
    starts.check_random_headings,
    starts.check_headings,
    starts.check_walled_off,
    starts.check_far,
    starts.check_expected,
    paths.check_reference,
    paths.check_paths,
    formation.check_length,
    formation.check_ends,
    formation.check_stops,
    formation.check_spacing,
    formation.check_slow,
    formation.check_neighbours,
)


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
        world, document = read_world(path, overrides=overrides, controller=controller, seed=seed)
    except WorldError as error:
        file, positions = str(path), error.positions or (None,) * len(error.faults)
        pairs = zip(error.faults, positions, strict=True)
        found = (Finding.of(fault, at, file if at is None else str(at.file)) for fault, at in pairs)
        return Findings(file=escaped(file), errors=tuple(found))
    faults = [replace(one, severity="warning") for one in document.warnings]
    faults += check_scale(world)
    laid, profiles, notes = _laid_out(world, faults)
    return Findings(
        file=escaped(document.source),
        errors=_located([one for one in faults if one.severity == "error"], document),
        warnings=_located([one for one in faults if one.severity == "warning"], document),
        notes=notes,
        clearance=profiles,
        layout=laid,
        document=document,
    )


@np.errstate(all="ignore")  # see build_scene
def _laid_out(
    world: World, faults: list[Fault]
) -> tuple[Layout | None, tuple[ClearanceProfile, ...], tuple[str, ...]]:
    """Where things are, the room on the paths, and notes; adds the faults that lie in that."""
    try:
        laid = lay_out(world)
        found = [*ground.check_boundaries(world)]
        found += [fault for check in CHECKS for fault in check(laid)]
        profiles = clearance_profiles(laid)
        faults += [*found, *paths.check_room(laid, profiles, found)]
        return laid, profiles, ground.road_notes(laid)
    except WorldError as error:
        faults += error.faults
        if all(fault.location[:1] != ("boundaries",) for fault in error.faults):
            faults += ground.check_boundaries(world)  # they may follow from that
    except shapely.errors.ShapelyError as error:
        reason = " ".join(str(error).split())[:100]
        faults.append(Fault((), f"the geometry is beyond what can be computed ({reason})"))
    return None, (), ()


def _located(faults: Sequence[Fault], document: Document) -> tuple[Finding, ...]:
    """Each fault once, at its place, in the order of the file."""
    error = document.error(faults)
    pairs = zip(error.faults, error.positions, strict=True)
    return tuple(Finding.of(fault, position, document.source) for fault, position in pairs)
