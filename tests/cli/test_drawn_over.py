"""A rate says what it is drawn over; where nothing is, what to write so that something is."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml

from physim import build_scene
from physim.world.file import parse_world
from tests.cli.commands import SMALL, physim
from tests.helpers import inside

TEMPLATES = inside("physim.cli", "TEMPLATES")


@pytest.mark.parametrize("template", TEMPLATES)
def test_a_new_world_draws_its_starts_until_it_is_told_not_to(
    template: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.chdir(tmp_path)
    physim("new", "w", "--template", template, capture=capsys)
    text = (tmp_path / "w.yaml").read_text(encoding="utf-8")
    world = parse_world(text)
    assert (build_scene(world, 1).start != build_scene(world, 2).start).any()
    assert "draws nothing" in text  # and this is how
    told = yaml.safe_load("[" + text.partition("pose: [")[2].partition("]")[0] + "]")
    robots = [{**one, "start": None, "pose": told} for one in yaml.safe_load(text)["robots"][:1]]
    fixed = world.changed(robots=[{k: v for k, v in one.items() if v} for one in robots])
    starts = [build_scene(fixed, seed).start.tolist() for seed in (1, 2)]
    assert starts[0] == [told]
    assert template == "random" or starts[0] == starts[1]


def test_rates_say_what_they_are_drawn_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "w.yaml").write_text(SMALL.replace("1.0, 0.0]\n", "1.0, random]\n"), "utf-8")
    over = "over 2 seeds, which draw the headings"
    runs = ("w.yaml", "--seeds", "0:2", "--workers", 1)
    short = ("--set", "time.duration=0.1")
    swept = physim("sweep", *runs, *short, "-o", "rows", capture=capsys)
    assert over in swept.out, swept.err
    said = physim("report", "rows", "--no-pictures", "--json", "r.json", capture=capsys)
    assert over in said.out
    assert over in (tmp_path / "rows/report.html").read_text(encoding="utf-8")
    assert json.loads((tmp_path / "r.json").read_text("utf-8"))["cells"][0]["draws"] == (
        "the headings"
    )
    assert over in physim("validate", *runs, *short, capture=capsys).out


def test_where_nothing_is_random_it_says_what_would_be(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "w.yaml").write_text(SMALL, "utf-8")
    short = ("w.yaml", "--seeds", "0:2", "--workers", 1, "--set", "time.duration=0.1")
    for command in ("sweep", "validate"):
        code, out, err = physim(command, *short, capture=capsys)
        assert code == 0, err
        assert "random]" in out + err
        assert "start: {region:" in out + err
