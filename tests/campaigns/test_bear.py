"""How much a world can bear: the search on curves that are known, and the command on real runs."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable
from pathlib import Path

import imageio.v3 as iio
import numpy as np
import pytest

from physim.errors import PhysimError
from physim.statistics import Decision, Goal, decide
from tests.campaigns.samples import WORLD, rows_in
from tests.cli.commands import physim, tree
from tests.helpers import check_error, facts, inside

next_strength, bracket = inside("physim.campaigns", "next_strength", "bracket")
each_confidence, varied = inside("physim.campaigns", "each_confidence", "varied")
Borne, sentences, picture = inside("physim.campaigns", "Borne", "sentences", "picture")

LAST, SEEDS, CONFIDENCE, REPEATED = 16, 300, 0.8, 150
TARGET = Goal("rate", ">", 0.5)
GRID = np.arange(LAST + 1) / LAST


def searched(rates: np.ndarray, draw: Callable[[int], np.ndarray]) -> dict[int, Decision]:
    """Search a curve of rates (LAST + 1,); ``draw`` gives numbers in [0, 1) for a strength."""
    known: dict[int, Decision] = {}
    each = each_confidence(CONFIDENCE, LAST + 1)
    while (k := next_strength(known, LAST)) is not None:
        assert k not in known
        good = draw(k) < rates[k]
        first = decide(TARGET, good[:60], each)  # the first that decide do so
        known[k] = first if first.decided else decide(TARGET, good, each)
    return known


CURVES = {
    "steep": np.where(GRID < 0.55, 0.95, 0.05),
    "slope": 1.0 - GRID,
    "just above": np.where(GRID == 0.0, 1.0, 0.5),  # nowhere below: each "missed" is wrong
    "just below": np.where(GRID == 0.0, 1.0, 0.5 - 1e-9),  # each "met" beyond 0 is wrong
    "up and down": np.where((4 * GRID).astype(int) % 2, 0.2, 0.8) - 0.6 * (GRID == 1.0),
}


@pytest.mark.parametrize(
    ("name", "paired"),
    [*((name, True) for name in CURVES), ("just above", False), ("just below", False)],
)
def test_a_bracket_is_right_as_often_as_it_says(name: str, paired: bool) -> None:
    """Whatever the curve, and though the same seeds decide and choose what is tried next."""
    rates, draws, wrong, wide = CURVES[name], np.random.default_rng(6), 0, []
    for _ in range(REPEATED):
        seeds = draws.random(SEEDS)
        known = searched(rates, lambda _: seeds if paired else draws.random(SEEDS))  # noqa: B023
        lower, upper = bracket(known)
        met = lower is None or rates[lower] >= TARGET.number
        missed = upper is None or rates[upper] < TARGET.number
        wrong += not (met and missed)
        wide.append(LAST if lower is None or upper is None else upper - lower)
    assert wrong <= (1.0 - CONFIDENCE) * REPEATED
    if name in ("steep", "slope"):
        assert np.median(wide) == (1 if name == "steep" else 4)


MET = Decision(20, 20, 0.8, 1.0, True, True)
MISSED = Decision(20, 4, 0.05, 0.45, True, False)
LESS = Decision(20, 1, 0.0, 0.04, True, False)  # an earlier look was below the share of 5 %
OPEN = Decision(20, 12, 0.3, 0.8, False, None)


@pytest.mark.parametrize(
    ("known", "said"),
    [
        ({0: MISSED}, ("0: fewer than 50 %", "even at the least")),
        ({0: MET, 4: MET}, ("4: at least 50 %", "--most")),
        ({0: MET, 2: OPEN, 4: MISSED}, ("0: at least 50 %", "4: fewer", "At 2", "--seeds")),
        ({0: OPEN, 4: OPEN}, ("not found", "At 0 and 4", "--seeds")),
        ({0: MET, 2: LESS, 4: MISSED}, ("2: fewer", "NOTE", "higher at 4 than at 2")),
    ],
)
def test_it_says_what_is_known_and_no_more(
    known: dict[int, Decision], said: tuple[str, ...]
) -> None:
    grid = (0.0, 1.0, 2.0, 3.0, 4.0)
    found = Borne("w", "c", "noise", TARGET, 0.95, grid, known, False)
    told = "\n".join(sentences(found))
    assert picture(found).axes
    assert re.search(facts(*said), told), told
    assert ("NOTE" in told) == ("NOTE" in said)


DICE = '''
from pydantic import BaseModel, Field

from physim.randomness import stream


class DiceSettings(BaseModel):
    risk: float = Field(default=0.0, ge=0.0, le=1.0, description="[-] of a run to go wrong")
    rolls: int = Field(default=1, ge=0, le=50, description="[-] times that this may happen")


class Dice:
    """Breaks off so many of the runs, which are bad ones then."""

    Settings = DiceSettings

    def __init__(self, settings):
        self.settings = settings

    def start(self, scene):
        drawn = stream(scene.seed, "dice", 0).uniform(size=self.settings.rolls)
        return bool((drawn < self.settings.risk).any())

    def disturb(self, scene, truth, filtered, state):
        if state:
            raise RuntimeError("as the dice fell")
        return filtered, state
'''


@pytest.fixture
def dice(here: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A disturbance of one's own, registered, whose rate is known: 1 - risk."""
    info = here / "installed/dice-1.0.dist-info"
    info.mkdir(parents=True)
    (here / "installed/dice.py").write_text(DICE)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: dice\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[physim.disturbances]\ndice = dice:Dice\n")
    monkeypatch.syspath_prepend(here / "installed")
    monkeypatch.delitem(sys.modules, "dice", raising=False)
    return here


@pytest.mark.usefixtures("in_process")
def test_the_limit_of_a_known_rate_is_found(dice: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ("bear", "small.yaml", "--vary", "dice.risk", "--most", "1", "--target", "0.5",
               "--precision", "0.25", "--set", "time.duration=0.1", "-o", "out")  # fmt: skip
    done = physim(*command, "--seeds", "0:70", "--json", capture=capsys)
    assert done.code == 0, done.err
    found = json.loads(done.out)
    assert found == json.loads((dice / "out/bear.json").read_text())
    assert (found["lower"], found["upper"]) == (0.25, 0.75)
    tried = {one["strength"]: one["holds"] for one in found["tried"]}
    assert tried == {0.0: True, 0.25: True, 0.5: None, 0.75: False, 1.0: False}
    for one in found["tried"]:
        assert one["low"] <= 1.0 - one["strength"] <= one["high"]
    assert iio.imread(dice / "out/bear.png").ndim == 3
    assert "dice.risk" in (dice / "out/bear.svg").read_text()

    rows = len(rows_in(dice / "out"))
    done = physim(*command, "--seeds", "0:75", capture=capsys)
    assert len(rows_in(dice / "out")) == rows + 5  # those of 0.5, which was open
    assert re.search(facts("0.25: at least 50 %", "0.75: fewer than 50 %", "At 0.5"), done.out)
    assert physim("report", "out", "--no-pictures", capture=capsys).code == 0


def test_what_is_varied_is_found_or_asked_for(dice: Path) -> None:
    def of(text: str, vary: str = "dice.rolls", most: float = 3.0) -> tuple[str, ...]:
        (dice / "world.yaml").write_text(text)
        found = varied("world.yaml", vary, 0.0, most, None, (), None)
        return (found.key, *found.values)

    one, two = "{type: dice, risk: 0.2}", "{type: dice, risk: 1.0e-5}"
    added = of(WORLD)
    assert added[:2] == ("disturbances", "[{type: dice, rolls: 0}]")
    assert len(added) == 1 + 4  # whole numbers
    assert of(f"{WORLD}disturbances: [{one}]\n") == ("disturbances.0.rolls", "0", "1", "2", "3")
    key, first, *_ = of(f"{WORLD}disturbances: [{one}]\n", "disturbances[0].risk", 1.0)
    assert (key, first, len(_)) == ("disturbances.0.risk", "0", 32)
    with pytest.raises(PhysimError, match=r"disturbances\.0\.rolls or disturbances\.1\.rolls"):
        of(f"{WORLD}disturbances: [{one}, {two}]\n")


@pytest.mark.parametrize(
    ("more", "text"),
    [
        (("--vary", "dcie.risk"), ("dcie", "dice")),
        (("--vary", "dice"), ("dice.risk", "dice.rolls")),
        (("--vary", "dice.risc"), ("--most 3", "disturbances[0].risc", "risk")),
        (("--vary", "dice.risk"), ("--most 3", "1", "given 3")),
        (("--vary", "name"), ("--most 3", "text", "given 3")),
        (("--vary", "robots.0.limits.v"), ("--least 0", "given 0")),
        (("--vary", "formation.gain", "--set", "formation.gain=1"), ("--set",)),
        (("--vary", "formation.gain", "--least", "3"), ("above --least",)),
        (("--vary", "formation.gain", "--target", "1"), ("below 1",)),
        (("--vary", "formation.gain", "--precision", "0.01"), ("0.015",)),
    ],
)
def test_bad_input_is_one_line_and_nothing_is_written(
    dice: Path, capsys: pytest.CaptureFixture[str], more: tuple[str, ...], text: tuple[str, ...]
) -> None:
    before = tree(dice)
    target = () if "--target" in more else ("--target", "0.9")
    done = physim("bear", "small.yaml", "--most", "3", *target, *more, capture=capsys)
    assert (done.code, done.out) == (2, "")
    place = more[2] if more[2:] and more[2] != "--set" else "--vary"
    check_error(done.err, "--most" if place == "--least" else place, *text)
    assert {k: v for k, v in tree(dice).items() if "pycache" not in k} == before
