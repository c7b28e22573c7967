"""Event-triggered updates (14) against fixed periods, and beta from 0.1 to 0.9.

The first minute of the ten robots, whose headings are random, with thresholds so low that robots
"only need to take collision avoidance actions when they are very close to collisions" (Section
3.3). (14) shortens an interval where a collision time is below the longest one over beta. With the
paper's 0.1 s that is rare, so 0.5 s is tried too, which leaves (14) more to do.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from physim.plots.style import WIDTH
from physim.record import Record
from physim.reproduction.studies.drawing import prepared, rows_of_measures
from physim.reproduction.studies.estimates import (
    Estimate,
    column,
    estimate,
    freely,
    outcome,
    share_text,
)
from physim.reproduction.studies.figures import figures, safety, work
from physim.reproduction.study import Arm, Measures, Study, Verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LATE = (
    "controller.time_low=0.5",
    "controller.time_high=1.0",
    "controller.distance_low=0.2",
    "controller.distance_high=0.3",
    "controller.boundary_low=0.05",
    "time.duration=60",
)
BETAS = (0.1, 0.3, 0.5, 0.7, 0.9)
FINE, FIXED, SHORT, COARSE, LONG = 0, 1, 2, 4, 5
"""places of the arms: fixed 0.01 s, fixed 0.1 s, (14) up to 0.1 s with beta 0.5 and then 0.1, fixed
0.5 s, (14) up to 0.5 s with every beta"""
MIDDLE = LONG + BETAS.index(0.5)


def measure(record: Record) -> Measures:
    """Work a robot and second, contacts, distance kept, shortest collision time."""
    return {**work(record), **safety(record), **figures(record, "shortest_collision_time")}


def _free(runs: Sequence[Measures]) -> tuple[int, int]:
    return freely(runs, "contacts", lambda value: value == 0.0)


def _of(runs: Sequence[Measures], name: str) -> Estimate:
    return estimate(column(runs, name))


def conclude(arms: Sequence[Sequence[Measures]]) -> Sequence[Verdict]:
    """What (14) saves against fixed periods, at what safety, and what beta does."""
    event, fine, fixed = arms[SHORT], arms[FINE], arms[FIXED]
    longer, coarse = arms[MIDDLE], arms[COARSE]
    updates = {k: _of(arms[k], "updates") for k in range(len(arms))}
    sweep = [updates[LONG + k] for k in range(len(BETAS))]
    fewer = updates[SHORT].high < updates[FINE].low
    ordered = all(b.median <= a.median for a, b in zip(sweep, sweep[1:], strict=False))
    safe = _free(longer)[0] >= _free(fixed)[0]
    less = updates[MIDDLE].high < updates[FIXED].low
    return (
        Verdict(
            "Event-triggered updates take less work than a fixed period of 0.01 s",
            "in words only",
            f"a robot and second: updates {updates[SHORT].text(2)} against "
            f"{updates[FINE].text(1)}, messages {_of(event, 'messages').text(1)} against "
            f"{_of(fine, 'messages').text(0)}, collision times {_of(event, 'evaluations').text(0)} "
            f"against {_of(fine, 'evaluations').text(0)}; free of contact "
            f"{share_text(*_free(event))} against {share_text(*_free(fine))}",
            outcome(fewer and _free(event)[0] >= _free(fine)[0], fewer),
        ),
        Verdict(
            "Event-triggered updates take less work than a fixed period of 0.1 s",
            "in words only",
            f"updates a robot and second {updates[SHORT].text(2)} at beta 0.5, "
            f"{updates[SHORT + 1].text(2)} at beta 0.1, against {updates[FIXED].text(2)}; free of "
            f"contact {share_text(*_free(event))} against {share_text(*_free(fixed))}",
            outcome(updates[SHORT].high < updates[FIXED].low),
            "By (14) no interval is longer than 0.1 s, so updates can only be added to those of "
            "that period.",
        ),
        Verdict(
            "With intervals up to 0.5 s, event-triggered updates save work and keep robots apart",
            "in words only",
            f"beta 0.5: {updates[MIDDLE].text(2)} updates a robot and second, free of contact "
            f"{share_text(*_free(longer))}; fixed 0.1 s: {share_text(*_free(fixed))}; fixed "
            f"0.5 s: {share_text(*_free(coarse))}",
            outcome(less and safe, less and _free(longer)[0] > _free(coarse)[0]),
            "The longer interval is ours: it shows what (14) can save.",
        ),
        Verdict(
            "A smaller beta brings more updates",
            "0 < beta < 1 in (14)",
            "updates a robot and second at beta "
            + ", ".join(f"{beta:g}: {one.text(2)}" for beta, one in zip(BETAS, sweep, strict=True)),
            outcome(ordered and sweep[-1].high < sweep[0].low, ordered),
            "The paper does not tell its beta.",
        ),
    )


def draw(figure: Figure, arms: Sequence[Sequence[Measures]]) -> None:
    """Updates, collision times and distance kept of every arm, with the runs free of contact."""
    prepared(figure, "Event-triggered updates against fixed periods", height=4.2, width=WIDTH)
    rows_of_measures(
        figure,
        [arm.label for arm in STUDY.arms],
        arms,
        (
            ("updates", "updates\n[1/s per robot]", True),
            ("evaluations", "collision times worked out\n[1/s per robot]", True),
            ("kept", "shortest distance\nto anything [m]", False),
        ),
        ["{} of {} free\nof contact".format(*_free(mine)) for mine in arms],
    )


def _arm(label: str, period: float, *more: str) -> Arm:
    grid = (f"controller.update_period={period}", f"controller.dwell_times=[{period}]")
    return Arm(label, "ten_robots", (*LATE, *grid, *more))


_FIXED = "controller.event_triggered=false"

STUDY = Study(
    name="updates",
    title="Event-triggered updates",
    claim="Updates triggered by collision times save work, and robots keep apart.",
    arms=(
        _arm("fixed 0.01 s", 0.01, _FIXED),
        _arm("fixed 0.1 s", 0.1, _FIXED),
        _arm("(14) ≤ 0.1 s, β 0.5", 0.1, "controller.beta=0.5"),
        _arm("(14) ≤ 0.1 s, β 0.1", 0.1, "controller.beta=0.1"),
        _arm("fixed 0.5 s", 0.5, _FIXED),
        *(_arm(f"(14) ≤ 0.5 s, β {beta:g}", 0.5, f"controller.beta={beta}") for beta in BETAS),
    ),
    measure=measure,
    conclude=conclude,
    draw=draw,
)
