"""Worlds, summaries and validations are values that show themselves on a line."""

from __future__ import annotations

import sys

from tests.edges.shell import Shell

NUMBER = "values"
TRIAL = """\
import copy, pickle
import physim

world = physim.load_world("straight").changed(time={"step": 0.01, "duration": 1.0})
record = physim.simulate(world, path="r.h5")
summary, validation = physim.summarise(record), physim.validate(record)
for one in (world, summary, validation):
    assert len(repr(one)) < 120 and repr(one).startswith("<"), repr(one)
    assert copy.deepcopy(one) == pickle.loads(pickle.dumps(one)) == one
assert pickle.loads(pickle.dumps(record)).digest() == record.digest()
try:
    world.seed = 4
except AttributeError as error:
    assert "changed" in str(error) and "http" not in str(error), error
else:
    raise AssertionError("a world can be changed in place")
"""


def try_them(shell: Shell) -> None:
    shell.write("trial.py", TRIAL)
    done = shell.sh(f'"{sys.executable}" trial.py')
    assert (done.code, done.err) == (0, ""), done.err
