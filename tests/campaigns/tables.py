"""Rows made up for reports and comparisons: the columns of a campaign, as a run would fill them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyarrow as pa

TEXTS = ("run", "world", "settings", "controller", "physim", "engine", "ended", "reason",
         "first_contact_pair", "severest_contact_pair", "least_distance_pair",
         "shortest_collision_time_pair", "not_arrived", "stood", "metrics", "record",
         "world_hash")  # fmt: skip
WHOLE = ("seed", "robots", "contacts", "contacts_between_robots", "contacts_with_boundaries",
         "grazes", "updates", "messages")  # fmt: skip
NUMBERS = ("seconds", "first_contact", "deepest", "closing_speed", "energy_lost", "impulse",
           "severest_contact_time", "shortest_distance", "shortest_boundary_distance",
           "least_distance", "least_distance_time",
           "shortest_collision_time", "shortest_collision_time_time", "formation_error",
           "deviation", "finish_time", "danger_share", "cpu_seconds", "wall_seconds")  # fmt: skip


def row(seed: int = 1, **given: Any) -> dict[str, Any]:
    """A run that was contact-free and finished, with what is ``given`` changed."""
    usual: dict[str, Any] = {
        "run": "", "world": "yard", "seed": seed, "settings": "", "controller": "good",
        "physim": "0.1.0", "engine": "pymunk 7.3.1", "ended": "finished", "reason": "",
        "seconds": 20.0, "robots": 3, "contacts": 0, "contacts_between_robots": 0,
        "contacts_with_boundaries": 0, "grazes": 0,
        "first_contact": None, "first_contact_pair": "", "deepest": None,
        "closing_speed": None, "energy_lost": None, "impulse": None, "severest_contact_pair": "",
        "severest_contact_time": None, "shortest_distance": 0.4, "shortest_boundary_distance": 0.6,
        "least_distance": 0.4, "least_distance_pair": "r1, r2", "least_distance_time": 3.2,
        "not_arrived": "", "stood": "", "shortest_collision_time": 1.5,
        "shortest_collision_time_pair": "r1, r2", "shortest_collision_time_time": 3.0,
        "formation_error": None, "deviation": 0.2, "finish_time": 18.0, "danger_share": 0.05,
        "updates": 900, "messages": 1800, "cpu_seconds": 0.1, "wall_seconds": 0.12, "metrics": "",
        "record": "", "world_hash": "0123456789ab",
    }  # fmt: skip
    made = {**usual, **given}
    words = "-".join(str(made[key]) for key in ("world", "settings", "controller", "seed"))
    return {**made, "run": made["run"] or words.encode().hex()[-20:]}


def failed(seed: int = 1, ended: str = "error", reason: str = "it broke", **given: Any) -> Any:
    """A run that came to nothing."""
    empty = dict.fromkeys((*WHOLE[1:], *NUMBERS))
    return row(seed, **{**empty, "ended": ended, "reason": reason, **given})


def hit(seed: int = 1, depth: float = 0.01, **given: Any) -> dict[str, Any]:
    """A run with a contact."""
    touched = {"contacts": 1, "contacts_between_robots": 1, "shortest_distance": -depth,
               "least_distance": -depth, "deepest": depth, "first_contact": 3.1}  # fmt: skip
    return row(seed, **{**touched, **given})


def table(rows: list[dict[str, Any]]) -> pa.Table:
    """Rows as a campaign reads them."""
    types = {**dict.fromkeys(TEXTS, pa.string()), **dict.fromkeys(WHOLE, pa.int64()),
             **dict.fromkeys(NUMBERS, pa.float64())}  # fmt: skip
    return pa.Table.from_pylist(rows, schema=pa.schema(list(types.items())))


def many(count: int, cells: int = 10, seed: int = 0) -> pa.Table:
    """A large campaign: worlds and two controllers, some runs with contacts, some failed."""
    rng = np.random.default_rng(seed)
    cell = np.arange(count) % cells
    number = np.arange(count) // cells
    bad = (cell % 2).astype(bool)
    distance = rng.gamma(4.0, 0.09, count) - np.where(bad, 0.15, -0.01)
    ends = rng.choice(["finished", "duration", "error"], count, p=[0.95, 0.04, 0.01])
    broke = ends == "error"
    touched = (distance < 0.0) & ~broke

    def some(values: Any) -> Any:
        return pa.array(np.asarray(values, float), mask=broke)

    def whole(values: Any) -> Any:
        return pa.array(np.asarray(values, np.int64), mask=broke)

    columns: dict[str, Any] = {
        "run": [f"{k:020x}" for k in range(count)],
        "world": [f"world_{k // 2}" for k in cell], "settings": [""] * count,
        "controller": np.where(bad, "path_following", "mode_switching").tolist(),
        "physim": ["0.1.0"] * count, "engine": ["pymunk 7.3.1"] * count, "ended": ends.tolist(),
        "reason": np.where(broke, "ZeroDivisionError: float division", "").tolist(),
        "first_contact_pair": [""] * count, "severest_contact_pair": [""] * count,
        "not_arrived": [""] * count, "stood": [""] * count,
        "least_distance_pair": ["r1, r2"] * count,
        "shortest_collision_time_pair": ["r1, r2"] * count, "metrics": [""] * count,
        "record": [""] * count,
        "world_hash": [f"{k // 2:012x}" for k in cell],
        "seed": pa.array(number), "robots": whole(np.full(count, 10)), "contacts": whole(touched),
        "contacts_between_robots": whole(touched),
        "contacts_with_boundaries": whole(np.zeros(count)), "grazes": whole(np.zeros(count)),
        "updates": whole(rng.integers(800, 900, count)),
        "messages": whole(rng.integers(800, 900, count)), "seconds": some(np.full(count, 20.0)),
        "first_contact": pa.array(np.full(count, 3.0), mask=~touched),
        "deepest": pa.array(np.abs(distance), mask=~touched),
        "closing_speed": pa.array(rng.random(count), mask=~touched),
        "energy_lost": pa.array(rng.random(count), mask=~touched),
        "impulse": pa.array(rng.random(count), mask=~touched),
        "severest_contact_time": pa.array(np.full(count, 3.0), mask=~touched),
        "shortest_distance": some(distance), "shortest_boundary_distance": some(distance + 1.0),
        "least_distance": some(distance), "least_distance_time": some(rng.random(count) * 20),
        "shortest_collision_time": some(rng.gamma(5.0, 0.4, count)),
        "shortest_collision_time_time": some(rng.random(count) * 20),
        "formation_error": pa.nulls(count, pa.float64()),
        "deviation": some(rng.gamma(4.0, 0.1, count)),
        "finish_time": pa.array(17.0 + rng.gamma(2.0, 1.0, count), mask=ends != "finished"),
        "danger_share": some(rng.beta(2.0, 9.0, count)),
        "cpu_seconds": some(rng.gamma(9.0, 0.02, count)),
        "wall_seconds": some(rng.gamma(9.0, 0.02, count)),
    }  # fmt: skip
    return pa.table({name: columns[name] for name in (*TEXTS, *WHOLE, *NUMBERS)})
