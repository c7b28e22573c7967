"""However fast robots meet, they do not sink into each other, or the run says so."""

from __future__ import annotations

import json

from tests.edges.shell import Shell

NUMBER = "8"

WORLD = """\
name: meet
time: {step: 0.01, duration: 3.0}
corridor: {centreline: [[0, 0], [80, 0]], width: 6.0}
robots:
  - {name: a, footprint: {length: 1.8, width: 1.0}, mass: 300, pose: [5, 0, 0],
     path: [[0, 0], [80, 0]], limits: {v: 20.0}}
  - {name: b, footprint: {length: 1.8, width: 1.0}, mass: 100, pose: [75.13, 0.3, 3.14159],
     path: [[80, 0], [0, 0]], limits: {v: 20.0}}
controller: {type: path_following, speed: 20.0}
"""


def try_head_on_at_20_metres_a_second(shell: Shell) -> None:
    done = shell.physim("run", shell.write("meet.yaml", WORLD), "-o", "out", "--no-video")
    assert done.code in (0, 1), done.err
    told = json.loads((shell.folder / "out" / "summary.json").read_text())
    assert told["contacts"]["count"] > 0
    assert told["contacts"]["max_depth_m"] <= 0.021 or told["deep_contacts"], told["contacts"]
    assert told["contacts"]["max_depth_m"] < 0.05, told["contacts"]
