"""Numeric settings of a controller and the bounds within which they are varied."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from physim.parts.registry import CONTROLLER, checked_settings, find_part, settings_model
from physim.world import World

FACTOR = 2.0
"""[-] A setting without two bounds of its own goes from its value over this to its value times
this, as far as its one bound allows."""
PROBES = (1.0 + 1e-3, 1.0 - 1e-3)
"""[-] A setting that can be changed by neither alone is tied to others, and stays."""
SHARES = (0.75, 0.5, 0.25)
"""[-] of the way from its value in the world to the one asked for that a setting is tried at"""


class Tunable(NamedTuple):
    """A setting that is varied."""

    key: str
    base: float
    low: float
    high: float
    whole: bool
    """whether it is a whole number"""

    def value(self, number: float) -> float | int:
        """The setting at a number."""
        return round(number) if self.whole else number


class Settings:
    """The numeric settings of the controller of a world."""

    def __init__(self, world: World) -> None:
        choice = world.controller
        self._part = find_part(CONTROLLER, choice.type, trusted=True)
        self.given = dict(choice.settings)
        self.varied = tuple(
            one for one in self._numbers() if any(self._moves(one, probe) for probe in PROBES)
        )

    def _numbers(self) -> list[Tunable]:
        model = settings_model(self._part)
        made, faults = checked_settings(self._part, self.given, ())
        if model is None or made is None or faults:
            return []
        found = []
        for key, field in model.model_fields.items():
            value = getattr(made, key)
            if type(value) not in (int, float) or not value:
                continue  # of 0 there is neither half nor double
            low, high = declared_bounds(field.metadata)
            if low is None or high is None:
                ends = sorted((value / FACTOR, value * FACTOR))
                low = ends[0] if low is None else max(low, ends[0])
                high = ends[1] if high is None else min(high, ends[1])
            found.append(Tunable(key, float(value), low, high, type(value) is int))
        return found

    def _moves(self, one: Tunable, probe: float) -> bool:
        moved = one.base + (1 if probe > 1.0 else -1) if one.whole else one.base * probe
        return one.low <= moved <= one.high and self._are_valid({one.key: one.value(moved)})

    def _are_valid(self, changed: Mapping[str, Any]) -> bool:
        return not checked_settings(self._part, {**self.given, **changed}, ())[1]

    def repaired(self, numbers: Mapping[str, float]) -> tuple[dict[str, Any], bool]:
        """Settings that the controller takes, and whether they are others than those asked for.

        Where it refuses these together, each in turn goes as far as it may beside those before it.
        """
        by_key = {one.key: one for one in self.varied}
        wanted = {key: by_key[key].value(number) for key, number in numbers.items()}
        if self._are_valid(wanted):
            return {**self.given, **wanted}, False
        taken: dict[str, Any] = {}
        for key, number in numbers.items():
            one = by_key[key]
            for share in (1.0, *SHARES):
                changed = {**taken, key: one.value(one.base + share * (number - one.base))}
                if self._are_valid(changed):
                    taken = changed
                    break
        return {**self.given, **taken}, True


def declared_bounds(metadata: list[Any]) -> tuple[float | None, float | None]:
    """Least and greatest value that a field declares; None where it has no such bound."""
    lows = [getattr(one, name, None) for one in metadata for name in ("ge", "gt")]
    highs = [getattr(one, name, None) for one in metadata for name in ("le", "lt")]
    low = max((float(x) for x in lows if x is not None), default=None)
    high = min((float(x) for x in highs if x is not None), default=None)
    return low, high
