"""Rules of the paper's controller, broken: avoidance (11) to (14), modes, safe area, arrival."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tests.helpers import inside
from tests.mutation.rules import called, found, given, instead, rule

AVOIDANCE = "physim.controllers.avoidance:"
MODES = "physim.controllers.mode_switching:"
DECISION = "physim.controllers.decision:"
SAFE_AREA = "physim.controllers.safe_area:"
SWITCHING = "physim.controllers.switching:"
SAFE, DISTANCE, TIME = 0, 1, 2


# Distance and collision time, (11) to (13)


def standing(a: Any) -> Any:
    return a.bodies._replace(command=np.zeros_like(a.bodies.command))


@rule("controllers")
def distance_is_that_of_reference_points() -> None:
    """(11) takes robots for points."""
    instead(
        AVOIDANCE + "distance_to",
        lambda a: math.hypot(a.there[0] - a.pose[0], a.there[1] - a.pose[1]),
    )


@rule("controllers")
def distance_of_touching_robots_is_nought() -> None:
    """(12) sees no better way out of an overlap than another."""
    found(AVOIDANCE + "distance_to", lambda value, a: max(value, 0.0))


@rule("controllers")
def others_stand_in_12() -> None:
    """(12) foresees the robot's own motion, and the others where they are."""
    given(AVOIDANCE + "distance_after", bodies=standing)


@rule("controllers")
def reference_point_decides_at_the_boundary() -> None:
    """The boundary distance is that of the reference point, not of the footprint."""
    point_clearance = inside("physim.controllers", "point_clearance")
    all_seen = inside("physim.geometry", "all_seen")

    instead(
        DECISION + "seen_distance",
        lambda a: point_clearance(a.sight.tree.walls, all_seen(a.sight), a.pose[0], a.pose[1]),
        here=True,
    )


# Modes (Fig. 5) and (14)


@rule("controllers")
def held_command_decides_on_danger() -> None:
    """The collision time that decides is that of the command held, not of safe mode's next."""
    given(DECISION + "smallest_time", pair=lambda a: a.bodies.command[a.near.me], here=True)


@rule("controllers")
def danger_takes_both() -> None:
    """Danger begins only where distance and collision time are short at once."""

    def both(old: Any, a: Any) -> Any:
        far = {"distance": math.inf, "collision_time": math.inf, "boundary_distance": math.inf}
        by_distance = old(**far | {"distance": a.distance})
        by_time = old(**far | {"collision_time": a.collision_time})
        by_boundary = old(**far | {"boundary_distance": a.boundary_distance})
        return old() if by_boundary != SAFE or SAFE not in (by_distance, by_time) else SAFE

    called(SWITCHING + "next_mode", both)


@rule("controllers")
def thresholds_are_exchanged() -> None:
    """Danger begins at the upper thresholds and ends at the lower ones."""
    given(
        SWITCHING + "next_mode",
        rules=lambda a: a.rules._replace(
            distance_low=a.rules.distance_high, distance_high=a.rules.distance_low,
            time_low=a.rules.time_high, time_high=a.rules.time_low,
        ),
    )  # fmt: skip


@rule("controllers")
def rules_of_danger_are_exchanged() -> None:
    """A short distance calls for (13), a short collision time for (12)."""
    found(SWITCHING + "next_mode", lambda mode, a: (SAFE, TIME, DISTANCE)[mode])


@rule("controllers")
def mode_before_is_forgotten() -> None:
    """There is no hysteresis."""
    given(SWITCHING + "next_mode", previous=lambda a: SAFE)


@rule("controllers")
def rule_of_danger_stays() -> None:
    """Who came into danger by distance stays with (12) until it is safe, and so for (13)."""
    found(
        SWITCHING + "next_mode",
        lambda mode, a: a.previous if SAFE not in (mode, a.previous) and a.previous < 3 else mode,
    )


@rule("controllers")
def safe_mode_avoids_nothing_it_touches() -> None:
    """Shapes that touch are no danger."""
    found(
        SWITCHING + "next_mode",
        lambda mode, a: SAFE if min(a.distance, a.boundary_distance) <= 0.0 else mode,
    )


@rule("controllers")
def interval_is_the_longer_one() -> None:
    """(14) holds a command for a share of the collision time where that is longer."""
    instead(SWITCHING + "update_interval", lambda a: max(a.longest, a.beta * a.collision_time))


@rule("controllers")
def interval_goes_by_the_safe_command() -> None:
    """(14) takes the collision time of the command that safe mode would have given, in (13)."""
    found(AVOIDANCE + "longest_pair", lambda value, a: (value[0], a.known_time))


# Safe area, stops


@rule("controllers")
def roomiest_point_replaces_every_target() -> None:
    """A target in the danger area goes to the roomiest point, though a safe one is near."""
    found(
        SAFE_AREA + "nearest_safe_point", lambda value, a: value._replace(is_found=False), here=True
    )


@rule("controllers")
def no_target_is_moved() -> None:
    """The danger area along the boundaries does not matter to the target."""
    instead(SAFE_AREA + "safe_target", lambda a: a.target.at)


@rule("controllers")
def safe_point_from_the_robot() -> None:
    """The safe point is that next to the robot, not that next to the target."""
    given(SAFE_AREA + "safe_target", target=lambda a: a.target._replace(at=a.position))


@rule("controllers")
def way_to_a_safe_point_may_cross_walls() -> None:
    """A target is moved to the nearest safe point, behind a wall if that is nearest."""
    instead(SAFE_AREA + "crosses", lambda a: False)


@rule("controllers")
def safe_points_behind_serve() -> None:
    """A safe point may lie any way behind the target."""
    given(SAFE_AREA + "nearest_safe_point", place=lambda a: a.place._replace(back=math.inf))


@rule("controllers")
def roomiest_point_is_the_target() -> None:
    """In a narrow place the target stays, wherever in the cross-section it is."""
    instead(SAFE_AREA + "roomiest_point", lambda a: a.place.target)


@rule("controllers")
def everybody_drives_to_its_paths_end() -> None:
    """Stops are not staggered by the formation: they crowd at the ends of the paths."""

    def at_the_end(a: Any) -> Any:
        last = a.cluster.paths.start[1:] - 1
        return a.cluster._replace(stop_station=a.cluster.paths.station[last])

    given(MODES + "decide_one", cluster=at_the_end)


@rule("controllers")
def arrival_by_the_way_left_straight() -> None:
    """A robot stands once it is near its stop by the straight way, round a bend before it."""
    point_at = inside("physim.geometry", "point_at")

    def near(a: Any) -> Any:
        stop = a.cluster.stop_station[a.i]
        x, y = point_at(a.cluster.paths, a.i, stop)[:2]
        at = a.bodies.pose[list(a.bodies.number).index(a.i)]
        return stop if math.hypot(x - at[0], y - at[1]) < 1.0 else a.station

    given(MODES + "decide_one", station=near)
