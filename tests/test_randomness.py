"""Random numbers: from the seed, the purpose and the robot alone."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from physim import build_scene
from physim.randomness import normal, philox, stream, uniform
from tests.helpers import examples, road


def test_headings_depend_on_seed_purpose_and_robot_alone() -> None:
    free = [[20.0, -10.0, "random"], [30.0, 0.0, "random"], [40.0, 10.0, "random"]]
    heading = build_scene(road(free, seed=5)).start[:, 2]
    assert len(set(heading)) == 3
    assert (np.abs(heading) <= math.pi).all()
    more = [*free, [60.0, 0.0, "random"]]
    assert np.array_equal(build_scene(road(more, seed=5)).start[:3, 2], heading)
    fixed = [free[0], [30.0, 0.0, 1.0], free[2]]
    assert np.array_equal(build_scene(road(fixed, seed=5)).start[[0, 2], 2], heading[[0, 2]])
    other = build_scene(road(free, seed=6)).start[:, 2]
    assert not set(other) & set(heading)
    assert np.array_equal(build_scene(road(free), 5).start[:, 2], heading)


def test_streams_differ_by_each_part_of_their_key_and_stay_what_they_are() -> None:
    keys = [(s, p, i) for s in (0, 1, 2**63) for p in ("heading", "noise") for i in (0, 1)]
    assert len({stream(*key).random() for key in keys}) == len(keys)
    assert stream(7, "heading", 2).random() == GOLDEN


GOLDEN = 0.11372706497649021


@examples(25, deep=200)
@given(st.lists(st.integers(0, 2**64 - 1), min_size=6, max_size=6))
def test_philox_is_that_of_numpy(words: list[int]) -> None:
    """numpy's generator counts on before it draws; its counter is one number of 256 bits."""
    key, counter = words[:2], words[2:]
    mine = np.empty(4, np.uint64)
    philox(*(np.uint64(word) for word in words), mine)
    whole = sum(word << 64 * k for k, word in enumerate(counter))
    theirs = np.random.Philox(key=key[0] + (key[1] << 64), counter=(whole - 1) % 2**256).random_raw(
        4
    )
    assert mine.tolist() == theirs.tolist()


def test_philox_compiled_is_the_plain_form() -> None:
    words = [np.uint64(w) for w in (1, 2**63, 5, 7, 11, 13)]
    found, plain = np.empty((2, 4), np.uint64)
    philox(*words, found)
    with np.errstate(over="ignore"):
        philox.py_func(*words, plain)
    assert found.tolist() == plain.tolist()


def test_noise_is_a_function_of_its_key_alone() -> None:
    whole = normal(7, "sight", 40, np.arange(6)[:, None], np.arange(5), 2)
    assert whole.shape == (6, 5, 2)
    alone = normal(7, "sight", 40, [3], [2], 2)
    assert np.array_equal(alone[0], whole[3, 2])
    assert np.array_equal(normal(7, "sight", 40, 3, 2, 4)[:2], whole[3, 2])
    others = [(8, "sight", 40), (7, "wind", 40), (7, "sight", 41)]
    assert all((normal(*key, 3, 2, 2) != alone[0]).all() for key in others)


def test_noise_is_distributed_as_it_says() -> None:
    """Kolmogorov and Smirnov at 1e-6: fails by chance once in a million keys."""
    z = normal(3, "test", 5, np.arange(20_000), 0, 4).ravel()
    u = uniform(3, "test", 5, np.arange(20_000), 1, 4).ravel()
    assert stats.kstest(z, "norm").pvalue > 1e-6
    assert stats.kstest(u, "uniform").pvalue > 1e-6
    assert abs(np.corrcoef(z[:-1], z[1:])[0, 1]) < 5.0 / math.sqrt(len(z))


@pytest.mark.parametrize("wrong", [{"width": 5}, {"width": 0}, {"step": -1}, {"i": [-1]}])
def test_noise_refuses_what_has_no_counter(wrong: dict[str, object]) -> None:
    given = {"seed": 1, "purpose": "test", "step": 0, "i": 0, "j": 0, "width": 1, **wrong}
    with pytest.raises(ValueError, match=r"allowed|at least 0"):
        normal(**given)
