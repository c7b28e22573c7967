"""What is sound in the values of a world, part by part, where the whole of them is no world.

A world with a fault in one place is no `World`; the rest of it is looked at all the same, so that
all faults arrive at once.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, get_args

from pydantic import BaseModel, TypeAdapter, ValidationError

from physim.world.group import RobotGroup, is_group
from physim.world.kinds import MOST_ROBOTS, Polygon, Polyline
from physim.world.model import Corridor, World
from physim.world.road import RandomCorridor, is_random_corridor
from physim.world.robot import Formation, Limits, Robot, Start
from physim.world.run import Expectation, Time

KEY_BY_KEY = (Time, Start, Formation, Expectation, Limits)
"""Parts of which each key is looked at by itself; of all others the whole value"""
ENTRIES: dict[str, Any] = {"boundaries": Polyline, "obstacles": Polygon}
"""Lists of which each entry is looked at by itself, as are the robots"""


def sound_parts(values: Mapping[str, Any]) -> Any:
    """A `World` whose attributes are None wherever ``values`` are missing or wrong by themselves.

    A reference path that is wrong is empty, as it does not give way to the centreline. Rules
    between values (as many widths as points) are not looked at; ``model_fields_set`` of each part
    holds the keys that were given.
    """
    return _Reader().model(World, values)


class _Reader:
    """Reads values key by key; what a kind of value may be is worked out once."""

    def __init__(self) -> None:
        self._kinds: dict[object, TypeAdapter[Any]] = {}

    def model(self, model: type[BaseModel], given: Mapping[str, Any] | None) -> Any:
        """A model made of what is sound; without ``given`` every key of it is None."""
        found: dict[str, Any] = {}
        for key, field in model.model_fields.items():
            value = None if given is None else given.get(key)
            classes = (field.annotation, *get_args(field.annotation))
            part = next((part for part in KEY_BY_KEY if part in classes), None)
            if given is not None and key not in given and not field.is_required():
                found[key] = field.get_default(call_default_factory=True)
            elif part is not None:
                found[key] = self.model(part, value if isinstance(value, Mapping) else None)
            elif key == "corridor":
                road = RandomCorridor if is_random_corridor(value) else Corridor
                found[key] = self.model(road, value if isinstance(value, Mapping) else None)
            elif key == "robots":
                robots = [item if isinstance(item, Mapping) else {} for item in _entries(value)]
                found[key] = tuple(
                    self.model(RobotGroup if is_group(robot) else Robot, robot) for robot in robots
                )
            elif key in ENTRIES:
                items = _entries(value)
                found[key] = tuple(self._value(key, ENTRIES[key], item) for item in items)
            elif given is None:
                found[key] = None
            else:
                kind: Any = Annotated[field.annotation, field]
                found[key] = self._value((model, key), kind, value)
        if found.get("reference_path", ...) is None and "reference_path" in (given or {}):
            found["reference_path"] = ()
        return model.model_construct(_fields_set=set(given or ()), **found)

    def _value(self, name: object, kind: Any, value: Any) -> Any:
        """A value as its kind takes it; None where it refuses it."""
        if name not in self._kinds:
            self._kinds[name] = TypeAdapter(kind)
        try:
            return self._kinds[name].validate_python(value)
        except ValidationError:
            return None


def _entries(value: Any) -> list[Any]:
    """Entries of a list that is not longer than a world takes, else none."""
    return value if isinstance(value, list) and len(value) <= MOST_ROBOTS else []
