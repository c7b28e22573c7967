"""The same world over many seeds: what is counted, and what is said of it."""

from __future__ import annotations

import pytest

from tests.helpers import inside
from tests.validation.reports import states

SeedResult, SeedStudy = inside("physim.analysis.validation", "SeedResult", "SeedStudy")
seeds_text = inside("physim.analysis.validation", "seeds_text")


@pytest.mark.parametrize(
    ("codes", "code", "free"),
    [((0, 0), 0, 2), ((0, 1), 1, 1), ((3, 1, 0), 3, 1), ((0, 1, 3, 1), 3, 1), ((0, 3), 3, 1)],
)
def test_the_worst_seed_decides(codes, code, free):
    results = tuple(
        SeedResult(seed, "", one, int(one == 1), 0, "duration", 1.0, "", None, False, ())
        for seed, one in enumerate(codes)
    )
    study = SeedStudy("made up", results, len(codes))
    assert (study.code, study.free) == (code, free)
    assert study.rates[0].share == free / len(codes)


def test_rates_stand_beside_each_other():
    results = tuple(
        SeedResult(seed, "", code, 0, 0, "finished" if done else "duration", 1.0, "", None, done,
                   () if done else ("finished",))
        for seed, (code, done) in enumerate([(0, True), (1, False), (0, True), (3, True)])
    )  # fmt: skip
    study = SeedStudy("made up", results, len(results))
    assert (study.free, study.finished, study.code) == (3, 2, 3)
    text = seeds_text(study)
    assert states(text, "3 of 4", "contact-free", "75.0%", within=30)
    assert states(text, "2 of 4", "finished", "50.0%", within=30)
    assert states(text, "seeds 1", "not as expected", "finished", within=40)
    assert "contacts with seeds" not in text
