"""Robots and walls as rigid bodies: the only package that imports pymunk."""

from __future__ import annotations

from physim.simulation.engine.host import Physics
from physim.simulation.engine.state import PhysicsState

__all__ = ["Physics", "PhysicsState"]
