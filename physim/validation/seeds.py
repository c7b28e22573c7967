"""The same world over many seeds: how often it is contact-free, and how sure that is."""

from __future__ import annotations

from dataclasses import dataclass

from physim.errors import plural
from physim.validation.contact_report import ContactReport, GrazeReport
from physim.validation.validation import CONTACTS, DISAGREE, FREE, Validation

CONFIDENCE = 0.95


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

    @classmethod
    def of(cls, seed: int, found: Validation) -> SeedResult:
        """Result of one seed."""
        first = ""
        touches: list[ContactReport | GrazeReport] = [*found.contacts[:1], *found.grazes[:1]]
        touches.sort(key=lambda one: one.time)
        if touches:
            one = touches[0]
            names = [body.name for body in found.run.bodies]
            who = " and ".join(names[i] for i in one.responsible)
            first = (
                f"{names[one.a]} and {names[one.b]} at {one.time:.2f} s near "
                f"({one.place[0]:.1f}, {one.place[1]:.1f}), responsible {who}"
            )
        near = found.near_misses.distances
        return cls(
            seed, found.verdict, found.code, len(found.contacts), len(found.grazes),
            found.run.ended,
            found.run.seconds, first, near[0].value if near else None,
        )  # fmt: skip


@dataclass(frozen=True)
class SeedStudy:
    """Results of all seeds, in the order of seeds; of the first ones when it was interrupted."""

    world: str
    results: tuple[SeedResult, ...]
    asked: int
    """number of seeds that it was to have"""

    @property
    def interrupted(self) -> bool:
        """Whether seeds are missing."""
        return len(self.results) < self.asked

    @property
    def free(self) -> int:
        """Number of contact-free runs whose checks agree."""
        return sum(one.code == FREE for one in self.results)

    @property
    def rate(self) -> float:
        """[-] share of contact-free runs."""
        return self.free / len(self.results)

    @property
    def interval(self) -> tuple[float, float]:
        """95 % Clopper-Pearson interval of the rate."""
        return clopper_pearson(self.free, len(self.results))

    @property
    def code(self) -> int:
        """Exit code: 3 if checks disagree in any run, else 1 if any had a contact, else 0."""
        codes = [one.code for one in self.results]
        return DISAGREE if DISAGREE in codes else CONTACTS if CONTACTS in codes else FREE


def clopper_pearson(successes: int, trials: int) -> tuple[float, float]:
    """Exact two-sided interval of a proportion at `CONFIDENCE` (Clopper and Pearson 1934).

    Errs to the wide side: it covers the true rate with at least that probability.
    """
    from scipy.stats import beta

    tail = (1.0 - CONFIDENCE) / 2.0
    low, high = 0.0, 1.0
    if successes > 0:
        low = float(beta.ppf(tail, successes, trials - successes + 1))
    if successes < trials:
        high = float(beta.ppf(1.0 - tail, successes + 1, trials - successes))
    return low, high


def seed_line(one: SeedResult) -> str:
    """One line of the table of seeds."""
    near = "" if one.nearest is None else f", nearest approach without contact {one.nearest:.3f} m"
    tail = f": {one.first}" if one.first else near
    return f"seed {one.seed:>6}  {one.ended} after {one.seconds:.2f} s  {one.verdict}{tail}"


def seeds_text(study: SeedStudy) -> str:
    """Rate of contact-free runs with its interval, and the verdict."""
    low, high = study.interval
    count = len(study.results)
    bad = [str(one.seed) for one in study.results if one.code == CONTACTS]
    wrong = [str(one.seed) for one in study.results if one.code == DISAGREE]
    lines = [
        f"{study.world}: {study.free} of {plural(count, 'run')} contact-free = {study.rate:.1%}, "
        f"95 % Clopper-Pearson interval {low:.1%} to {high:.1%}",
    ]
    if study.interrupted:
        lines.append(f"interrupted: {study.asked - count} of {study.asked} seeds were not run")
    if bad:
        lines.append(f"contacts with seeds {', '.join(bad)}")
    if wrong:
        lines.append(f"checks disagree with seeds {', '.join(wrong)}")
    return "\n".join(lines) + "\n"
