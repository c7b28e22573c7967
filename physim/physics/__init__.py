"""Robots and walls as rigid bodies: the only package that imports pymunk."""

from __future__ import annotations

from physim.physics.host import Physics
from physim.physics.state import PhysicsState

__all__ = ["Physics", "PhysicsState"]
