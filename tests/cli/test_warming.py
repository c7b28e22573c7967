"""Two processes that compile: together they compile what is needed, and none waits for ever."""

from __future__ import annotations

import multiprocessing
import subprocess
import sys
from pathlib import Path

import pytest

from physim.cli import warming
from tests.helpers import inside

WARMING = inside("physim.campaigns", "WARMING")
SecondProcess, finish = inside("physim.cli", "SecondProcess", "finish")
second_process = inside("physim.cli", "second_process")

NEEDED = """
from numba.core.caching import Cache
from physim.analysis.metrics.distances import shortest_pair_collision_time
from physim.analysis.validation import validate
from physim.cli.warming import warm_up_checks, warm_up_motion_alone
from physim.parts.registry import CONTROLLER, make_part
from physim.simulation.run import simulate, warm_up
from physim.world.file import load_world
from physim.world.layout.scene_builder import build_scene

needed, load = [], Cache.load_overload

def noted(cache, signature, context):
    needed.append(cache._impl.filename_base.split("-")[0])
    return load(cache, signature, context)

Cache.load_overload = noted
world = load_world("nonconvex", overrides=["time.duration=3.0"])
choice = world.controller

def wait():
    warm_up_motion_alone()
    needed.clear()

warm_up(build_scene(world), make_part(CONTROLLER, choice.type, choice.settings), wait)
print("run:", *needed)
warm_up_checks(choice.type)
needed.clear()
with simulate(world) as record:
    validate(record)
    shortest_pair_collision_time(record)
print("checks:", *needed)
"""


@pytest.mark.deep
def test_nothing_is_left_to_compile_for_a_run_and_its_checks() -> None:
    """Of a run, the first process alone needs decisions and swept contacts; of all else, nothing.

    Numbers of robots, walls and parts differ between the two worlds, and so does what happens.
    """
    found = subprocess.run(
        [sys.executable, "-c", NEEDED], cwd=Path(__file__).parents[2],
        capture_output=True, text=True,
    )  # fmt: skip
    assert found.returncode == 0, found.stderr
    assert found.stdout.splitlines() == ["run: swept_contacts.find_swept_contacts", "checks:"]


def helpers() -> list[multiprocessing.process.BaseProcess]:
    return [one for one in multiprocessing.active_children() if one.name == WARMING]


@pytest.mark.deep
def test_the_second_process_says_when_a_run_can_go_on_and_ends(
    capfd: pytest.CaptureFixture[str],
) -> None:
    second = SecondProcess("mode_switching")
    (process,) = helpers()
    second.wait()
    finish(quiet=True)
    assert process.exitcode == 0
    assert not helpers()
    assert capfd.readouterr() == ("", "")


@pytest.mark.deep
def test_nobody_waits_for_a_process_that_is_gone() -> None:
    second = SecondProcess("mode_switching")
    (process,) = helpers()
    process.kill()
    second.wait()
    finish(quiet=True)
    assert not helpers()


def test_there_is_one_only_where_it_helps(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[str] = []
    monkeypatch.setattr(warming, "SecondProcess", made.append)
    cores = {0, 1}
    monkeypatch.setattr(warming.os, "sched_getaffinity", lambda process: cores, raising=False)
    second_process("a")
    assert made == ["a"]
    monkeypatch.setattr(warming, "is_kept", lambda kernel: False)
    assert second_process("b") is None
    monkeypatch.undo()
    monkeypatch.setattr(warming, "SecondProcess", made.append)
    monkeypatch.setattr(warming.os, "sched_getaffinity", lambda process: {3}, raising=False)
    assert second_process("c") is None
    assert made == ["a"]
