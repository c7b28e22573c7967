"""Which contacts were due to a disturbance: the run is made again, with the same seed, without.

Sensing stages and disturbances are left out all together. A pair that does not touch then touched
because of them. One run tells this of one seed; how often it is so, runs of many seeds tell.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from physim.analysis.validation.rerun import run_again
from physim.contacts import Phase
from physim.errors import PhysimError, plural
from physim.record import Record
from physim.simulation.again import AgainError, simulation_again
from physim.units import joined

if TYPE_CHECKING:
    from physim.parts.controller import Controller
    from physim.simulation.loop import Simulation

MOST_NAMED = 6
"""Pairs that are named"""


@dataclass(frozen=True)
class Pair:
    """Two bodies that touched in the run."""

    a: int
    b: int
    time: float | None
    """[s] of their first contact without the disturbances; None where they do not touch then"""

    @property
    def words(self) -> str:
        """Whether the disturbances are to blame, in a sentence."""
        if self.time is None:
            return "Due to the disturbances: without them these two do not touch."
        return f"Without the disturbances these two touch, too, first at {self.time:.2f} s."


@dataclass(frozen=True)
class Undisturbed:
    """What of the contacts of a run is left without its sensing stages and disturbances."""

    without: tuple[str, ...]
    """names of these parts"""
    pairs: tuple[Pair, ...] = ()
    """every pair that touched; none where it is not known"""
    why_not: str = ""
    """why it is not known; empty where it is"""

    def sentences(self, names: Sequence[str], full: bool = False) -> Iterator[str]:
        """What is to be said of the pairs; ``names`` by body id."""
        parts = joined(self.without)
        if self.why_not:
            yield f"Whether contacts are due to {parts} is not known: {self.why_not}."
        due, not_due = (
            [one for one in self.pairs if (one.time is None) == is_due] for is_due in (True, False)
        )

        def listed(some: Sequence[Pair]) -> str:
            shown = some if full else some[:MOST_NAMED]
            said = [
                f"{names[one.a]} with {names[one.b]}"
                + ("" if one.time is None else f" (first at {one.time:.2f} s)")
                for one in shown
            ]
            more = len(some) - len(shown)
            return joined([*said, plural(more, "more pair")] if more else said)

        if due:
            yield (
                f"Due to {parts}: contacts of {listed(due)}. With the same seed, but without "
                f"{parts}, {'these do' if len(due) > 1 else 'this pair does'} not touch."
            )
        if not_due:
            yield f"Without {parts} these touch, too: {listed(not_due)}."


def disturbing(record: Record) -> tuple[str, ...]:
    """Names of sensing stages and disturbances of a run, those of the world first, each once."""
    stages = record.setup.stages
    named = [part.name for key in ("sensing", "disturbances") for part in stages[key]]
    given = [name for kind, name in record.given if kind in ("sensing stage", "disturbance")]
    return tuple(dict.fromkeys([*named, *given]))


def first_contacts(record: Record) -> dict[tuple[int, int], float]:
    """Time [s] of the first contact of each pair that touched, at a sample or between two."""
    found: dict[tuple[int, int], float] = {}
    for row in record.contacts[record.contacts["phase"] == Phase.BEGAN]:
        found.setdefault((int(row["a"]), int(row["b"])), float(row["step"] * record.dt))
    return found


def undisturbed(
    record: Record,
    *,
    controller: Controller | None = None,
    stop: Callable[[], bool] = lambda: False,
    progress: Callable[[Simulation, float], None] | None = None,
) -> Undisturbed | None:
    """Run a record again without sensing stages and disturbances: which pairs touch then, too?

    None where there were no such parts, or no contacts. A ``controller`` that came from Python has
    to be given again; what cannot be made again is told in ``why_not``.
    """
    names, touched = disturbing(record), first_contacts(record)
    if not names or not touched:
        return None
    try:
        simulation = simulation_again(record, controller=controller, disturbed=False)
        with run_again(record, simulation, stop=stop, progress=progress) as again:
            without = first_contacts(again)
    except AgainError as error:
        return Undisturbed(names, why_not=error.why)
    except PhysimError as error:
        return Undisturbed(names, why_not=str(error).splitlines()[0])
    return Undisturbed(names, tuple(Pair(*pair, without.get(pair)) for pair in touched))
