"""A run restored at any sample goes on bit for bit, anywhere; one that is reset is as good as new.

Two hosts of a scene run alike by that, too.
"""

from __future__ import annotations

import copy
import functools
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from physim.errors import PhysimError
from tests.simulation.engine.crowds import KINDS, crowd, digest, go_on, run, told, worth_restoring
from tests.simulation.engine.hosts import host

ONWARD = 200
"""steps that a restored run is followed"""


def last(kind):
    """Sample of the last state that is restored; false contacts are rare."""
    return 400 if kind == "apart" else 160


@functools.cache
def past(kind):
    return run(kind, 1, ONWARD + last(kind))


@functools.cache
def chosen(kind):
    return worth_restoring(past(kind).states[: last(kind)], np.random.default_rng(1), 4)


def follows(kind, state):
    """What the undisturbed run tells from a state on."""
    return past(kind).samples[int(state.step) : int(state.step) + ONWARD + 1]


@pytest.mark.parametrize("kind", KINDS)
def test_restored_in_the_same_and_in_a_fresh_physics(kind):
    scene = crowd(kind, 1)
    used, fresh = scene.physics(), scene.physics()
    go_on(scene, used, 100)
    for state in chosen(kind):
        for physics in (used, fresh):
            physics.restore(state)
            assert physics.state == state
            until = int(state.step) + ONWARD
            assert go_on(scene, physics, until) == follows(kind, state)
            assert physics.state == past(kind).states[until]


@pytest.mark.deep
def test_restored_in_another_process(tmp_path):
    cases = [(kind, state) for kind in KINDS for state in chosen(kind)]
    (tmp_path / "cases").write_bytes(pickle.dumps(cases))
    script = (
        "import pickle, sys\n"
        "from tests.simulation.engine.crowds import crowd, digest, go_on\n"
        "for kind, state in pickle.load(open(sys.argv[1], 'rb')):\n"
        "    scene = crowd(kind, 1)\n"
        "    physics = scene.physics()\n"
        "    physics.restore(state)\n"
        f"    print(digest(go_on(scene, physics, int(state.step) + {ONWARD})))\n"
    )
    command = [sys.executable, "-c", script, str(tmp_path / "cases")]
    done = subprocess.run(command, cwd=Path(__file__).parents[3], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [digest(follows(*case)) for case in cases]


@pytest.mark.parametrize("kind", KINDS)
def test_reset_is_the_same_as_built(kind):
    scene = crowd(kind, 2)
    used = scene.physics()
    for steps in (0, 1, 110):
        go_on(scene, used, steps)
        start = scene.start[::-1] + (0.01 * steps, 0.0, 0.2)
        fresh = scene._replace(start=start).physics()
        used.reset(start)
        assert told(used) == told(fresh)
        assert used.state == fresh.state
        assert go_on(scene, used, 120) == go_on(scene, fresh, 120)


@pytest.mark.parametrize(
    "again",
    [lambda one: one, copy.deepcopy, copy.copy, lambda one: pickle.loads(pickle.dumps(one))],
)
def test_a_state_never_changes_nor_do_copies(again):
    scene = crowd("jam", 1)
    physics = scene.physics()
    go_on(scene, physics, 120)
    state = again(physics.state)
    kept = pickle.dumps(state)
    assert state == past("jam").states[120]
    assert len(state.part)
    assert not any(array.flags.writeable for array in state.arrays().values())
    go_on(scene, physics, 150)
    physics.contacts["depth"] = 9.0
    assert physics.state != state
    physics.restore(state)
    assert go_on(scene, physics, 160) == past("jam").samples[120:161]
    assert pickle.dumps(state) == kept


@pytest.mark.parametrize(
    ("start", "words"),
    [
        ([0.0, 0.0, 0.0], r"shape \(3,\); allowed: \(1, 3\)"),
        ([[0.0, 0.0, 0.0]] * 2, r"shape \(2, 3\); allowed: \(1, 3\)"),
        ([[0.0, np.nan, 0.0]], "not finite"),
    ],
)
def test_bad_starts_are_refused(start, words):
    physics = host([[0.0, 0.0, 0.0]])
    with pytest.raises(PhysimError, match=words):
        physics.reset(start)
    assert physics.pose.tolist() == [[0.0, 0.0, 0.0]]


def test_a_state_of_another_scene_is_refused():
    with pytest.raises(PhysimError, match=r"poses of shape \(8, 3\); allowed: \(16, 3\)"):
        crowd("jam", 1).physics().restore(past("boxes").states[0])
    scene = crowd("jam", 1)
    other = scene._replace(robots=[scene.robots[1]] * 16)
    physics = other.physics()
    with pytest.raises(PhysimError, match=r"another scene.*contacts"):
        physics.restore(past("jam").states[120])
    physics.reset(scene.start)
    assert told(physics) == told(other.physics())
