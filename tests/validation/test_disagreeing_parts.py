"""Records whose parts are right each for itself, and disagree."""

from __future__ import annotations

import re
import shutil
from copy import deepcopy

import h5py
import pytest
import yaml

from physim.errors import RecordError
from physim.record import Record
from tests.forgeries.edits import Forgery
from tests.forgeries.runs import free
from tests.forgeries.tools import cells
from tests.forgeries.trial import tried
from tests.helpers import inside

pose_blocks = inside("physim.analysis.validation", "pose_blocks")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    path = tmp_path_factory.mktemp("made") / "free.h5"
    free(path)
    return {"free": path}


@pytest.mark.parametrize("change", [lambda some: some[:-1], lambda some: [*some, some[0]]])
def test_a_world_inside_of_other_robots_is_told(made, tmp_path, change):
    def other(file: h5py.File) -> None:
        world = yaml.safe_load(file.attrs["world"])
        robots = change(world["robots"])
        robots[-1] = {**deepcopy(robots[-1]), "name": "last", "pose": [7.5, 0.0, 0.0]}  # no alias
        world["formation"]["spacing"] = "initial"
        file.attrs["world"] = yaml.safe_dump({**world, "robots": robots})

    words = ("number of robots is 3 in the record", "the world inside has", "the record 3 robots")
    assert tried(Forgery("", "free", other, words), made, tmp_path) == ""


def test_simulated_again_texts_that_differ_are_told(made, tmp_path):
    words = ("/bodies/name, row 0 is other in the record, r1 simulated again",)
    change = cells("/bodies/name", 0, "other")
    forgery = Forgery("", "free", change, words, ("--rerun", "--json", str(tmp_path / "told.json")))
    assert tried(forgery, made, tmp_path) == ""


def test_a_jump_of_millions_of_metres_is_refused(made, tmp_path):
    """When its steps are read: the search for contacts, which comes later, would not end."""
    jumps = tmp_path / "jumps.h5"
    shutil.copy(made["free"], jumps)
    with h5py.File(jumps, "r+") as file:
        file["/steps/pose"][40, 1, 0] = 2.0e6
    told = re.escape("/steps/pose, row 40: a step of 2e+06 m")
    with Record.load(jumps) as record, pytest.raises(RecordError, match=told):
        list(pose_blocks(record))
