"""Host the robots in the engine: solve, then move."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.geometry.closeness import describe_pairs, joined
from physim.geometry.motion import chord_velocities
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.physics.bodies import BodyArrays
from physim.physics.guard import PythonGuard, Touches
from physim.physics.pairs import (
    Pairs,
    contact_rows,
    false_rows,
    gather,
    impulse_of,
    no_contacts,
    no_false_contacts,
    no_pairs,
    phases,
    split,
)
from physim.physics.space import body_parts, build_space, moment, part_bodies


class Physics:
    """N robots among walls as rigid bodies that follow commands and are stopped by contact.

    While something touches, a step first asks the engine what contacts allow of the wanted
    velocities (push); then every body moves with the velocity it may have, and the contacts at
    the new poses are found (impact). Without contact robots move exactly as commanded, and a held
    robot is free at once when its command turns away.

    ``contacts`` holds the rows (`physim.contacts.CONTACT`) of the present sample, sorted by a and
    b, at most one a pair; walls have the ids from N on. The impulse of a row is all that the pair
    exchanged in the step that led to the sample: the push while it touched (a robot held from
    v is pushed with m v a step) and the impact of new contacts (m v for a dead stop), magnitudes
    added over the parts that touch.

    ``false_contacts`` holds the rows (`physim.contacts.FALSE_CONTACT`) of the present sample: pairs
    that the engine reported as touching, and which the exact check found apart and kept out.

    The force of a command is m v / dt, what it takes to bring a robot from rest to its speed within
    a step, and has no other limit. Overlaps stay below (closing speed + sum of r|omega|) dt in the
    step of an impact and settle below SETTLED_DEPTH; jams of driven robots may go beyond, and what
    is deeper than DEEP is told by whoever reads the record.

    Every contact at a sample is found, to the tolerance CONTACT; a graze that begins and ends
    between two samples is not.
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
        """Place robots and find what touches at sample 0.

        ``shapes`` of the N robots in their own frames, ``walls`` in the world frame, ``start``
        (N, 3) x, y [m], heading [rad], ``mass`` (N,) [kg], time step ``dt`` [s], coefficients of
        ``friction`` and ``elasticity`` of every contact. Since velocities are commanded anew at
        each step, elasticity adds to the impulse of an impact but nothing bounces.
        """
        start = np.ascontiguousarray(start, dtype=np.float64)
        hosted = build_space(shapes, walls, start, mass, friction, elasticity)
        self.dt = dt
        self.step_number = 0
        self._robots = len(start)
        self._space = hosted.space
        self._shapes = joined(shapes, walls)
        self._body_of_part = part_bodies(self._shapes)
        self._bodies = len(self._shapes.body_start) - 1
        self._guard = PythonGuard(hosted, self._shapes, checks=_guarded)
        self._arrays = BodyArrays(hosted.space, self._robots)
        inertia = [(m, m, moment(body_parts(shapes, i), m)) for i, m in enumerate(mass)]
        self._drive_per_speed = np.array(inertia, dtype=np.float64).reshape(-1, 3) / dt
        self._wanted = np.zeros((self._robots, 3))
        self._placed = np.zeros((self._bodies, 3))
        self._pairs = self._no_pairs = no_pairs()
        self.contacts = self._no_contacts = no_contacts()
        self.false_contacts = self._no_false = no_false_contacts()
        self._move(self._no_pairs)

    @property
    def pose(self) -> FloatArray:
        """(N, 3) x, y [m], heading [rad, unwrapped] at this sample; a copy."""
        return self._arrays.pose.copy()

    @property
    def touching(self) -> NDArray[np.bool_]:
        """(N,) whether each robot touches a robot or a wall at this sample."""
        touching = np.zeros(self._bodies, dtype=np.bool_)
        touching[split(self._pairs.key, self._bodies)] = True
        return touching[: self._robots]

    @property
    def rejected(self) -> int:
        """False contacts of the engine that were kept out so far, counted by parts and solves."""
        return self._guard.rejected

    def step(self, command: FloatArray) -> None:
        """Advance one step under commands (N, 2): v [m/s], omega [rad/s], each along its arc."""
        chord_velocities(self._arrays.pose, command, self.dt, self._wanted)
        pushes = self._no_pairs
        self.false_contacts = self._no_false
        if len(self._pairs.key):
            pushes = self._hold_back()
        self._arrays.velocity[:] = self._wanted
        self._arrays.write_velocity()
        self.step_number += 1
        self._move(pushes)

    def _hold_back(self) -> Pairs:
        """Replace wanted velocities of robots in contact by what contacts allow; the pushes.

        Bodies stand still, but for the engine's easing of overlaps, and are driven by the forces
        that would give them the wanted velocities.
        """
        drive = self._arrays.drive
        drive[:, :3] = 0.0
        np.multiply(self._wanted, self._drive_per_speed, out=drive[:, 3:])
        self._arrays.write_drive()
        self._space.step(self.dt)
        self._arrays.read_velocity()
        pushes = self._gather(self._guard.take())
        self._guard.take_rejected()  # the same as those met when the bodies came here
        held = np.unique(split(pushes.key, self._bodies))
        held = held[held < self._robots]
        self._wanted[held] = self._arrays.velocity[held]
        return pushes

    def _move(self, pushes: Pairs) -> None:
        """Move all bodies, find the contacts at their new poses, and set ``contacts``."""
        self._space.step(self.dt)
        self._arrays.read_pose()
        touches = self._guard.take()
        self._note_false(self._guard.take_rejected())
        before = self._pairs
        if not len(before.key) and not len(touches.part):
            self.contacts = self._no_contacts
            return
        self._pairs = now = self._gather(touches)
        key = np.union1d(before.key, now.key)
        pairs = split(key, self._bodies)
        self._placed[: self._robots] = self._arrays.pose
        self.contacts = contact_rows(
            self.step_number,
            pairs,
            phases(key, before.key, now.key),
            describe_pairs(self._shapes, self._placed, pairs),
            impulse_of(key, pushes, now),
        )

    def _note_false(self, parts: IntArray) -> None:
        """Set ``false_contacts``: pairs that the engine reported at this sample, yet are apart."""
        if not len(parts):
            return
        reported = self._gather(Touches(parts, np.zeros(len(parts))))
        pairs = split(reported.key, self._bodies)
        self._placed[: self._robots] = self._arrays.pose
        found = describe_pairs(self._shapes, self._placed, pairs)
        self.false_contacts = false_rows(self.step_number, pairs, found[:, 4])

    def _gather(self, touches: Touches) -> Pairs:
        return gather(self._body_of_part[touches.part], touches.impulse, self._bodies)
