"""Analytic checks with something broken on purpose: the crash test must notice each."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from tests.helpers import inside

Packed, Prediction, predict = inside("physim.analysis.crashtest", "Packed", "Prediction", "predict")


def without_rotation(batch: Packed) -> Prediction:
    """Collision times as if nobody turned; distances are right."""
    straight = batch._replace(twist=batch.twist * (1.0, 0.0, 1.0))
    return predict(batch)._replace(time=predict(straight).time)


def smaller(batch: Packed, by: float = 0.01) -> Prediction:
    """Every footprint drawn in by about 1 cm on all sides, in all that is analytic."""
    shapes = batch.shapes
    vertices = shapes.vertices.copy()
    for first, last in zip(shapes.part_start[:-1], shapes.part_start[1:], strict=True):
        part = vertices[first:last]
        middle = part.mean(axis=0)
        size = np.hypot(*(part - middle).T)
        vertices[first:last] = middle + (part - middle) * (1.0 - by / size.max())
    return predict(batch._replace(shapes=shapes._replace(vertices=vertices)))


def two_steps_late(batch: Packed, steps: float = 2.0) -> Prediction:
    found = predict(batch)
    return found._replace(time=np.maximum(found.time + steps * batch.dt, 0.0))


def contacts_dropped(batch: Packed) -> Prediction:
    """No collision is ever predicted."""
    found = predict(batch)
    return found._replace(time=np.full_like(found.time, np.inf))


BROKEN = (
    (without_rotation, 0.3),  # straight motion needs none
    (smaller, 0.3),  # 1 cm is often less than the advance of a step
    (two_steps_late, 0.9),
    pytest.param(partial(two_steps_late, steps=-2.0), 0.9, marks=pytest.mark.deep),
    pytest.param(contacts_dropped, 0.9, marks=pytest.mark.deep),
)
"""What is broken, and the share of hits that must be noticed"""
