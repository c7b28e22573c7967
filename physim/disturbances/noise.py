"""Noise: robots are sensed elsewhere, and turned otherwise, than they are.

The error of each observer about each robot is a constant bias and normal noise. Noise correlated in
time needs no memory: it is drawn at knots, ``correlation`` seconds apart, and blended between two
of them so that its deviation is the same at all times. Averaged over time its correlation is 0.29
one such time later, and 0 after two.

A robot tells its station as it believes it to be, so an error about itself is in what others are
told, too.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, hypot, isnan, sin, sqrt
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from physim.compiled import compiled
from physim.disturbances.named import Stream
from physim.disturbances.rows import Rows, Stage, rows_of
from physim.errors import Fault, Location
from physim.geometry.path import SHORTEST_WINDOW, track
from physim.geometry.shapes import FloatArray, IntArray, Polylines, Rows3, Rows4
from physim.parts.controller import Sensed, Snapshot
from physim.parts.registry import OF_ROBOTS, make_part
from physim.randomness import Words, draw_normal
from physim.tolerances import SHARE
from physim.world import World
from physim.world.scene import Scene

WIDTH = 32
"""Most places in which draws of one observer are kept"""
Deviation = Annotated[float, Field(ge=0.0, le=1.0e3, allow_inf_nan=False)]
Bias = Annotated[float, Field(ge=-1.0e3, le=1.0e3, allow_inf_nan=False)]


class NoiseSettings(BaseModel):
    """Keys of ``type: noise`` under ``sensing.stages``."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    position: Deviation = Field(default=0.0, description="[m] standard deviation of x and of y")
    heading: Deviation = Field(default=0.0, description="[rad] standard deviation of the heading")
    bias: tuple[Bias, Bias] = Field(
        default=(0.0, 0.0),
        description="[m] constant error, forward and to the left as the observer faces",
    )
    heading_bias: Bias = Field(default=0.0, description="[rad] constant error of the heading")
    correlation: Deviation = Field(
        default=0.0, description="[s] time over which noise is alike; 0: drawn anew at every step"
    )
    of: Literal["all", "own", "others"] = Field(
        default="all", description="whose pose a robot errs about: its own, that of others, or all"
    )
    stream: Stream = 0


class Size(NamedTuple):
    """How large errors are."""

    position: float
    heading: float
    forward: float
    left: float
    turned: float
    of_own: bool
    of_others: bool


class Kept(NamedTuple):
    """Draws that are kept, as observers look again before they change: this only saves time."""

    mark: IntArray
    """(2 N width,) knot and body of a draw; -1 where there is none"""
    drawn: Rows4
    """(2 N width, 4)"""
    bodies: int
    width: int
    """places for each observer at a knot; bodies take turns"""


class Noise(Stage):
    """Adds errors to the poses that robots sense: deviation, bias, correlation in time."""

    Settings = NoiseSettings

    def __init__(self, settings: NoiseSettings | None = None) -> None:
        self.settings = s = settings or NoiseSettings()
        self._size = Size(
            s.position, s.heading, *s.bias, s.heading_bias, s.of != "others", s.of != "own"
        )
        self.is_off = not any(self._size[:5])
        self._window = max(SHORTEST_WINDOW, 8.0 * s.position + hypot(*s.bias))
        self._kept: tuple[Any, Kept] | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        """Copies keep no draws."""
        return type(self), (self.settings,)

    def world_doubts(self, world: World, where: Location) -> Iterator[Fault]:
        """Doubt noise larger than what arrival allows, or than where a controller avoids."""
        s, both = self.settings, sqrt(2.0) if self.settings.of == "all" else 1.0
        off, near = 4.0 * s.position, world.arrival.tolerance
        if s.of != "others" and off > near * (1.0 + SHARE):
            yield Fault(
                (*where, "position"),
                f"robots stop up to {off:.3g} m (4 standard deviations) from where they believe to "
                f"stop, beyond the {near:g} m of arrival.tolerance: they may never arrive; lower "
                "the one, or raise the other",
            )
        beyond = 3.0 * both * s.position
        for driver in world.drivers():
            if ":" in driver.type:
                continue  # code of one's own, of which no world may make one
            made = make_part(OF_ROBOTS, driver.type, driver.settings, where=driver.where)
            for name in ("distance_low", "boundary_low"):
                kept = getattr(getattr(made, "settings", None), name, None)
                is_met = s.of != "others" if name == "boundary_low" else True
                size = 3.0 * s.position if name == "boundary_low" else beyond
                if is_met and isinstance(kept, float) and size > kept * (1.0 + SHARE):
                    yield Fault(
                        (*where, "position"),
                        f"distances are wrong by up to {size:.3g} m (3 standard deviations), "
                        f"beyond the {kept:g} m of {driver.type}.{name}: robots may touch before "
                        f"they avoid; lower the one, or raise the other",
                    )
                    return

    def changed(self, scene: Scene, truth: Snapshot, sensed: Sensed) -> Sensed:
        """Rows with errors; what robots tell of themselves follows their own."""
        s, of = self.settings, (scene.seed, scene.robots, scene.moving)
        if self._kept is None or self._kept[0] != of:
            width = min(WIDTH, scene.moving) if s.correlation else 1
            places = 2 * scene.robots * width
            kept = Kept(np.full(places, -1), np.empty((places, 4)), scene.moving, width)
            self._kept = of, kept
        time = sensed.step * scene.dt / s.correlation if s.correlation else float(sensed.step)
        pose, station = sensed.pose.copy(), sensed.station.copy()
        reference = sensed.reference_station.copy()
        put_noise(
            Draws(self.key(scene), time, self._size, self._kept[1]), rows_of(truth, sensed),
            scene.reference, scene.paths, self._window, truth.station, truth.reference_station,
            sensed.heard, pose, reference, station,
        )  # fmt: skip
        return sensed._replace(pose=pose, reference_station=reference, station=station)


class Draws(NamedTuple):
    """What errors are drawn by."""

    key: Words
    time: float
    """in knots"""
    size: Size
    kept: Kept


@compiled
def put_error(draws: Draws, i: int, j: int, heading: float, out: FloatArray) -> None:
    """Write the error (3,) of observer i, who faces along ``heading``, about body j."""
    size, kept, knot = draws.size, draws.kept, int(draws.time)
    u = draws.time - knot
    norm = sqrt((1.0 - u) * (1.0 - u) + u * u)
    out[0], out[1], out[2] = 0.0, 0.0, 0.0
    pairs = 2 if size.heading > 0.0 else 1
    for k in range(knot, knot + (2 if u > 0.0 else 1)):
        share = (1.0 - u if k == knot else u) / norm
        place = 2 * (kept.width * i + j % kept.width) + k % 2
        drawn, mark = kept.drawn[place], kept.bodies * k + j
        if kept.mark[place] != mark:
            kept.mark[place] = mark
            draw_normal(draws.key, np.uint64(k), np.uint64(i), np.uint64(j), pairs, drawn)
        for m in range(1 + pairs):
            out[m] += share * drawn[m]
    out[0], out[1] = size.position * out[0], size.position * out[1]
    out[2] = size.heading * out[2] + size.turned
    if size.forward != 0.0 or size.left != 0.0:
        c, s = cos(heading), sin(heading)
        out[0] += c * size.forward - s * size.left
        out[1] += s * size.forward + c * size.left


@compiled
def put_noise(
    draws: Draws,
    rows: Rows,
    line: Polylines,
    paths: Polylines,
    window: float,
    true_station: FloatArray,
    true_reference: FloatArray,
    heard: FloatArray,
    pose: Rows3,
    reference: FloatArray,
    station: FloatArray,
) -> None:
    """Add errors to poses (M, 3), and to stations along s* and own paths what follows of them.

    What robots tell follows their own errors, what nobody told follows the pose that is seen.
    """
    truth, robots, size = rows.truth, rows.observers, draws.size
    error, own = np.empty(3), np.empty(3 * robots)
    shift, is_known = np.zeros(robots), np.zeros(robots, np.int64)
    for i in range(robots):
        for row in range(rows.first[i], rows.end[i]):
            j = rows.robot[row]
            if size.of_own and j < robots and is_known[j] == 0:
                put_error(draws, j, j, truth[j, 2], own[3 * j :])
                x, y = truth[j, 0] + own[3 * j], truth[j, 1] + own[3 * j + 1]
                at, _, _ = track(line, 0, x, y, true_reference[j], window)
                shift[j], is_known[j] = at - true_reference[j], 1
            if j < robots and heard[row] < np.inf:
                reference[row] += shift[j]
            if j == i:
                if size.of_own:
                    for m in range(3):
                        pose[row, m] += own[3 * i + m]
                    x, y = truth[i, 0] + own[3 * i], truth[i, 1] + own[3 * i + 1]
                    at, _, _ = track(paths, i, x, y, true_station[i], window)
                    station[i] += at - true_station[i]
            elif size.of_others and not isnan(pose[row, 0]):
                put_error(draws, i, j, truth[i, 2], error)
                for m in range(3):
                    pose[row, m] += error[m]
                if not heard[row] < np.inf:
                    x, y = pose[row, 0], pose[row, 1]
                    reference[row], _, _ = track(line, 0, x, y, reference[row], window)
