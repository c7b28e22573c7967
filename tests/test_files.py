"""What is no file of its own is not replaced: a device, a pipe, a link to what lies elsewhere."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import physim
from physim.drawing.page import Page
from physim.errors import PhysimError
from tests.helpers import inside
from tests.helpers.records import make_record

save_figure = inside("physim.drawing.plots", "save_figure")
save_still, VideoFile = inside("physim.drawing.video", "save_still", "VideoFile")


def _simulated(path: str | Path) -> None:
    world = physim.load_world("worlds/straight.yaml")
    physim.simulate(world.changed(time={"duration": 0.1}), path=path, overwrite=True)


WRITERS: dict[str, Callable[[Path], object]] = {
    "record": _simulated,
    "copy of a record": lambda path: make_record(seconds=0.1).save(path),
    "world": lambda path: physim.load_world("worlds/straight.yaml").save(path),
    "page": lambda path: Page("<p>").write(path),
    "plot": lambda path: save_figure(path, "png", Figure),
    "still": lambda path: save_still(path, np.zeros((2, 2, 3), np.uint8)),
    "video": lambda path: VideoFile(path, 25.0),
}
ENDINGS = {"still": "out.png", "video": "out.mp4"}


@pytest.mark.parametrize("what", WRITERS)
@pytest.mark.parametrize("kind", ["pipe", "link"])
def test_what_is_no_regular_file_stays(tmp_path: Path, what: str, kind: str) -> None:
    """Renaming would replace it, and /dev/null for every program of the machine."""
    path, other = tmp_path / ENDINGS.get(what, "out.h5"), tmp_path / "other"
    other.write_text("mine")
    os.mkfifo(path) if kind == "pipe" else path.symlink_to(other)
    before = path.lstat()
    with pytest.raises(PhysimError, match=f"not a regular file but a (named )?{kind}"):
        WRITERS[what](path)
    assert path.lstat() == before
    assert other.read_text() == "mine"
    assert sorted(one.name for one in tmp_path.iterdir()) == sorted(["other", path.name])


@pytest.mark.parametrize(("path", "told"), [(".", "is a folder"), ("a\0b", "no file can have")])
def test_a_record_has_a_name_that_a_file_can_have(path: str, told: str) -> None:
    with pytest.raises(PhysimError, match=told):
        _simulated(path)
