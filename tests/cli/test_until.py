"""``physim sweep --until``: stops when it is decided, however many workers there are."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from physim.campaigns import read
from tests.campaigns.real import WORLD
from tests.cli.commands import physim
from tests.helpers import check_error


def test_the_decision_is_the_same_with_any_number_of_workers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("small.yaml").write_text(WORLD, encoding="utf-8")
    found = []
    for workers in (1, 2):
        done = physim(
            "sweep", "small.yaml", "--seeds", "1:200", "--until", "contact_free > 0.8",
            "--workers", workers, "-o", f"by{workers}", "--json", capture=capsys,
        )  # fmt: skip
        assert done.code == 0
        (cell,) = json.loads(done.out)["cells"]
        found.append(cell["decision"])
        runs = read(Path(f"by{workers}"))["seed"].to_pylist()
        assert cell["decision"]["runs"] <= len(runs) < 60
        assert runs[: cell["decision"]["runs"]] == list(range(1, cell["decision"]["runs"] + 1))
    assert found[0] == found[1]
    assert found[0]["holds"] is True
    done = physim("report", "by2", "--json", "-", "--quiet", "--no-pictures", capture=capsys)
    values = json.loads(done.out)
    assert values["interval"] == "beta-binomial sequence"
    assert values["cells"][0]["decision"] == found[0]


@pytest.mark.parametrize(
    ("arguments", "place", "said"),
    [
        (("--seeds", "1:9", "--until", "rate > x"), '--until "rate > x":', ("character 8",)),
        (("--seeds", "1:9", "--until", "2"), "--until 2:", ("0.02", "contact_free")),
        (("--until", "0.1"), "--until:", ("--seeds",)),
        (("--seeds", "1:9", "--until", "0.1", "--shard", "1/2"), "--until:", ("--shard",)),
    ],
)
def test_goals_that_cannot_be(
    arguments: tuple[str, ...],
    place: str,
    said: tuple[str, ...],
    capsys: pytest.CaptureFixture[str],
) -> None:
    done = physim("sweep", "three_robots", *arguments, capture=capsys)
    assert (done.code, done.out) == (2, "")
    check_error(done.err, place, *said)
