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
from math import cos, hypot, sin, sqrt
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from physim.compiled import compiled
from physim.disturbances.rows import moved, moving, own_rows
from physim.errors import Fault, Location
from physim.geometry.path import SHORTEST_WINDOW
from physim.geometry.shapes import FloatArray, IntArray, Rows3, Rows4
from physim.parts.controller import Sensed, Snapshot
from physim.parts.registry import OF_ROBOTS, make_part
from physim.parts.stages import follow_poses, observer_of_row
from physim.randomness import Words, draw, purpose_key, words
from physim.world import World
from physim.world.scene import Scene

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
    stream: Annotated[int, Field(ge=0, le=10**6)] = Field(
        default=0, description="number of the draws: with another number noise is independent"
    )


class Size(NamedTuple):
    """How large errors are."""

    position: float
    heading: float
    forward: float
    left: float
    turned: float
    of_own: bool
    of_others: bool


class Noise:
    """Adds errors to the poses that robots sense: deviation, bias, correlation in time."""

    Settings = NoiseSettings
    on_demand = True

    def __init__(self, settings: NoiseSettings | None = None) -> None:
        self.settings = s = settings or NoiseSettings()
        self._size = Size(
            s.position, s.heading, *s.bias, s.heading_bias, s.of != "others", s.of != "own"
        )
        self._is_off = not any(self._size[:5])
        self._window = max(SHORTEST_WINDOW, 8.0 * s.position + hypot(*s.bias))

    def world_doubts(self, world: World, where: Location) -> Iterator[Fault]:
        """Doubt noise that is larger than the distances at which a controller avoids."""
        s, both = self.settings, sqrt(2.0) if self.settings.of == "all" else 1.0
        beyond = 3.0 * both * s.position
        for driver in world.drivers():
            made = make_part(OF_ROBOTS, driver.type, driver.settings, where=driver.where)
            for name in ("distance_low", "boundary_low"):
                kept = getattr(getattr(made, "settings", None), name, None)
                is_met = s.of != "others" if name == "boundary_low" else True
                size = 3.0 * s.position if name == "boundary_low" else beyond
                if is_met and isinstance(kept, float) and size > kept:
                    yield Fault(
                        (*where, "position"),
                        f"distances are wrong by up to {size:.3g} m (3 standard deviations), "
                        f"beyond the {kept:g} m of {driver.type}.{name}: robots may touch before "
                        f"they avoid; lower the one, or raise the other",
                    )
                    return

    def start(self, scene: Scene) -> None:
        """Nothing is remembered."""

    def sense(
        self, scene: Scene, truth: Snapshot, sensed: Sensed, state: Any
    ) -> tuple[Sensed, Any]:
        """Rows with errors; what robots tell of themselves follows their own."""
        if self._is_off or not len(sensed.robot):
            return sensed, state
        s, (pose, _) = self.settings, moving(truth)
        rows = own_rows(scene, sensed)
        time = sensed.step * scene.dt / s.correlation if s.correlation else float(sensed.step)
        key = np.array([scene.seed, purpose_key(f"noise {s.stream}")], dtype=np.uint64)
        if self._size.of_own:
            robots = np.arange(scene.robots)
            believed = pose[: scene.robots] + self._errors(key, time, robots, robots, pose)
            station, reference = truth.station.copy(), truth.reference_station.copy()
            follow_poses(
                scene.reference, scene.paths, scene.robots, robots, robots, believed, reference,
                station, self._window,
            )  # fmt: skip
            shift = np.zeros(len(pose))
            shift[: scene.robots] = reference - truth.reference_station
            rows = rows._replace(
                station=rows.station + (station - truth.station),
                reference_station=rows.reference_station + shift[rows.robot],
            )
        error = self._errors(key, time, observer_of_row(rows), rows.robot, pose)
        return moved(scene, rows, rows.pose + error), state

    def _errors(
        self, key: Words, time: float, who: IntArray, whom: IntArray, pose: FloatArray
    ) -> FloatArray:
        """Errors (M, 3) of observers ``who`` about bodies ``whom``; ``pose`` are the true ones."""
        out = np.empty((len(who), 3))
        knot = int(time)
        drawn = np.empty((2, len(who), 4))
        for k in range(2 if self.settings.correlation else 1):
            draw(key, np.uint64(knot + k), words(who), words(whom), len(who), True, drawn[k])
        put_errors(self._size, time - knot, len(who), who, whom, pose, drawn[0], drawn[1], out)
        return out


@compiled
def put_errors(
    size: Size,
    along: float,
    many: int,
    who: IntArray,
    whom: IntArray,
    pose: Rows3,
    before: Rows4,
    after: Rows4,
    out: Rows3,
) -> None:
    """Write errors (M, 3) from normal numbers at the knots before and after, ``along`` 0 to 1."""
    norm = sqrt((1.0 - along) * (1.0 - along) + along * along)
    a, b = (1.0 - along) / norm, along / norm
    for k in range(many):
        i, j = who[k], whom[k]
        out[k, 0], out[k, 1], out[k, 2] = 0.0, 0.0, 0.0
        if size.of_own if i == j else size.of_others:
            c, s = cos(pose[i, 2]), sin(pose[i, 2])
            x, y, turn = a * before[k, 0], a * before[k, 1], a * before[k, 2]
            if b > 0.0:  # else there is none after
                x, y, turn = x + b * after[k, 0], y + b * after[k, 1], turn + b * after[k, 2]
            out[k, 0] = size.position * x + (c * size.forward - s * size.left)
            out[k, 1] = size.position * y + (s * size.forward + c * size.left)
            out[k, 2] = size.heading * turn + size.turned
