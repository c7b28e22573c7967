"""The wheel holds what it must, under ``physim`` alone, and works where the sources are not."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of wheel and source distribution.

    Built from a copy of the tracked kinds of files, so that nothing is left in the sources.
    """
    folder = tmp_path_factory.mktemp("built")
    source = folder / "source"
    for path in sorted(ROOT.rglob("*")):
        name = path.relative_to(ROOT)
        if name.parts[0] not in KINDS or not path.is_file() or path.suffix in (".pyc", ".so"):
            continue
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        (source / name).write_bytes(path.read_bytes())
    build = [
        sys.executable, "-c",
        "import sys; from setuptools import build_meta; folder = sys.argv[1]\n"
        "build_meta.build_sdist(folder); build_meta.build_wheel(folder)",
    ]  # fmt: skip
    done = subprocess.run(
        [*build, str(folder)], cwd=source, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.fixture(scope="module")
def wheel(built: Path) -> Path:
    (found,) = built.glob("*.whl")
    return found


KINDS = (
    "physim", "controllers", "worlds", "tests", "benchmarks", "media",
    "pyproject.toml", "setup.py", "README.md", "LICENSE", "MANIFEST.in", "CHANGELOG.md",
)  # fmt: skip


KEPT = (".py", ".pyi", ".pxi", ".yaml", ".md", ".json", ".typed", ".js", ".css", ".html")


def expected() -> set[str]:
    """Every file of the sources that belongs into the wheel, by its place there."""
    found = set()
    for folder, place in (
        ("physim", "physim"), ("controllers", "physim/controllers"), ("worlds", "physim/worlds")
    ):  # fmt: skip
        for file in (ROOT / folder).rglob("*"):
            if file.suffix in KEPT and file.is_file():
                found.add(f"{place}/{file.relative_to(ROOT / folder).as_posix()}")
    return found


def test_wheel_holds_the_sources_and_nothing_beside_physim(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    inside = {name for name in names if ".dist-info/" not in name}
    assert inside == expected() | {"physim/_kernels.abi3.so"}
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert wheel.name.startswith(f"physim-{version}-cp311-abi3-")
    assert {"physim/py.typed", "physim/worlds/world.schema.json"} <= inside
    assert {f"physim/drawing/page/assets/{name}" for name in ("page.html", "main.js")} <= inside
    assert any(name.startswith("physim/worlds/") and name.endswith(".yaml") for name in inside)
    tops = {name.split("/")[0] for name in names}
    assert "physim" in tops
    assert [top for top in tops - {"physim"} if not top.endswith(".dist-info")] == []


def test_source_distribution_holds_what_the_wheel_is_built_from(built: Path) -> None:
    (packed,) = built.glob("*.tar.gz")
    with tarfile.open(packed) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert {"setup.py", "pyproject.toml", "physim/kernels.pxi", "LICENSE"} <= names
    for folder in ("physim", "controllers", "worlds"):
        files = {path for path in (ROOT / folder).rglob("*") if path.suffix in KEPT}
        assert {path.relative_to(ROOT).as_posix() for path in files} <= names
    assert [name for name in names if name.endswith((".so", ".c", ".pyx"))] == []


def test_wheel_says_what_it_offers(wheel: Path) -> None:
    archive = zipfile.ZipFile(wheel)
    texts = {
        Path(name).name: archive.read(name).decode()
        for name in archive.namelist()
        if ".dist-info/" in name
    }
    assert "physim = physim.cli:main" in texts["entry_points.txt"]
    assert (
        "mode_switching = physim.controllers.mode_switching:ModeSwitching"
        in (texts["entry_points.txt"])
    )
    assert "Requires-Python: >=3.11" in texts["METADATA"]
    assert "LICENSE" in texts


def test_wheel_works_in_another_place(wheel: Path, tmp_path: Path) -> None:
    """Unpacked beside the libraries: finds its own worlds and controllers, writes a record."""
    zipfile.ZipFile(wheel).extractall(tmp_path / "site")
    script = (
        "import json, physim, physim.controllers, physim.worlds\n"
        "from physim.parts.registry import CONTROLLER, find_part\n"
        "from physim.world.file.files import shipped_worlds, find_world\n"
        "from physim.cli import main\n"
        "main(['--version'])\n"
        "world = physim.load_world(find_world('straight'))\n"
        "print(json.dumps([[m.__file__ for m in (physim, physim.controllers, physim.worlds)],\n"
        "    sorted([*shipped_worlds(), *shipped_worlds('league'), *shipped_worlds('training')]),\n"
        "    find_world('league/lanes_2').with_name('league.yaml').is_file(),\n"
        "    find_part(CONTROLLER, 'mode_switching').__module__, world.name]))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True,
        env={**os.environ, "PYTHONPATH": str(tmp_path / "site")},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    version, told = done.stdout.splitlines()
    assert re.fullmatch(r"physim \d+\.\d+\.\d+", version)  # and no commit: this is no checkout
    files, worlds, programme, module, name = json.loads(told)
    assert all(Path(file).is_relative_to(tmp_path / "site") for file in files)
    on_disk = (file.relative_to(ROOT / "worlds") for file in (ROOT / "worlds").rglob("*.yaml"))
    assert worlds == sorted({str(file.with_suffix("")) for file in on_disk} - {"league/league"})
    assert programme
    assert module == "physim.controllers.mode_switching"
    assert name == "straight"
