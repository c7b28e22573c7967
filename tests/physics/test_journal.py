"""Without the engine's memory of contacts a state is reached by doing the steps since again."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pymunk
import pytest
from crowds import crowd, go_on, run, worth_restoring
from engine_memory import biases, set_biases

from physim.errors import PhysimError
from physim.simulation.engine import state as engine_state
from tests.helpers import inside

ContactMemory = inside("physim.simulation.engine", "ContactMemory")
goes_on_from_impulses = inside("physim.simulation.engine", "goes_on_from_impulses")

KINDS = ("wall_ends", "abreast", "apart", "jam")
STEPS = 180


@pytest.fixture
def forgetful(monkeypatch):
    """As with a version of pymunk that fails the trial."""
    monkeypatch.setattr("physim.simulation.engine.host.goes_on_from_impulses", lambda: False)


@pytest.mark.parametrize("kind", KINDS)
def test_restored_by_doing_the_steps_again(kind, forgetful):
    scene, past = crowd(kind, 4), run(kind, 4, STEPS + 200)
    for state in worth_restoring(past.states[:STEPS], np.random.default_rng(0), 3):
        assert len(state.part) == 0
        physics = scene.physics()
        go_on(scene, physics, 30)
        physics.restore(pickle.loads(pickle.dumps(copy.deepcopy(state))))
        assert physics.state == state
        k = int(state.step)
        assert go_on(scene, physics, k + 200) == past.samples[k : k + 201]
        assert physics.state == past.states[k + 200]


def test_it_is_the_run_of_an_engine_with_memory(monkeypatch):
    remembered = run("jam", 4, 150)
    with monkeypatch.context() as patch:
        patch.setattr("physim.simulation.engine.host.goes_on_from_impulses", lambda: False)
        forgotten = run("jam", 4, 150)
    assert forgotten.samples == remembered.samples
    # An engine with memory takes up both kinds of state.
    physics = crowd("jam", 4).physics()
    physics.restore(forgotten.states[100])
    assert len(physics.state.part) > 0
    assert go_on(crowd("jam", 4), physics, 150) == remembered.samples[100:]


def test_the_origin_is_the_last_sample_without_a_reported_contact(forgetful):
    states = run("apart", 4, 420).states
    free = [k for k, s in enumerate(states) if not len(s.false_contacts) and not len(s.touching)]
    assert 300 < len(free) < 420
    for k, state in enumerate(states):
        origin = max(j for j in free if j <= k)
        assert int(state.origin_step) == origin
        assert state.origin_pose.tobytes() == states[origin].pose.tobytes()
        assert state.applied.shape == (k - origin, 2, 2)


def test_a_start_in_contact_is_an_origin(forgetful):
    states = run("abreast", 1, 40).states
    assert len(states[0].touching)
    assert {int(s.origin_step) for s in states if len(s.touching)} == {0}


def test_a_state_in_contact_of_an_engine_with_memory_is_refused(monkeypatch):
    states = run("jam", 4, 150).states
    monkeypatch.setattr("physim.simulation.engine.host.goes_on_from_impulses", lambda: False)
    physics = crowd("jam", 4).physics()
    with pytest.raises(PhysimError, match="pymunk"):
        physics.restore(states[150])
    free = next(s for s in reversed(states) if not len(s.touching))
    physics.restore(free)
    assert go_on(crowd("jam", 4), physics, 150) == run("jam", 4, 150).samples[int(free.step) :]


# The trial


def trial():
    return goes_on_from_impulses.__wrapped__()


def test_this_engine_goes_on_from_impulses():
    assert trial()


def no_arbiters(space):
    raise AttributeError("_get_arbiters")


def test_no_access_to_the_memory_fails_the_trial(monkeypatch):
    monkeypatch.setattr(pymunk.Space, "_get_arbiters", no_arbiters)
    assert not trial()


@pytest.mark.parametrize("factor", [(0.0, 1.0), (1.0, 0.0), (1.0 + 1e-15, 1.0)])
def test_other_impulses_fail_the_trial(monkeypatch, factor):
    read = ContactMemory.read

    def changed(memory):
        impulses = read(memory)
        return impulses._replace(impulse=impulses.impulse * factor)

    monkeypatch.setattr(ContactMemory, "read", changed)
    assert not trial()


def test_other_biases_fail_the_trial(monkeypatch):
    write = ContactMemory.write

    class Shell:
        def __init__(self, space):
            self._engine = self
            self._space = space

    def changed(memory, kept):
        write(memory, kept)
        assert np.abs(biases(Shell(memory._space))).max() > 0.0
        set_biases(Shell(memory._space), 0.0)

    monkeypatch.setattr(ContactMemory, "write", changed)
    assert not trial()


def test_the_trial_is_made_once_a_process(monkeypatch):
    goes_on_from_impulses()
    monkeypatch.setattr(engine_state, "_trial", no_arbiters)
    assert goes_on_from_impulses()
