"""Many copies of a world as one Gymnasium vector environment, in one process or in several."""

from __future__ import annotations

import multiprocessing
from collections.abc import Sequence
from multiprocessing.connection import Connection
from multiprocessing.sharedctypes import RawArray
from typing import Any, NamedTuple

import numpy as np
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from physim.errors import PhysimError
from physim.learning.episode import Episodes
from physim.learning.task import WEIGHTS, Task
from physim.world.layout.scene_builder import build_scene


class Shared(NamedTuple):
    """Memory that all processes read and write: R rows, N for each copy."""

    action: Any
    """(R, columns) of 4 bytes"""
    seen: Any
    """(R, S) of 4 bytes"""
    told: Any
    """(R, 3 + T) of 8 bytes: reward, terminated, truncated, terms"""

    def arrays(self, rows: int) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
        """The same as arrays."""
        action, seen = (np.frombuffer(one, np.float32).reshape(rows, -1) for one in self[:2])
        return action, seen, np.frombuffer(self.told, np.float64).reshape(rows, -1)


class Block:
    """Copies ``first`` to ``end`` - 1 of a task, which write their rows."""

    def __init__(self, task: Task, many: int, first: int, end: int, shared: Shared) -> None:
        self.copies = [Episodes(task, stride=many) for _ in range(first, end)]
        robots = self.copies[0].simulation.scene.robots
        self.is_over = [False] * len(self.copies)
        arrays = shared.arrays(many * robots)
        self.rows = [
            [one[k * robots : (k + 1) * robots] for one in arrays] for k in range(first, end)
        ]

    def reset(self, seeds: Sequence[int]) -> None:
        """Begin an episode in each copy."""
        self.is_over = [False] * len(self.copies)
        for copy, seed, (_, seen, told) in zip(self.copies, seeds, self.rows, strict=True):
            seen[:], told[:] = copy.reset(seed), 0.0

    def step(self) -> None:
        """Take the actions; a copy whose episode was over begins another one."""
        for k, (copy, (action, seen, told)) in enumerate(zip(self.copies, self.rows, strict=True)):
            if self.is_over[k]:
                seen[:], told[:], self.is_over[k] = copy.reset(), 0.0, False
                continue
            found = copy.step(action)
            seen[:], told[:, 0], told[:, 3:] = found.seen, found.reward, found.terms
            told[:, 1], told[:, 2] = found.terminated, found.truncated
            self.is_over[k] = found.terminated or found.truncated


def work(pipe: Connection, *block: Any) -> None:
    """Serve a block in a process of its own: seeds reset it, None makes a step, "" ends it."""
    copies = Block(*block)
    try:
        while (asked := pipe.recv()) != "":
            try:
                copies.step() if asked is None else copies.reset(asked)
                pipe.send(None)
            except PhysimError as error:
                pipe.send(error)
    except (EOFError, KeyboardInterrupt):
        pass


class ManyEnv(VectorEnv[NDArray[np.float32], NDArray[np.float32], NDArray[Any]]):
    """A Gymnasium ``VectorEnv``, which `physim.vector_env` makes."""

    def __init__(self, task: Task, many: int, workers: int) -> None:
        for name, value, least in (("many", many, 1), ("workers", workers, 0)):
            if type(value) is not int or value < least:
                raise PhysimError(f"{name} = {value!r}; it must be a whole number from {least} on")
        scene = build_scene(task.world)
        self.task, self.many = task, many
        self.num_envs, self._seed = many * scene.robots, scene.seed
        self.metadata = {"autoreset_mode": AutoresetMode.NEXT_STEP}
        self.single_observation_space = Box(-np.inf, np.inf, (task.size,), np.float32)
        self.single_action_space = Box(-1.0, 1.0, (scene.columns,), np.float32)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        sizes = ("f", scene.columns), ("f", task.size), ("d", 3 + len(WEIGHTS))
        shared = Shared(*(RawArray(kind, self.num_envs * size) for kind, size in sizes))
        self._action, self._seen, self._told = shared.arrays(self.num_envs)
        ends = np.linspace(0, many, min(workers, many) + 1).astype(int).tolist()
        self._ends = list(zip(ends[:-1], ends[1:], strict=True))
        self._block: Block | None = None if workers else Block(task, many, 0, many, shared)
        self._pipes: list[Connection] = []
        self._processes: list[Any] = []
        for first, end in self._ends if workers else ():
            here, there = multiprocessing.Pipe()
            process = multiprocessing.Process(
                target=work, args=(there, task, many, first, end, shared), daemon=True
            )
            process.start()
            there.close()
            self._pipes.append(here)
            self._processes.append(process)

    def reset(
        self,
        *,
        seed: int | Sequence[int] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begin an episode in each copy; see `physim.vector_env`."""
        first = self._seed if seed is None else seed
        seeds = [first + k for k in range(self.many)] if isinstance(first, int) else list(first)
        if len(seeds) != self.many:
            raise PhysimError(f"seed lists {len(seeds)}; one for each of {self.many} copies")
        self._seed = max(seeds) + 1
        if self._block is not None:
            self._block.reset(seeds)
        self._all([seeds[first:end] for first, end in self._ends])
        return self._seen.copy(), {}

    def step(
        self, actions: NDArray[Any]
    ) -> tuple[NDArray[np.float32], NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """Hold the actions (R, columns) for a period; infos hold the ``terms`` (R,) by name."""
        self._action[:] = actions
        if self._block is not None:
            self._block.step()
        self._all([None] * len(self._pipes))
        told = self._told.copy()
        terms = dict(zip(WEIGHTS, told[:, 3:].T, strict=True))
        over, cut = told[:, 1] > 0.0, told[:, 2] > 0.0
        return self._seen.copy(), told[:, 0], over, cut, {"terms": terms}

    def _all(self, asked: Sequence[Any]) -> None:
        """Ask all processes and wait for them. Raises what one of them raised."""
        for pipe, one in zip(self._pipes, asked, strict=False):
            pipe.send(one)
        try:
            answers = [pipe.recv() for pipe in self._pipes]
        except EOFError:
            raise PhysimError("a worker of the environment ended before its work did") from None
        for error in answers:
            if error is not None:
                raise error

    def close_extras(self, **kwargs: Any) -> None:
        """End the processes."""
        for pipe, process in zip(self._pipes, self._processes, strict=True):
            pipe.send("")
            process.join()
            pipe.close()
        self._pipes, self._processes = [], []
