"""The compiled guard is the plain one, bit for bit; the plain one serves where it cannot be had."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pymunk
import pytest
from crowds import KINDS, run
from test_guard import FALSE_CONTACTS, side_by_side

from physim.simulation.engine import Physics, choice, guard, native_guard, native_memory
from tests.helpers import inside

joined_shapes, pack_parts = inside("physim.geometry", "joined_shapes", "pack_parts")
judges_natively, PlainGuard = inside("physim.simulation.engine", "judges_natively", "PlainGuard")
NativeGuard, ACTS, APART = inside("physim.simulation.engine", "NativeGuard", "ACTS", "APART")
LEFT, SIDE, deepest = inside("physim.simulation.engine", "LEFT", "SIDE", "deepest")
deepest_point = inside("physim.simulation.engine", "deepest_point")

SEEDS = (11, 17, 18)
STEPS = 400


@pytest.fixture
def plainly(monkeypatch):
    """Called, it makes guards plain ones from then on; counts their verdicts."""
    verdicts: Counter[int] = Counter()
    classify = guard.classify

    def counted(*arguments):
        found = classify(*arguments)
        verdicts[found[0]] += 1
        return found

    def switch():
        monkeypatch.setattr(choice, "judges_natively", lambda: False)
        monkeypatch.setattr(guard, "classify", counted)
        return verdicts

    return switch


def test_this_engine_lets_the_compiled_guard_judge():
    assert judges_natively()
    assert isinstance(side_by_side(35, guarded=True)._guard, NativeGuard)
    assert isinstance(side_by_side(35, guarded=False)._guard, PlainGuard)


def test_it_is_the_plain_guard_bit_for_bit(plainly):
    """Thousands of steps of boxes, compound robots, wall ends, jams and false contacts."""
    native = [run(kind, seed, STEPS) for kind in KINDS for seed in SEEDS]
    verdicts = plainly()
    plain = [run(kind, seed, STEPS) for kind in KINDS for seed in SEEDS]
    for one, other in zip(native, plain, strict=True):
        assert one.samples == other.samples
        assert one.states == other.states
    assert verdicts[ACTS] > 10_000
    assert verdicts[APART] > 300
    assert verdicts[LEFT] > 20
    assert verdicts[SIDE] > 20


def test_deep_false_contacts_are_kept_out_alike(plainly):
    def runs():
        told = []
        for seed in FALSE_CONTACTS:
            physics = side_by_side(seed, guarded=True)
            for _ in range(400):
                physics.step(np.array([[1.0, 0.0], [1.0, 0.0]]))
            told.append((physics.rejected, physics.pose.tobytes()))
        return told

    native = runs()
    verdicts = plainly()
    assert native == runs()
    assert verdicts[APART] >= len(FALSE_CONTACTS)


def test_many_contacts_in_one_solve(plainly):
    """More than the arrays hold at first."""
    rng = np.random.default_rng(0)
    shapes = pack_parts([[[(-0.5, -0.3), (0.5, -0.3), (0.0, 0.5)]]] * 60)
    start = np.column_stack((rng.uniform(0, 3, (60, 2)), rng.uniform(-3, 3, 60)))
    wall = pack_parts([[[(-99.0, 0.0), (-99.0, 1.0)]]])

    def told():
        physics = Physics(shapes, wall, start, np.ones(60), 0.05)
        counts = []
        for _ in range(6):
            physics.step(np.ones((60, 2)))
            counts.append((len(physics.contacts), physics.pose.tobytes()))
        return counts, physics.contacts.tobytes()

    native = told()
    plainly()
    assert native == told()
    assert native[0][0][0] > 200


def test_the_deepest_point_is_the_first_of_them():
    rng = np.random.default_rng(0)
    some = 0
    for _ in range(500):
        ends = rng.uniform(-1, 1, (4, 2)).round(2)
        walls = [ends[k : k + 2].tolist() for k in range(3)]
        corners = 0.7 * np.exp(1j * np.sort(rng.uniform(0, 2 * np.pi, rng.integers(3, 7))))
        robot = np.column_stack((corners.real, corners.imag))
        shapes = joined_shapes(pack_parts([[robot]]), pack_parts([walls]))
        links = guard.segment_links(shapes)
        pose = np.array([*rng.uniform(-1, 1, 2), rng.uniform(-4, 4)])
        for segment, (one, other) in enumerate(walls, 1):
            ex, ey = np.subtract(other, one)
            nx, ny = np.array([-ey, ex]) / np.hypot(ex, ey) * rng.choice([-1.0, 1.0])
            plain = deepest(shapes, links, 0, pose, segment, nx, ny)
            found = deepest_point(shapes, links, 0, pose, segment, nx, ny)
            assert found[0] == bool(plain)
            some += found[0]
            if plain:
                assert found[1:] == (*plain[0][0], *plain[0][1])
    assert 500 < some < 1400


# The trial


@pytest.fixture
def untried():
    """The trial is made anew, in the test and after it."""
    judges_natively.cache_clear()
    yield
    judges_natively.cache_clear()


def missing(*arguments):
    raise AttributeError("gone")


@pytest.mark.parametrize(
    ("where", "name", "value"),
    [
        (pymunk.Space, "_get_arbiters", missing),
        (native_guard, "address", missing),
        (native_memory, "layout_is_known", lambda: False),
        (NativeGuard, "take_rejected", lambda self: guard.NOTHING.part),
        (NativeGuard, "take", lambda self: guard.NOTHING),
    ],
)
def test_the_plain_guard_serves_where_the_trial_fails(untried, monkeypatch, where, name, value):
    monkeypatch.setattr(where, name, value)
    assert not judges_natively()
    assert isinstance(side_by_side(35, guarded=True)._guard, PlainGuard)


@pytest.mark.parametrize("callback", ["preSolveFunc", "postSolveFunc"])
def test_a_callback_that_does_nothing_fails_the_trial(untried, monkeypatch, callback):
    connect = NativeGuard._connect

    def unconnected(self, hosted):
        connect(self, hosted)
        handler = hosted.space._handlers[None, None]._handler
        setattr(handler, callback, native_guard.ffi.addressof(native_guard.lib, "DoNothing"))

    monkeypatch.setattr(NativeGuard, "_connect", unconnected)
    assert not judges_natively()


def test_poses_that_the_engine_does_not_tell_fail_the_trial(untried, monkeypatch):
    connect = NativeGuard._connect

    def asks_for_nothing(self, hosted):
        connect(self, hosted)
        self._kept[-4].fields = 0  # of bodies

    monkeypatch.setattr(NativeGuard, "_connect", asks_for_nothing)
    assert not judges_natively()
