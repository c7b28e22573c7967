"""Worlds run, judged and checked: the one place at which the search asks for runs."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor, Future, TimeoutError
from pathlib import Path

from physim.campaigns.falsify.robustness import Judged, judged
from physim.campaigns.one_run import one_line, ready
from physim.campaigns.pool import POLL_SECONDS, Job, LostError, OverdueError, begin
from physim.campaigns.spec import usual_limit
from physim.errors import WorldError
from physim.parts.controller import Controller
from physim.parts.registry import CONTROLLER, make_part
from physim.simulation.loop import Simulation
from physim.simulation.recorder import SaveAt
from physim.simulation.run import record_run
from physim.world import World
from physim.world.checks.check import check_world
from physim.world.file import parse_world

Evaluate = Callable[[Sequence[World]], Iterable[Judged]]
"""Runs worlds and judges them, in their order. Whoever asks may look at the first few only. Raises
`StoppedError`."""

NEEDED = SaveAt(every=1, tables=("contacts", "updates"))  # severity is of single steps


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
        return Judged(None, reason=one_line(error), refused=True)
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        return Judged(None, reason=one_line(error))
    try:
        with record_run(simulation, save=NEEDED, stop=stop) as record:
            if record.ended == "interrupted":
                raise StoppedError
            return judged(record)
    except (StoppedError, KeyboardInterrupt):
        raise
    except BaseException as error:
        return Judged(None, reason=one_line(error))


def in_this_process(stop: Callable[[], bool] = never) -> Evaluate:
    """Evaluate worlds one after the other."""

    def evaluate(worlds: Sequence[World]) -> Iterator[Judged]:
        return (judge_world(world, stop) for world in worlds)

    return evaluate


def by_executor(executor: Executor, world: World, stop: Callable[[], bool] = never) -> Evaluate:
    """Evaluate worlds by the workers of an executor; a run that one of them does not survive, or
    that takes too long, is one that broke off. All have controller and stages of ``world``."""
    code = world.controller.type

    def evaluate(worlds: Sequence[World]) -> Iterator[Judged]:
        jobs = (
            Job("a run", judge_text, (one.to_yaml(),), usual_limit(one), ready, code)
            for one in worlds
        )
        futures = [begin(executor, job) for job in jobs]
        try:
            for future in futures:
                yield _result(future, stop)
        finally:
            for future in futures:
                future.cancel()

    return evaluate


def judge_text(text: str, stop: Callable[[], bool] = never) -> Judged | None:
    """Run a world that is given as text, in a worker; None when it was stopped."""
    try:
        return judge_world(parse_world(text, check_controller=False), stop)
    except StoppedError:
        return None


def _result(future: Future[Judged | None], stop: Callable[[], bool]) -> Judged:
    while True:
        try:
            found = future.result(timeout=POLL_SECONDS)
        except TimeoutError:
            if stop():
                raise StoppedError from None
            continue
        except (LostError, OverdueError) as error:
            return Judged(None, reason=one_line(error))
        if found is None:
            raise StoppedError
        return found


Accepts = Callable[[World], str]
"""The first error of a world; empty where there is none."""


def accepted(controller: str | None = None) -> Accepts:
    """Ask the check; ``controller`` is the one that the command line named, if it did."""

    def accepts(world: World) -> str:
        with tempfile.TemporaryDirectory(prefix="physim-") as folder:
            file = Path(folder) / "world.yaml"
            world.save(file)
            errors = check_world(file, controller=controller).errors
        return errors[0].message if errors else ""

    return accepts
