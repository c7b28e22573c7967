"""How large a run is, told before it is made; and that one which cannot fit is refused."""

from __future__ import annotations

import os
import re
import shutil
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from physim import Decision, build_scene, simulate
from physim.errors import RecordError
from tests.helpers import THREE, Says, facts, inside, road

LARGE_BYTES, check_room = inside("physim.simulation", "LARGE_BYTES", "check_room")
size_of = inside("physim.simulation", "size_of")


def scene_of(**changes: Any) -> Any:
    """Three robots on a road."""
    time = {"step": 0.01, "duration": 30.0, "record_every": 1, **changes}
    world = road(THREE)
    return build_scene(world.changed(time=type(world.time)(**time)))


@pytest.mark.parametrize("every", [1, 7])
def test_samples_take_what_is_told_of_them(tmp_path: Path, every: int) -> None:
    scene = scene_of(record_every=every)
    size = size_of(scene, every)
    file = tmp_path / "r.h5"
    standing = Says(lambda o: Decision(0.0, 0.0, hold=1.0))
    with simulate(scene.world, controller=standing, path=file) as record:
        held = sum(
            record.read(f"/steps/{name}").nbytes
            for name in ("step", "pose", "clearance", "boundary_clearance")
        )
    assert held <= size.samples <= 1.05 * held
    assert size.samples < os.path.getsize(file)
    assert size_of(scene, every, tables=("contacts",)).decisions == 0
    assert not size.is_large
    huge = size_of(scene_of(duration=3e5), 1)
    assert huge.is_large
    assert huge.record > LARGE_BYTES
    assert re.search(facts("3", "30,000,000", "GB"), huge.line())


def test_a_record_that_does_not_fit_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = scene_of()
    size, file = size_of(scene, 1), tmp_path / "not" / "there" / "r.h5"
    free = size.samples
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: SimpleNamespace(free=free, total=1e15))
    check_room(size, file)  # just
    free = size.samples - 1
    told = facts("384 kB", str(tmp_path), "3", "time.duration", "30", "time.record_every", "1")
    with pytest.raises(RecordError, match=told):
        check_room(size, file)
    with pytest.raises(RecordError, match=told):
        simulate(scene.world, path=tmp_path / "r.h5")
    assert list(tmp_path.iterdir()) == []
    check_room(size, None)  # in memory it fits
    monkeypatch.setattr(sys.modules[size_of.__module__], "memory", lambda: float(free))
    with pytest.raises(RecordError, match=facts("memory", "time.record_every")):
        simulate(scene.world)
