"""Rules of the physics, broken: motion (1), contacts, friction, impulses, energy, states."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tests.mutation.rules import called, found, given, instead, rule

CUTTING = "physim.simulation.engine.cutting:"
ENERGY = "physim.simulation.engine.energy:"
HOST = "physim.simulation.engine.host:"
PAIRS = "physim.simulation.engine.pairs:"
SPACE = "physim.simulation.engine.space:"
VERDICT = "physim.simulation.engine.verdict:"
APART, ACTS, LEFT, SIDE = range(4)


# Motion


@rule("engine")
def robots_move_along_their_first_heading() -> None:
    """A step goes along the heading at its start, not along the chord of the arc (1)."""
    instead(
        "physim.geometry.motion:chord_velocity",
        lambda a: (a.v * math.cos(a.heading), a.v * math.sin(a.heading)),
    )


# Contact


@rule("engine")
def nothing_rubs() -> None:
    """No contact has friction."""
    given(SPACE + "build_space", friction=lambda a: 0.0)


@rule("engine")
def friction_and_elasticity_are_exchanged() -> None:
    """What rubs bounces, and what bounces rubs."""
    given(SPACE + "build_space", friction=lambda a: a.elasticity, elasticity=lambda a: a.friction)


@rule("engine")
def impacts_lose_no_energy() -> None:
    """Every impact is wholly elastic."""
    given(SPACE + "build_space", elasticity=lambda a: 1.0)


@rule("engine")
def robots_are_equally_heavy() -> None:
    """Every robot has the mean mass."""
    given(HOST + "Physics.__init__", mass=lambda a: np.full(len(a.mass), np.mean(a.mass)))


@rule("engine")
def nobody_is_turned() -> None:
    """Contacts change how robots move, not how they turn."""

    def straight(a: Any) -> Any:
        allowed = a.allowed.copy()
        allowed[:, 2] = a.wanted[:, 2]
        return allowed

    given(PAIRS + "hold_back", allowed=straight)


@rule("engine")
def moment_is_about_the_middle() -> None:
    """The moment of inertia is that about the centre of the area, not the reference point."""

    def about_the_middle(value: float, a: Any) -> float:
        area, first = 0.0, np.zeros(2)
        for part in a.parts:
            after = np.roll(part, -1, axis=0)
            cross = part[:, 0] * after[:, 1] - part[:, 1] * after[:, 0]
            area += 0.5 * cross.sum()
            first += (cross[:, None] * (part + after)).sum(axis=0) / 6.0
        return float(value - a.mass * np.square(first / area).sum())

    found("physim.geometry.polygon:moment", about_the_middle)


@rule("engine")
def contact_holds_wholly() -> None:
    """A robot in contact stands, in place of moving as contact allows."""
    given(PAIRS + "hold_back", allowed=lambda a: np.zeros_like(a.allowed))


@rule("engine")
def only_the_first_of_a_pair_is_held() -> None:
    """Actio without reactio: of two robots the second goes on as commanded."""
    given(
        PAIRS + "hold_back",
        key=lambda a: np.array(
            [one // a.bodies * a.bodies + a.bodies - 1 for one in a.key], dtype=np.int64
        ),
    )


@rule("engine")
def pushes_go_to_everybody() -> None:
    """All robots get the engine's velocities while anything touches, free ones too."""

    def all_of_them(old: Any, a: Any) -> None:
        a.wanted[:] = a.allowed

    called(PAIRS + "hold_back", all_of_them)


@rule("engine")
def what_the_engine_reports_is_believed() -> None:
    """A contact that the exact check finds apart is kept."""
    found(VERDICT + "classify", lambda value, a: (value[0] or ACTS, *value[1:]))


@rule("engine")
def joints_hold_robots() -> None:
    """The end of a segment holds a robot that slides along a wall, as if nothing met it there."""

    def none(links: Any, a: Any) -> Any:
        return links._replace(part=np.full_like(links.part, -1))

    found(VERDICT + "segment_links", none)


@rule("engine")
def side_contacts_go_their_shortest_way() -> None:
    """In a corner that closes a robot is pushed the shortest way out of each segment."""
    found(
        VERDICT + "classify",
        lambda value, a: (ACTS, *value[1:]) if value[0] == SIDE else value,
    )


@rule("engine")
def the_engine_knows_where_parts_meet() -> None:
    """Point and normal of a contact along an edge are never set right."""
    instead("physim.simulation.engine.meeting:is_misled", lambda a: False)


# Depth and energy


@rule("engine")
def all_stop_with_the_first() -> None:
    """Where one pair would come too deep every robot stops when that pair does."""

    def at_once(old: Any, a: Any) -> None:
        old()
        a.moves.share[:] = a.moves.share.min(initial=1.0)

    called(CUTTING + "cut_short", at_once)


@rule("engine")
def bodies_stop_short() -> None:
    """Who is stopped within a step stops apart from what it met, and so loses the contact."""

    def earlier(old: Any, a: Any) -> None:
        old()
        a.moves.share[a.moves.share < 1.0] *= 0.9

    called(CUTTING + "cut_short", earlier)


@rule("engine")
def depth_allowed_is_that_of_a_short_step() -> None:
    """Long steps may end no deeper than short ones."""
    given("physim.contacts:allowed_depth", step=lambda a: 0.01)


@rule("engine")
def contacts_may_add_energy() -> None:
    """What the solver makes of contacts is believed, however fast robots leave them."""

    called(ENERGY + "failures", lambda old, a: np.zeros(0, dtype=np.bool_))


@rule("engine")
def each_robot_has_its_own_energy() -> None:
    """A robot may take none from another that pushes it."""
    given(ENERGY + "failures", pairs=lambda a: type(a.pairs)(a.pairs.key[:0], a.pairs.impulse))


# Rows and states


@rule("engine")
def impulses_of_parts_do_not_add_up() -> None:
    """The impulse of a pair is the largest of its parts, not their sum."""

    def largest(old: Any, a: Any) -> Any:
        pairs: dict[int, float] = {}
        for (p, q), impulse in zip(a.body.tolist(), a.impulse.tolist(), strict=True):
            key = min(p, q) * a.bodies + max(p, q)
            pairs[key] = max(pairs.get(key, 0.0), impulse)
        key = np.array(sorted(pairs), dtype=np.int64)
        return type(old())(key, np.array([pairs[k] for k in key.tolist()], dtype=np.float64))

    called(PAIRS + "gather", largest)


@rule("engine")
def impulse_is_the_impact_alone() -> None:
    """The push of the step that led to a sample is not told."""
    given(
        PAIRS + "contact_rows", pushes=lambda a: a.pushes._replace(impulse=0.0 * a.pushes.impulse)
    )


@rule("engine")
def contact_lies_at_the_reference_point() -> None:
    """The point of a contact is where the first robot stands."""

    def there(old: Any, a: Any) -> None:
        old()
        a.out[0], a.out[1] = a.pose_a[0], a.pose_a[1]

    called(PAIRS + "describe_contact", there, here=True)


@rule("engine")
def normal_leads_along_the_line_of_centres() -> None:
    """The normal of a contact leads from one reference point to the other."""

    def along(old: Any, a: Any) -> None:
        old()
        x, y = a.pose_b[0] - a.pose_a[0], a.pose_b[1] - a.pose_a[1]
        size = math.hypot(x, y)
        a.out[2], a.out[3] = x / size, y / size

    called(PAIRS + "describe_contact", along, here=True)


@rule("engine")
def restored_robots_have_no_impulses() -> None:
    """A run goes on from poses and pairs; what contacts had accumulated is lost."""
    given(HOST + "Physics._recall", state=lambda a: None)


@rule("engine")
def robots_move_along_their_last_heading() -> None:
    """A step goes along the heading at its end, not along the chord of the arc (1)."""

    def last(a: Any) -> tuple[float, float]:
        heading = a.heading + a.omega * a.dt
        return a.v * math.cos(heading), a.v * math.sin(heading)

    instead("physim.geometry.motion:chord_velocity", last)


@rule("engine")
def friction_of_a_pair_is_squared() -> None:
    """A contact has the product of two frictions, each the world's."""
    given(SPACE + "build_space", friction=lambda a: a.friction**2)
