"""Put a log on steps: its own, or those asked for; what cannot be known between samples is told.

Between two samples a robot keeps its twist in its own frame: it goes along an arc about a fixed
point, or straight, and turns evenly, by less than half a turn.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from physim.errors import PhysimError, plural
from physim.geometry.path import SHORTEST_WINDOW
from physim.geometry.shapes import FloatArray, IntArray
from physim.judging.log import Log, Track
from physim.world.rules import MOST_STEPS

ON_STEP = 0.01
"""of a step by which a sample may be off it"""
MOST_GAP = 5.0
"""usual spacings of a robot's samples: what is longer is a gap"""
FASTEST = 3.0
"""times its limits, and no more, a robot may be seen to go"""
PLACE_NOISE, HEADING_NOISE = 0.1, 0.3
"""[m, rad] by which two samples may be apart beyond that, by errors of measurement"""
LEAST_STEP, LONGEST_STEP = 1e-6, 10.0
"""[s]"""


@dataclass(frozen=True)
class Reading:
    """How a log is to be read, where that is not plain.

    ``every`` [s]: the step of the record; the log's own where it is None. ``gaps`` [s]: gaps up to
    so long are bridged. ``jumps``: robots may go faster than their limits allow. ``headings``:
    "radians" or "degrees".
    """

    every: float | None = None
    gaps: float | None = None
    jumps: bool = False
    headings: str | None = None


@dataclass(frozen=True)
class Motion:
    """Poses at every step."""

    dt: float
    """[s]"""
    begun: float
    """[s] time of the log at step 0"""
    pose: FloatArray
    """(K, N, 3) [m, m, rad] headings unwrapped"""
    notes: tuple[str, ...]
    """what was done to the log, a sentence each"""


def motion_of(log: Log, limits: FloatArray, how: Reading) -> Motion:
    """Poses of a log at the steps of a record; ``limits`` (N, 2) [m/s, rad/s] of its robots.

    Raises PhysimError, one line, for a gap, a jump, headings that look like degrees, and times on
    no common step, unless ``how`` says what is meant.
    """
    notes = []
    tracks = []
    for track, limit in zip(log.tracks, limits, strict=True):
        one = Track(track.name, track.time, _unwrapped(log, track, how), track.row)
        notes += [*_gaps(log, one, how), *_jumps(log, one, limit, how)]
        tracks.append(one)
    begun, end = max(one.time[0] for one in tracks), min(one.time[-1] for one in tracks)
    notes += _ends(log, tracks, float(begun), float(end), how)
    dt = how.every if how.every is not None else _own_step(log, tracks)
    count = math.floor((end - begun) / dt + ON_STEP)
    if not 1 <= count <= MOST_STEPS:
        raise PhysimError(
            f"{log.place(int(tracks[0].row[0]), 'time')}: the {end - begun:g} s that all robots "
            f"share make {count} steps of {dt:g} s; a record has 1 to {MOST_STEPS:,}; give another "
            "--every"
        )
    poses = np.empty((count + 1, len(tracks), 3))
    source = "the log's own" if how.every is None else "as asked for"
    notes.insert(0, f"a step every {dt:g} s, {source}")
    if begun != 0.0:
        notes.insert(1, f"0 s is {begun:.12g} s of the log")
    for k, one in enumerate(tracks):
        poses[:, k], between = _at_steps(one, begun + dt * np.arange(count + 1.0), dt)
        if between:
            notes.append(f"{one.name}: {between} of {count + 1} poses lie between two samples, "
                         "along the twist that joins them")  # fmt: skip
    if log.unread:
        notes.append(f"columns not read: {', '.join(log.unread)}")
    return Motion(dt, float(begun), poses, tuple(notes))


def _unwrapped(log: Log, track: Track, how: Reading) -> FloatArray:
    """Poses (M, 3) with headings in radians, unwrapped. PhysimError where they may be degrees."""
    pose = track.pose.copy()
    if how.headings == "degrees":
        pose[:, 2] = np.radians(pose[:, 2])
    elif how.headings is None:
        turn = 2.0 * math.pi + 1e-6
        far = np.abs(np.diff(pose[:, 2], prepend=0.0)) > turn
        if far.any():
            k = int(np.argmax(far))
            log.refuse(
                int(track.row[k]), "heading",
                f"{track.name} heads for {pose[k, 2]:g}"
                + (f" after {pose[k - 1, 2]:g}" if k else " at first")
                + ", more than a whole turn in radians; give --degrees, or --radians if they are",
            )  # fmt: skip
    pose[:, 2] = np.unwrap(pose[:, 2])
    return pose


def _gaps(log: Log, track: Track, how: Reading) -> Iterator[str]:
    """What is said of the gaps of a robot that are bridged. PhysimError for one that is not."""
    apart = np.diff(track.time)
    usual = float(np.median(apart))
    longer = apart > MOST_GAP * usual * (1.0 + 1e-9)
    allowed = MOST_GAP * usual if how.gaps is None else how.gaps
    if (gone := apart > allowed * (1.0 + 1e-9)).any():
        k = int(np.argmax(gone))
        log.refuse(
            int(track.row[k + 1]), "time",
            f"no sample of {track.name} for {apart[k]:g} s, from {track.time[k]:.12g} s on; it has "
            f"one every {usual:g} s, and gaps of up to {allowed:g} s are bridged; "
            f"{_bridge(float(apart[k]))} to bridge it along its twist, or cut the log there",
        )  # fmt: skip
    if count := int(longer.sum()):
        yield f"{track.name}: {plural(count, 'gap')} of up to {apart.max():g} s, bridged"


def _bridge(seconds: float) -> str:
    return f"give --gaps {math.ceil(seconds * 1e3 - 1e-6) / 1e3:g}"


def _jumps(log: Log, track: Track, limit: FloatArray, how: Reading) -> Iterator[str]:
    """What is said of steps that are farther than a robot goes. PhysimError where not allowed."""
    moved, apart = np.diff(track.pose, axis=0), np.diff(track.time)
    for what, unit, way, most, noise in (
        ("moves", "m", np.hypot(moved[:, 0], moved[:, 1]), float(limit[0]), PLACE_NOISE),
        ("turns", "rad", np.abs(moved[:, 2]), float(limit[1]), HEADING_NOISE),
    ):
        far = way > FASTEST * most * apart + noise
        if not far.any():
            continue
        k = int(np.argmax(far))
        if not how.jumps:
            column = "x" if unit == "m" else "heading"
            degrees = ", or --degrees" if unit == "rad" and how.headings is None else ""
            log.refuse(
                int(track.row[k + 1]), column,
                f"{track.name} {what} {way[k]:.3g} {unit} in {apart[k]:.3g} s; its limit is "
                f"{most:g} {unit}/s, and {FASTEST:g} times that and {noise:g} {unit} are taken for "
                f"motion; correct the log, or give --jumps to take it as it is{degrees}",
            )  # fmt: skip
        jumps = plural(int(far.sum()), "jump")
        yield (
            f"{track.name}: {jumps} taken for motion, the first of {way[k]:.3g} {unit} in "
            f"{apart[k]:.3g} s at {track.time[k + 1]:.12g} s of the log"
        )


def _ends(log: Log, tracks: list[Track], begun: float, end: float, how: Reading) -> Iterator[str]:
    """What is said of the time when not all robots were seen. PhysimError where that is long."""
    for one in tracks:
        usual = float(np.median(np.diff(one.time)))
        allowed = MOST_GAP * usual if how.gaps is None else how.gaps
        for late, row, words in (
            (one.time[0] - min(other.time[0] for other in tracks), 0, "before its first"),
            (max(other.time[-1] for other in tracks) - one.time[-1], -1, "after its last"),
        ):
            if late > allowed * (1.0 + 1e-9):
                log.refuse(
                    int(one.row[row]), "time",
                    f"others were seen {late:g} s {words} sample of {one.name}; up to {allowed:g} "
                    f"s are left out; {_bridge(float(late))} to leave that out, or cut the log",
                )  # fmt: skip
    first, last = (
        begun - min(one.time[0] for one in tracks), max(one.time[-1] for one in tracks) - end
    )  # fmt: skip
    if first > 0.0 or last > 0.0:
        yield f"{first:g} s before and {last:g} s after, when not all robots were seen, left out"


def _own_step(log: Log, tracks: list[Track]) -> float:
    """Step [s] of which the times of all samples are multiples. PhysimError where there is none."""
    times = np.concatenate([one.time for one in tracks])
    rows = np.concatenate([one.row for one in tracks])
    who = np.repeat(np.arange(len(tracks)), [len(one.time) for one in tracks])
    order = np.argsort(times, kind="stable")
    times, rows, who = times[order], rows[order], who[order]
    apart = np.diff(times)
    new = apart > LEAST_STEP
    shortest = float(apart[new].min())
    number = np.concatenate(([0], np.cumsum(np.where(new, np.rint(apart / shortest), 0.0))))
    step = float(f"{(times[-1] - times[0]) / number[-1]:.9g}")
    off = np.abs((times - times[0]) / step - number)
    ask = "give --every SECONDS for a step of the record; poses there lie along twists"
    if (off > ON_STEP).any():
        k = int(np.argmax(off > ON_STEP))
        log.refuse(
            int(rows[k]), "time",
            f"{tracks[who[k]].name} at {times[k]:.12g} s is {off[k]:.2g} steps off; times must be "
            f"multiples of one step, here {step:.4g} s; {ask}",
        )  # fmt: skip
    for one in tracks:
        share = (len(one.time) - 1) / max(1.0, (one.time[-1] - one.time[0]) / step)
        way = np.hypot(*np.diff(one.pose[:, :2], axis=0).T).max() * min(1.0, share)
        fault = ""
        if share < 0.5 - ON_STEP:
            fault = (
                f"{one.name} has a sample in {share:.0%} of the steps of {step:.4g} s that fit all"
            )
        elif step > LONGEST_STEP:
            fault = (
                f"a step of {step:g} s is too long, at most {LONGEST_STEP:g} s; times are seconds"
            )
        elif way > 0.5 * SHORTEST_WINDOW:
            fault = f"{one.name} moves {way:.2g} m in a step of {step:g} s, too far to follow"
        if fault:
            log.refuse(int(one.row[0]), "time", f"{fault}; {ask}")
    return step


def _at_steps(track: Track, times: FloatArray, dt: float) -> tuple[FloatArray, int]:
    """Poses (K, 3) at times (K,) [s] within those of a robot, and how many are of no sample."""
    time, pose = track.time, track.pose
    nearest = np.clip(np.searchsorted(time, times - 0.5 * dt), 0, len(time) - 1)
    after = np.minimum(nearest + 1, len(time) - 1)
    nearest = np.where(np.abs(time[after] - times) < np.abs(time[nearest] - times), after, nearest)
    known = np.abs(time[nearest] - times) <= ON_STEP * dt
    found = np.where(known[:, None], pose[nearest], _between(time, pose, times))
    return found, int((~known).sum())


def _between(time: FloatArray, pose: FloatArray, times: FloatArray) -> FloatArray:
    """Poses (K, 3) at times, along the constant twist from each sample to the next."""
    k: IntArray = np.clip(np.searchsorted(time, times, side="right") - 1, 0, len(time) - 2)
    start, moved = pose[k], pose[k + 1] - pose[k]
    share = np.clip((times - time[k]) / (time[k + 1] - time[k]), 0.0, 1.0)
    half = 0.5 * moved[:, 2]
    length = share * np.sinc(share * half / np.pi) / np.sinc(half / np.pi)
    turn = (share - 1.0) * half
    cos, sin = np.cos(turn), np.sin(turn)
    x, y = moved[:, 0], moved[:, 1]
    way = np.stack((length * (cos * x - sin * y), length * (sin * x + cos * y)), axis=1)
    return np.column_stack((start[:, :2] + way, start[:, 2] + share * moved[:, 2]))
