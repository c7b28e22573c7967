"""The pseudo-velocities of pymunk 7.3.1 in memory: an oracle, for tests alone."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest
from pymunk._chipmunk_cffi import ffi

POSITION, ANGLE, BIAS = 64 // 8, 112 // 8, 192 // 8
"""place in the structure of a body, in numbers of eight bytes"""


def memory(body: pymunk.Body) -> np.ndarray:
    values = np.frombuffer(ffi.buffer(ffi.cast("double *", body._body), 8 * (BIAS + 3)))
    known = (*values[POSITION : POSITION + 2], values[ANGLE])
    if known != (*body.position, body.angle):
        pytest.skip(f"pymunk {pymunk.version} lays out its bodies in another way")
    return values


def biases(physics) -> np.ndarray:
    """(N, 3) v_bias [m/s], w_bias [rad/s] of all robots."""
    return np.array([memory(b)[BIAS : BIAS + 3] for b in physics._engine._space.bodies])


def set_biases(physics, value: float) -> None:
    for body in physics._engine._space.bodies:
        memory(body)[BIAS : BIAS + 3] = value
