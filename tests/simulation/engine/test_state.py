"""A run restored at any sample goes on bit for bit, anywhere; and what it takes for that."""

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

ROOT = Path(__file__).parents[3]
ONWARD = 200
"""steps that a restored run is followed"""
LAST = 160
"""sample of the last state that is restored"""
FALSE_LAST = 400
"""the same where false contacts are rare"""


@functools.cache
def past(kind, seed):
    return run(kind, seed, ONWARD + last(kind))


def last(kind):
    return FALSE_LAST if kind == "apart" else LAST


@functools.cache
def chosen(kind, seed):
    rng = np.random.default_rng(seed)
    return worth_restoring(past(kind, seed).states[: last(kind)], rng, 4)


def follows(kind, seed, state):
    """What the undisturbed run tells from a state on."""
    return past(kind, seed).samples[int(state.step) : int(state.step) + ONWARD + 1]


every_kind = pytest.mark.parametrize("kind", KINDS)


@every_kind
def test_restored_in_the_same_and_in_a_fresh_physics(kind):
    scene = crowd(kind, 1)
    used, fresh = scene.physics(), scene.physics()
    go_on(scene, used, 100)
    for state in chosen(kind, 1):
        for physics in (used, fresh):
            physics.restore(state)
            assert physics.state == state
            until = int(state.step) + ONWARD
            assert go_on(scene, physics, until) == follows(kind, 1, state)
            assert physics.state == past(kind, 1).states[until]


@pytest.mark.deep
def test_restored_in_another_process(tmp_path):
    cases = [(kind, 1, state) for kind in KINDS for state in chosen(kind, 1)]
    (tmp_path / "cases").write_bytes(pickle.dumps(cases))
    script = (
        "import pickle, sys\n"
        "from tests.simulation.engine.crowds import crowd, digest, go_on\n"
        "for kind, seed, state in pickle.load(open(sys.argv[1], 'rb')):\n"
        "    scene = crowd(kind, seed)\n"
        "    physics = scene.physics()\n"
        "    physics.restore(state)\n"
        f"    print(digest(go_on(scene, physics, int(state.step) + {ONWARD})))\n"
    )
    command = [sys.executable, "-c", script, str(tmp_path / "cases")]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [digest(follows(*case)) for case in cases]


# The value


def test_a_state_never_changes():
    scene = crowd("jam", 2)
    physics = scene.physics()
    go_on(scene, physics, 120)
    state = physics.state
    kept = pickle.dumps(state)
    assert len(state.part)
    for array in state.arrays().values():
        assert not array.flags.writeable
    go_on(scene, physics, 150)
    physics.contacts["depth"] = 9.0
    assert physics.state != state
    physics.restore(state)
    go_on(scene, physics, 125)
    assert pickle.dumps(state) == kept


def pickled(state):
    return pickle.loads(pickle.dumps(state))


@pytest.mark.parametrize("again", [copy.deepcopy, copy.copy, pickled])
def test_copies_are_equal_and_read_only(again):
    state = past("jam", 1).states[120]
    other = again(state)
    assert other == state
    assert not any(array.flags.writeable for array in other.arrays().values())
    scene = crowd("jam", 1)
    physics = scene.physics()
    physics.restore(other)
    assert go_on(scene, physics, 160) == past("jam", 1).samples[120:161]


# Of another scene


def test_another_number_of_robots_is_refused():
    with pytest.raises(PhysimError, match=r"poses of shape \(8, 3\); allowed: \(16, 3\)"):
        crowd("jam", 1).physics().restore(past("boxes", 1).states[0])


def test_other_contacts_at_the_poses_are_told():
    scene = crowd("jam", 1)
    state = past("jam", 1).states[120]
    physics = scene._replace(robots=[scene.robots[1]] * 16).physics()
    with pytest.raises(PhysimError, match=r"another scene.*contacts"):
        physics.restore(state)
    physics.reset(scene.start)
    assert told(physics) == told(scene._replace(robots=[scene.robots[1]] * 16).physics())
