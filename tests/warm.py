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
from physim.cli.warming import warm_up_checks, warm_up_motion_alone
warm_up_motion_alone()
warm_up_checks("constant")
from physim.cli import main
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
