"""Coarse records of runs that were interrupted or killed are simulated as far as they go."""

from __future__ import annotations

import json

import h5py
import numpy as np
import pytest

import physim
from tests.validation.reports import states
from tests.validation.runs import LANE, Careless
from tests.validation.test_command import CARELESS, run


def stopped_at(path, step, **changes):
    """Record of a run of Careless that was interrupted at a step."""
    overrides = [f"{key}={value}" for key, value in changes.items()]
    steps = iter(range(1, step + 1))
    world = physim.parse_world(LANE, overrides=overrides)
    record = physim.simulate(
        world, controller=Careless(), path=path, stop=lambda: next(steps) == step
    )
    record.close()


@pytest.mark.parametrize(("ended", "says"), [("interrupted", "INTERRUPTED"), ("running", "KILLED")])
def test_a_coarse_record_that_breaks_off_is_judged_up_to_there(tmp_path, capsys, ended, says):
    path = tmp_path / f"{ended}.h5"
    stopped_at(path, 100, **{"time.record_every": 7})
    with h5py.File(path, "r+") as file:
        if ended == "running":
            file.attrs.modify("ended", np.bytes_(ended))
    target = tmp_path / f"{ended}.json"
    code, out, _ = run(capsys, path, "--controller", CARELESS, "--json", target)
    assert code == 0
    assert states(out, "1.00 s of at most 3 s", "step 0.01 s", says)
    assert states(out, "Simulated again", "to the bit")
    written = json.loads(target.read_text(encoding="utf-8"))["run"]
    assert (written["ended"], written["samples"]) == (ended, 101)


def test_a_coarse_record_of_a_run_that_ended_elsewhere(tmp_path, capsys):
    path = tmp_path / "elsewhere.h5"
    stopped_at(path, 105, **{"time.record_every": 7})
    with h5py.File(path, "r+") as file:
        file.attrs.modify("ended", np.bytes_("finished"))
    code, out, _ = run(capsys, path, "--controller", CARELESS)
    assert code == 3
    text = " ".join(out.split())
    assert states(text, "ended", "finished in the record", "duration simulated again")
