"""Put a log on steps: its own, or those asked for; what was done to it is told.

Between two samples a robot keeps its twist in its own frame: it goes along an arc about a fixed
point, or straight, and turns evenly, by less than half a turn.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from physim.errors import plural
from physim.geometry.path import SHORTEST_WINDOW
from physim.geometry.shapes import FloatArray
from physim.judging.log import COLUMNS, Log, Track
from physim.world.rules import MOST_STEPS

ON_STEP = 0.01
"""of a step by which a sample may be off it"""
ROUNDING = 1e-6
"""of a step that was asked for"""
MOST_GAP = 5.0
"""usual spacings of a robot's samples: what is longer is a gap"""
FASTEST = 3.0
"""times its limits, and no more, a robot may be seen to go"""
PLACE_NOISE, HEADING_NOISE = 0.1, 0.3
"""[m, rad] by which two samples may be apart beyond that, by errors of measurement"""
LEAST_STEP, LONGEST_STEP = 1e-6, 10.0
"""[s]"""
USUALLY = 0.95
"""of its samples at which a robot is followed along its path from step to step"""
PIECE, LEAST_PIECES = 0.2, 3
"""[m] length of pieces of a course, and how many tell where a robot goes"""
ASKEW, STRAIGHT = 0.5, 0.2
"""[rad] off the way that they go, by the median, headings are doubtful, and others fit"""
MAYBE_DEGREES = "headings may be degrees"
"""What a note begins with that doubts them"""
EVERY = "give --every SECONDS for a step of the record"


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


def motion_of(
    log: Log,
    limits: FloatArray,
    every: float | None = None,
    gaps: float | None = None,
    jumps: bool = False,
    degrees: bool = False,
) -> Motion:
    """Poses of a log at the steps of a record; ``limits`` (N, 2) [m/s, rad/s] of its robots.

    The step is ``every`` [s], or the log's own; ``gaps`` [s], those up to so long are bridged;
    ``jumps``, robots may go faster than their limits allow; ``degrees``, headings are such. Raises
    PhysimError, one line, for what none of these allows.
    """
    first, last = (pick(one.time[k] for one in log.tracks) for pick, k in ((min, 0), (max, -1)))
    tracks, told = [], []
    for track, limit in zip(log.tracks, limits, strict=True):
        one = replace(track, pose=_unwrapped(log, track, degrees))
        told += [*_gaps(log, one, first, last, gaps), *_jumps(log, one, limit, jumps)]
        tracks.append(one)
    begun, end = (
        float(pick(one.time[k] for one in tracks)) for pick, k in ((max, 0), (min, -1))
    )  # fmt: skip
    dt = _own_step(log, tracks) if every is None else every
    count = math.floor((end - begun) / dt + ON_STEP)
    if not 1 <= count <= MOST_STEPS:
        log.refuse(
            int(tracks[0].line[0]), "time",
            f"all robots are seen from {begun:.12g} to {end:.12g} s, which makes {max(count, 0)} "
            f"steps of {dt:g} s; a record has 1 to {MOST_STEPS:,}; give another --every",
        )  # fmt: skip
    source, slack = ("the log's own", ON_STEP) if every is None else ("as asked for", ROUNDING)
    notes = [f"a step every {dt:g} s, {source}"]
    if begun != 0.0:
        notes.append(f"0 s is {begun:.12g} s of the log")
    if begun > first or end < last:
        notes.append(f"left out the {begun - first:g} s before and {last - end:g} s after, when "
                     "not all robots were seen")  # fmt: skip
    poses, between = np.empty((count + 1, len(tracks), 3)), np.zeros(len(tracks), dtype=np.int64)
    for k, one in enumerate(tracks):
        poses[:, k], between[k] = _at_steps(one, begun, dt, count, slack)
    if between.any():
        most, share = tracks[int(np.argmax(between))].name, between / (count + 1)
        told.append(f"{share.mean():.1%} of the poses lie between two samples, along the twist "
                    f"that joins them; most of {most}, {share.max():.1%}")  # fmt: skip
    if unread := [one for one in log.columns if one not in COLUMNS]:
        told.append(f"columns not read: {', '.join(unread)}")
    if not degrees:
        notes += _doubts(log, tracks)
    return Motion(dt, begun, poses, (*notes, *told))


def _unwrapped(log: Log, track: Track, degrees: bool) -> FloatArray:
    """Poses (M, 3) with headings in radians, unwrapped. PhysimError where they may be degrees."""
    pose = track.pose.copy()
    turned = np.abs(np.diff(pose[:, 2], prepend=0.0)) > 2.0 * math.pi + 1e-6
    if degrees:
        pose[:, 2] = np.radians(pose[:, 2])
    elif turned.any():
        k = int(np.argmax(turned))
        log.refuse(
            int(track.line[k]), "heading",
            f"heading is {pose[k, 2]:g}, {f'after {pose[k - 1, 2]:g}' if k else 'at first'}, more "
            "than a whole turn in radians; give --degrees, or take off whole turns",
        )  # fmt: skip
    pose[:, 2] = np.unwrap(pose[:, 2])
    return pose


def _doubts(log: Log, tracks: list[Track]) -> Iterator[str]:
    """What speaks for degrees in a log read as radians: the ways that robots go. Where none goes
    far, nothing."""
    found: list[tuple[float, float, str]] = []
    for given, track in zip(log.tracks, tracks, strict=True):
        x, y = track.pose[:, :2].T
        way = np.cumsum(np.hypot(np.diff(x, prepend=x[0]), np.diff(y, prepend=y[0])))
        _, ends = np.unique((way / PIECE).astype(int), return_index=True)
        dx, dy = np.diff(x[ends]), np.diff(y[ends])
        far = np.hypot(dx, dy) > 0.5 * PIECE
        if far.sum() < LEAST_PIECES:
            continue
        median = []
        for heading in (track.pose[ends, 2], np.radians(given.pose[ends, 2])):
            apart = np.arctan2(dy, dx) - 0.5 * (heading[1:] + heading[:-1])  # exact on an arc
            turned = np.remainder(apart[far] + math.pi, 2.0 * math.pi) - math.pi
            median.append(float(np.median(np.abs(turned))))
        found.append((median[0], median[1], track.name))
    small = all((np.abs(one.pose[:, 2]) <= 2.0 * math.pi).all() for one in log.tracks)
    if small and found and max(found)[0] > ASKEW and max(fits for _, fits, _ in found) < STRAIGHT:
        off, fits, name = max(found)
        yield (
            f"{MAYBE_DEGREES}: read as radians, that of {name} is {math.degrees(off):.0f}° off the "
            f"way it goes, read as degrees {math.degrees(fits):.0f}°; if they are, give --degrees"
        )


def _gaps(log: Log, track: Track, first: float, last: float, gaps: float | None) -> Iterator[str]:
    """What is said of the gaps of a robot that are bridged. PhysimError for one that is not.

    The log goes from ``first`` to ``last`` [s].
    """
    usual = float(np.median(np.diff(track.time)))
    apart = np.diff(track.time, prepend=first, append=last)
    allowed = MOST_GAP * usual if gaps is None else gaps
    k = int(np.argmax(apart))
    if apart[k] > allowed * (1.0 + 1e-9):
        since, enough = track.time[k - 1] if k else first, math.ceil(apart[k] * 1e3 - 1e-6) / 1e3
        log.refuse(
            int(track.line[min(k, len(track.line) - 1)]), "time",
            f"no sample of {track.name} for {apart[k]:g} s, from {since:.12g} s on; usual are "
            f"{usual:g} s, up to {allowed:g} s are bridged; give --gaps {enough:g} to bridge them "
            "along the twist, or cut the log",
        )  # fmt: skip
    inner = apart[1:-1] > MOST_GAP * usual * (1.0 + 1e-9)
    if inner.any():
        yield f"{plural(int(inner.sum()), 'gap')} of {track.name}, up to {apart[k]:g} s, bridged"


def _jumps(log: Log, track: Track, limit: FloatArray, jumps: bool) -> Iterator[str]:
    """What is said of steps that are farther than a robot goes. PhysimError where not allowed."""
    moved, apart = np.diff(track.pose, axis=0), np.diff(track.time)
    for column, unit, way, most, noise in (
        ("x", "m", np.hypot(moved[:, 0], moved[:, 1]), limit[0], PLACE_NOISE),
        ("heading", "rad", np.abs(moved[:, 2]), limit[1], HEADING_NOISE),
    ):
        if not (far := way > FASTEST * most * apart + noise).any():
            continue
        k = int(np.argmax(far))
        if not jumps:
            degrees = ", or --degrees where headings are such" if unit == "rad" else ""
            log.refuse(
                int(track.line[k + 1]), column,
                f"a jump of {track.name}, {way[k]:.3g} {unit} in {apart[k]:.3g} s; more than "
                f"{FASTEST:g} times its limit of {most:g} {unit}/s, and {noise:g} {unit}, is taken "
                f"for an error; correct the log, or give --jumps to take it as it is{degrees}",
            )  # fmt: skip
        yield f"{plural(int(far.sum()), 'jump')} of {track.name} by up to {way.max():.3g} {unit}"


def _own_step(log: Log, tracks: list[Track]) -> float:
    """Step [s] of which the times of all samples are multiples. PhysimError where there is none."""
    times, lines = (np.concatenate([getattr(one, of) for one in tracks]) for of in ("time", "line"))
    order = np.argsort(times, kind="stable")
    times, lines = times[order], lines[order]
    apart = np.diff(times, prepend=times[0])
    apart[apart < LEAST_STEP] = 0.0
    number = np.cumsum(np.rint(apart / apart[apart > 0.0].min()))
    step = float(f"{(times[-1] - times[0]) / number[-1]:.9g}")
    off = np.abs((times - times[0]) / step - number)
    if (off > ON_STEP).any():
        k = int(np.argmax(off > ON_STEP))
        log.refuse(
            int(lines[k]), "time",
            f"{times[k]:.12g} s is {off[k]:.2g} steps off, were the steps even; times must be "
            f"multiples of one step; {EVERY}, and its poses lie along the twists between samples",
        )  # fmt: skip
    for one in tracks:
        spacing = np.diff(one.time)
        speed = np.hypot(*np.diff(one.pose[:, :2], axis=0).T) / spacing
        way = float(np.quantile(speed, USUALLY)) * step
        fault = ""
        if np.median(spacing) > (2.0 + ON_STEP) * step:
            fault = f"{one.name} has samples at less than half of the steps of {step:.4g} s"
        elif step > LONGEST_STEP:
            fault = f"times are seconds, and a step is at most {LONGEST_STEP:g} s, not {step:g} s"
        elif way > SHORTEST_WINDOW:
            fault = f"{one.name} goes {way:.2g} m in a step of {step:g} s, too far to follow"
        if fault:
            log.refuse(int(one.line[0]), "time", f"{fault}; {EVERY}")
    return step


def _at_steps(
    track: Track, begun: float, dt: float, count: int, slack: float
) -> tuple[FloatArray, int]:
    """Poses (K, 3) of a robot at steps from 0 to ``count``, and how many are of no sample.

    Samples no more than ``slack`` steps off a step are of that.
    """
    number = np.rint((track.time - begun) / dt)
    at = begun + dt * number
    time = np.where(np.abs(track.time - at) <= slack * dt, at, track.time)
    times = begun + dt * np.arange(count + 1.0)
    k = np.searchsorted(time, times, side="right") - 1
    start, moved = track.pose[k], np.diff(track.pose, axis=0, append=track.pose[-1:])[k]
    share = (times - time[k]) / np.diff(time, append=np.inf)[k]
    half = 0.5 * moved[:, 2]
    length = share * np.sinc(share * half / np.pi) / np.sinc(half / np.pi)
    cos, sin = length * np.cos((share - 1.0) * half), length * np.sin((share - 1.0) * half)
    x, y = moved[:, 0], moved[:, 1]
    moved = np.stack((cos * x - sin * y, sin * x + cos * y, share * moved[:, 2]), axis=1)
    return start + moved, int(count + 1 - np.isin(times, time).sum())
