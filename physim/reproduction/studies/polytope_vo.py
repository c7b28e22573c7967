"""The second paper: polytope velocity obstacles (Huang et al., RA-L 2023), the worlds of its code.

The paper's tables are not readable for us. Its published code is: its worlds and its protocol are
repeated here, and what is reported is what is stored beside it, or what a run of it gives (with its
overlap test by separating axes). The code moves robots by kinematics in steps of 0.1 s; robots that
arrived or touched stand and stay in the way. Here bodies meet by physics in steps of 0.01 s, they
decide every 0.1 s as there, a contact ends a trial as a collision, and robots arrive within 0.3 m
of their goals, as there.

One world is one course, and small things change it: apart from seed 0, which is as published, every
start moves by up to a millimetre (in the random trials the seed draws who goes where).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from physim.randomness import stream
from physim.record import Record
from physim.reproduction.measures import Measures
from physim.reproduction.model import Arm, Outcome, Verdict, outcome
from physim.reproduction.study import Runs, Share, Shown, Study
from physim.statistics import clopper_pearson

ARRIVED = 0.3
"""[m] from the goal"""
LIMIT = 300
"""steps of 0.1 s after which a trial is over"""
MOVED = 0.001
"""[m] by which starts are moved, but for seed 0"""
SAME = 0.05
"""[-] A course equals the reported one when its steps, or its way, are within this share."""
PLACE = 0.1
"""[m] within which a robot stands where it is reported to"""
MOST = 0.9
"""[-] share of the runs that do what is claimed"""
METHODS = tuple(product(("polytope", "circle"), ("vo", "rvo", "hrvo")))
NAMES = tuple("_".join(one) for one in METHODS)
RECTANGLE = ((-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3))
SHAPES = (
    ((-0.5, -0.289), (0.5, -0.289), (0.0, 0.5774)),
    ((-0.45, -0.45), (0.45, -0.45), (0.45, 0.45), (-0.45, 0.45)),
    RECTANGLE,
    ((-0.35, -0.482), (0.35, -0.482), (0.567, 0.184), (0.0, 0.596), (-0.567, 0.184)),
    ((-0.6, 0.0), (-0.3, -0.5196), (0.3, -0.5196), (0.6, 0.0), (0.3, 0.5196), (-0.3, 0.5196)),
)
CIRCLE = tuple(
    (5.0 + 4.0 * math.cos(k * math.pi / 4.0), 5.0 + 4.0 * math.sin(k * math.pi / 4.0))
    for k in range(8)
)
"""[m] eight places"""
L_CORRIDOR = (
    "[[0, 0], [10, 0], [10, 4.5], [0, 4.5]]",
    "[[0, 5.5], [3.5, 5.5], [3.5, 10], [0, 10]]",
    "[[7, 4.5], [10, 4.5], [10, 10], [7, 10]]",
)
TURNAROUND = (
    "[[1.5, 1.5], [8.5, 1.5], [8.5, 4.5], [1.5, 4.5]]",
    "[[3.5, 5.5], [6, 5.5], [6, 7.5], [3.5, 7.5]]",
)

Place = tuple[float, float]
Way = tuple[Place, Place, Sequence[Place]]
"""start, goal, footprint"""


def world_text(
    name: str, ways: Sequence[Way], size: float, omega: float, seed: int,
    obstacles: Sequence[str] = (), margin: float = 0.15, duration: float = 0.1 * LIMIT,
) -> str:  # fmt: skip
    """World file: robots go straight to their goals, those walls nowhere near that it must have."""
    moved = stream(seed, "moved starts", 0).uniform(-MOVED, MOVED, (len(ways), 2)) * (seed > 0)
    robots = []
    for k, ((start, goal, shape), off) in enumerate(zip(ways, moved, strict=True)):
        corners = [[round(size * x, 6), round(size * y, 6)] for x, y in shape]
        x, y = start[0] + float(off[0]), start[1] + float(off[1])
        heading = math.atan2(goal[1] - start[1], goal[0] - start[0])
        robots.append(
            f"  - {{name: r{k + 1}, footprint: {corners}, pose: [{x}, {y}, {heading}], "
            f"path: [[{x}, {y}], {list(goal)}], limits: {{v: 1.2, omega: {omega}}}, "
            f"omegas: [-{omega}, 0.0, {omega}]}}\n"
        )
    return (
        f"name: {name}\ntime: {{step: 0.01, duration: {duration}}}\n"
        "boundaries: [[[-20, -20], [30, -20], [30, 30], [-20, 30], [-20, -20]]]\n"
        "reference_path: [[-10, -8], [20, -7]]\n"
        f"robots:\n{''.join(robots)}obstacles: [{', '.join(obstacles)}]\n"
        f"arrival: {{tolerance: {ARRIVED}}}\n"
        "controller: {type: polytope_vo, speed: 1.2, look_ahead: 50.0, arrival_tolerance: 0.15, "
        f"range_of: mean, margin: {margin}}}\n"
    )


def drawn(seed: int) -> list[tuple[int, int]]:
    """(start, goal) of eight robots: each place once, goals three to five numbers on or back."""
    rng = stream(seed, "matching", 0)
    while True:
        free, found = set(range(8)), []
        for start in rng.permutation(8).tolist():
            goals = [goal for goal in sorted(free) if abs(goal - start) in (3, 4, 5)]
            if not goals:
                break
            found.append((start, int(rng.choice(goals))))
            free.remove(found[-1][1])
        else:
            return found


def matched(size: float, seed: int) -> str:
    """World of a random trial."""
    ways = [(CIRCLE[a], CIRCLE[b], RECTANGLE) for a, b in drawn(seed)]
    return world_text("random matching", ways, size, 1.0, seed)


def small(seed: int) -> str:
    """Random trial of robots of 0.4 m by 0.24 m."""
    return matched(0.4, seed)


def large(seed: int) -> str:
    """Random trial of robots of 0.8 m by 0.48 m."""
    return matched(0.8, seed)


def eight(seed: int) -> str:
    """World of eight robots of five shapes that change places (robot_world.yaml)."""
    ways = [(CIRCLE[k], CIRCLE[(k + 4) % 8], SHAPES[k % 5]) for k in range(8)]
    return world_text("circle of eight", ways, 0.7, 1.0, seed)


def corridor(seed: int) -> str:
    """World of the L-shaped corridor (l_shaped_corridor.yaml)."""
    way = ((0.5, 5.0), (5.25, 8.5), RECTANGLE)
    return world_text("L corridor", [way], 0.8, 0.5, seed, L_CORRIDOR, 0.05, 50.0)


def turnaround(seed: int) -> str:
    """World of a gap and a way round it (turnaround.yaml)."""
    way = ((9.0, 5.0), (1.0, 5.0), RECTANGLE)
    return world_text("turnaround", [way], 0.8, 0.5, seed, TURNAROUND, 0.05, 50.0)


def measure_trial(record: Record) -> Measures:
    """How a trial ended, whole steps of 0.1 s till the last arrived, mean way, the first's place.

    Contacts count up to the end of the run; a robot's way ends where it arrives.
    """
    robots = len(record.names)
    place = record.pose[:, :robots, :2]
    goals = record.paths.points[record.paths.start[1:] - 1]
    there = np.hypot(*np.moveaxis(place - goals, -1, 0)) < ARRIVED
    first = np.where(there.any(axis=0), there.argmax(axis=0), len(place) - 1)
    legs = np.hypot(*np.moveaxis(np.diff(place, axis=0), -1, 0))
    ways = [float(legs[:end, i].sum()) for i, end in enumerate(first)]
    touched, all_there = len(record.contacts) > 0, bool(there.any(axis=0).all())
    solved = all_there and not touched
    return {
        "solved": float(solved),
        "collision": float(touched),
        "deadlock": float(not all_there and not touched),
        "steps": float(math.ceil(record.time[first.max()] / 0.1 - 1e-9)) if solved else math.nan,
        "way": float(np.mean(ways)) if solved else math.nan,
        "x": float(place[-1, 0, 0]),
        "y": float(place[-1, 0, 1]),
    }


def solved(runs: Runs) -> Share:
    """Trials in which all robots arrived and none touched anything."""
    return runs.share("solved", lambda value: value > 0.0)


def counts(runs: Runs) -> str:
    """ "99/1/0": arrived, collision, deadlock."""
    return "/".join(
        str(runs.share(name, lambda value: value > 0.0).good)
        for name in ("solved", "collision", "deadlock")
    )


def course(runs: Runs) -> str:
    """What came of the published world, and of those with moved starts."""
    first = runs.runs[0]
    own = f"{first['steps']:.0f} steps, {first['way']:.2f} m"
    if not first["solved"]:
        own = "a collision" if first["collision"] else "a deadlock"
    return (
        f"as published {own}; all seeds: {solved(runs).text} arrive, median "
        f"{runs.of('steps').text(0, 'steps')}, {runs.of('way').text(2, 'm')}"
    )


def of_course(runs: Runs, steps: float, way: float = math.nan) -> Outcome:
    """Met where the published world takes as many steps, and as long a way, and most seeds arrive.

    Partly where the number of steps lies in the range of all seeds that arrive.
    """
    first, found = runs.runs[0], runs.column("steps")
    near = [abs(first["steps"] - steps) <= SAME * steps]
    near += [abs(first["way"] - way) <= SAME * way] if not math.isnan(way) else []
    most = solved(runs).rate >= MOST
    known = [value for value in found if not math.isnan(value)]
    among = bool(known) and min(known) <= steps * (1 + SAME) and steps * (1 - SAME) <= max(known)
    return outcome(all(near) and most, among or (all(near) or most))


def conclude_eight(arms: Sequence[Runs]) -> Sequence[Verdict]:
    """Steps of each method."""
    stored = "stored with the code"
    run = "run of the code"
    reported = {0: (129, run), 1: (114, stored), 2: (131, run), 4: (103, stored)}
    return [
        Verdict(
            f"Eight polygons change places ({NAMES[k]})", f"{steps} steps ({source}), all arrive",
            course(arms[k]), of_course(arms[k], steps),
        )
        for k, (steps, source) in reported.items()
    ]  # fmt: skip


def conclude_corridor(arms: Sequence[Runs]) -> Sequence[Verdict]:
    """Who gets through, and why."""
    polygons, hybrid, discs, nearest = arms
    stands = [
        not run["solved"] and math.dist((run["x"], run["y"]), (0.95, 5.15)) <= PLACE
        for run in discs.runs
    ]
    x, y = discs.of("x"), discs.of("y")
    return (
        *(
            Verdict(
                f"One polygon arrives through a corridor of 1 m ({name})",
                "98 steps, 7.16 m (run of the code)", course(runs), of_course(runs, 98.0, 7.16),
            )
            for name, runs in (("polytope_vo", polygons), ("polytope_hrvo", hybrid))
        ),
        Verdict(
            "A disc freezes in it (circle_vo)", "stands at (0.95, 5.15) after 500 steps",
            f"{solved(discs).text} arrive; median place ({x.median:.2f}, {y.median:.2f})",
            outcome(sum(stands) >= MOST * len(stands), not solved(discs).good),
            f"The same place is one within {PLACE:g} m.",
        ),
        Verdict(
            "The polygon arrives when it sees the whole corridor, too (polytope_vo)",
            "not tried: walls count by the mean of their vertices, within 5 m",
            f"nearest points count: {solved(nearest).text} arrive",
            outcome(solved(nearest).rate >= MOST, solved(nearest).good > 0),
            "The code does not see the wall below at the start, nor the one ahead; velocities "
            "that ever lead into a wall are forbidden, those towards a wall that closes the "
            "corridor among them.",
        ),
    )  # fmt: skip


def conclude_turnaround(arms: Sequence[Runs]) -> Sequence[Verdict]:
    """Through the gap, or round."""
    reported = (
        ("A polygon goes through a gap of 1 m (polytope_vo)", 65, 7.71),
        ("A disc goes round by the other way (circle_vo)", 182, 11.15),
    )
    return [
        Verdict(
            words, f"{steps} steps, {way} m (run of the code)", course(runs),
            of_course(runs, steps, way),
        )
        for runs, (words, steps, way) in zip(arms, reported, strict=True)
    ]  # fmt: skip


RATES: dict[str, Sequence[int]] = {
    "0.4": (96, 99, 100, 100, 100, 100),
    "0.8": (100, 98, 94, 100, 100, 100),
}
"""trials of 100 in which all arrive, by size; the others end in a collision"""
WAYS: dict[str, Sequence[float]] = {
    "0.4": (7.495, 7.543, 7.500, 7.530, 7.630, 7.532),
    "0.8": (7.848, 7.815, 7.831, 8.086, 8.134, 8.224),
}
"""[m] mean way of a robot over the trials that all six solve"""


def overlap(a: Share, b: Share) -> bool:
    """Whether the 95 % intervals of two shares do."""
    (low, high), (least, most) = (map(float, clopper_pearson(*one)) for one in (a, b))
    return low <= most and least <= high


def conclude_random(arms: Sequence[Runs]) -> Sequence[Verdict]:
    """Rates of each shape at each size, ways over the trials that all solve, deadlocks."""
    many = len(METHODS)
    found: list[Verdict] = []
    sizes = {"0.4": arms[:many], "0.8": arms[many:]}
    for (size, six), shape in product(sizes.items(), ("polytope", "circle")):
        part = slice(0, 3) if shape == "polytope" else slice(3, 6)
        rates, runs, names = RATES[size][part], six[part], NAMES[part]
        fits = [overlap(solved(one), Share(r, 100)) for r, one in zip(rates, runs, strict=True)]
        found.append(
            Verdict(
                f"Random trials, size {size}, {shape}s: arrived/collision/deadlock",
                ", ".join(f"{n} {r}/{100 - r}/0" for n, r in zip(names, rates, strict=True)),
                ", ".join(f"{n} {counts(one)}" for n, one in zip(names, runs, strict=True)),
                outcome(all(fits), any(fits)),
                "Reported is a run of the code, whose limits fall to 1 m/s after the first trial. "
                "Met where the intervals of all three overlap.",
            )
        )
    for size, six in sizes.items():
        ways = np.array([runs.column("way") for runs in six])
        common = ways[:, np.isfinite(ways).all(axis=0)]
        means = common.mean(axis=1) if common.size else np.full(many, math.nan)
        shorter = [means[k] < means[k + 3] for k in range(3)]
        found.append(
            Verdict(
                f"Random trials, size {size}: polygons travel less than discs",
                ", ".join(f"{n} {w:.3f}" for n, w in zip(NAMES, WAYS[size], strict=True)) + " m",
                ", ".join(f"{n} {w:.3f}" for n, w in zip(NAMES, means, strict=True))
                + f" m, over {common.shape[1]} of {ways.shape[1]} trials that all six solve",
                outcome(all(shorter), any(shorter)),
                "Reported is a run of the code; the paper claims it in words.",
            )
        )
    polygons, discs = (
        [runs for six in sizes.values() for runs in six[part]]
        for part in (slice(0, 3), slice(3, 6))
    )
    for words, name in (("arrive more often", "solved"), ("deadlock less often", "deadlock")):
        a, b = (
            Share(
                int(sum(sum(one.column(name)) for one in runs)), sum(len(one.runs) for one in runs)
            )
            for runs in (polygons, discs)
        )
        better = a.good > b.good if name == "solved" else a.good < b.good
        found.append(
            Verdict(
                f"Random trials: polygons {words} than discs", "in words (abstract)",
                f"{a.text} against {b.text}", outcome(better and not overlap(a, b), better),
                "Met where the 95 % intervals are apart. In the run of the code discs arrive in "
                "600 of 600 trials and polygons in 587, and nothing deadlocks.",
            )
        )  # fmt: skip
    return found


def arms_of(
    text: Callable[[int], str], world: str, methods: Sequence[tuple[str, str]] = METHODS
) -> tuple[Arm, ...]:
    """One arm a method."""
    return tuple(
        Arm(
            f"{shape}_{kind}", world, (f"controller.shape={shape}", f"controller.kind={kind}"), text
        )
        for shape, kind in methods
    )


SHOWN = {"steps": Shown("steps of 0.1 s", "", 0), "way": Shown("mean way of a robot", "m")}
WITH_NEAREST = arms_of(corridor, "L corridor")[0]


def note(runs: Runs) -> str:
    """Note at the row of an arm."""
    return f"{counts(runs)}\narrived/collision/deadlock"


EIGHT = Study(
    "eight", "Eight polygons of five shapes on a circle", "All change places with those opposite.",
    arms_of(eight, "circle of eight"), measure_trial, conclude_eight, SHOWN, note, seeds=50,
)  # fmt: skip
CORRIDOR = Study(
    "corridor", "L-shaped corridor", "One rectangle of 0.8 m goes through a corridor of 1 m.",
    (
        *arms_of(corridor, "L corridor", (METHODS[0], METHODS[2], METHODS[3])),
        replace(
            WITH_NEAREST, label="polytope_vo,\nnearest points",
            overrides=(*WITH_NEAREST.overrides, "controller.range_of=nearest"),
        ),
    ),
    measure_trial, conclude_corridor, SHOWN, note,
)  # fmt: skip
TURN = Study(
    "turnaround", "A gap, or the way round", "One rectangle of 0.8 m, a gap of 1 m.",
    arms_of(turnaround, "turnaround", (METHODS[0], METHODS[3])), measure_trial,
    conclude_turnaround, SHOWN, note,
)  # fmt: skip
RANDOM = Study(
    "random", "Random matching on a circle",
    "Eight rectangles go to places drawn by the seed, the same for all six methods.",
    tuple(
        replace(arm, label=f"{arm.label}, {size}")
        for size, text in (("0.4", small), ("0.8", large))
        for arm in arms_of(text, f"random matching, size {size}")
    ),
    measure_trial, conclude_random, SHOWN, note, seeds=100, quick_seeds=5,
)  # fmt: skip
