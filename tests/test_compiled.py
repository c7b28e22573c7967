"""Kernels called from Python, from kernels, and from functions that know nothing of them."""

from __future__ import annotations

import math
import os
import pickle
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numba
import numpy as np
import pytest
from numba.core.caching import CacheImpl, IndexDataCacheFile, UserProvidedCacheLocator

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
