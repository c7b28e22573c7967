"""An episode after the other of one simulation: actions in, observations and rewards out.

Everything is an array with a row for each agent; the environments give it the forms of their
libraries.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.drawing.video import frame_at
from physim.errors import PhysimError
from physim.geometry.shapes import FloatArray, IntArray
from physim.learning.task import WEIGHTS, Task
from physim.parts.controller import Controller, Decisions
from physim.parts.drive import ANY
from physim.simulation.loop import Simulation
from physim.simulation.observation import View
from physim.simulation.recorder import Recorder
from physim.simulation.run import recording
from physim.simulation.team import Team
from physim.world.group import Driver


class Outcome(NamedTuple):
    """What came of an action of A agents."""

    seen: NDArray[np.float32]
    """(A, S) what they may know after it"""
    reward: FloatArray
    """(A,)"""
    terms: FloatArray
    """(A, T) of the reward, in the order of `WEIGHTS`"""
    terminated: bool
    truncated: bool


class Steered:
    """Drives robots as it is told from outside, by ``command``."""

    drives = (ANY,)

    def __init__(self, period: float) -> None:
        self.period = period
        self.command = np.zeros((0, 2))
        """(N, columns) v [m/s], omega [rad/s], lateral [m/s]"""

    def decide_all(self, view: View, due: IntArray, memory: dict[str, NDArray[Any]]) -> Decisions:
        """Hold the commands for a period."""
        return Decisions.of(due, self.command[due], self.period)


def rendering(task: Task) -> dict[str, Any]:
    """What an environment tells of its pictures: one an action makes a film in real time."""
    return {"render_modes": ["rgb_array"], "render_fps": max(1, round(1.0 / task.period))}


class Mixed(Team):
    """Controllers of a world, and some robots told what to do from outside."""

    drives = (ANY,)


class Episodes:
    """Episodes of a task, each begun by `reset`.

    ``agents`` are the robots that the actions drive, all where it is None; the others are driven by
    ``controller`` or the world's own. ``stride`` is from the seed of an episode to that of the next
    where none is given.
    """

    def __init__(
        self,
        task: Task,
        agents: Sequence[int] | None = None,
        controller: Controller | str | None = None,
        render_mode: str | None = None,
        record: str | os.PathLike[str] | None = None,
        stride: int = 1,
    ) -> None:
        """Make the simulation. Raises PhysimError, and what `Simulation` raises."""
        if render_mode not in (None, "rgb_array"):
            raise PhysimError(f"render_mode = {render_mode!r}; allowed: None, rgb_array")
        self.task, self.stride, self.max_cycles = task, stride, task.max_cycles
        self.folder = None if record is None else Path(record)
        self.steered = Steered(task.period)
        if agents is None:
            self.simulation = Simulation(task.world, controller=self.steered)
        else:
            plain = Simulation(task.world, controller=controller)
            rest = [
                (one, driver._replace(robots=tuple(set(driver.robots) - set(agents))))
                for one, driver in plain.parts.driving
            ]
            mine = self.steered, Driver("steered", {}, tuple(agents), (), False)
            team = Mixed([one for one in rest if one[1].robots] + [mine])
            self.simulation = Simulation(plain.scene, controller=team)
        scene = self.simulation.scene
        self.robots = tuple(range(scene.robots) if agents is None else agents)
        self.agents = slice(None) if agents is None else np.array(agents)
        self.weights = np.array(task.weights)
        self.columns, self.next_seed = scene.columns, scene.seed
        self.recorder: Recorder | None = None
        self._begin()

    def reset(self, seed: int | None = None) -> NDArray[np.float32]:
        """Begin an episode of a seed, or of the next one; what the agents (A, S) know at first."""
        self.stop_recording("interrupted")
        seed = self.next_seed if seed is None else int(seed)
        self.next_seed = seed + self.stride
        self.simulation.reset(seed=seed)
        if self.folder is not None:
            self.folder.mkdir(parents=True, exist_ok=True)
            file = self.folder / f"episode_{seed}.h5"
            self.recorder = recording(self.simulation, path=file, overwrite=True)
            self.simulation.look_on(self.recorder)
        self._begin()
        return self._seen()

    def _begin(self) -> None:
        scene, agents = self.simulation.scene, self.agents
        self.cycles, self.action = 0, np.zeros((len(self.robots), self.columns))
        self.limits = scene.limits[agents]
        curvature = scene.curvature[agents]
        turn = np.where(np.isinf(curvature), 0.0, curvature)
        self.turn = turn if turn.any() else None
        self.arrived = np.zeros(len(self.robots), np.bool_)
        self.left = self._left()

    def step(self, action: NDArray[Any]) -> Outcome:
        """Hold an action (A, columns), shares of what is greatest, for a period."""
        simulation, agents, task = self.simulation, self.agents, self.task
        action = np.asarray(action, np.float64)
        if action.shape != self.action.shape or not np.isfinite(action).all():
            raise PhysimError(
                f"action {action.tolist()}; it must be finite numbers of the shape "
                f"{self.action.shape[1:]} for each agent"
            )
        action = np.clip(action, -1.0, 1.0)
        command = action * self.limits
        if self.turn is not None:
            most = np.abs(command[:, 0]) * self.turn
            bent = np.clip(command[:, 1], -most, most)
            command[:, 1] = np.where(self.turn > 0.0, bent, command[:, 1])
        terms = np.zeros((len(action), len(WEIGHTS)))
        if self.recorder is None and len(action) == simulation.scene.robots:
            simulation.step(command, steps=task.held)  # quicker than by a decision
        else:
            self.steered.command = np.zeros((simulation.scene.robots, self.columns))
            self.steered.command[agents] = command
            simulation.step(steps=task.held)
        bodies = simulation.scene.moving
        for rows in simulation.met:
            a, b = rows["a"], rows["b"]
            is_wall, now = b >= bodies, np.zeros((2, bodies))
            now[is_wall.astype(np.int64), a] = 1.0
            now[0, b[~is_wall]] = 1.0
            terms[:, 1:3] += now[:, agents].T
        left, arrived = self._left(), simulation.arrived[agents]
        terms[:, 0] = np.abs(self.left) - np.abs(left)
        terms[:, 1:3] /= task.held
        terms[:, 3] = arrived & ~self.arrived
        terms[:, 4] = task.period * ~arrived
        terms[:, 5] = np.square(action - self.action).sum(axis=1)
        self.left, self.action, self.cycles = left, action, self.cycles + 1
        self.arrived |= arrived
        ended = bool(arrived.all())
        stopped = ended or (task.contact_ends and bool(terms[:, 1:3].any()))
        cut = not stopped and self.cycles >= self.max_cycles
        if stopped or cut:
            is_cut_short = self.cycles * task.held + task.held <= simulation.scene.steps
            self.stop_recording(
                "finished" if simulation.finished
                else "interrupted" if is_cut_short else "duration"
            )  # fmt: skip
        return Outcome(self._seen(), terms @ self.weights, terms, stopped, cut)

    def picture(self) -> NDArray[np.uint8]:
        """Picture (720, 1280, 3) of the present sample, as films show it."""
        one = recording(self.simulation)
        one.start(self.simulation)
        one.close("interrupted")
        one.finish("interrupted")
        return frame_at(one.writer.record(), self.simulation.time)

    def stop_recording(self, ended: str) -> None:
        """Close the record of the episode, if there is one."""
        recorder, self.recorder, self.simulation.observers = self.recorder, None, []
        if recorder is not None:
            recorder.close(ended)
            recorder.finish(ended)

    def _left(self) -> FloatArray:
        scene, agents = self.simulation.scene, self.agents
        return np.asarray(scene.stop_station[agents] - self.simulation.now.station[agents])

    def _seen(self) -> NDArray[np.float32]:
        task = self.task
        found = self.simulation.arrays(task.others, task.walls, task.ahead)
        many = len(self.robots)
        rows = [field[self.agents].reshape(many, -1) for field in found]
        return np.concatenate(rows, axis=1, dtype=np.float32)
