"""The same world over many seeds: how often it is contact-free, and how sure that is; as JSON."""

from __future__ import annotations

import math
from dataclasses import dataclass

from physim.analysis.validation.validation import (
    CONTACTS,
    DISAGREE,
    FREE,
    Validation,
    json_text,
    plain,
)
from physim.errors import place_text, plural
from physim.statistics import clopper_pearson


@dataclass(frozen=True)
class SeedResult:
    """One seed of a study."""

    seed: int
    verdict: str
    code: int
    contacts: int
    grazes: int
    """contacts between two samples"""
    ended: str
    seconds: float
    """[s] simulated"""
    first: str
    """first contact in a few words; empty without one"""
    nearest: float | None
    """[m] smallest distance of an approach without contact; None when nothing came near"""
    finished: bool
    """all robots arrived"""
    missed: tuple[str, ...]
    """what the world expects of each run and did not get of this one"""

    @property
    def free(self) -> bool:
        """Whether the checks agree that nothing touched, at samples or between them."""
        return self.code != DISAGREE and not self.contacts and not self.grazes

    @classmethod
    def of(cls, seed: int, found: Validation) -> SeedResult:
        """Result of one seed."""
        first = ""
        touches = sorted((*found.contacts[:1], *found.grazes[:1]), key=lambda one: one.time)
        if touches:
            one = touches[0]
            names = found.names
            who = " and ".join(names[i] for i in one.responsible)
            x, y = one.place
            first = (
                f"{names[one.a]} and {names[one.b]} at {one.time:.2f} s, "
                f"{one.along or f'at {place_text(x, y, 4)}'}{who and f', responsible {who}'}"
            )
        near = found.near_misses.distances
        return cls(
            seed, found.verdict, found.code, len(found.contacts), len(found.grazes),
            found.run.ended, found.run.seconds, first, near[0].value if near else None,
            found.run.ended == "finished", tuple(one.key for one in found.missed),
        )  # fmt: skip


@dataclass(frozen=True)
class Rate:
    """A share of the runs of a study, and how sure it is."""

    runs: int
    of: int

    @property
    def share(self) -> float:
        """[-]"""
        return self.runs / self.of

    @property
    def interval(self) -> tuple[float, float]:
        """95 % Clopper-Pearson interval."""
        return clopper_pearson(self.runs, self.of)

    def words(self, what: str) -> str:
        """``9 of 10 runs WHAT = 90.0%, 95 % Clopper-Pearson interval 55.4% to 99.8%``.

        Both ends of the interval are rounded outward.
        """
        low, high = self.interval
        low, high = math.floor(low * 1e3 + 1e-9) / 1e3, math.ceil(high * 1e3 - 1e-9) / 1e3
        return (
            f"{self.runs} of {plural(self.of, 'run')} {what} = {self.share:.1%}, "
            f"95 % Clopper-Pearson interval {low:.1%} to {high:.1%}"
        )


@dataclass(frozen=True)
class SeedStudy:
    """Results of all seeds, in the order of seeds; of the first ones when it was interrupted."""

    world: str
    results: tuple[SeedResult, ...]
    asked: int
    """number of seeds that it was to have"""
    draws: str = ""
    """what the seed draws, in words"""

    @property
    def interrupted(self) -> bool:
        """Whether seeds are missing."""
        return len(self.results) < self.asked

    @property
    def free(self) -> int:
        """Number of contact-free runs whose checks agree."""
        return sum(one.free for one in self.results)

    @property
    def finished(self) -> int:
        """Number of runs in which all robots arrived, and whose checks agree."""
        return sum(one.finished and one.code != DISAGREE for one in self.results)

    @property
    def rates(self) -> tuple[Rate, Rate]:
        """Of contact-free runs, and of those that finished."""
        return Rate(self.free, len(self.results)), Rate(self.finished, len(self.results))

    @property
    def code(self) -> int:
        """Exit code: 3 if checks disagree in any run, else 1 if any had a contact or was not as
        expected, else 0."""
        codes = [one.code for one in self.results]
        return DISAGREE if DISAGREE in codes else CONTACTS if CONTACTS in codes else FREE


def seed_line(one: SeedResult) -> str:
    """One line of the table of seeds."""
    near = "" if one.nearest is None else f", nearest approach without contact {one.nearest:.3f} m"
    tail = f": {one.first}" if one.first else near
    return f"seed {one.seed:>6}  {one.ended} after {one.seconds:.2f} s  {one.verdict}{tail}"


def seeds_text(study: SeedStudy) -> str:
    """Rates of contact-free and of finished runs with their intervals, and the verdict."""
    count = len(study.results)
    bad = [str(one.seed) for one in study.results if one.code == CONTACTS and not one.free]
    wrong = [str(one.seed) for one in study.results if one.code == DISAGREE]
    lines = [
        f"{study.world}: {rate.words(what)}"
        for rate, what in zip(study.rates, ("contact-free", "finished"), strict=True)
    ]
    if study.draws:
        lines.append(f"over {plural(count, 'seed')}, which draw {study.draws}")
    if study.interrupted:
        lines.append(f"interrupted: {study.asked - count} of {study.asked} seeds were not run")
    if bad:
        lines.append(f"contacts with seeds {', '.join(bad)}")
    for key in sorted({key for one in study.results for key in one.missed} - {"contacts"}):
        seeds = ", ".join(str(one.seed) for one in study.results if key in one.missed)
        lines.append(f"not as expected, {key}: with seeds {seeds}")
    if wrong:
        lines.append(f"checks disagree with seeds {', '.join(wrong)}")
    return "\n".join(lines) + "\n"


INTERRUPTED = 130


def json_of_seeds(study: SeedStudy) -> str:
    """JSON of a study over seeds."""
    free, finished = study.rates
    return json_text(
        {
            "format": "physim-validation-seeds",
            "version": 2,
            "world": study.world,
            "seeds_asked": study.asked,
            "interrupted": study.interrupted,
            "runs": len(study.results),
            "draws": study.draws,
            "contact_free": study.free,
            "rate": free.share,
            "interval_95": list(free.interval),
            "finished": study.finished,
            "finished_rate": finished.share,
            "finished_interval_95": list(finished.interval),
            "exit_code": INTERRUPTED if study.interrupted else study.code,
            "seeds": plain(study.results),
        }
    )
