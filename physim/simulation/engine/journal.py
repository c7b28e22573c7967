"""What leads to the present sample, where the engine's memory of contacts cannot be had."""

from __future__ import annotations

import numpy as np

from physim.geometry.shapes import FloatArray


class Journal:
    """The last sample from which poses alone lead on, and the commands applied since.

    Such is a start, and every sample at which the engine reports no contact, not even a false one:
    it then remembers nothing. To go on from a later sample, the steps since are done again.
    """

    def __init__(self, robots: int) -> None:
        """Begin with no sample."""
        self.step = 0
        self.pose: FloatArray = np.zeros((0, 3))
        """(N, 3) at that sample"""
        self.rejected = 0
        """false contacts kept out until then"""
        self._applied: list[FloatArray] = []
        self._robots = robots

    @property
    def applied(self) -> FloatArray:
        """(M, N, 2) commands of the steps since that sample."""
        return np.array(self._applied).reshape(-1, self._robots, 2)

    def begin(self, step: int, pose: FloatArray, rejected: int) -> None:
        """Take a sample; the commands so far are forgotten."""
        self.step, self.pose, self.rejected = step, pose.copy(), rejected
        self._applied = []

    def add(self, command: FloatArray) -> None:
        """Note the commands (N, 2) of one step."""
        self._applied.append(np.array(command, dtype=np.float64))
