"""Do two states of the sources give the same records? ``python -m tests.digests --against COMMIT``

Every shipped world is run whole by the sources here and by those of the commit, and the digests of
the records are compared (`physim.Record.digest`: all that is recorded but wall-clock times and
versions). Where they differ, so may the layout of the file alone: then every value that
`physim.Record` gives is compared. Where these differ, it is said whether the robots moved alike all
the same. Exit code 0: all are equal, or hold equal values; 1: one does not; 2: bad input.
"""

from __future__ import annotations

import argparse
import io
import json
import subprocess
import sys
import tarfile
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from tests.checkout import LINKS, copy_checkout, environment, python

ROOT = Path(__file__).parents[1]

SCRIPT = """
import hashlib, json, sys
import numpy as np
import physim
NAMES = (
    "name world_text seed dt steps_planned record_every steps_run safe_distance ended "
    "rejected_contacts tables given declared bodies stop_station lead footprints shapes walls "
    "paths reference accessible safe steps pose clearance boundary_clearance updates commands "
    "considered contacts false_contacts extremes farthest arrived"
).split()
def add(total, value):
    if isinstance(value, (tuple, list)):
        total.update(f"{len(value)} of\\n".encode())
        for one in value:
            add(total, one)
    elif isinstance(value, np.ndarray):
        total.update(f"{value.dtype.descr} {value.shape}\\n".encode() + value.tobytes())
    else:
        total.update(f"{value!r}\\n".encode())
for name in sys.argv[2:]:
    for seed in range(int(sys.argv[1])):
        record = physim.simulate(physim.load_world(name), seed=seed)
        motion = hashlib.sha256(record.pose.tobytes() + record.contacts.tobytes()).hexdigest()
        values = hashlib.sha256()
        for one in NAMES:
            add(values, one)
            add(values, getattr(record, one))
        found = [name, seed, record.steps_run, record.digest(), values.hexdigest(), motion]
        print(json.dumps(found), flush=True)
"""


class Run(NamedTuple):
    """What is compared of a run."""

    world: str
    seed: int
    steps: int
    digest: str
    values: str
    """of what a `physim.Record` gives, however it is laid out in the file"""
    motion: str
    """of poses and contacts alone"""


class CheckoutError(Exception):
    """Why there is nothing to compare; one line."""


def runs(checkout: Path, temporary: Path, worlds: list[str], seeds: int) -> list[Run]:
    """Runs of worlds by the sources of a checkout, in a process of its own."""
    done = subprocess.run(
        python("-c", SCRIPT, str(seeds), *worlds), cwd=checkout, capture_output=True, text=True,
        env=environment(checkout, temporary),
    )  # fmt: skip
    if done.returncode:
        reason = done.stderr.strip().splitlines() or ["it ended without a word"]
        raise CheckoutError(f"{checkout.name}: {reason[-1]}")
    return [Run(*json.loads(line)) for line in done.stdout.splitlines()]


def copy_commit(commit: str, target: Path) -> None:
    """Unpack the files of a commit, and link what the package holds from beside it."""
    packed = subprocess.run(["git", "archive", commit], cwd=ROOT, capture_output=True)
    if packed.returncode:
        raise CheckoutError(f"--against {commit}: no such commit here")
    with tarfile.open(fileobj=io.BytesIO(packed.stdout)) as files:
        files.extractall(target, filter="data")
    for link, to in LINKS.items():
        (target / link).symlink_to(to, target_is_directory=True)
    if (target / "setup.py").exists():
        command = python("setup.py", "-q", "build_ext", "-i")
        built = subprocess.run(command, cwd=target, capture_output=True, text=True)
        if built.returncode:
            reason = built.stderr.strip().splitlines()[-1:]
            raise CheckoutError(f"--against {commit}: its kernels cannot be built: {reason}")


def compared(one: Run, other: Run) -> str:
    """Whether two runs of a world hold the same, in words; empty where they do."""
    if one.digest == other.digest or one.values == other.values:
        return ""
    alike = "robots move alike" if one.motion == other.motion else "robots move otherwise"
    return f"DIFFERENT: {alike}, {one.steps} and {other.steps} steps"


def compare(against: str, worlds: list[str], seeds: int) -> int:
    """Run and compare, a line for each run; how many are not the same."""
    with tempfile.TemporaryDirectory() as folder:
        here, there = Path(folder, "here"), Path(folder, "there")
        copy_commit(against, there)
        copy_checkout(ROOT, here)
        if new := [world for world in worlds if not (there / f"worlds/{world}.yaml").exists()]:
            print(f"not in {against}: {', '.join(new)}")
        worlds = [world for world in worlds if world not in new]
        with ThreadPoolExecutor() as pool:
            both = [
                pool.submit(runs, copy, Path(folder, f"{copy.name}-tmp"), worlds, seeds)
                for copy in (here, there)
            ]
            mine, theirs = (one.result() for one in both)
    different = 0
    for one, other in zip(mine, theirs, strict=True):
        verdict = compared(one, other)
        different += bool(verdict)
        words = "equal" if one.digest == other.digest else "equal values, another layout"
        print(f"{one.world:14} seed {one.seed}: {verdict or f'{words}, {one.digest[:16]}'}")
    return different


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    shipped = sorted(file.stem for file in (ROOT / "worlds").glob("*.yaml"))
    parser.add_argument("worlds", nargs="*", default=shipped, help="shipped worlds; all by default")
    parser.add_argument("--against", required=True, metavar="COMMIT", help="what to compare with")
    parser.add_argument("--seeds", type=int, default=1, metavar="N", help="seeds 0 to N - 1")
    given = parser.parse_args()
    if unknown := set(given.worlds) - set(shipped):
        parser.error(f"no shipped world: {', '.join(sorted(unknown))}; {', '.join(shipped)}")
    try:
        return 1 if compare(given.against, given.worlds, given.seeds) else 0
    except CheckoutError as error:
        print(error, file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
