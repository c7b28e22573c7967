"""A world in which nothing is left to the seed but noise: every start is written down."""

from __future__ import annotations

from physim.world import World
from physim.world.layout.layout import lay_out
from physim.world.scene import Layout


def pinned(world: World, seed: int | None = None) -> tuple[World, Layout]:
    """The world with each robot by itself at the pose where ``seed`` puts it, and its layout.

    Without ``seed`` the world's own. Groups become robots one by one. Raises WorldError where the
    world cannot be run.
    """
    laid = lay_out(world, seed)
    robots = tuple(
        robot.model_copy(update={"pose": tuple(pose), "start": None})
        for robot, pose in zip(laid.world.robots, laid.start.tolist(), strict=True)
    )
    return laid.world.changed(robots=robots, start=None), laid
