"""Host the robots in the engine: solve, then move."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray, Shapes
from physim.physics.bodies import BodyArrays
from physim.physics.closeness import body_closeness
from physim.physics.contacts import Closeness, Pair, contact_rows, no_contacts
from physim.physics.guard import PythonGuard, Touches
from physim.physics.motion import chord_velocities
from physim.physics.space import body_parts, build_space, moment, part_bodies


class Physics:
    """N robots among walls as rigid bodies that follow commands and are stopped by contact.

    A step has two parts. While something touches, the engine is first asked what contacts allow
    of the wanted velocities (push); then every body moves with the velocity it may have, and the
    contacts at the new poses are found (impact). Without contact robots move exactly as
    commanded. Contacts take nothing from a command: a held robot is free at once when it turns.

    Overlaps stay below (closing speed + sum of r|omega|) dt in the step of an impact and below
    SETTLED_DEPTH at rest. No contact is missed at a sample; a graze between two samples is.
    """

    def __init__(
        self,
        shapes: Shapes,
        walls: Shapes,
        start: FloatArray,
        mass: FloatArray,
        dt: float,
        friction: float = 0.0,
        elasticity: float = 0.0,
        *,
        _guarded: bool = True,
    ) -> None:
        """Place robots at ``start`` and find what touches there (sample 0).

        Parameters: ``shapes`` of the N robots in their frames, ``walls`` in the world frame,
        ``start`` (N, 3) x, y [m], heading [rad], ``mass`` (N,) [kg], time step ``dt`` [s],
        ``friction`` and ``elasticity`` coefficients of every contact. Since a robot's velocity is
        commanded anew each step, elasticity adds to impulses but nothing bounces.
        """
        start = np.ascontiguousarray(start, dtype=np.float64)
        hosted = build_space(shapes, walls, start, mass, friction, elasticity)
        robots = len(start)
        self.dt = dt
        self.step_number = 0
        self._space = hosted.space
        self._shapes = _joined(shapes, walls)
        self._body_of_part = part_bodies(self._shapes)
        self._guard = PythonGuard(hosted, self._shapes, checks=_guarded)
        self._arrays = BodyArrays(hosted.space, robots)
        inertia = [(m, m, moment(body_parts(shapes, i), m)) for i, m in enumerate(mass)]
        self._drive_per_speed = np.array(inertia, dtype=np.float64).reshape(-1, 3) / dt
        self._wanted = np.zeros((robots, 3))
        self._placed = np.zeros((len(self._shapes.body_start) - 1, 3))
        self._pairs: frozenset[Pair] = frozenset()
        self.contacts = no_contacts()
        self._move_and_log({})

    @property
    def pose(self) -> FloatArray:
        """(N, 3) x, y [m], heading [rad, unwrapped] at this sample; a copy."""
        return self._arrays.pose.copy()

    @property
    def touching(self) -> NDArray[np.bool_]:
        """(N,) whether each robot touches a robot or a wall at this sample."""
        touching = np.zeros(len(self._wanted), dtype=np.bool_)
        robots = [body for pair in self._pairs for body in pair if body < len(touching)]
        touching[robots] = True
        return touching

    @property
    def rejected(self) -> int:
        """False contacts of the engine that were kept out so far."""
        return self._guard.rejected

    def step(self, command: FloatArray) -> None:
        """Advance one step under commands (N, 2): v [m/s], omega [rad/s], each along its arc."""
        wanted = self._wanted
        chord_velocities(self._arrays.pose, command, self.dt, wanted)
        pushes: dict[Pair, float] = {}
        if self._pairs:
            pushes = self._hold_back(wanted)
        self._arrays.velocity[:] = wanted
        self._arrays.write_velocity()
        self.step_number += 1
        self._move_and_log(pushes)

    def _hold_back(self, wanted: FloatArray) -> dict[Pair, float]:
        """Replace the wanted velocities of robots in contact by what contacts allow; the pushes.

        The bodies stand still but for the engine's own easing of overlaps, and are driven by the
        forces that would give them the wanted velocities.
        """
        drive = self._arrays.drive
        drive[:, :3] = 0.0
        np.multiply(wanted, self._drive_per_speed, out=drive[:, 3:])
        self._arrays.write_drive()
        self._space.step(self.dt)
        impulses = self._by_pair(self._guard.take())
        self._arrays.read_velocity()
        held = [body for pair in impulses for body in pair if body < len(wanted)]
        wanted[held] = self._arrays.velocity[held]
        return impulses

    def _move_and_log(self, pushes: dict[Pair, float]) -> None:
        """Move all bodies, find contacts at the new poses and set ``contacts``."""
        self._space.step(self.dt)
        self._arrays.read_pose()
        touches = self._guard.take()
        before = self._pairs
        if not before and not len(touches.part):
            if len(self.contacts):
                self.contacts = no_contacts()
            return
        impulses = self._by_pair(touches)
        self._pairs = frozenset(impulses)
        self._placed[: len(self._wanted)] = self._arrays.pose
        for pair, push in pushes.items():
            impulses[pair] = impulses.get(pair, 0.0) + push
        self.contacts = contact_rows(
            self.step_number, before, self._pairs, self._describe, impulses
        )

    def _by_pair(self, touches: Touches) -> dict[Pair, float]:
        """Impulse [N s] of each touching pair of bodies, summed over its parts."""
        impulses: dict[Pair, float] = {}
        bodies = np.sort(self._body_of_part[touches.part], axis=1)
        for (a, b), impulse in zip(bodies.tolist(), touches.impulse.tolist(), strict=True):
            impulses[a, b] = impulses.get((a, b), 0.0) + impulse
        return impulses

    def _describe(self, a: int, b: int) -> Closeness:
        s = self._shapes
        return body_closeness(s.vertices, s.part_start, s.body_start, self._placed, a, b)


def _joined(shapes: Shapes, walls: Shapes) -> Shapes:
    """Robots and walls in one numbering of bodies and parts: robots first."""
    return Shapes(
        np.concatenate((shapes.vertices, walls.vertices)),
        _follow(shapes.part_start, walls.part_start),
        _follow(shapes.body_start, walls.body_start),
        np.concatenate((shapes.radius, walls.radius)),
    )


def _follow(first: NDArray[np.int64], second: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.concatenate((first, second[1:] + first[-1]))
