"""Do two checkouts move the robots alike, to the bit? ``python benchmarks/same_motion.py OTHER``

OTHER is another checkout with an environment of its own in ``.venv``. Every world that is shipped
here is run in both, ``--seeds`` times; compared are SHA-256 of poses, distances, contacts and the
decisions' stations, modes, targets, distances and times up to the sooner end: what runs have in
common whatever the version of their records. Exit 0 where all are equal, 1 otherwise.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path

COLUMNS = (
    "step", "robot", "mode", "station", "reference_station", "formation_error", "deviation",
    "next_step", "target_x", "target_y", "distance", "boundary_distance", "collision_time",
)  # fmt: skip

SCRIPT = """
import hashlib, json, sys
import numpy as np, physim
name, seed, steps = sys.argv[1], int(sys.argv[2]), json.loads(sys.argv[3])
world = physim.load_world(name)
record = physim.simulate(world, seed=seed)
end = record.steps_run if steps is None else steps
rows = record.updates[record.updates["step"] < end]
contacts = record.contacts[record.contacts["step"] <= end]
parts = [array[: end + 1] for array in (record.pose, record.clearance, record.boundary_clearance)]
parts += [contacts, *(rows[column].astype(float) for column in COLUMNS)]
total = hashlib.sha256(b"".join(np.ascontiguousarray(part).tobytes() for part in parts))
print(json.dumps([record.steps_run, len(record.contacts), total.hexdigest()]))
"""


def run(checkout: Path, name: str, seed: int, steps: int | None) -> tuple[int, int, str]:
    """Steps, contact rows and digest of one run in a checkout, of its first steps if given."""
    script = f"COLUMNS = {COLUMNS!r}\n{SCRIPT}"
    done = subprocess.run(
        [checkout / ".venv/bin/python", "-c", script, name, str(seed), json.dumps(steps)],
        cwd=checkout, capture_output=True, text=True, check=True,
    )  # fmt: skip
    length, contacts, digest = json.loads(done.stdout.splitlines()[-1])
    return int(length), int(contacts), str(digest)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("other", type=Path, help="the other checkout")
    parser.add_argument("worlds", nargs="*", help="names of shipped worlds; all without any")
    parser.add_argument("--seeds", type=int, default=1, help="how many seeds, from 0 on")
    given = parser.parse_args()
    here = Path(__file__).resolve().parent.parent
    worlds = given.worlds or sorted(file.stem for file in (here / "worlds").glob("*.yaml"))
    differ = 0
    for name in worlds:
        for seed in range(given.seeds):
            mine, theirs = (run(c, name, seed, None) for c in (here, given.other.resolve()))
            steps = min(mine[0], theirs[0])
            if mine[0] != theirs[0]:
                mine, theirs = (run(c, name, seed, steps) for c in (here, given.other.resolve()))
            equal = mine[2] == theirs[2]
            differ += not equal
            print(f"{name:14} seed {seed}: {'equal' if equal else 'DIFFERENT'} over {steps} steps,"
                  f" {mine[1]} contact rows, {mine[2][:16]}", flush=True)  # fmt: skip
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
