"""Why a robot decided as it did: what the rules of a controller say, and its thresholds.

Rules and modes are told in the words that the controller declared. For the shipped controllers
there is more: a line of prose a rule, and the thresholds of Fig. 5, which are settings.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from physim.drawing.drivers import settings_of
from physim.parts.declarations import Rule
from physim.record import Record
from physim.record.setup import Part

EQUATION = re.compile(r"\(\d+[a-z]?\)")

STEERS = (
    "It chooses the rotational speed that brings it nearest to its target, a point of its path a "
    "little ahead of it"
)
PROSE = MappingProxyType(
    {
        "mode_switching": {
            "path_following": (
                f"No robot or wall is too near, so it follows its path. {STEERS}; its forward "
                "speed "
            ),
            "plan": "It continues with the speeds that it planned at an earlier decision.",
            "distance": (
                "Something is very near. It chooses the speeds after which the smallest distance "
                "to the robots ahead and to near walls is largest."
            ),
            "time": (
                "It keeps clear of what it would touch first. It chooses the speeds for which the "
                "first collision comes latest; among equal ones, those that follow its path best."
            ),
            "stop": "It has reached its stop and stands there; it needs no further decision.",
        },
        "path_following": {
            "path_following": f"It follows its path and ignores robots and walls. {STEERS}.",
            "stop": "It has reached its stop and stands there.",
        },
    }
)
"""By controller and rule: what the rule does, for people who do not know the paper."""
IN_FORMATION = (
    "comes from the formation: robots that are behind drive faster, robots too far ahead slower."
)
ALONE = "is that of its settings, as there is no formation."
"""How the forward speed comes about that the rule of path following of `PROSE` leaves open."""
NEXT = MappingProxyType(
    {
        "mode_switching": (
            "(14)", "after {beta:g} times the collision time, at most {longest:g} s"
        )
    }
)  # fmt: skip
"""By controller: the equation that sets the time of the next decision, and what it says"""
PRIORITY = MappingProxyType(
    {
        "mode_switching": (
            "It considers only robots in range that are ahead of it along the reference path."
        )
    }
)
"""By controller: whom a robot has to look at"""
WHEREVER = " It considers movers and obstacles to push wherever they are."


def explanations(record: Record) -> dict[str, Any]:
    """What the page says of the rules of a record's controllers, and their thresholds."""
    controllers = record.setup.controllers
    prose = [_prose(record, part) for part, _ in controllers]
    drivers = [_driver(*one) for one in controllers]
    if len(drivers) == 1:
        drivers[0]["robots"] = None
    if record.moving > record.robots:
        for driver in drivers:
            driver["priority"] += WHEREVER if driver["priority"] else ""
    return {
        "controller": record.setup.controller_names,
        "rules": [_rule(rule, prose) for rule in record.declared.rules],
        "drivers": drivers,
    }


def _prose(record: Record, part: Part) -> dict[str, str]:
    """What the rules of one controller do."""
    prose = dict(PROSE.get(part.name, {}))
    if part.name == "mode_switching":
        prose["path_following"] += IN_FORMATION if record.world_settings.get("formation") else ALONE
    if settings_of(part).get("avoidance") == "none" and "path_following" in prose:
        prose["path_following"] = f"Avoidance is off: it does not keep clear of anything. {STEERS}."
    return prose


def _driver(part: Part, robots: Sequence[int]) -> dict[str, Any]:
    """What holds for the robots of one controller."""
    name, settings = part.name, settings_of(part)
    return {
        "controller": str(part),
        "robots": robots,
        "priority": PRIORITY.get(name, ""),
        "thresholds": _thresholds(settings) if name in NEXT else [],
        "next": _next(name, settings),
        "horizon": settings.get("horizon") if name in NEXT else None,
        "avoids": settings.get("avoidance") != "none",
    }


def _rule(rule: Rule, prose: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """A rule of one of the controllers; a `Team` calls some by the number of theirs."""
    name, _, number = rule.name.rpartition("_")
    told = next((one[rule.name] for one in prose if rule.name in one), "")
    if not told and number.isdecimal() and 1 <= int(number) <= len(prose):
        told = prose[int(number) - 1].get(name, "")
    found = EQUATION.search(str(rule))
    return {
        "name": rule.name,
        "words": str(rule),
        "equation": found[0] if found else "",
        "prose": told,
    }


def _thresholds(settings: dict[str, Any]) -> list[dict[str, Any]]:
    """Thresholds of Fig. 5: below ``enter`` danger begins, above ``leave`` it can end.

    Above ``boundary`` a collision time with a boundary ends it, where that has one of its own.
    """
    kinds = (
        ("distance", "m", "distance_low", "distance_high"),
        ("collision_time", "s", "time_low", "time_high"),
        ("boundary_distance", "m", "boundary_low", "boundary_low"),
    )
    ahead = settings.get("boundary_time_high")
    own = {"collision_time": {"boundary": ahead}} if isinstance(ahead, float | int) else {}
    return [
        {"column": column, "unit": unit, "enter": settings[low], "leave": settings[high]}
        | own.get(column, {})
        for column, unit, low, high in kinds
        if isinstance(settings.get(low), float | int)
        and isinstance(settings.get(high), float | int)
    ]


def _next(name: str, settings: dict[str, Any]) -> dict[str, str] | None:
    """How the time of the next decision comes about; None where that is not known."""
    if name not in NEXT or not {"beta", "update_period"} <= settings.keys():
        return None
    longest = settings.get("longest_interval") or 2.0 * settings["update_period"]
    equation, words = NEXT[name]
    if not settings.get("event_triggered", True):
        return {"equation": "", "words": f"{longest:g} s after each decision"}
    return {"equation": equation, "words": words.format(beta=settings["beta"], longest=longest)}
