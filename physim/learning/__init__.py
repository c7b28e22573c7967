"""Worlds as environments for reinforcement learning; needs ``pip install "physim[rl]"``.

`env` is a PettingZoo environment in which every robot is an agent, `single_env` a Gymnasium one
with one robot as the agent, `vector_env` many copies of a world at once. All three see and do the
same, which `Task` says.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from physim.errors import MissingExtraError
from physim.learning.task import Task, task_of

if TYPE_CHECKING:
    from physim.learning.parallel import RobotsEnv
    from physim.learning.single import RobotEnv
    from physim.learning.vector import ManyEnv
    from physim.parts.controller import Controller
    from physim.world import World


def env(
    world: World | str,
    *,
    period: float = 0.1,
    others: int = 4,
    walls: int = 4,
    ahead: Sequence[float] = (1.0, 2.0),
    rewards: Mapping[str, float] | None = None,
    contact_ends: bool = False,
    max_cycles: int | None = None,
    render_mode: str | None = None,
    record: str | os.PathLike[str] | None = None,
    **changes: Any,
) -> RobotsEnv:
    """A PettingZoo ``ParallelEnv`` of a world: every robot is an agent, ``robot_0`` and so on.

    ``world`` is a name, a file or a `World`; ``changes`` are those of `World.changed`. An action is
    held for ``period`` [s]. Observations tell of the nearest ``others`` robots and ``walls``, and
    of points ``ahead`` [m] on the path, as one array of 32 bits: the fields of `Arrays` one behind
    the other, where `Task.columns` says. Actions are shares, -1 to 1, of the greatest v and omega
    of the robot, and of the lateral speed in a world with an omnidirectional robot.

    The reward of a robot is the sum of its terms times their weights, which ``rewards`` changes by
    name: ``progress`` [m] along its path (1), ``contact`` with bodies that move, as a share of the
    period (-1), ``boundary``, contact with walls, likewise (-1), ``arrival``, once an episode (1),
    ``time`` [s] until arrived (0), ``smoothness``, squares of the changes of its action (0). The
    terms stand in the infos.

    An episode is terminated when all have arrived, with ``contact_ends`` also when some robot
    touches something, and truncated at the world's duration or after ``max_cycles`` actions.
    ``reset(seed=…)`` draws the starts anew; without a seed the next one is taken, at first the
    world's own. With ``render_mode`` "rgb_array" `render` gives a picture (720, 1280, 3). With a
    folder ``record`` each episode goes to a file ``episode_SEED.h5`` there.

    Raises MissingExtraError without the extra, PhysimError for what it cannot take.
    """
    try:
        from physim.learning.parallel import RobotsEnv
    except ModuleNotFoundError:
        raise MissingExtraError("physim.env", "rl") from None
    task = task_of(world, changes, period, others, walls, ahead, rewards, contact_ends, max_cycles)
    return RobotsEnv(task, render_mode, record)


def single_env(
    world: World | str,
    robot: int | str = 0,
    *,
    controller: Controller | str | None = None,
    period: float = 0.1,
    others: int = 4,
    walls: int = 4,
    ahead: Sequence[float] = (1.0, 2.0),
    rewards: Mapping[str, float] | None = None,
    contact_ends: bool = False,
    max_cycles: int | None = None,
    render_mode: str | None = None,
    record: str | os.PathLike[str] | None = None,
    **changes: Any,
) -> RobotEnv:
    """A Gymnasium ``Env`` of a world: one ``robot``, by number or name, is the agent.

    The world's controller drives the other robots, or ``controller`` in its place, an object or a
    name. An episode is terminated when the agent has arrived. All else, and what is raised, as for
    `env`.
    """
    try:
        from physim.learning.single import RobotEnv
    except ModuleNotFoundError:
        raise MissingExtraError("physim.single_env", "rl") from None
    task = task_of(world, changes, period, others, walls, ahead, rewards, contact_ends, max_cycles)
    return RobotEnv(task, robot, controller, render_mode, record)


def vector_env(
    world: World | str,
    many: int = 8,
    *,
    workers: int = 0,
    period: float = 0.1,
    others: int = 4,
    walls: int = 4,
    ahead: Sequence[float] = (1.0, 2.0),
    rewards: Mapping[str, float] | None = None,
    contact_ends: bool = False,
    max_cycles: int | None = None,
    **changes: Any,
) -> ManyEnv:
    """A Gymnasium ``VectorEnv`` of ``many`` copies of a world of N robots: ``many`` times N rows.

    Row N k + i is Robot i of copy k, so one policy drives them all. The copies run in this process,
    or share out among ``workers`` processes, with the same results. ``reset(seed=s)`` gives copy k
    the seed s + k, a list each its own. When an episode of a copy is over, the next step begins
    another one, of a seed that no copy had, and ignores the actions. All else, and what is raised,
    as for `env`.
    """
    try:
        from physim.learning.vector import ManyEnv
    except ModuleNotFoundError:
        raise MissingExtraError("physim.vector_env", "rl") from None
    task = task_of(world, changes, period, others, walls, ahead, rewards, contact_ends, max_cycles)
    return ManyEnv(task, many, workers)


__all__ = ["Task", "env", "single_env", "vector_env"]
