"""Movers and obstacles that can be pushed: their contacts, their motion, and who is responsible."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

import physim
from physim import Record
from physim.analysis.validation import report, validate
from tests.analysis.validation.runs import judged

YARD = """\
name: yard
time: {step: 0.01, duration: 6}
boundaries: [[[0, 0], [20, 0], [20, 10], [0, 10], [0, 0]]]
reference_path: [[2, 5], [18, 5]]
robots:
  - {name: stands, footprint: {length: 1.0, width: 0.6}, pose: [5, 5, 0], path: {offset: 0}}
  - {name: beside, footprint: {length: 1.0, width: 0.6}, pose: [5, 5.7, 0], path: {offset: 0.7}}
  - {name: goes, footprint: {length: 1.0, width: 0.6}, pose: [9, 8, 0], path: {offset: 3}, mass: 60}
  - {name: waits, footprint: {length: 1.0, width: 0.6}, pose: [12, 8, 0], path: {offset: 3}}
  - {name: crosses, footprint: {length: 1.0, width: 0.6}, pose: [14, 2, 0], path: {offset: -3}}
obstacles:
  - {corners: [[10, 7.7], [10.8, 7.7], [10.8, 8.3], [10, 8.3]], mass: 20}
  - {corners: [[2, 8], [3, 8], [3, 9]], mass: 20}
movers:
  - {name: cart, footprint: {length: 1.0, width: 1.0}, waypoints: [[5, 2], [5, 5]], speed: 0.7}
  - {name: gate, footprint: [[0, -0.1], [1.5, -0.1], [1.5, 0.1], [0, 0.1]],
     waypoints: [[17, 1, 1.5708], [17, 1, 3.1416], [17, 1, 1.5708]], times: [0, 4, 6]}
controller: {type: constant, commands: [[0, 0], [0, 0], [0.6, 0], [0, 0], [0.5, 0]]}
"""
CART, GATE, BOX, LEFT_ALONE = 5, 6, 7, 8


@pytest.fixture(scope="module")
def yard() -> Record:
    return physim.simulate(physim.parse_world(YARD))


def test_contacts_with_movers_agree_are_foretold_and_have_somebody_responsible(
    yard: Record,
) -> None:
    found = validate(yard)
    assert (found.code, found.findings) == (1, [(), (), (), (), (), ()])
    rows = yard.contacts[(yard.contacts["phase"] < 2) & (yard.contacts["b"] < 9)]
    counted = found.comparison.at_samples["movers"]
    assert (counted.both, counted[1:3]) == (int((rows["b"] >= 5).sum()), (0, 0))
    assert counted.neither == yard.samples * (9 * 8 - 5 * 4 - 2) // 2 - counted.both
    charged = {(one.a, one.b): one.responsible for one in found.contacts}
    assert charged == {
        (0, CART): (CART,), (0, 1): (CART,), (2, BOX): (2,), (3, BOX): (2,), (4, GATE): (4,),
    }  # fmt: skip
    first = {(one.a, one.b): one.prediction for one in reversed(found.contacts)}
    for pair in ((0, CART), (2, BOX), (4, GATE)):
        assert (foretold := first[pair]) is not None
        assert foretold.verdict == "agrees"
        assert foretold.error == pytest.approx(0.0, abs=1e-8)
    said = " ".join(report(found, full=True).split())
    for words in (
        "cart pushed stands into beside", "cart ran into stands", "1 between robots, 7 with movers",
        "a mover gives way to nobody", "goes pushed obstacle 1 into waits",
    ):  # fmt: skip
        assert words in said


@pytest.mark.parametrize(
    ("body", "step", "part", "by", "says"),
    [
        (CART, 200, 1, 1e-6, r"cart: its pose is 1e-06 m and 0 rad from where its path has it"),
        (CART, 500, 0, 1e-6, r"cart: its pose is 1e-06 m and 0 rad from"),  # pushing
        (GATE, 100, 2, 1e-6, r"gate: its pose is 0 m and 1e-06 rad from where its path has it"),
        (LEFT_ALONE, 300, 0, 1e-6, r"obstacle 2: it touches nothing, yet it moved 1e-06 m"),
        (BOX, 400, 0, 0.03, r"obstacle 1: in contact it moved 0.03\d* m"),
    ],
)
def test_a_pose_that_is_forged_is_found(
    yard: Record, tmp_path: Path, body: int, step: int, part: int, by: float, says: str
) -> None:
    def moved(file: Any) -> None:
        file["/steps/pose"][step, body, part] += by

    found = judged(yard, tmp_path, moved, rerun=False)
    assert found.code == 3
    told = [one.line(found.names).split(" s ", 1)[1] for one in found.motion.strays]
    assert any(re.match(says, one) for one in told)
