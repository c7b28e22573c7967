"""Kernels called from Python, from kernels, and from functions that know nothing of them."""

from __future__ import annotations

import math
import os
import pickle
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numba
import numpy as np
import pytest
from numba.core.caching import CacheImpl, IndexDataCacheFile, UserProvidedCacheLocator

import physim
from physim import compiled as compiled_module
from physim.compiled import compiled, is_cached
from tests.helpers import inside

FloatArray = inside("physim.geometry", "FloatArray")


@compiled
def leaf(values: FloatArray, factor: float) -> float:
    total = 0.0
    for value in values:
        total += factor * value
    return total


@compiled
def middle(values: FloatArray) -> float:
    return leaf(values, 2.0) + leaf(values[1:], 0.1)


@compiled
def top(values: FloatArray) -> float:
    return middle(values) + leaf(values, 3.0)


@compiled
def oddities(values: FloatArray) -> tuple[int, int, int]:
    nan, most, least = 0, 0, 0
    for value in values:
        if value != value:
            nan += 1
        elif value == np.inf:
            most += 1
        elif value == -np.inf:
            least += 1
    return nan, most, least


@compiled
def misfit(values: FloatArray) -> float:
    values[:2] = values[:3]
    return leaf(values, 1.0)


@compiled
def calls_misfit(values: FloatArray) -> float:
    return misfit(values)


VALUES = np.array([0.1, 0.7, 1.3, 2.9])


def test_kernels_agree_with_their_plain_functions() -> None:
    @numba.njit
    def outside(values: FloatArray) -> float:
        return float(top(values) + leaf(values, 1.0))

    for kernel in (middle, top):
        assert kernel(VALUES) == kernel.py_func(VALUES)  # type: ignore[attr-defined]
    assert outside(VALUES) == top(VALUES) + leaf(VALUES, 1.0)


def test_kernels_know_what_is_no_number_and_what_is_infinite() -> None:
    """Which a compiler that takes liberties with numbers may leave out."""
    odd = np.array([1.0, math.nan, math.inf, 2.0, -math.inf, math.nan])
    assert oddities(odd) == oddities.py_func(odd) == (2, 1, 1)  # type: ignore[attr-defined]


def test_the_stamp_changes_with_any_source(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Of the package and of the controllers; by what stands in a file, not by its name alone."""
    shutil.copytree(Path(compiled_module.__file__).parent, tmp_path / "physim")
    monkeypatch.setattr(compiled_module, "__file__", str(tmp_path / "physim" / "compiled.py"))
    stamp = compiled_module.source_stamp.__wrapped__
    seen = {stamp()}
    for name in ("tolerances.py", "geometry/convex.py", "simulation/run.py"):
        with (tmp_path / "physim" / name).open("a", encoding="utf-8") as file:
            file.write("# edited\n")
        seen.add(stamp())
    with (tmp_path / "physim/cli/run.py").open("a", encoding="utf-8") as file:
        file.write("# edited\n")  # no kernel stands there
    assert stamp() in seen
    assert len(seen) == 4


def short_run(name: str = "crossing", duration: float = 2.0) -> str:
    """Digest of a short run in which robots avoid each other."""
    world = physim.load_world(name, overrides=(f"time.duration={duration}",))
    with physim.simulate(world) as record:
        return record.digest()


@pytest.mark.deep
def test_a_run_of_plain_functions_is_the_same() -> None:
    """Robots touch from 4.28 s on. In other worlds last bits may differ, as those of powers do."""
    script = "from tests.test_compiled import *; print(type(leaf), short_run('jam', 4.4))"
    found = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", script], cwd=Path(__file__).parents[1],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert found.stdout.split() == ["<class", "'function'>", short_run("jam", 4.4)]


def test_a_cache_of_sources_that_have_gone_is_none(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """As after an update: what is stored names types of modules that have moved."""
    file = leaf.whole._cache._cache_file  # type: ignore[attr-defined]
    index = tmp_path / "leaf.nbi"
    index.write_bytes(pickle.dumps(file._version) + b"cphysim.gone\nType\n.")
    monkeypatch.setattr(file, "_index_path", str(index))
    with pytest.raises(ModuleNotFoundError):
        IndexDataCacheFile._load_index(file)  # type: ignore[no-untyped-call]
    assert file._load_index() == {}
    assert not compiled_module.is_cached(leaf)


@pytest.mark.parametrize("ending", ["nbi", "nbc"])
@pytest.mark.parametrize("share", [0.5, pytest.param(0.0, marks=pytest.mark.deep)])
def test_a_damaged_cache_is_compiled_anew(
    ending: str, share: float, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    expected = leaf.py_func(VALUES, 2.0)  # type: ignore[attr-defined]
    assert fresh()(VALUES, 2.0) == expected  # type: ignore[operator]
    (file,) = tmp_path.rglob(f"*.{ending}")
    whole = file.read_bytes()
    file.write_bytes(whole[: int(share * len(whole))])
    assert fresh()(VALUES, 2.0) == expected  # type: ignore[operator]
    read = fresh()
    assert read(VALUES, 2.0) == expected  # type: ignore[operator]
    assert sum(read.whole.stats.cache_hits.values()) == 1  # type: ignore[attr-defined]


def test_errors_come_out_of_inner_kernels() -> None:
    with pytest.raises(ValueError, match="cannot assign slice"):
        calls_misfit(VALUES.copy())


@pytest.fixture
def nowhere(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Path]:
    """Neither the sources nor the home are writable; an empty folder for temporary files."""
    monkeypatch.setattr(CacheImpl, "_locator_classes", [UserProvidedCacheLocator])
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    compiled_module._note.cache_clear()
    yield tmp_path
    compiled_module._note.cache_clear()


def fresh() -> object:
    return compiled(leaf.py_func)  # type: ignore[attr-defined]


def test_kernels_are_kept_in_a_temporary_folder_where_no_other_is_writable(
    nowhere: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kernel = fresh()
    assert kernel(VALUES, 2.0) == leaf.py_func(VALUES, 2.0)  # type: ignore
    (folder,) = nowhere.iterdir()
    assert is_cached(kernel)  # type: ignore[arg-type]
    assert folder.stat().st_mode & 0o077 == 0
    assert os.environ["NUMBA_CACHE_DIR"] == str(folder)  # worker processes use it too
    fresh()(VALUES, 2.0)  # type: ignore[operator]
    (line,) = capsys.readouterr().err.splitlines()
    assert str(folder) in line
    assert "NUMBA_CACHE_DIR" in line


def test_kernels_run_without_a_cache_where_the_temporary_folder_is_not_the_users(
    nowhere: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = nowhere / f"physim-kernels-{os.getuid()}"
    folder.mkdir()
    folder.chmod(0o777)
    for kernel in (fresh(), fresh()):
        assert kernel(VALUES, 2.0) == leaf.py_func(VALUES, 2.0)  # type: ignore
        assert not is_cached(kernel)  # type: ignore[arg-type]
    assert not list(folder.iterdir())
    (line,) = capsys.readouterr().err.splitlines()
    assert "compiled anew each time" in line
    assert "NUMBA_CACHE_DIR" in line
