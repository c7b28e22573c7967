"""Update intervals by (14) against fixed ones.

(14) is lost; the text says that it saves messages and work. Read as the smaller of 0.1 s and beta
times the collision time it can only add updates to those of a fixed 0.1 s; read as beta times the
collision time, held below a longest interval of its own, it saves what the longest one saves. Both
readings, beta from 0.05 to 0.9, and fixed intervals from 0.01 to 0.5 s, over the first 70 s of the
ten robots, with their merge in them.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
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

FIXED = (0.01, 0.05, 0.1, 0.2, 0.3, 0.5)
"""[s] fixed intervals"""
LONGEST = (0.1, 0.2, 0.3, 0.5)
"""[s] longest intervals of (14), with the beta of the world"""
BETAS = (0.05, 0.3, 0.5, 0.9)
"""other values of beta, up to 0.2 s"""
FIRST = "time.duration=70"


def _fixed(interval: float) -> int:
    """Place of an arm."""
    return FIXED.index(interval)


def _event(longest: float) -> int:
    """Place of an arm."""
    return len(FIXED) + LONGEST.index(longest)


def measure(record: Record) -> Measures:
    """Work a robot and second, contacts, distance kept, shortest collision time."""
    return {**work(record), **safety(record), **figures(record, "shortest_collision_time")}


def _free(runs: Sequence[Measures]) -> tuple[int, int]:
    return freely(runs, "contacts", lambda value: value == 0.0)


def _of(runs: Sequence[Measures], name: str) -> Estimate:
    return estimate(column(runs, name))


def conclude(arms: Sequence[Sequence[Measures]]) -> Sequence[Verdict]:
    """What (14) saves against fixed intervals, at what safety, and what beta does."""
    event, fine, plain = arms[_event(0.2)], arms[_fixed(0.01)], arms[_fixed(0.1)]
    updates = [_of(mine, "updates") for mine in arms]
    betas = updates[len(FIXED) + len(LONGEST) :]
    fewer = updates[_event(0.2)].high < updates[_fixed(0.01)].low
    less = updates[_event(0.2)].high < updates[_fixed(0.1)].low
    ordered = all(b.median <= a.median for a, b in pairwise(betas))
    kept = [
        f"{longest:g} s: {updates[_event(longest)].text(2)} updates a robot and second, free of "
        f"contact {share_text(*_free(arms[_event(longest)]))}, fixed "
        f"{share_text(*_free(arms[_fixed(longest)]))}"
        for longest in LONGEST
    ]
    return (
        Verdict(
            "Event-triggered updates take less work than a fixed interval of 0.01 s",
            "in words only",
            f"a robot and second: updates {updates[_event(0.2)].text(2)} against "
            f"{updates[_fixed(0.01)].text(1)}, messages {_of(event, 'messages').text(1)} against "
            f"{_of(fine, 'messages').text(0)}, collision times {_of(event, 'evaluations').text(0)} "
            f"against {_of(fine, 'evaluations').text(0)}; free of contact "
            f"{share_text(*_free(event))} against {share_text(*_free(fine))}",
            outcome(fewer and _free(event)[0] >= _free(fine)[0], fewer),
        ),
        Verdict(
            "Event-triggered updates take less work than a fixed interval of 0.1 s",
            "in words only",
            f"updates a robot and second {updates[_event(0.2)].text(2)} up to 0.2 s, "
            f"{updates[_event(0.1)].text(2)} up to 0.1 s, against {updates[_fixed(0.1)].text(2)}; "
            f"messages {_of(event, 'messages').text(1)} against {_of(plain, 'messages').text(1)}; "
            f"free of contact {share_text(*_free(event))} against {share_text(*_free(plain))}",
            outcome(less and _free(event)[0] >= _free(plain)[0], less),
            "Up to 0.1 s (14) can only add updates; nearly all of the saving comes from the longer "
            "interval, which is ours.",
        ),
        Verdict(
            "Intervals that adapt to the collision time keep robots apart where fixed ones of the "
            "same length do not",
            "in words only",
            "; ".join(kept),
            outcome(
                all(
                    _free(arms[_event(t)])[0] >= _free(arms[_fixed(t)])[0] for t in LONGEST
                )
                and any(_free(arms[_event(t)])[0] > _free(arms[_fixed(t)])[0] for t in LONGEST),
                any(_free(arms[_event(t)])[0] > _free(arms[_fixed(t)])[0] for t in LONGEST),
            ),
        ),
        Verdict(
            "A smaller beta brings more updates",
            "0 < beta < 1 in (14)",
            "updates a robot and second at beta "
            + ", ".join(f"{beta:g}: {one.text(2)}" for beta, one in zip(BETAS, betas, strict=True)),
            outcome(ordered and betas[-1].high < betas[0].low, ordered),
            "The paper does not tell its beta.",
        ),
    )  # fmt: skip


def draw(figure: Figure, arms: Sequence[Sequence[Measures]]) -> None:
    """Updates, collision times and distance kept of every arm, with the runs free of contact."""
    prepared(figure, "Event-triggered updates against fixed periods", height=5.2, width=WIDTH)
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


def _arm(label: str, *overrides: str) -> Arm:
    return Arm(label, "ten_robots", (*overrides, FIRST))


STUDY = Study(
    name="updates",
    title="Update intervals",
    claim="Updates triggered by collision times save messages and work, and robots keep apart.",
    arms=(
        *(
            _arm(
                f"fixed {interval:g} s",
                "controller.event_triggered=false",
                f"controller.longest_interval={interval}",
            )
            for interval in FIXED
        ),
        *(_arm(f"(14) ≤ {t:g} s", f"controller.longest_interval={t}") for t in LONGEST),
        *(_arm(f"(14) ≤ 0.2 s, β {beta:g}", f"controller.beta={beta}") for beta in BETAS),
    ),
    measure=measure,
    conclude=conclude,
    draw=draw,
)
