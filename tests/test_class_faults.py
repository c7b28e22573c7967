"""Faults of a controller's class name the file and line of its author."""

from __future__ import annotations

import inspect
import re

import numpy as np
import pytest

from physim import Decisions, Mode, Simulation
from physim.errors import ControllerError
from physim.world.file import load_world
from tests.cli.commands import physim
from tests.helpers import inside

CONTROLLER, find_part = inside("physim.parts", "CONTROLLER", "find_part")


class NoModel:
    Settings = dict

    def decide(self, observation, memory): ...


class TwoModes:
    modes = (Mode("a", "#000000"), Mode("a", "#000000"))

    def decide(self, observation, memory): ...


class NoColour:
    modes = (Mode("a", "black"),)

    def decide(self, observation, memory): ...


class Empty:
    pass


class Text:
    def decide(self, observation, memory):
        return "forward"


class NoBatch(Empty):
    def decide(self, observation, memory): ...

    def batch(self, scene):
        return None


class HalfBatch:
    """Its batch form answers no number for a command."""

    def decide(self, observation, memory): ...

    def batch(self, scene):
        return self

    def memory(self):
        return {}

    def decide_due(self, sensed, due, memory):
        many = len(due)
        none, counts = np.full(many, -1), np.zeros(many + 1, dtype=np.int64)
        wrong, report = np.full((many, 2), np.nan), np.zeros((many, 0))
        return Decisions(due, wrong, np.full(many, 0.1), none, none, report, counts[:0], counts)


def a_function(): ...


@pytest.mark.parametrize(
    ("given", "named"),
    [
        (NoBatch(), NoBatch.batch),
        (HalfBatch(), HalfBatch.decide_due),
        ("tests.test_class_faults:a_function", a_function),
        ("tests.test_class_faults:NoModel", NoModel),
        ("tests.test_class_faults:Empty", Empty),
        (TwoModes(), TwoModes),
        (NoColour(), NoColour),
        (Empty(), Empty),
        (Text, Text),
        (Text(), Text.decide),
    ],
)
def test_a_fault_of_a_class_names_the_line_at_which_its_author_wrote_it(given, named):
    line = inspect.getsourcelines(named)[1]
    with pytest.raises(ControllerError) as caught:
        Simulation(load_world("straight"), controller=given).step()
    assert str(caught.value).endswith(f" ({__file__}:{line})")


def test_a_class_that_is_not_in_its_module_names_the_file():
    with pytest.raises(ControllerError, match=re.escape(f" ({__file__})") + "$"):
        find_part(CONTROLLER, "tests.test_class_faults:Lost", trusted=True)


AWAY = """\
import os
{at_import}

class Away:
    def __init__(self):
        {in_init}

    def decide(self, observation, memory):
        from physim import Decision
        {in_decide}
        return Decision(v=0.0, omega=0.0, hold=0.1)
"""


@pytest.mark.parametrize("place", ["at_import", "in_init", "in_decide"])
def test_code_that_goes_to_another_folder_takes_no_output_along(
    tmp_path, monkeypatch, capsys, place
):
    """Such as to its weights: record and summary are written where the command was given."""
    (tmp_path / "model").mkdir()
    (tmp_path / "work").mkdir()
    away = f"os.chdir({str(tmp_path / 'model')!r})"
    where = {"at_import": "", "in_init": "pass", "in_decide": "", place: away}
    (tmp_path / "model" / f"away_{place}.py").write_text(AWAY.format(**where))
    monkeypatch.chdir(tmp_path / "work")
    monkeypatch.syspath_prepend(tmp_path / "model")
    done = physim(
        "run", "straight", "--controller", f"away_{place}:Away", "-o", "out", "--no-video",
        "--quiet", "--set", "time.duration=0.2", "--set", "expect=null", capture=capsys,
    )  # fmt: skip
    assert done.code == 0, done.err
    assert (tmp_path / "work" / "out" / "record.h5").is_file()
    assert [one.name for one in (tmp_path / "model").iterdir() if one.suffix != ".py"] in (
        [],
        ["__pycache__"],
    )
