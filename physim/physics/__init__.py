"""Robots and walls as rigid bodies: the only package that imports pymunk."""

from __future__ import annotations

from physim.physics.host import Physics

__all__ = ["Physics"]
