"""ORCA of physim and of navground: one decision of all robots, by ``python -m benchmarks.orca``.

physim: processor time of ``decide_all``, from what is sensed to the commands, of unicycles with the
tracking bound and without. navground: that of a step with ORCA less that of one without behavior,
twice, as every other step decides. Both look 5 m far at whoever is there, and go by walls.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from statistics import median

from benchmarks.environments import PEERS, environment
from benchmarks.measuring import FAILED, HERE, run, runner

sys.path.insert(0, str(HERE / "runners"))
SIGHT, STEPS = 5.0, 200


def ours(robots: int, bounded: bool) -> float:
    """Processor time [s] of a decision of all robots."""
    from physim_corridor import corridor

    from physim import Simulation
    from physim.world import World

    world = corridor(robots).model_dump(exclude_unset=True)
    del world["formation"]
    settings = {"speed": 0.8, "look_ahead": 1.0, "max_neighbours": 1000, "bounded": bounded}
    world |= {"sensing": {"range": SIGHT}, "controller": {"type": "orca", **settings}}
    running, spent = Simulation(World(**world)), []
    decide = running._asked.form.decide_all

    def timed(*given: object) -> object:
        began = time.process_time()
        answer = decide(*given)
        spent.append(time.process_time() - began)
        return answer

    running._asked.form.decide_all = timed
    for _ in range(STEPS):
        running.step()
    return median(spent)


def theirs(robots: int, python: str) -> float:
    """The same of navground."""
    each = []
    for kind in ("ORCA", "Dummy"):
        job = runner("speed", "navground", kind, python, "run_navground.py", what="speed",
                     robots=robots, kind=kind, jam=False, seconds=0.5, most=STEPS)  # fmt: skip
        found = run(job)
        if FAILED in found:
            raise SystemExit(f"navground: {found[FAILED]}")
        each.append(robots / found["rate"])
    return 2.0 * (each[0] - each[1])


def main() -> None:
    """Measure both in turn and print the medians."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--work", type=Path, default=HERE / ".work" / "environments")
    options = parser.parse_args()
    peer = environment(next(one for one in PEERS if one.name == "navground"), options.work)
    if peer.failed:
        raise SystemExit(f"navground {peer.failed}")
    print(f"{'robots':>8}{'physim':>12}{'unbounded':>12}{'navground':>12}{'ratio':>8}{'unb.':>8}")
    for robots in (100, 1000):
        rounds = [
            (ours(robots, True), ours(robots, False), theirs(robots, peer.python))
            for _ in range(options.rounds)
        ]
        a, b, c = (median(one) for one in zip(*rounds, strict=True))
        times = "".join(f"{1e3 * t:>9.3f} ms" for t in (a, b, c))
        print(f"{robots:>8}{times}{a / c:>8.2f}{b / c:>8.2f}")


if __name__ == "__main__":
    main()
