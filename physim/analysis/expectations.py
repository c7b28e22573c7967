"""What a world says a run must show (its ``expect`` block), held against what the run showed."""

from __future__ import annotations

from typing import NamedTuple

from physim.analysis.metrics import Figures
from physim.analysis.metrics.metric import section
from physim.record import Record
from physim.world import Expectation

Figure = bool | float | int | None


class Held(NamedTuple):
    """One expectation and whether the run met it."""

    key: str
    wanted: Figure
    got: Figure
    """[m] for distances; None where the run does not have it, which counts as held, or does not
    show it, as one that was cut short whether all arrive"""
    held: bool

    def __str__(self) -> str:
        """``held: 2 <= 2``: whether it held, what was found, the bound."""
        if self.key == "finished" and self.got is None:
            return "NOT HELD: the run was cut short, and does not show whether all arrive"
        sign = "=" if self.key == "finished" else ">=" if self.key.startswith("min_") else "<="
        digits = 4  # as many as a bound that was missed differs in
        while not self.held and digits < 17 and self._text(self.got, digits) == self._text(
            self.wanted, digits
        ):  # fmt: skip
            digits += 1
        got, wanted = (self._text(one, digits) for one in (self.got, self.wanted))
        return f"{'held' if self.held else 'NOT HELD'}: {got} {sign} {wanted}"

    def _text(self, value: Figure, digits: int) -> str:
        if value is None:
            return "n/a"
        if isinstance(value, bool):
            return "true" if value else "false"
        return str(value) if self.key == "contacts" else f"{value:.{digits}g} m"


def expectations(record: Record) -> list[Held]:
    """Expectations of the record's world, in a fixed order; empty when it has none.

    ``contacts`` is the largest number of contact episodes and contacts between two samples
    together: touching is a contact, wherever the samples fall. ``min_distance``,
    ``min_boundary_distance`` and ``max_distance`` are bounds [m] over all physics steps,
    ``finished`` says whether all robots arrive, which a run that was cut short does not show: it
    does not hold then. A distance that a run does not have (one robot, no walls) holds any bound.
    """
    cut = record.ended in ("running", "interrupted") and record.steps_run < record.steps_planned
    run, wanted = Figures(record), section(record, "expect", Expectation) or Expectation()
    found: dict[str, Figure] = {
        "contacts": len(run.episodes) + len(run.grazes),
        "min_distance": run.value("shortest_distance"),
        "min_boundary_distance": run.value("shortest_boundary_distance"),
        "max_distance": run.value("farthest_distance"),
        "finished": None if cut else run.value("finished"),
    }
    held = []
    for key, got in found.items():
        if (bound := getattr(wanted, key)) is None:
            continue
        if key == "finished":
            holds = got is bound
        else:
            holds = got is None or (got >= bound if key.startswith("min_") else got <= bound)
        held.append(Held(key, bound, got, holds))
    return held
