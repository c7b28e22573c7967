"""What a record file holds: names, row types, version.

The file is plain HDF5 that any version of the library reads. All lengths are metres, angles
radians, times seconds, in the world frame; steps count from 0, the start.
"""

from __future__ import annotations

import numpy as np

from physim.contacts import CONTACT, FALSE_CONTACT

FORMAT = "physim-record"
VERSION = 2
"""Raised with every change that an older reader would misread. 2: contacts between samples, and
false contacts of the engine one by one."""

UNITS = "m, rad, s, N s; world frame; headings counter-clockwise from the x axis, unwrapped"

ENDED = ("running", "finished", "duration", "interrupted", "error")
"""How a run ended; a file whose run was killed still says "running"."""

ENDED_BYTES = 16
"""Length of the attribute ``ended``: fixed, so that it changes in place (see `crash_safe`)."""

UPDATE = np.dtype(
    [
        ("step", "<i8"),
        ("robot", "<i4"),
        ("mode", "i1"),
        ("wanted_v", "<f8"),
        ("wanted_omega", "<f8"),
        ("given_v", "<f8"),
        ("given_omega", "<f8"),
        ("target_x", "<f8"),
        ("target_y", "<f8"),
        ("station", "<f8"),
        ("reference_station", "<f8"),
        ("formation_error", "<f8"),
        ("deviation", "<f8"),
        ("distance", "<f8"),
        ("boundary_distance", "<f8"),
        ("collision_time", "<f8"),
        ("considered", "<i4"),
        ("evaluations", "<i4"),
        ("next_step", "<i8"),
    ]
)
"""One decision: commands [m/s, rad/s], target [m], stations [m] along the own and the reference
path, formation error [m], deviation [m] from the own path (left positive), deciding distances [m]
and collision time [s] (inf when there is none, NaN where a controller has no such value), robots
considered, collision times worked out, step of the next decision."""

EXTREME = np.dtype(
    [
        ("clearance", "<f8"),
        ("clearance_step", "<i8"),
        ("clearance_other", "<i4"),
        ("boundary_clearance", "<f8"),
        ("boundary_step", "<i8"),
        ("boundary_other", "<i4"),
    ]
)
"""Shortest distances of one robot over all physics steps [m], when, and to which body id; inf, -1
and -1 where there is nothing to be near to."""

FARTHEST = np.dtype([("farthest", "<f8"), ("step", "<i8"), ("a", "<i4"), ("b", "<i4")])
"""Largest distance between two robots over all physics steps [m], when, who; -inf and -1 for one
robot."""

NO_EXTREME = np.array((np.inf, -1, -1, np.inf, -1, -1), dtype=EXTREME)
NO_FARTHEST = np.array((-np.inf, -1, -1, -1), dtype=FARTHEST)

TABLES = {"/updates": UPDATE, "/contacts": CONTACT, "/false_contacts": FALSE_CONTACT}
"""Growing tables of rows."""

STEPS = ("/steps/step", "/steps/pose", "/steps/clearance", "/steps/boundary_clearance")
"""Growing datasets with one row a recorded sample; they come last in the file, see `crash_safe`."""

FIXED = (
    "/bodies/id",
    "/bodies/kind",
    "/bodies/name",
    "/robots/stop_station",
    "/walls/vertices",
    "/walls/part_start",
    "/walls/body_start",
    "/paths/points",
    "/paths/start",
    "/reference/points",
    "/reference/start",
    "/areas/accessible/points",
    "/areas/accessible/start",
    "/areas/safe/points",
    "/areas/safe/start",
)
"""Datasets written once, at the start."""

EXTREMES = "/extremes"
EXTREMES_FARTHEST = "/extremes_farthest"

DATASETS = (*FIXED, EXTREMES, EXTREMES_FARTHEST, *TABLES, *STEPS)
"""Every dataset that a record must have, besides the footprints."""

ATTRIBUTES = (
    "format",
    "version",
    "units",
    "name",
    "world",
    "seed",
    "dt",
    "steps_planned",
    "record_every",
    "safe_distance",
    "ended",
    "steps_run",
    "rejected_contacts",
)
"""Root attributes, all inside the digest. ``versions`` (of physim and its libraries) is outside."""

NOTES = ("filtered", "controller")
"""Root attributes that only some runs have, inside the digest: filters stood between controller and
robots; what decided, where it was an object given from Python."""

TEXTS = ("format", "units", "name", "world")
"""Attributes that are texts."""

FOOTPRINTS = "/robots/{:03d}/footprint"
"""Group of one robot's convex parts, named 00, 01, …; robots by index, never by name."""

WALL_CLOCK = "/wall_clock"
"""Group whose attributes are figures of the wall clock: outside the digest."""


def steps_rows(robots: int) -> dict[str, tuple[tuple[int, ...], str]]:
    """Shape and type of one row of each dataset in ``STEPS``."""
    shapes: dict[str, tuple[tuple[int, ...], str]] = {
        "/steps/step": ((), "<i8"),
        "/steps/pose": ((robots, 3), "<f8"),
        "/steps/clearance": ((robots,), "<f8"),
        "/steps/boundary_clearance": ((robots,), "<f8"),
    }
    return shapes


__all__ = ["CONTACT", "DATASETS", "ENDED", "EXTREME", "FARTHEST", "FORMAT", "UPDATE", "VERSION"]
