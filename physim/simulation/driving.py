"""What drives make of commands, and what robots can come to; see `physim.parts.drive`."""

from __future__ import annotations

import numpy as np

from physim.errors import ControllerError
from physim.geometry.motion import twists
from physim.geometry.shapes import FloatArray, read_only
from physim.parts.controller import FASTEST
from physim.parts.user_code import kind_of, naming
from physim.world.scene import Scene


def followed(scene: Scene, command: FloatArray, state: FloatArray, time: float) -> FloatArray:
    """State (N, 4) of all robots over the step from ``time`` [s], under commands (N, columns).

    Those without a drive follow at once. Raises ControllerError for what a drive may not answer.
    """
    twist = twists(command)
    out = np.zeros((len(twist), 4))
    out[:, :3] = twist
    for kind, drive, robots in scene.drives:
        with naming(f"drive {kind} at {time:g} s", drive.follow):
            found = drive.follow(twist[robots], state[robots], scene.dt)
            if not isinstance(found, np.ndarray) or found.shape != (len(robots), 4):
                raise ControllerError(
                    f"follow returned {kind_of(found)}; it must return an array of {len(robots)} "
                    "rows of v, omega, lateral and steering"
                )
            if not (np.abs(found) <= FASTEST).all():
                raise ControllerError(f"follow returned {found.tolist()}, beyond {FASTEST:g}")
            out[robots] = found
    return read_only(out)


def applied_of(followed: FloatArray, command: FloatArray) -> FloatArray:
    """Commands that a state is; the very array of those given where they are followed at once."""
    made = np.ascontiguousarray(followed[:, : command.shape[1]])
    return command if np.array_equal(made, command) else read_only(made)


def reachable(scene: Scene, state: FloatArray, time: float) -> FloatArray:
    """(N, 6) least and greatest v, omega and curvature of each robot within a time [s]."""
    most = np.column_stack((scene.limits[:, :2], scene.curvature))
    out = np.empty((scene.robots, 6))
    out[:, ::2], out[:, 1::2] = -most, most
    for _, drive, robots in scene.drives:
        found, own = drive.reach(state[robots], time), out[robots]
        least, greatest = own[:, ::2], own[:, 1::2]
        out[robots, ::2] = np.clip(found[:, ::2], least, greatest)
        out[robots, 1::2] = np.clip(found[:, 1::2], least, greatest)
    return out
