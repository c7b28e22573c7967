"""Random streams: one for each seed, purpose and robot, so that a new use changes no other."""

from __future__ import annotations

import hashlib

import numpy as np


def stream(seed: int, purpose: str, robot: int) -> np.random.Generator:
    """Generator of the stream (seed, purpose, robot index); equal on every machine."""
    key = int.from_bytes(hashlib.sha256(purpose.encode()).digest()[:8], "little")
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, key, robot])))
