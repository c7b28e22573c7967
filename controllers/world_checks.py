"""What does not go together with the paper's controller in a world, reported before the run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import ceil, hypot
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from physim.errors import Fault, Location, plural
from physim.world import each_robot

from .settings import ModeSwitchingSettings

if TYPE_CHECKING:
    from physim.world import Robot, World

    from .navigation import NavigationSettings

    Following: TypeAlias = ModeSwitchingSettings | NavigationSettings


def omega_faults(
    omegas: Sequence[float], is_written: bool, robots: Mapping[int, Robot]
) -> list[Fault]:
    """Faults of a set of rotational speeds [rad/s], chosen from by robots without one of their own.

    They stand at ``controller.omegas`` where the world writes the set, else at the robots' limits.
    """
    using = {i: robot for i, robot in robots.items() if robot.omegas is None}
    if is_written:
        return [
            fault for k, omega in enumerate(omegas) for fault in _beyond(k, float(omega), using)
        ]
    fastest = max((abs(float(omega)) for omega in omegas), default=0.0)
    return [
        Fault(
            ("robots", i, "limits", "omega"),
            f"{robot.limits.omega:g} rad/s is below {fastest:.5g} rad/s, the fastest of the "
            "controller's rotational speeds; raise the limit, or give the robot its own omegas "
            "within it",
        )
        for i, robot in using.items()
        if fastest > robot.limits.omega
    ]


def _beyond(k: int, omega: float, robots: Mapping[int, Robot]) -> list[Fault]:
    """Fault of one speed [rad/s] of the set, with the robot of the lowest limit."""
    slow = [robot for robot in robots.values() if abs(omega) > robot.limits.omega]
    if not slow:
        return []
    slowest = min(slow, key=lambda robot: robot.limits.omega)
    more = f" and beyond that of {plural(len(slow) - 1, 'more robot')}" if len(slow) > 1 else ""
    message = (
        f"{omega:g} rad/s is beyond limits.omega = {slowest.limits.omega:g} of "
        f'"{slowest.name}"{more}; use slower ones, raise the limit, or give the robot its own '
        "omegas"
    )
    return [Fault(("controller", "omegas", k), message)]


def speed_faults(settings: Following, world: World, where: Location) -> list[Fault]:
    """Refuse ``speed`` beside a formation, which has a speed of its own."""
    if world.formation is None or "speed" not in settings.model_fields_set:
        return []
    message = (
        "has no effect beside formation, whose robots share one speed; set formation.speed instead"
    )
    return [Fault((*where, "speed"), message)]


def speed_doubts(settings: Following, world: World, where: Location, by_7: bool) -> list[Fault]:
    """Warn of a speed beyond the limits of all robots, if it is written.

    Where speeds are set ``by_7``, of one outside those of the formation.
    """
    plan = world.formation
    of, at = (settings, where) if plan is None else (plan, ("formation",))
    is_written = "speed" in of.model_fields_set
    if by_7 and plan is not None and not plan.limits[0] <= plan.speed <= plan.limits[1]:
        message = (
            f"the speed, {plan.speed:g} m/s, lies outside formation.limits, which hold (7) at "
            f"{plan.limits[plan.speed > plan.limits[1]]:g} m/s until errors are large; write a "
            "speed between the limits, or widen them"
        )
        return [Fault((*at, "speed" if is_written else "limits"), message)]
    fastest = max(robot.limits.v for robot in world.robots)
    if not is_written or of.speed <= fastest:
        return []
    message = (
        f"no robot drives at {of.speed:g} m/s: each goes at its limits.v, at most {fastest:g} m/s; "
        "raise the limits, or lower the speed"
    )
    return [Fault((*at, "speed"), message)]


def safe_area_doubts(settings: ModeSwitchingSettings, world: World, where: Location) -> list[Fault]:
    """Warn of a corridor so narrow that no place of it is as far from both walls as is kept."""
    width = getattr(world.corridor, "width", None)  # a road that the seed draws has none
    if width is None or (widest := float(np.max(width))) > 2.0 * settings.safe_distance:
        return []
    message = (
        f"no place is {settings.safe_distance:g} m from both walls, as the corridor is at most "
        f"{widest:g} m wide: there is no safe area; widen it, or set safe_distance below "
        f"{widest / 2.0:g} m"
    )
    return [Fault((*where, "safe_distance"), message)]


def stop_doubts(settings: Following, world: World, may_stand: bool = False) -> list[Fault]:
    """Warn of robots that stop farther from their stop stations than arrival allows.

    One that ``may_stand`` rather than go on does so where half a period would take it to its stop,
    whatever the controller's own tolerance.
    """
    allowed, short = world.arrival.tolerance, settings.arrival_tolerance
    why = "controller.arrival_tolerance"
    fastest = max(robot.limits.v for robot in world.robots)
    speed = settings.speed if world.formation is None else world.formation.speed
    half = 0.5 * min(speed, fastest) * settings.update_period
    if may_stand and half > short:
        short, why = half, "half of what they move in controller.update_period"
    if allowed >= short:
        return []
    is_set = "arrival_tolerance" in settings.model_fields_set and allowed > 0.0
    where: Location = ("controller", "arrival_tolerance") if is_set else ("arrival", "tolerance")
    message = (
        f"robots stop up to {short:g} m ({why}) before their stop stations, but count as arrived "
        f"only within {allowed:g} m (arrival.tolerance), so some may never arrive; set "
        f"arrival.tolerance to {short:g} m or more"
    )
    return [Fault(where, message)]


def interval_doubts(settings: ModeSwitchingSettings, world: World) -> list[Fault]:
    """Warn of commands that may be held until a robot is far on its way to where it heads for.

    Beyond half of that way robots of the shipped worlds have left their paths, and met walls.
    """
    held = settings.rules().longest_interval
    speed = settings.speed if world.formation is None else world.formation.speed
    moved = held * min(speed, max(robot.limits.v for robot in world.robots))
    if moved <= 0.5 * settings.look_ahead:
        return []
    is_set = "longest_interval" in settings.model_fields_set
    key, times = ("longest_interval", "") if is_set else ("update_period", "twice ")
    message = (
        f"a command may be held for {held:g} s ({times}controller.{key}), in which a robot moves "
        f"{moved:.4g} m, more than half of the {settings.look_ahead:g} m (controller.look_ahead) "
        "to where it heads for: it may leave its path; shorten the one, or lengthen the other"
    )
    return [Fault(("controller", key), message)]


def range_doubts(settings: ModeSwitchingSettings, world: World) -> list[Fault]:
    """Warn of a sensing range too short for the thresholds of the controller."""
    reach = world.sensing_range
    needed, why = max(_needs(settings, world))
    if reach >= needed:
        return []
    where: Location = ("sensing", "range")
    if world.sensing.range is None and world.formation is not None:
        where = ("formation", "range")
    message = (
        f"robots sense up to {reach:g} m, from one reference point to another or to a wall, and "
        f"{why}; set it to at least {ceil(needed * 10.0) / 10.0:g} m"
    )
    return [Fault(where, message)]


def _needs(settings: ModeSwitchingSettings, world: World) -> Iterator[tuple[float, str]]:
    """Ranges [m] that are needed, with what happens below them."""
    plan = world.formation
    fastest = settings.speed if plan is None else max(plan.speed, plan.limits[1])
    robots, _ = each_robot(world.robots, world.seed)
    around = [max(hypot(x, y) for x, y in robot.outline) for robot in robots]
    radii = sorted(around)
    yield (
        radii[-1] + settings.boundary_low,
        "a wall nearer than controller.boundary_low may go unseen",
    )
    yield (
        settings.look_ahead + settings.safe_distance,
        "a target controller.look_ahead away may lie within controller.safe_distance of an "
        "unseen wall",
    )
    if len(radii) == 1:
        return
    yield (
        sum(radii[-2:]) + settings.distance_low,
        "two robots nearer than controller.distance_low may not sense each other",
    )
    reaches = sorted(
        radius + min(fastest, robot.limits.v) * settings.time_low
        for radius, robot in zip(around, robots, strict=True)
    )
    yield (
        sum(reaches[-2:]),
        "two robots head-on may sense each other less than controller.time_low before they meet",
    )
