"""Rows made up for reports and comparisons, as runs would fill them."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.campaigns import Row


def row(seed: int = 1, **given: Any) -> Row:
    """A run that was contact-free and finished, with what is ``given`` changed."""
    usual: dict[str, Any] = {
        "world": "yard", "controller": "good", "physim": "0.1.0", "engine": "pymunk 7.3.1",
        "ended": "finished", "seconds": 20.0, "robots": 3, "contacts": 0,
        "contacts_between_robots": 0, "contacts_with_boundaries": 0, "grazes": 0,
        "shortest_distance": 0.4, "shortest_boundary_distance": 0.6,
        "least_distance": 0.4, "least_distance_pair": "r1, r2", "least_distance_time": 3.2,
        "shortest_collision_time": 1.5, "shortest_collision_time_pair": "r1, r2",
        "shortest_collision_time_time": 3.0, "shortest_pair_collision_time": 2.0,
        "deviation_peak": 0.2, "time_to_finish": 18.0, "danger_share": 0.05, "decisions": 900,
        "messages": 1800, "cpu_seconds": 0.1, "wall_seconds": 0.12, "world_hash": "0123456789ab",
    }  # fmt: skip
    made = {"settings": "", **usual, **given, "seed": seed}
    words = "-".join(str(made[key]) for key in ("world", "settings", "controller", "seed"))
    return Row(**{"run": words.encode().hex()[-20:].rjust(20, "0"), **made})


def failed(seed: int = 1, ended: str = "error", reason: str = "it broke", **given: Any) -> Row:
    """A run that came to nothing."""
    one = row(seed, ended=ended, reason=reason, **given)
    return Row(
        run=one.run, world=one.world, seed=seed, settings=one.settings, controller=one.controller,
        physim=one.physim, engine=one.engine, ended=one.ended, reason=reason,
    )  # fmt: skip


def hit(seed: int = 1, depth: float = 0.01, **given: Any) -> Row:
    """A run with a contact."""
    touched = {"contacts": 1, "contacts_between_robots": 1, "shortest_distance": -depth,
               "least_distance": -depth, "deepest_contact": depth,
               "first_contact": 3.1}  # fmt: skip
    return row(seed, **{**touched, **given})


def many(count: int, cells: int = 10, seed: int = 0) -> list[Row]:
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
    return rows
