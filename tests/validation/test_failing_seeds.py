"""``physim validate --seeds`` where the run of one seed fails: the others are not lost with it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.campaigns.samples import WORLD
from tests.cli.commands import shell

CONTROLLER = '''\
"""Does what its class says where a robot starts with a heading above 2."""

import os

from physim import Decision


class Leaves:
    def decide(self, observation, memory):
        if observation.time == 0.0 and observation.pose[2] > 2.0:
            self.fail()
        return Decision(v=0.5, omega=0.0, hold=0.1)

    def fail(self):
        os._exit(0)


class Raises(Leaves):
    def fail(self):
        raise ValueError("as it was told")
'''


@pytest.mark.parametrize(
    ("name", "said"), [("Leaves", "a worker process was killed"), ("Raises", "as it was told")]
)
def test_the_seeds_so_far_are_reported_and_written(tmp_path: Path, name: str, said: str) -> None:
    """The seed was run again where the study itself is: it ended without a word, with code 0."""
    (tmp_path / "small.yaml").write_text(WORLD, encoding="utf-8")
    (tmp_path / "sometimes.py").write_text(CONTROLLER, encoding="utf-8")
    done = shell(
        "validate", "small.yaml", "--seeds", "1:40", "--controller", f"sometimes:{name}",
        "--workers", "2", "--json", "study.json", folder=tmp_path,
    )  # fmt: skip
    assert done.code == 2
    found = json.loads((tmp_path / "study.json").read_text(encoding="utf-8"))
    seeds = len(found["seeds"])
    assert 0 < seeds < 39
    assert f"seed {seeds + 1} failed after {seeds} of 39 seeds" in done.err
    assert said in done.err
    assert f"{seeds} runs contact-free" in done.out
