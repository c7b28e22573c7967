"""The nearest point of half-planes, held against all the places where it can be."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.helpers import inside

nearest_in, put_box, violation_by = inside(
    "physim.controllers", "nearest_in", "put_box", "violation_by"
)


def drawn(rng: np.random.Generator, many: int, spread: float) -> np.ndarray:
    """Half-planes (m, 4) about the origin; those of a small spread permit nothing together."""
    angle = rng.uniform(-np.pi, np.pi, many)
    d = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    out = d[:, ::-1] * (1, -1) * rng.uniform(-spread, 1.0, many)[:, None]
    return np.hstack((out + d * rng.uniform(-1, 1, many)[:, None], d))


def depths(lines: np.ndarray, points: np.ndarray) -> np.ndarray:
    """(n, m) by how much points (n, 2) violate half-planes."""
    p, d = lines[:, :2], lines[:, 2:]
    off = p - points[:, None]
    return np.asarray(d[:, 0] * off[..., 1] - d[:, 1] * off[..., 0])


def candidates(lines: np.ndarray, radius: float, wish: np.ndarray) -> np.ndarray:
    """Every place where the nearest one can be: itself, its feet, crossings, on the disc."""
    found = [wish, wish * min(1.0, radius / np.hypot(*wish))]
    for k, (p, d) in enumerate((line[:2], line[2:]) for line in lines):
        along = p @ d
        found.append(p + d * (d @ (wish - p)))
        square = along**2 + radius**2 - p @ p
        if square >= 0:
            found += [p + d * (-along + side * math.sqrt(square)) for side in (-1, 1)]
        for q, e in ((line[:2], line[2:]) for line in lines[:k]):
            if abs(across := d[0] * e[1] - d[1] * e[0]) > 1e-9:
                off = q - p
                found.append(p + d * ((off[0] * e[1] - off[1] * e[0]) / across))
    return np.array(found)


@pytest.mark.parametrize("many", [300, pytest.param(20000, marks=pytest.mark.deep)])
def test_the_nearest_permitted_point(many: int) -> None:
    rng, feasible = np.random.default_rng(1), 0
    for _ in range(many):
        lines = drawn(rng, rng.integers(1, 9), rng.choice([0.1, 0.8]))
        wish, radius = rng.uniform(-2, 2, 2), rng.uniform(0.5, 2.0)
        x, y, violation = nearest_in(lines, len(lines), 0, radius, *wish)
        assert math.hypot(x, y) <= radius + 1e-7
        places = candidates(lines, radius, wish)
        inside_all = depths(lines, places).max(axis=1) <= 1e-12
        places = places[inside_all & (np.hypot(*places.T) <= radius + 1e-12)]
        if violation:
            assert not len(places)
            assert violation == pytest.approx(depths(lines, np.array([[x, y]])).max())
            continue
        feasible += 1
        assert depths(lines, np.array([[x, y]])).max() <= 1e-9
        if len(places):
            assert math.dist((x, y), wish) == pytest.approx(
                np.hypot(*(places - wish).T).min(), abs=1e-9
            )
    assert 0.2 * many < feasible < 0.95 * many


def test_where_nothing_is_permitted_hard_ones_are_kept_and_none_does_better() -> None:
    rng, looked_at = np.random.default_rng(2), 0
    grid = np.stack(np.meshgrid(*[np.linspace(-1, 1, 81)] * 2), axis=-1).reshape(-1, 2)
    grid = grid[np.hypot(*grid.T) <= 1.0]
    for _ in range(300):
        hard = int(rng.integers(0, 3))
        lines = np.vstack((drawn(rng, hard, 0.0), drawn(rng, 6, 0.9)))
        x, y, violation = nearest_in(lines, len(lines), hard, 1.0, *rng.uniform(-1, 1, 2))
        allowed = grid[depths(lines[:hard], grid).max(axis=1, initial=-1.0) <= 0.0]
        if not violation or not len(allowed):
            continue
        looked_at += 1
        assert depths(lines[:hard], np.array([[x, y]])).max(initial=0.0) <= 1e-9
        assert violation <= depths(lines, allowed).max(axis=1).min() + 1e-9
    assert looked_at > 100


def test_a_box_is_four_half_planes() -> None:
    lines = np.zeros((5, 4))
    radius = put_box(lines, -0.2, -1.0, 0.5, 1.0)
    assert radius == pytest.approx(math.hypot(0.5, 1.0))
    for x, y in np.random.default_rng(3).uniform(-2, 2, (50, 2)).tolist():
        found = nearest_in(lines, 4, 4, radius, x, y)
        inner = min(max(x, -0.2), 0.5), min(max(y, -1.0), 1.0)
        assert found[:2] == pytest.approx(inner, abs=1e-9)
        assert np.all(depths(lines[:4], np.array([found[:2]])) <= 1e-9)
    lines[4] = 0.3, 0.0, 0.0, 1.0  # x <= 0.3
    assert nearest_in(lines, 5, 4, radius, 0.45, 0.4) == pytest.approx((0.3, 0.4, 0.0))
    assert violation_by(lines[4], 0.5, 0.0) == pytest.approx(0.2)
