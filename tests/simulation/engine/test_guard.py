"""False contacts of the engine are kept out, true ones kept."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.simulation.engine.crowds import crowd, digest, go_on
from tests.simulation.engine.hosts import FALSE_CONTACTS, box, drive, host, side_by_side


def disturbed(guarded):
    """Runs in which two robots 0.2 m apart, with one heading, touched or strayed."""
    bad = 0
    for seed in (*range(10), *FALSE_CONTACTS):
        physics = side_by_side(seed, guarded)
        gap = physics.pose[1, :2] - physics.pose[0, :2]
        poses, rows = drive(physics, [[1.0, 0.0], [1.0, 0.0]], 400)
        strayed = np.abs(poses[-1, 1, :2] - poses[-1, 0, :2] - gap).max() > 1e-9
        bad += strayed or any(len(r) for r in rows)
    return bad


def test_robots_side_by_side_never_touch():
    assert disturbed(guarded=True) == 0
    # Without the guard the engine's false contacts come through: so this test can fail.
    assert disturbed(guarded=False) == len(FALSE_CONTACTS)


def test_each_false_contact_is_told_at_its_sample():
    told = 0
    for seed in FALSE_CONTACTS[:4]:
        physics = side_by_side(seed, True)
        for step in range(1, 401):
            physics.step(np.array([[1.0, 0.0], [1.0, 0.0]]))
            for row in physics.false_contacts:
                assert (row["step"], row["a"], row["b"]) == (step, 0, 1)
                assert row["distance"] == pytest.approx(0.2)
            told += len(physics.false_contacts)
    assert told >= 4


def test_pressed_side_by_side_they_stay_in_step():
    for seed in range(20):
        rng = np.random.default_rng(seed)
        heading, gap = rng.uniform(-3, 3), rng.uniform(-1e-3, 1e-3)
        left = np.array([-np.sin(heading), np.cos(heading)])
        start = [[0.0, 0.0, heading], [*((0.6 + gap) * left), heading]]
        poses, _ = drive(host(start), [[1.0, 0.0], [1.0, 0.0]], 50)
        moved = np.hypot(*np.diff(poses, axis=0)[:, :, :2].reshape(-1, 2).T)
        assert moved == pytest.approx(0.05, abs=1e-5)


def test_parts_of_one_robot_do_not_collide():
    overlapping = [box(), box(x=0.4)]
    physics = host([[0.0, 0.0, 0.0]], [overlapping])
    poses, rows = drive(physics, [1.0, 0.0], 40)
    assert not any(len(r) for r in rows)
    assert poses[-1, 0, 0] == pytest.approx(2.0, abs=1e-12)


PLAIN = """
from tests.simulation.engine.crowds import crowd, digest, go_on
for kind, steps in (("abreast", 30), ("wall_ends", 16)):
    scene = crowd(kind, 1)
    print(digest(go_on(scene, scene.physics(), steps)))
"""


@pytest.mark.deep
def test_compiled_callbacks_do_what_they_do_as_plain_python():
    done = subprocess.run(
        [sys.executable, "-c", PLAIN], cwd=Path(__file__).parents[3], capture_output=True,
        text=True, env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    runs = ((crowd(kind, 1), steps) for kind, steps in (("abreast", 30), ("wall_ends", 16)))
    assert done.stdout.split() == [digest(go_on(s, s.physics(), n)) for s, n in runs]
