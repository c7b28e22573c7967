"""A run whose record cannot fit is refused before it is made."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from types import SimpleNamespace

import pytest

from physim import Decision, build_scene, simulate
from physim.errors import RecordError
from tests.helpers import THREE, Says, facts, inside, road

check_room = inside("physim.simulation", "check_room")


@pytest.mark.parametrize("every", [1, 7])
def test_a_record_that_does_not_fit_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, every: int
) -> None:
    """By what its samples take, which is certain; on the disk, and in memory."""
    world = road(THREE, duration=30.0)
    world = world.changed(time={"step": 0.01, "duration": 30.0, "record_every": every})
    standing = Says(lambda o: Decision(0.0, 0.0, hold=1.0))
    with simulate(world, controller=standing, path=tmp_path / "r.h5") as record:
        names = ("step", "pose", "clearance", "boundary_clearance")
        held = sum(record.read(f"/steps/{name}").nbytes for name in names)
    scene, file = build_scene(world), tmp_path / "not" / "there" / "r.h5"
    free = held * 1.1
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: SimpleNamespace(free=free, total=1e15))
    check_room(scene, every, file)
    free = held - 1
    told = facts("MB", str(tmp_path), "3", "time.duration", "30", "time.record_every", str(every))
    with pytest.raises(RecordError, match=told):
        check_room(scene, every, file)
    with pytest.raises(RecordError, match=told):
        simulate(world, path=tmp_path / "other.h5")
    assert [one.name for one in tmp_path.iterdir()] == ["r.h5"]
    check_room(scene, every, None)  # in memory it fits
    monkeypatch.setattr(os, "sysconf", lambda name: 1 if name == "SC_PAGE_SIZE" else held - 1)
    with pytest.raises(RecordError, match=facts("memory", "time.record_every")):
        simulate(world)
