"""A physics that is reset is as good as new."""

from __future__ import annotations

import numpy as np
import pytest
from crowds import KINDS, crowd, go_on, told
from hosts import host

from physim.errors import PhysimError


@pytest.mark.parametrize("kind", KINDS)
def test_reset_is_the_same_as_built(kind):
    scene = crowd(kind, 2)
    used = crowd(kind, 2).physics()
    for steps in (0, 1, 110):
        go_on(scene, used, steps)
        start = scene.start[::-1] + (0.01 * steps, 0.0, 0.2)
        fresh = scene._replace(start=start).physics()
        used.reset(start)
        assert told(used) == told(fresh)
        assert used.state == fresh.state
        assert go_on(scene, used, 120) == go_on(scene, fresh, 120)


@pytest.mark.parametrize("overlap", [0.0, 0.3])
def test_from_and_into_contact(overlap):
    starts = [
        np.array([[0.0, 0.0, 0.0], [1.0 - overlap, 0.1, 0.0]]),
        np.array([[0.0, 0.0, 0.0], [0.0, 0.6 - overlap, 0.0]]),
        np.array([[0.0, 0.0, 0.0], [9.0, 0.0, 0.0]]),
    ]
    used = host(starts[0])
    for start in (*starts, *starts[::-1]):
        used.reset(start)
        fresh = host(start)
        for _ in range(20):
            for physics in (used, fresh):
                physics.step(np.array([[0.5, 0.0], [-0.5, 0.1]]))
            assert told(used) == told(fresh)


def test_the_start_may_be_a_list_and_is_not_kept():
    physics = host([[0.0, 0.0, 0.0]])
    start = np.array([[1.0, 2.0, 0.5]])
    physics.reset(start)
    start[:] = 9.0
    assert physics.pose.tolist() == [[1.0, 2.0, 0.5]]
    physics.reset([[3.0, 4.0, 0.5]])
    assert physics.pose.tolist() == [[3.0, 4.0, 0.5]]
    assert physics.step_number == 0


@pytest.mark.parametrize(
    ("start", "told"),
    [
        ([0.0, 0.0, 0.0], r"shape \(3,\); allowed: \(1, 3\)"),
        ([[0.0, 0.0, 0.0]] * 2, r"shape \(2, 3\); allowed: \(1, 3\)"),
        ([[0.0, np.nan, 0.0]], "not finite"),
    ],
)
def test_bad_starts_are_refused(start, told):
    physics = host([[0.0, 0.0, 0.0]])
    with pytest.raises(PhysimError, match=told):
        physics.reset(start)
    assert physics.pose.tolist() == [[0.0, 0.0, 0.0]]


def test_after_a_failure_in_a_callback(monkeypatch):
    monkeypatch.setattr("physim.simulation.engine.choice.judges_natively", lambda: False)
    scene = crowd("jam", 1)
    physics = scene.physics()
    go_on(scene, physics, 110)
    state = physics.state
    with monkeypatch.context() as patch:
        patch.setattr(physics._guard, "_classify", lambda arbiter: 1 / 0)
        with pytest.raises(ZeroDivisionError):
            physics.step(scene.command(110, physics.pose))
    physics.restore(state)
    other = scene.physics()
    go_on(scene, other, 110)
    assert go_on(scene, physics, 150) == go_on(scene, other, 150)
