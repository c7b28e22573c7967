"""The engine with its robots."""

from __future__ import annotations

from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.simulation.engine.guard import Guard, Touches
from physim.simulation.engine.space import BodyArrays, Hosted, parking, rounds, stepper
from physim.simulation.engine.state import ContactMemory, Impulses, no_impulses


class Engine:
    """A space that holds N robots, of which ``arrays`` reads and writes poses and velocities."""

    def __init__(
        self, hosted: Hosted, shapes: Shapes, walls: Shapes, guard: Guard, dt: float
    ) -> None:
        """Take a space in which the robots stand at rest; steps are of ``dt`` [s]."""
        self.arrays = BodyArrays(hosted.space, len(hosted.bodies))
        self.guard = guard
        self._space = hosted.space
        self._memory = ContactMemory(hosted)
        self._parking = parking(shapes, walls)
        self._step = stepper(hosted.space, dt)

    @property
    def remembers(self) -> bool:
        """Whether the last step found contacts, if only false ones: the next begins from them."""
        return bool(self.guard.reported)

    def step(self, pairs: int = 0) -> Touches:
        """Move all bodies, find the contacts at their new poses and solve them; the true ones.

        ``pairs`` of bodies touched before: so much there is to solve.
        """
        self._space.iterations = rounds(pairs)
        self._step()
        return self.guard.take()

    def rejected(self) -> IntArray:
        """Return the parts (M, 2) of the false contacts since the last call."""
        return self.guard.take_rejected()

    def stand(self, pose: FloatArray) -> None:
        """Put all robots at poses (N, 3), at rest; the engine forgets the contacts it had."""
        while self.remembers:  # twice, if the easing of overlaps leads from parking into contact
            self._put(self._parking)
            self.step()
        self._put(pose)
        self.rejected()

    def impulses(self) -> Impulses:
        """Return what contacts have accumulated in the last step."""
        return self._memory.read() if self.remembers else no_impulses()

    def recall(self, pose: FloatArray, pairs: int, impulses: Impulses | None) -> None:
        """Stand the robots at poses (N, 3) where contacts had accumulated impulses, if known.

        ``pairs`` are those of the `step` that led there.

        Raises PhysimError where the contacts found at the poses are others.
        """
        self.stand(pose)
        self.step(pairs)
        self.rejected()
        self.arrays.read_pose()
        if impulses is not None:
            self._memory.write(impulses)

    def _put(self, pose: FloatArray) -> None:
        self.arrays.velocity[:] = 0.0
        self.arrays.write_velocity()
        self.arrays.pose[:] = pose
        self.arrays.write_pose()
