"""The comparison of two states of the sources sees what differs, and says so."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.digests import CheckoutError, Run, compared, copy_commit, main

ONE = Run("straight", 0, 100, "a", "v", "m")


OTHERS = [
    (ONE._replace(digest="b", values="w"), "alike"),
    (Run("straight", 0, 90, "b", "w", "n"), "otherwise"),
]


@pytest.mark.parametrize(("other", "word"), OTHERS)
def test_a_difference_is_told(other: Run, word: str) -> None:
    verdict = compared(ONE, other)
    assert "DIFFERENT" in verdict
    assert word in verdict
    assert compared(ONE, ONE) == compared(ONE, ONE._replace(digest="b")) == ""


def test_a_commit_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(CheckoutError, match="no-such-commit"):
        copy_commit("no-such-commit", tmp_path)


def test_a_world_that_is_not_shipped(monkeypatch, capsys) -> None:
    monkeypatch.setattr("sys.argv", ["digests", "--against", "HEAD", "no_world"])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    told = capsys.readouterr().err
    assert "no_world" in told
    assert "straight" in told
