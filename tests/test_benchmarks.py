"""The benchmark's own work: in turn, kept, resumed, and nothing silently dropped."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import pytest

from benchmarks import report, speed, targets
from benchmarks.__main__ import main
from benchmarks.environments import PEERS, Environment
from benchmarks.measuring import (
    FAILED,
    Job,
    Progress,
    Store,
    cell,
    in_turn,
    ratio,
    run,
    runner,
    spread,
)
from benchmarks.runners import common

HERE = {peer.name: Environment(peer, sys.executable) for peer in PEERS if not peer.optional}


def prints(code: str, who: str = "a", what: str = "it", timeout: float = 60.0) -> Job:
    return Job("speed", who, what, (sys.executable, "-c", code), timeout)


def test_what_goes_wrong_is_the_result() -> None:
    assert run(prints("print('words'); print('{\"rate\": 2.0}')")) == {"rate": 2.0}
    assert run(prints("raise SystemExit('no wheel')"))[FAILED] == "no wheel"
    assert "3" in run(prints("raise SystemExit(3)"))[FAILED]
    assert FAILED in run(prints("print('no result')"))
    assert FAILED in run(prints("import time; time.sleep(60)", timeout=0.2))
    assert FAILED in run(Job("speed", "a", "it", ("/there/is/no/such/program",)))


@pytest.mark.deep
def test_jobs_are_done_in_turn_and_every_other_round_backwards(tmp_path: Path) -> None:
    log = tmp_path / "log"
    code = f"open({str(log)!r}, 'a').write('%s '); print('{{\"rate\": 1.0}}')"
    group = [prints(code % who, who) for who in ("a", "b", "c")]
    store = Store(tmp_path / "measured")
    in_turn([group], 3, store, False, Progress(9))
    assert log.read_text() == "a b c c b a a b c "
    assert store.values("speed", "b", "it") == [1.0] * 3


def test_a_resumed_run_keeps_what_is_there_and_tries_again_what_failed(tmp_path: Path) -> None:
    store, good = Store(tmp_path), prints("print('{\"rate\": 5.0}')")
    bad = prints("raise SystemExit('gone')", "b")
    store.put(good, 0, {"rate": 4.0})
    store.put(bad, 0, {FAILED: "then"})
    in_turn([[good, bad]], 2, store, True, Progress(4))
    assert sorted(store.values("speed", "a", "it")) == [4.0, 5.0]
    assert store.why_not("speed", "b", "it") == "gone"
    assert len(store.results("speed", "b", "it")) == 1  # once is enough


def test_ratios_and_spreads_are_of_medians() -> None:
    assert ratio([10.0, 1.0, 4.0], [2.0]) == 2.0
    assert ratio([], [2.0]) is None
    assert spread([1.5e6, 1e3, 12.0]) == "1 k (12–1.5 M)"
    assert spread([]) == "–"


def made_up(store: Store, quick: bool = False) -> None:
    """Results of every measurement: physim twice as fast as all others."""
    for group in speed.groups(HERE, quick):
        for job in group:
            rate = 2e3 if job.who == "physim" else 1e3
            for number, share in enumerate((0.9, 1.0, 1.2)):
                store.put(job, number, {"rate": rate * share, "version": "1.2", "memory": 90.0})


def test_a_peer_that_is_not_there_is_told(tmp_path: Path) -> None:
    store = Store(tmp_path / "measured")
    made_up(store)
    peers = {**HERE, "navground": Environment(PEERS[0], "", "cannot be installed: no wheel")}
    job = runner("speed", "irsim-rvo", "controller-100", "python", "x.py")
    for number in range(3):
        store.put(job, number, {FAILED: "not done in 60 s"})
    report.write(store, peers, tmp_path / "RESULTS.md", quick=True)
    text = (tmp_path / "RESULTS.md").read_text(encoding="utf-8")
    speeds, versions = text.split("## Peers")
    assert speeds.count("| cannot be installed: no wheel") == 4 + 4 + 4 + 2
    assert speeds.count("not done in 60 s") == 1
    assert "| navground | cannot be installed: no wheel |" in versions
    assert "| irsim | 1.2 |" in versions
    assert "| vmas | not asked for |" in versions


def test_targets_of_its_own_are_met_or_short_or_not_measured(tmp_path: Path) -> None:
    store = Store(tmp_path)

    def put(subject: str, what: str, who: str = "physim", **result: Any) -> None:
        store.put(Job(subject, who, what, ()), 0, result)

    put("targets", "record-100", rate=50.0, without=100.0, lasting=65.0)
    put("targets", "plain-10", rate=70e3)
    put("targets", "plain-100", **{FAILED: "gone"})
    put("targets", "default-10", rate=90.0, danger=0.25)
    put("targets", "short-10", rate=100.0, danger=0.5)
    put("targets", "world", built=2.5, checked=1.5)
    put("first", "video", rate=300.0)
    put("speed", "drive-10", rate=100.0)
    put("speed", "drive-10", "irsim-contact", rate=200.0)
    rows = [line.split(" | ") for line in targets.text(store).splitlines() if " | " in line][2:]
    assert [(row[1], row[3], row[4]) for row in rows] == [
        ("100", "≥ 0.6", "short |"),
        ("100", "≥ 0.6", "met |"),
        ("10", "≥ 0.769", "met |"),
        ("10", "≥ 60 k", "met |"),
        ("100", "≥ 40 k", "not measured |"),
        ("1,000", "≤ 2 s", "short |"),
        ("1,000", "≤ 2 s", "met |"),
        ("10", "≥ 250", "met |"),
        ("10", "≥ 1", "short |"),
    ]
    assert "(25 and 50 % of the decisions in danger mode)" in rows[2][0]
    assert rows[4][2] == "gone"


def test_uneven_spans_are_measured_again_and_said(tmp_path: Path) -> None:
    log = tmp_path / "log"
    code = f"open({str(log)!r}, 'a').write('x'); print('{{\"rate\": 9.0, \"spans\": [4.0, %s]}}')"
    store = Store(tmp_path / "measured")
    in_turn([[prints(code % 9.0), prints(code % 7.0, "b")]], 1, store, False, Progress(2))
    assert log.read_text() == "xxx"
    assert cell(store, "speed", "a", "it") == "9†"
    assert cell(store, "speed", "b", "it") == "9"


def test_a_rate_leaves_out_what_comes_once(monkeypatch: Any) -> None:
    """The first step, and the way back to the start, are in no span."""
    now, first = [0.0], [True]
    monkeypatch.setattr(common.time, "process_time", lambda: now[0])

    def step() -> None:
        now[0] += 100.0 if first[0] else 0.01
        first[0] = False

    def again() -> None:
        now[0] += 5.0

    found = common.rate(step, 10, 0.2, 7, again)
    assert found["rate"] == pytest.approx(1000.0)
    assert found["spans"] == pytest.approx([1000.0, 1000.0])
    whole = common.rate(step, 10, 0.2, 50, again, whole=True)
    assert whole["steps"] == 100


@pytest.mark.parametrize("given", [["--trial", "nowhere"], ["--quick", "nothing"]])
def test_bad_input_ends_with_2(given: list[str], monkeypatch: Any, capsys: Any) -> None:
    monkeypatch.setattr(sys, "argv", ["benchmarks", *given])
    try:
        code = main()
    except SystemExit as stop:
        code = stop.code
    assert code == 2
    assert given[1] in capsys.readouterr().err


def test_results_are_whole_files(tmp_path: Path) -> None:
    """What is cut short is no result."""
    store, job = Store(tmp_path), prints("")
    store.put(job, 0, {"rate": 1.0})
    file = next(tmp_path.rglob("*.json"))
    file.write_text(json.dumps({"rate": 1.0})[:-4])
    assert store.get(job, 0) is None
