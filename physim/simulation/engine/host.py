"""Host the robots in the engine: solve, then move."""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import lib

from physim.contacts import CONTACT_ROW, FALSE_CONTACT_ROW, allowed_depth
from physim.errors import PhysimError
from physim.geometry.bodies import describe_pairs
from physim.geometry.motion import chord_velocities
from physim.geometry.polygon import moment
from physim.geometry.shapes import (
    FloatArray,
    IntArray,
    Shapes,
    body_parts,
    joined_shapes,
    part_bodies,
)
from physim.geometry.timed_paths import TimedPaths, put_path_velocities
from physim.geometry.walls import build_wall_tree, nearest_walls
from physim.simulation.engine.cutting import Moves, cut_short
from physim.simulation.engine.energy import OF_IMPACTS, OF_PUSHES, failures
from physim.simulation.engine.guard import Guard, Touches
from physim.simulation.engine.pairs import (
    Among,
    Pairs,
    contact_rows,
    hold_back,
    pairs_of,
    put_solid_keys,
    split,
)
from physim.simulation.engine.space import BodyArrays, build_space
from physim.simulation.engine.state import ContactMemory, PhysicsState
from physim.tolerances import CONTACT
from physim.world.ground.solids import solids_of

LEAST_ROUNDS, MOST_ROUNDS = 20, 400
"""Rounds of the contact solver per step. Each mends one contact after the other, so a push needs
the more of them the more robots it goes through, and the lighter they are than who pushes."""

ALL_ROUNDS = 2_500
"""Rounds times the square of the pairs that touch, where not at one of these bounds. Rows of up to
six robots go straight by it; more rounds in crowds would cost more than all else of a step."""


class Physics:
    """N bodies among walls as rigid bodies that follow commands and are stopped by contact.

    Robots come first. Movers, of infinite mass, follow timed paths whatever stands there; obstacles
    that can be pushed are like robots that want to stand.

    While something touches, a step first asks the engine what contacts allow of the wanted
    velocities (push); then every body moves with the velocity it may have, and the contacts at
    the new poses are found (impact). Without contact robots move exactly as commanded, and a held
    robot is free at once when its command turns away.

    ``contacts`` holds the rows (`physim.contacts.CONTACT_ROW`) of the present sample, sorted by a
    and b, at most one a pair; walls have the ids from N on. The impulse of a row is all that the
    pair exchanged in the step that led to the sample: the push while it touched (a robot held from
    v is pushed with m v a step) and the impact of new contacts (m v for a dead stop), magnitudes
    added over the parts that touch. ``false_contacts`` holds the rows
    (`physim.contacts.FALSE_CONTACT_ROW`) of pairs that the engine reported as touching, and which
    the exact check found apart and kept out.

    The force of a command is m v / dt, what it takes to bring a robot from rest to its speed within
    a step, and has no other limit. Overlaps stay below (closing speed + sum of r|omega|) dt in the
    step of an impact, and below what is allowed (`physim.contacts.allowed_depth`), and settle below
    SETTLED_DEPTH. Every contact at a sample is found, to the tolerance CONTACT; a swept contact,
    which begins and ends between two samples, is not.
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
        movers: TimedPaths | None = None,
        _guarded: bool = True,
    ) -> None:
        """Place bodies and find what touches at sample 0.

        ``shapes`` of the N bodies in their own frames, ``walls`` in the world frame, ``start``
        (N, 3) x, y [m], heading [rad], ``mass`` (N,) [kg], inf of those that follow ``movers``,
        time step ``dt`` [s], coefficients of ``friction`` and ``elasticity`` of every contact.
        Since velocities are commanded anew at each step, elasticity adds to the impulse of an
        impact but nothing bounces.
        """
        start = np.ascontiguousarray(start, dtype=np.float64)
        self.dt = dt
        solids = solids_of(walls)
        all_shapes, joined = joined_shapes(shapes, walls), joined_shapes(shapes, solids.shapes)
        self._robots, self._bodies = len(start), len(all_shapes.body_start) - 1
        self._among = Among(
            all_shapes, joined, part_bodies(joined), solids, build_wall_tree(walls),
            nearest_walls(0), self._robots, self._bodies,
        )  # fmt: skip
        self._solid = np.concatenate((np.arange(len(start)), len(start) + solids.of))
        self._solids = len(joined.body_start) - 1
        self._allowed_depth = allowed_depth(shapes, dt)

        hosted = build_space(shapes, solids.shapes, start, mass, friction, elasticity)
        self._space = hosted.space
        # Past pymunk's own bookkeeping, which serves callbacks that add and remove bodies.
        self._advance = functools.partial(lib.cpSpaceStep, hosted.space._space, dt)
        self._arrays = BodyArrays(hosted.space, len(start))
        self._guard = Guard(hosted, joined, checks=_guarded)
        self._memory = ContactMemory(hosted)
        room = 4.0 * float(shapes.radius.max())
        self._parking = np.zeros((len(start), 3))  # above the walls, in a row
        self._parking[:, 0] = room * np.arange(len(start))
        self._parking[:, 1] = room + walls.vertices[:, 1].max(initial=0.0)

        self._goes_on = np.isinf(mass)
        self._movers = np.flatnonzero(self._goes_on)
        self._paths = movers if len(self._movers) else None
        finite = np.where(self._goes_on, 0.0, mass)
        inertia = [(m, m, moment(body_parts(shapes, i), m)) for i, m in enumerate(finite)]
        self._inertia = np.array(inertia, dtype=np.float64).reshape(-1, 3)
        self._reach = shapes.radius
        self._drive_per_speed = self._inertia / dt
        self._placed = np.zeros((self._bodies, 3))
        self._twist = np.zeros((self._robots, 3))
        self._no_pairs = Pairs(np.zeros(0, dtype=np.int64), np.zeros(0), 0)
        self._no_contacts = np.zeros(0, CONTACT_ROW)
        self._no_false = np.zeros(0, FALSE_CONTACT_ROW)
        self._begin(start)

    @property
    def pose(self) -> FloatArray:
        """(N, 3) x, y [m], heading [rad, unwrapped] at this sample; a copy."""
        return self._arrays.pose.copy()

    @property
    def touching(self) -> NDArray[np.bool_]:
        """(N,) whether each body touches another or a wall at this sample."""
        touching = np.zeros(self._bodies, dtype=np.bool_)
        touching[split(self._pairs.key, self._bodies)] = True
        return touching[: self._robots]

    def step(self, command: FloatArray) -> None:
        """Advance one step under commands (R, 2 or 3) of the robots, each along its arc.

        v [m/s], omega [rad/s] and, where some robot is omnidirectional, the lateral speed [m/s].
        """
        before, start, arrays = self._pairs, self._arrays.pose.copy(), self._arrays
        self._twist[: len(command), : command.shape[1]] = command
        chord_velocities(arrays.pose, self._twist, self._robots, self.dt, arrays.velocity)
        self.step_number += 1
        if self._paths is not None:
            put_path_velocities(
                self._paths, self.step_number * self.dt, self._movers, arrays.pose, self.dt,
                arrays.velocity,
            )  # fmt: skip
        pushes, to_solve = self._no_pairs, self._to_solve(before.key)
        if to_solve:
            pushes = self._hold_back(to_solve)
        self._move(before, pushes, to_solve)
        if self._is_deep():
            self._cut_short(start, before, pushes, to_solve)

    @property
    def state(self) -> PhysicsState:
        """All that the next step depends on, as a value; `restore` goes on from it bit for bit."""
        known = self._memory.read() if self._guard.reported else self._memory.nothing
        return PhysicsState(
            np.array(self.step_number), self._arrays.pose, *known, self.contacts,
            self.false_contacts,
        )  # fmt: skip

    def restore(self, state: PhysicsState) -> None:
        """Go back, or on, to a state of the same scene: what follows is the same to the last bit.

        The state may come from another `Physics` of the same arguments, in another process on the
        same kind of machine. Raises PhysimError for a state of another scene; restore or reset
        before going on then.
        """
        self._check(state.pose)
        before, touching = (pairs @ (self._bodies, 1) for pairs in (state.before, state.touching))
        self._recall(state.pose, self._to_solve(before), state)
        if self._arrays.pose.tobytes() != state.pose.tobytes():
            raise PhysimError("the state is of another scene: its steps lead to other poses")
        self._pairs = Pairs(touching, np.zeros(len(touching)), len(touching))
        self.step_number = int(state.step)
        self.contacts, self.false_contacts = state.contacts, state.false_contacts

    def reset(self, start: FloatArray) -> None:
        """Begin anew at poses (N, 3) x, y [m], heading [rad]: the same as if built with them.

        Raises PhysimError for another number of poses, or one that is not finite.
        """
        start = np.asarray(start, dtype=np.float64)
        self._check(start)
        self._stand(start)
        self._begin(start)

    def _check(self, pose: FloatArray) -> None:
        if pose.shape != (self._robots, 3):
            raise PhysimError(f"poses of shape {pose.shape}; allowed: {(self._robots, 3)}")
        if not np.isfinite(pose).all():
            raise PhysimError("a pose is not finite")

    def _begin(self, pose: FloatArray) -> None:
        """Find what touches at sample 0, at whose poses the robots stand."""
        self.step_number = 0
        self._pairs = self._no_pairs
        self.contacts, self.false_contacts = self._no_contacts, self._no_false
        self._move(self._no_pairs, self._no_pairs, 0)

    # A step

    def _is_deep(self) -> bool:
        """Whether two bodies are deeper in each other than they may be."""
        depth = self.contacts["depth"]
        return bool(len(depth) and np.maximum.reduce(depth) > self._allowed_depth)

    def _hold_back(self, to_solve: int) -> Pairs:
        """Make of the velocities of robots in contact what these allow; the pushes.

        Bodies stand still, but for the engine's easing of overlaps, and are driven by the forces
        that would give them the wanted velocities. Movers come, from a step back, to where they
        stand.
        """
        arrays, wanted = self._arrays, self._arrays.velocity.copy()
        arrays.drive[:, :3] = 0.0
        np.multiply(wanted, self._drive_per_speed, out=arrays.drive[:, 3:])
        if self._paths is not None:
            movers, standing = self._movers, arrays.pose.copy()
            arrays.drive[movers, :3] = wanted[movers]
            arrays.pose[movers] -= wanted[movers] * self.dt
            arrays.write_pose()
            arrays.pose[:] = standing
        arrays.write_drive()
        pushes = self._gather(self._solve(to_solve))
        arrays.read_velocity()
        self._guard.take_rejected()  # the same as those met when the bodies came here
        failed = self._failures(pushes, wanted, OF_PUSHES)
        if len(failed):
            self._recall(arrays.pose.copy(), to_solve)
            arrays.velocity[:] = np.where(failed[:, None], 0.0, wanted)
        hold_back(pushes.key, pushes.size, self._bodies, arrays.velocity, self._robots, wanted)
        arrays.velocity[:] = wanted
        return pushes

    def _move(self, before: Pairs, pushes: Pairs, to_solve: int) -> None:
        """Move all bodies by ``velocity`` and set ``contacts``, given the pairs ``before``."""
        arrays = self._arrays
        arrays.write_velocity()
        touches = self._solve(to_solve)
        arrays.read_pose()
        now = self._gather(touches)
        self.false_contacts = self._no_false
        if self._guard.reported and len(parts := self._guard.take_rejected()):
            reported = self._gather(Touches(parts, np.zeros(len(parts))))
            pairs = split(reported.key, self._bodies)
            told = np.empty((len(pairs), 5))
            describe_pairs(self._among.shapes, self._placed, pairs, len(pairs), told)
            distance = told[:, 4]
            apart = distance > CONTACT  # of other pairs other parts do touch
            self.false_contacts = np.zeros(int(apart.sum()), FALSE_CONTACT_ROW)
            self.false_contacts["step"] = self.step_number
            self.false_contacts["a"], self.false_contacts["b"] = pairs[apart].T
            self.false_contacts["distance"] = distance[apart]
        self._pairs = now
        if not before.size and not now.size:
            self.contacts = self._no_contacts
            return
        given = arrays.velocity.copy()
        arrays.read_velocity()
        if len(self._failures(now, given, OF_IMPACTS)):
            self._recall(arrays.pose.copy(), to_solve)
        arrays.velocity[:] = given
        self._placed[: self._robots] = arrays.pose
        self.contacts = contact_rows(
            self.step_number, before.key, now, pushes, self._among, self._placed
        )

    def _cut_short(self, start: FloatArray, before: Pairs, pushes: Pairs, to_solve: int) -> None:
        """Do the step from poses (N, 3) again; bodies that came too deep stop where they touch."""
        arrays, robots = self._arrays, self._robots
        velocity, end = arrays.velocity.copy(), self._placed[: self._solids].copy()
        last, share = np.ones((2, robots))
        way = end[:robots] - start
        moves = Moves(self._among.joined, end, way, share, self._goes_on, robots, self._solids)
        keys = self._solid_keys(before.key)
        while True:  # what stops may be met by what passed it before
            keys = np.union1d(keys, self._solid_keys(self._pairs.key))
            cut_short(keys, len(keys), moves, self._allowed_depth)
            if np.array_equal(share, last):
                return
            last[:] = share
            stop = end[:robots] - (1.0 - share)[:, None] * moves.way
            self._stand(stop - velocity * self.dt)
            arrays.velocity[:] = velocity
            self._move(before, pushes, to_solve)

    # The engine

    def _solve(self, pairs: int) -> Touches:
        """Move all bodies, find the contacts at their new poses and solve them; the true ones.

        ``pairs`` of bodies touched before: so much there is to solve.
        """
        rounds = ALL_ROUNDS // max(1, pairs * pairs)
        self._space.iterations = max(LEAST_ROUNDS, min(MOST_ROUNDS, rounds))
        self._advance()
        return self._guard.take()

    def _stand(self, pose: FloatArray) -> None:
        """Put all robots at poses (N, 3), at rest; the engine forgets the contacts it had."""
        self._arrays.velocity[:] = 0.0
        # Twice, if the easing of overlaps leads from parking into contact.
        while self._guard.reported:
            self._put(self._parking)
            self._solve(0)
        self._put(pose)
        self._guard.take_rejected()

    def _put(self, pose: FloatArray) -> None:
        self._arrays.write_velocity()
        self._arrays.pose[:] = pose
        self._arrays.write_pose()

    def _recall(self, pose: FloatArray, pairs: int, state: PhysicsState | None = None) -> None:
        """Stand the robots at poses (N, 3) where contacts had accumulated the impulses of a state.

        Without a state they have none. ``pairs`` are those of the `_solve` that led there. Raises
        PhysimError where the contacts found at the poses are others.
        """
        self._stand(pose)
        self._solve(pairs)
        self._guard.take_rejected()
        self._arrays.read_pose()
        if state is not None:
            self._memory.write(state)

    # Pairs of bodies

    def _gather(self, touches: Touches) -> Pairs:
        """Pairs of bodies that touch by their parts, the robots at ``pose`` as last read."""
        if not len(touches.part):
            return self._no_pairs
        self._placed[: self._robots] = self._arrays.pose
        return pairs_of(*touches, self._among, self._placed)

    def _failures(self, pairs: Pairs, given: FloatArray, gain: float) -> NDArray[np.bool_]:
        """On which robots (N,) the solver failed, (0,) for none; sets the impulses of pairs."""
        found = self._arrays.velocity
        robots, failed = self._robots, np.empty(self._robots, dtype=np.bool_)
        any_has = failures(
            pairs, self._inertia, given, found, robots, self._bodies, gain, self._reach, failed
        )
        return failed if any_has else failed[:0]

    def _to_solve(self, key: IntArray) -> int:
        """How many contacts of robots and solids the engine has to solve where pairs touch."""
        return len(self._solid_keys(key)) if len(key) else 0

    def _solid_keys(self, key: IntArray) -> IntArray:
        """Keys of pairs in the numbering of robots and solids."""
        keys, pairs = np.empty_like(key), len(key)
        return keys[: put_solid_keys(key, pairs, self._bodies, self._solid, self._solids, keys)]
