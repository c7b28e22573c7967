"""A pass of shrinking: the run starts later, from where all robots were then.

A robot has no inertia: it moves as it is told from the first step on, so where it was is all that a
start needs of its motion. What else a run carries along begins anew: modes and what controllers
remember, commands held, the states of stages, noise by its step. So a later start is another run,
taken like any simpler world only where it fails in the same way; where the failure needs what came
before, none is.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator

import numpy as np

from physim.campaigns.falsify.passes import State, Tree
from physim.campaigns.falsify.robustness import Moment
from physim.campaigns.falsify.starts import Starts
from physim.errors import WorldError
from physim.world import World
from physim.world.layout.layout import lay_out
from physim.world.layout.scene_builder import build_scene

MARGIN, MOST = 1.5, 0.9
"""[-] of the time that was left until the contact, and of that of the contact: the new run takes as
long, so that the same failure may come a little later and the run is shorter all the same"""


def later(state: State) -> Iterator[Tree]:
    """Start as shortly before the first contact as can be, then earlier ones.

    Starts keep the distances that starts of the search do: what begins all but in contact tells
    nobody anything.
    """
    while True:
        tree = state.tree
        try:
            world = World(**tree)
            starts = starts_of(world)
        except WorldError:  # as where robots stand closer than a start may be judged
            return
        for moment in state.judged.before:
            poses = np.array(moment.poses)
            if len(tree["robots"]) == len(poses) and starts.fit(poses):
                yield _from(state, world, moment)
            if state.tree is not tree:
                break
        else:
            return


def starts_of(world: World) -> Starts:
    """Where the robots of a world may start, its own starts first. Raises WorldError."""
    return Starts(lay_out(world), [None] * len(world.robots))


def _from(state: State, world: World, moment: Moment) -> Tree:
    """The tree of a world in which robots start where they were at a moment."""
    touched = state.judged.touched
    assert touched is not None
    tree = copy.deepcopy(state.tree)
    step = tree["time"]["step"]
    end = min(MARGIN * (touched.time - moment.time), MOST * touched.time)
    tree["time"]["duration"] = round(max(1, math.ceil(end / step - 1e-9)) * step, 10)
    tree.pop("start", None)
    for robot, (x, y, heading) in zip(tree["robots"], moment.poses, strict=True):
        robot.pop("start", None)
        robot["pose"] = [x, y, math.remainder(heading, 2.0 * math.pi)]
    if world.formation is not None and world.formation.spacing == "initial":
        tree["formation"]["spacing"] = build_scene(world).formation.lead.tolist()
    return tree
