"""In which values two worlds differ, against the same looked up one by one."""

from __future__ import annotations

import yaml
from hypothesis import given
from hypothesis import strategies as st

from tests.helpers import examples, inside

differences = inside("physim.world", "differences")


class Given:
    """Stands for a world of which only the values matter."""

    def __init__(self, values: object) -> None:
        self.values = values

    def to_yaml(self) -> str:
        return yaml.safe_dump(self.values)


def flat(value: object, key: str = "") -> dict[str, str]:
    if not isinstance(value, dict | list):
        return {key: str(value)}
    parts = value.items() if isinstance(value, dict) else enumerate(value)
    found: dict[str, str] = {}
    for name, part in parts:
        found.update(flat(part, f"{key}.{name}" if key else str(name)))
    return found


def slowly(a: object, b: object) -> dict[str, tuple[str, str]]:
    """By the words of the docstring: each missing key looked for in all of the other world."""
    first, second = flat(a), flat(b)

    def told(values: dict[str, str], key: str) -> str:
        if key in values:
            return values[key]
        parts = key.split(".")
        numbers = [k for k, part in enumerate(parts) if part.isdigit()]
        entry = ".".join(parts[: numbers[-1] + 1]) if numbers else ""
        held = any(other == entry or other.startswith(f"{entry}.") for other in values)
        return "default" if not numbers or held else "none"

    found = {key: (told(first, key), told(second, key)) for key in {**first, **second}}
    found = {key: pair for key, pair in found.items() if pair[0] != pair[1]}
    types = [key for key in found if key.endswith(".type")]
    return {
        key: pair
        for key, pair in found.items()
        if not any(key.startswith(one.removesuffix("type")) and key != one for one in types)
    }


names = st.sampled_from(["type", "name", "pose", "path"])
values = st.recursive(
    st.integers(0, 2),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(names, inner, max_size=3),
    max_leaves=12,
)
worlds = st.dictionaries(st.sampled_from(["seed", "controller", "filters"]), values, max_size=3)


@examples(25, deep=200)
@given(worlds, worlds)
def test_differences_are_those_found_one_by_one(a, b):
    assert differences(Given(a), Given(b)) == slowly(a, b)
