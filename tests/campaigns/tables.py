"""Rows made up for reports and comparisons: the columns of a campaign, as a run would fill them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyarrow as pa

TEXTS = ("run", "world", "settings", "controller", "physim", "engine", "ended", "reason",
         "first_contact_pair", "severest_contact_pair", "least_distance_pair",
         "shortest_collision_time_pair", "not_arrived", "stood", "record",
         "world_hash")  # fmt: skip
WHOLE = ("seed", "robots", "contacts", "contacts_between_robots", "contacts_with_boundaries",
         "grazes", "decisions", "messages")  # fmt: skip
NUMBERS = ("seconds", "first_contact", "deepest_contact", "closing_speed", "energy_lost", "impulse",
           "severest_contact_time", "shortest_distance", "shortest_boundary_distance",
           "least_distance", "least_distance_time",
           "shortest_collision_time", "shortest_collision_time_time",
           "shortest_pair_collision_time", "formation_error_peak",
           "deviation_peak", "time_to_finish", "danger_share", "cpu_seconds",
           "wall_seconds")  # fmt: skip


def row(seed: int = 1, **given: Any) -> dict[str, Any]:
    """A run that was contact-free and finished, with what is ``given`` changed."""
    usual: dict[str, Any] = {
        "run": "", "world": "yard", "seed": seed, "settings": "", "controller": "good",
        "physim": "0.1.0", "engine": "pymunk 7.3.1", "ended": "finished", "reason": "",
        "seconds": 20.0, "robots": 3, "contacts": 0, "contacts_between_robots": 0,
        "contacts_with_boundaries": 0, "grazes": 0,
        "first_contact": None, "first_contact_pair": "", "deepest_contact": None,
        "closing_speed": None, "energy_lost": None, "impulse": None, "severest_contact_pair": "",
        "severest_contact_time": None, "shortest_distance": 0.4, "shortest_boundary_distance": 0.6,
        "least_distance": 0.4, "least_distance_pair": "r1, r2", "least_distance_time": 3.2,
        "not_arrived": "", "stood": "", "shortest_collision_time": 1.5,
        "shortest_collision_time_pair": "r1, r2", "shortest_collision_time_time": 3.0,
        "shortest_pair_collision_time": 2.0,
        "formation_error_peak": None, "deviation_peak": 0.2, "time_to_finish": 18.0,
        "danger_share": 0.05, "decisions": 900, "messages": 1800, "cpu_seconds": 0.1,
        "wall_seconds": 0.12, "record": "", "world_hash": "0123456789ab",
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
               "least_distance": -depth, "deepest_contact": depth,
               "first_contact": 3.1}  # fmt: skip
    return row(seed, **{**touched, **given})


def table(rows: list[dict[str, Any]]) -> pa.Table:
    """Rows as a campaign reads them."""
    types = {**dict.fromkeys(TEXTS, pa.string()), **dict.fromkeys(WHOLE, pa.int64()),
             **dict.fromkeys(NUMBERS, pa.float64())}  # fmt: skip
    return pa.Table.from_pylist(rows, schema=pa.schema(list(types.items())))


def many(count: int, cells: int = 10, seed: int = 0) -> pa.Table:
    """A large campaign: worlds and two controllers, some runs with contacts, some failed."""
    rng = np.random.default_rng(seed)
    distances, ends = rng.gamma(4.0, 0.09, count), rng.random(count)
    rows = []
    for k in range(count):
        cell, number = k % cells, k // cells
        given = {"world": f"world_{cell // 2}", "run": f"{k:020x}",
                 "controller": "path_following" if cell % 2 else "mode_switching"}  # fmt: skip
        distance = float(distances[k]) - (0.15 if cell % 2 else -0.01)
        if ends[k] < 0.01:
            rows.append(failed(number, **given))
        elif distance < 0.0:
            rows.append(hit(number, -distance, closing_speed=distance**2, **given))
        else:
            near = {"least_distance": distance, "shortest_distance": distance}
            rows.append(row(number, shortest_boundary_distance=9.0, **near, **given))
    return table(rows)
