"""Rules of the paper's controller, broken: priority, path following (2) to (6), (7) to (10)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from physim import View
from tests.mutation.rules import called, found, given, instead, replaced, rule

MODES = "physim.controllers.mode_switching:"
FOLLOWING = "physim.controllers.path_following:"
FORMATION = "physim.controllers.formation:"
PRIORITY = "physim.controllers.priority:"


def seen(view: View, **arrays: Any) -> View:
    return View(view.scene, view.sensed._replace(**arrays), view)


# Priority


@rule("controllers")
def who_is_behind_has_priority() -> None:
    """A robot considers those behind it along s*, not those ahead."""
    given(
        PRIORITY + "has_priority",
        station_i=lambda a: a.station_j, station_j=lambda a: a.station_i,
        index_i=lambda a: a.index_j, index_j=lambda a: a.index_i,
    )  # fmt: skip


@rule("controllers")
def range_along_the_path_alone() -> None:
    """The range of priority holds along s* only, however far a robot is straight away."""
    given(PRIORITY + "considered_by_rank", pose=lambda a: np.zeros_like(a.pose))


@rule("controllers")
def range_straight_alone() -> None:
    """The range of priority holds straight only, however far a robot is ahead along s*."""
    given(PRIORITY + "considered_by_rank", station=lambda a: 1e-6 * a.station)


@rule("controllers")
def stations_of_own_paths_decide() -> None:
    """Formation and priority go by stations along the own paths, not along s*."""
    given(
        MODES + "ModeSwitching.decide_all",
        view=lambda a: seen(a.view, reference_station=a.view.sensed.station),
    )


@rule("controllers")
def robots_decide_one_after_the_other() -> None:
    """Who decides later in a step sees the new commands of those before, not one snapshot."""

    def tell(old: Any, a: Any) -> Any:
        looked_at = old()
        a.bodies.command[list(a.bodies.number).index(a.i)] = a.out.command[a.k]
        return looked_at

    given(
        MODES + "ModeSwitching.decide_all",
        view=lambda a: seen(a.view, command=a.view.sensed.command.copy()),
    )
    called(MODES + "decide_one", tell)


# Target and path following, (2) to (6)


@rule("controllers")
def target_straight_ahead_of_the_projection() -> None:
    """(3) leaves the path: the target lies on the tangent at the projection."""

    def straight(old: Any, a: Any) -> Any:
        x, y, tx, ty = old(look_ahead=0.0)
        return x + a.look_ahead * tx, y + a.look_ahead * ty, tx, ty

    called(FOLLOWING + "target_on_path", straight)


@rule("controllers")
def target_beyond_the_last_waypoint() -> None:
    """(3) goes on straight where the path ends, in place of the last waypoint."""

    def onward(value: Any, a: Any) -> Any:
        x, y, tx, ty = value
        last = a.paths.start[a.k + 1] - 1
        over = max(0.0, a.station + a.look_ahead - a.paths.station[last])
        return x + over * tx, y + over * ty, tx, ty

    found(FOLLOWING + "target_on_path", onward)


@rule("controllers")
def energy_is_a_distance() -> None:
    """(4) is half the distance to the target, not half its square."""
    instead(
        FOLLOWING + "target_energy", lambda a: 0.5 * math.hypot(*np.subtract(a.position, a.target))
    )


@rule("controllers")
def heading_decides_before_distance() -> None:
    """Ties of (12) and (13) go to the smaller heading error first, then to the distance."""
    found(FOLLOWING + "judged", lambda value, a: type(value)(value.error, value.gap, value.turning))


@rule("controllers")
def plan_is_judged_by_its_first_pair() -> None:
    """(5) looks at a plan as if its first speed pair were held throughout."""
    given(FOLLOWING + "plan_end", plan=lambda a: np.tile(a.plan[0], (a.dwells, 1)))


@rule("controllers")
def plan_moves_along_the_first_heading() -> None:
    """(5) foresees straight motion with a turn on the spot, not the arc of (1)."""
    instead(
        FOLLOWING + "arc",
        lambda a: (
            a.x + a.v * a.t * math.cos(a.heading),
            a.y + a.v * a.t * math.sin(a.heading),
            a.heading + a.omega * a.t,
        ),
        here=True,
    )


@rule("controllers")
def plan_is_judged_beyond_the_last_waypoint() -> None:
    """A plan is judged ``judge_ahead``, however near the last waypoint is."""
    instead(FOLLOWING + "judging_time", lambda a: a.judge_ahead)


@rule("controllers")
def heading_error_is_not_wrapped() -> None:
    """The heading error grows with every full turn of the robot."""
    instead(
        FOLLOWING + "heading_error",
        lambda a: abs(math.atan2(a.ty - a.y, a.tx - a.x) - a.heading),
    )


@rule("controllers")
def ties_go_by_the_order_of_the_sets() -> None:
    """Neither heading error nor the smaller |omega| settles a tie of (5), (12) or (13)."""
    instead(FOLLOWING + "comes_first", lambda a: a.a[0] < a.b[0] - 1e-12)


@rule("controllers")
def nobody_drives_backwards() -> None:
    """In danger the candidates have no speeds below 0."""
    given(FOLLOWING + "put_pairs", speeds=lambda a: np.maximum(a.speeds, 0.0))


# Formation, (7) to (10)


@rule("controllers")
def no_desired_distances() -> None:
    """(7) draws all robots to one station: l*_ij counts as 0."""
    given(FORMATION + "formation_sum", lead=lambda a: np.zeros_like(a.lead))


@rule("controllers")
def formation_takes_the_mean() -> None:
    """(7) adds the gain times the mean over N_i, not times the sum."""
    found(FORMATION + "formation_sum", lambda value, a: value / max(1, a.many))


@rule("controllers")
def formation_looks_ahead_only() -> None:
    """N_i holds only who is ahead, so it is not symmetric, and (10) does not hold."""

    def ahead(old: Any, a: Any) -> float:
        those = [j for j in a.neighbours[: a.many] if a.station[j] > a.station[a.me]]
        return float(old(neighbours=those, many=len(those)))

    called(FORMATION + "formation_sum", ahead)


@rule("controllers")
def limit_holds_before_the_formation() -> None:
    """A robot's top speed bounds nu_0, and (7) may go beyond it."""
    given(
        FORMATION + "forward_speed",
        rule=lambda a: a.rule._replace(nu_0=min(a.rule.nu_0, a.top_speed)),
        top_speed=lambda a: math.inf,
    )


@rule("controllers")
def energy_counts_each_pair_once() -> None:
    """(9) leaves out the pairs j < i, so that W is half of what it is."""
    given(FORMATION + "formation_energy", adjacency=lambda a: np.triu(a.adjacency))


@rule("controllers")
def energy_falls_by_the_squares_of_errors() -> None:
    """(10) sums the squares of the single errors, not the squares of the sums over N_i."""

    def rate(a: Any) -> float:
        error = np.subtract.outer(a.station - a.lead, a.station - a.lead)
        return float(-2.0 * a.alpha * (a.adjacency * error**2).sum())

    instead(FORMATION + "formation_energy_rate", rate)


@rule("controllers")
def speed_of_the_formation_without_one() -> None:
    """Without a formation robots drive at the formation's steady speed, not at their own."""

    def of(old: Any) -> Any:
        make = old.__func__
        return staticmethod(lambda plan, speed: make(plan, speed)._replace(nu_0=plan.speed))

    replaced(FORMATION + "SpeedRule.of", of)
