"""Options that would have no effect, or would undo each other, are refused, not dropped."""

from __future__ import annotations

import pytest

from tests.cli.commands import physim
from tests.helpers import check_error

OF_NO_EFFECT = {
    ("validate", "x", "--workers", "3"): ("--workers", "--seeds"),
    ("validate", "x", "--verbose"): ("--verbose", "--seeds"),
    ("validate", "x", "--seeds", "1:3", "--rerun"): ("--rerun", "--seeds"),
    ("validate", "ten_robots", "--set", "time.record_every=5"): (
        "--set time.record_every", "every step",
    ),
    ("schema", "--force"): ("--force", "-o"),
    ("report", "x", "--no-pictures", "--videos"): ("--videos", "--no-pictures"),
    ("report", "x", "--no-pictures", "--pages"): ("--pages", "--no-pictures"),
    ("report", "x", "-o", "x/pages/4f1c.html", "--force"): ("x/pages/4f1c.html", "part of"),
    ("report", "x", "--json", "x/stills/4f1c.png", "--force"): ("x/stills/4f1c.png", "part of"),
    ("plot", "x", "--only", "modes", "--snapshots", "3"): ("--snapshots", "trajectories"),
    ("run", "ten_robots", "--controller", "path_following", "--set",
     "controller.type=mode_switching"): ("--set controller.type", "path_following", "one of them"),
    ("run", "ten_robots", "--controller", "path_following", "--set",
     "controller={alpha: 1}"): ("--set controller", "path_following", "controller.KEY=VALUE"),
    ("sweep", "ten_robots", "--seeds", "1:3", "--set", "seed=7"): ("--set seed", "--seeds"),
}  # fmt: skip


@pytest.mark.parametrize("arguments", OF_NO_EFFECT, ids=" ".join)
def test_an_option_without_effect_is_refused(arguments, capsys, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = physim(*arguments, capture=capsys)
    assert (done.code, done.out) == (2, "")
    check_error(done.err, *OF_NO_EFFECT[arguments])
    assert list(tmp_path.iterdir()) == []
