"""Worlds run and judged: the one place at which the search asks for runs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

from physim.campaigns.falsify.robustness import Judged, judged
from physim.errors import PhysimError, WorldError
from physim.parts.controller import Controller
from physim.parts.registry import CONTROLLER, make_part
from physim.simulation.loop import Simulation
from physim.simulation.recorder import SaveAt
from physim.simulation.run import record_run
from physim.world import World

Evaluate = Callable[[Sequence[World]], Iterable[Judged]]
"""Runs worlds and judges them, in their order. Whoever asks may look at the first few only. Raises
`StoppedError`."""

CONTACTS_ALONE = SaveAt(tables=("contacts",))


class StoppedError(Exception):
    """The search was told to stop in the middle of a run."""


def never() -> bool:
    """Do not stop."""
    return False


def controller_of(world: World) -> Controller:
    """The controller that a world names: whoever read the world trusted it."""
    made: Controller = make_part(
        CONTROLLER, world.controller.type, world.controller.settings, trusted=True
    )
    return made


def judge_world(world: World, stop: Callable[[], bool] = never) -> Judged:
    """Run a world in this process and judge the run; raises StoppedError when ``stop`` says so."""
    try:
        simulation = Simulation(world, controller=controller_of(world))
    except WorldError as error:
        return Judged(None, reason=first_line(error), refused=True)
    except PhysimError as error:
        return Judged(None, reason=first_line(error))
    try:
        with record_run(simulation, save=CONTACTS_ALONE, stop=stop) as record:
            if record.ended == "interrupted":
                raise StoppedError
            return judged(record)
    except PhysimError as error:
        return Judged(None, reason=first_line(error))


def in_this_process(stop: Callable[[], bool] = never) -> Evaluate:
    """Evaluate worlds one after the other."""

    def evaluate(worlds: Sequence[World]) -> Iterator[Judged]:
        return (judge_world(world, stop) for world in worlds)

    return evaluate


def first_line(error: Exception) -> str:
    """What an error says first."""
    return next(iter(str(error).splitlines()), type(error).__name__)
