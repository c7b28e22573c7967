from __future__ import annotations

import re
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from physim.errors import ControllerError
from tests.cli.commands import environment
from tests.helpers import facts, inside
from tests.world.file import parts_for_tests as fakes

CONTROLLER = inside("physim.parts", "CONTROLLER")
find_part, make_part = inside("physim.parts", "find_part", "make_part")

HERE = "tests.world.file.parts_for_tests"


def test_controllers_are_made_with_checked_settings():
    made = make_part(CONTROLLER, "mode_switching", {"omegas": (0.5, 1)})
    assert isinstance(made, fakes.Switching)
    assert made.settings.omegas == (0.5, 1.0)
    assert isinstance(make_part(CONTROLLER, "plain", {}), fakes.Plain)
    assert isinstance(make_part(CONTROLLER, f"{HERE}:Plain", {}, trusted=True), fakes.Plain)


@pytest.mark.parametrize(
    ("name", "trusted", "parts"),
    [
        ("mode_swich", True, ('"mode_swich"', '"mode_switching"')),
        ("broken", True, ('"broken"', "no module", '"no_such_module_here"')),
        (f"{HERE}:Plain", False, (f'"{HERE}:Plain"', "registered")),
        (f"{HERE}:Plane", True, ("Plane", '"Plain"')),
        (f"{HERE}:Mute", True, ("Mute", "no method decide")),
        (f"{HERE}:", True, ("no class",)),
        (":x", True, ("cannot be imported",)),
        ("../evil:X", True, ("evil:X",)),
    ],
)
def test_controllers_that_cannot_be_had_say_why(name, trusted, parts):
    with pytest.raises(ControllerError) as caught:
        find_part(CONTROLLER, name, trusted)
    assert re.search(facts(*parts), str(caught.value))
    assert "\n" not in str(caught.value)


def test_the_current_folder_comes_last(tmp_path, monkeypatch):
    """A file of the user must not be taken for a module that physim or a library imports later."""
    (tmp_path / "my_late_controller.py").write_text(
        "class Mine:\n    def decide(self, observation, memory):\n        return None\n"
    )
    for name in ("heapq", "random"):
        (tmp_path / f"{name}.py").write_text("class Mine:\n    pass\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.path", [*sys.path])
    find_part(CONTROLLER, "my_late_controller:Mine", trusted=True)
    place = sys.path.index(str(tmp_path))
    for key in ("stdlib", "purelib"):
        assert sys.path.index(sysconfig.get_paths()[key]) < place
    for name in ("heapq:Mine", "random.more:Mine"):
        with pytest.raises(ControllerError) as caught:  # and says which file was looked into
            find_part(CONTROLLER, name, trusted=True)
        assert re.search(facts(name, "module"), str(caught.value))
        assert str(tmp_path) not in str(caught.value)


@pytest.mark.deep
def test_files_named_as_libraries_beside_a_controller(tmp_path):
    (tmp_path / "ctl.py").write_text(
        "from physim import Decision\n\nclass C:\n    def decide(self, observation, memory):\n"
        "        return Decision(v=0.5, omega=0.0, hold=0.1)\n"
    )
    for name in ("imageio_ffmpeg", "cma", "argparse", "random", "heapq", "shapely", "controllers"):
        (tmp_path / f"{name}.py").write_text("raise SystemError('of the user')\n")
    for arguments in (
        ("run", "three_robots", "--quiet", "-o", "out"),
        ("sweep", "three_robots", "--quiet", "--seeds", "0:2", "--workers", "2", "-o", "study"),
    ):
        # the script: with python -m, Python itself has the folder first
        command = [Path(sys.executable).with_name("physim"), *arguments, "--controller", "ctl:C",
                   "--set", "time.duration=0.2", "--set", "expect=null"]  # fmt: skip
        done = subprocess.run(
            command, cwd=tmp_path, capture_output=True, text=True, timeout=300, env=environment()
        )
        assert (done.returncode, "SystemError" in done.stderr) == (0, False), done.stderr
    assert (tmp_path / "out/video.mp4").is_file()
