"""Compile what the tests need, once for all workers: ``python -m tests.warm``.

Two processes share the work. A mark beside the kernels' cache says for which sources it was done.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from physim.compiled import source_stamp

ROOT = Path(__file__).parents[1]
MARK = ROOT / ".pytest_cache" / "warm"

JOBS = (
    """
from physim import load_world
from physim.simulation.run import warm_up
from physim.world.layout.scene_builder import build_scene
warm_up(build_scene(load_world("ten_robots")))
""",
    """
from physim import build_scene, load_world, simulate
from physim.analysis.metrics.distances import shortest_pair_collision_time
from physim.analysis.validation import validate
from physim.cli import main
from physim.simulation.run import warm_up_motion
world = load_world("three_robots", overrides=["time.duration=0.2"])
world = world.changed(controller={"type": "constant"})
warm_up_motion(build_scene(world))
with simulate(world) as record:
    validate(record, rerun=False)
    shortest_pair_collision_time(record)
main(["crashtest", "--cases", "3", "--quiet"])
main(["check-controller", "path_following"])
""",
)


def main() -> int:
    """Compile; the exit code of the process that failed, if one did."""
    if MARK.exists() and MARK.read_text() == source_stamp():
        return 0
    quiet = {"stdout": subprocess.DEVNULL}
    running = [subprocess.Popen([sys.executable, "-c", job], **quiet) for job in JOBS]  # type: ignore[call-overload]
    codes = [one.wait() for one in running]
    if not any(codes):
        MARK.parent.mkdir(exist_ok=True)
        MARK.write_text(source_stamp())
    return max(codes)


if __name__ == "__main__":
    sys.exit(main())
